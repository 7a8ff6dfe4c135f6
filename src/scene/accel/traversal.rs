//! Rays through the hierarchy: nearest hit in order of distance, any hit in any order.

use super::{
    pack::WideRay,
    tree::{BEYOND, FLATS, INNER, KIND, Node, RARE, ROUND, Tree},
};
use crate::{
    math::{
        axes,
        offset::{BOX_WIDENING, LEAST_COMPONENT},
    },
    shape::{CurvedModel, Hit, Ray},
};
use glam::Vec4;

/// A ray's reciprocal direction over four lanes, finite in every component.
struct Slabs {
    origin: [Vec4; 3],
    inverse: [Vec4; 3],
    /// Per axis: which of a box's two planes the ray crosses first.
    first: [usize; 3],
}

impl Slabs {
    #[inline(always)]
    fn new(ray: &Ray, wide: &WideRay) -> Self {
        let least = |d: f32| if d.abs() < LEAST_COMPONENT { LEAST_COMPONENT.copysign(d) } else { d };
        let direction = axes(|i| least(ray.direction[i]));
        Self {
            origin: wide.origin,
            inverse: axes(|i| Vec4::splat(1.0 / direction[i])),
            first: axes(|i| usize::from(direction[i] < 0.0)),
        }
    }

    /// Which boxes the ray hits before `t_max` (a bit each), and where it enters them.
    #[inline(always)]
    fn enter(&self, node: &Node, t_max: f32) -> (u32, Vec4) {
        let (mut near, mut far) = (Vec4::ZERO, Vec4::INFINITY);
        for axis in 0..3 {
            let first = self.first[axis] & 1;
            let (a, b) = (node.planes[first][axis], node.planes[1 - first][axis]);
            near = near.max((a - self.origin[axis]) * self.inverse[axis]);
            far = far.min((b - self.origin[axis]) * self.inverse[axis]);
        }
        let far = (far * BOX_WIDENING).min(Vec4::splat(t_max));
        (near.cmple(far).bitmask(), near)
    }
}

/// A subtree yet to be visited: where the ray enters its box, and what it is.
type Entry = (f32, u32);

/// Room for the siblings left behind on the way down an ordinary tree.
const SHALLOW: usize = 64;

impl Tree {
    /// The nearest hit with t in (0, `t_max`).
    #[inline]
    pub(super) fn closest(&self, ray: &Ray) -> Option<Hit> {
        match self.stack_need() {
            0 => self.closest_of_list(ray),
            1..=SHALLOW => self.closest_below::<false>(ray, &mut [(0.0, 0); SHALLOW]),
            need => self.closest_rarely(ray, need),
        }
    }

    /// True if anything is hit with t in (0, `t_max`).
    #[inline]
    pub(super) fn occluded(&self, ray: &Ray) -> bool {
        match self.stack_need() {
            0 => self.occluded_by_list(ray),
            1..=SHALLOW => self.occluded_below::<false>(ray, &mut [0; SHALLOW]),
            need => self.occluded_rarely(ray, need),
        }
    }

    /// Entries on the stack: each level leaves at most three siblings, the last one of a shadow ray all four children. 0 for
    /// a plain list. With curved primitives, [`RARE`] levels more.
    #[inline]
    fn stack_need(&self) -> usize {
        if self.depth == 0 { 0 } else { 3 * self.depth + 1 }
    }

    /// Very deep trees, and curved primitives.
    #[inline(never)]
    fn closest_rarely(&self, ray: &Ray, need: usize) -> Option<Hit> {
        if need < RARE {
            return self.closest_below::<false>(ray, &mut vec![(0.0, 0); need]);
        }
        match need - 3 * RARE {
            1 => self.closest_of_mixed_list(ray),
            2..=SHALLOW => self.closest_below::<true>(ray, &mut [(0.0, 0); SHALLOW]),
            need => self.closest_below::<true>(ray, &mut vec![(0.0, 0); need]),
        }
    }

    /// Very deep trees, and curved primitives.
    #[inline(never)]
    fn occluded_rarely(&self, ray: &Ray, need: usize) -> bool {
        if need < RARE {
            return self.occluded_below::<false>(ray, &mut vec![0; need]);
        }
        match need - 3 * RARE {
            1 => self.occluded_by_mixed_list(ray),
            2..=SHALLOW => self.occluded_below::<true>(ray, &mut [0; SHALLOW]),
            need => self.occluded_below::<true>(ray, &mut vec![0; need]),
        }
    }

    #[inline]
    fn closest_of_list(&self, ray: &Ray) -> Option<Hit> {
        let wide = WideRay::new(ray);
        let mut best = Best::new(ray);
        for pack in &self.packs {
            best.offer(pack.closest(&wide, best.t_max));
        }
        for ball in &self.balls {
            best.offer(ball.closest(ray, best.t_max));
        }
        best.hit
    }

    fn closest_of_mixed_list(&self, ray: &Ray) -> Option<Hit> {
        let mut best = Best::new(ray);
        best.offer(self.closest_of_list(ray));
        for index in 0..self.curved.len() {
            best.offer(self.closest_of_curved(index, ray, best.t_max));
        }
        best.hit
    }

    #[inline]
    fn occluded_by_list(&self, ray: &Ray) -> bool {
        let wide = WideRay::new(ray);
        self.packs.iter().any(|pack| pack.occluded(&wide, ray.t_max))
            || self.balls.iter().any(|ball| ball.closest(ray, ray.t_max).is_some())
    }

    fn occluded_by_mixed_list(&self, ray: &Ray) -> bool {
        self.occluded_by_list(ray)
            || self.curved.iter().any(|(curved, _)| curved.closest(ray, ray.t_max).is_some())
    }

    fn closest_of_curved(&self, index: usize, ray: &Ray, t_max: f32) -> Option<Hit> {
        let (curved, primitive) = &self.curved[index];
        curved.closest(ray, t_max).map(|[t, u, v]| Hit { t, primitive: *primitive, u, v })
    }

    /// What `index` of a reference to a [`ROUND`] refers to, in a tree with `CURVED` primitives or without.
    #[inline(always)]
    fn closest_of_round<const CURVED: bool>(&self, index: usize, ray: &Ray, t_max: f32) -> Option<Hit> {
        if CURVED && index & BEYOND as usize != 0 {
            return self.closest_of_curved(index & !(BEYOND as usize), ray, t_max);
        }
        self.balls[index].closest(ray, t_max)
    }

    fn closest_below<const CURVED: bool>(&self, ray: &Ray, stack: &mut [Entry]) -> Option<Hit> {
        let wide = WideRay::new(ray);
        let slabs = Slabs::new(ray, &wide);
        let mut best = Best::new(ray);
        let (mut current, mut height) = (INNER, 0);
        loop {
            let index = (current & !KIND) as usize;
            let nearest = match current & KIND {
                INNER => self.open(index, &slabs, best.t_max, stack, &mut height),
                kind => {
                    best.offer(match kind {
                        FLATS => self.packs[index].closest(&wide, best.t_max),
                        _ => self.closest_of_round::<CURVED>(index, ray, best.t_max),
                    });
                    None
                }
            };
            let Some(next) = nearest.or_else(|| nearer(stack, &mut height, best.t_max)) else {
                return best.hit;
            };
            current = next;
        }
    }

    /// The nearest of the children that the ray hits, if it hits one; the others are put on the stack, nearer ones above.
    #[inline(always)]
    fn open(
        &self,
        index: usize,
        slabs: &Slabs,
        t_max: f32,
        stack: &mut [Entry],
        height: &mut usize,
    ) -> Option<u32> {
        let node = &self.nodes[index];
        let (mut mask, near) = slabs.enter(node, t_max);
        let near = near.to_array();
        let mut take = || {
            let slot = mask.trailing_zeros() as usize & 3;
            let found = (mask != 0).then(|| (near[slot], node.child[slot]));
            mask &= mask.wrapping_sub(1);
            found
        };
        let mut nearest = take()?;
        let base = *height;
        while let Some(other) = take() {
            let (first, later) = if other.0 > nearest.0 { (nearest, other) } else { (other, nearest) };
            nearest = first;
            let mut at = *height;
            while at > base && stack[at - 1].0 < later.0 {
                stack[at] = stack[at - 1];
                at -= 1;
            }
            stack[at] = later;
            *height += 1;
        }
        Some(nearest.1)
    }

    fn occluded_below<const CURVED: bool>(&self, ray: &Ray, stack: &mut [u32]) -> bool {
        let wide = WideRay::new(ray);
        let slabs = Slabs::new(ray, &wide);
        let mut height = 1;
        stack[0] = INNER;
        while height > 0 {
            height -= 1;
            let node = &self.nodes[(stack[height] & !KIND) as usize];
            let (mut mask, _) = slabs.enter(node, ray.t_max);
            while mask != 0 {
                let child = node.child[mask.trailing_zeros() as usize & 3];
                mask &= mask - 1;
                let index = (child & !KIND) as usize;
                let blocked = match child & KIND {
                    FLATS => self.packs[index].occluded(&wide, ray.t_max),
                    ROUND => self.closest_of_round::<CURVED>(index, ray, ray.t_max).is_some(),
                    _ => {
                        stack[height] = child;
                        height += 1;
                        false
                    }
                };
                if blocked {
                    return true;
                }
            }
        }
        false
    }
}

/// Takes the uppermost subtree off the stack that the ray enters before `t_max`, and all above it.
#[inline(always)]
fn nearer(stack: &[Entry], height: &mut usize, t_max: f32) -> Option<u32> {
    while *height > 0 {
        *height -= 1;
        let (near, next) = stack[*height];
        if near < t_max {
            return Some(next);
        }
    }
    None
}

/// The nearest hit so far.
struct Best {
    hit: Option<Hit>,
    t_max: f32,
}

impl Best {
    #[inline(always)]
    fn new(ray: &Ray) -> Self {
        Self { hit: None, t_max: ray.t_max }
    }

    #[inline(always)]
    fn offer(&mut self, hit: Option<Hit>) {
        if let Some(nearer) = hit {
            self.t_max = nearer.t;
            self.hit = hit;
        }
    }
}
