//! Rays through the hierarchy: nearest hit in order of distance, any hit in any order.

use super::{
    pack::WideRay,
    tree::{BEYOND, FLATS, Form, INNER, KIND, Node, ROUND, Tree, WIDTH},
};
use crate::{
    math::{
        axes,
        offset::{BOX_WIDENING, LEAST_COMPONENT},
    },
    shape::{CurvedModel, Hit, Ray},
};
use wide::f32x8;

/// A ray over eight lanes, with its reciprocal direction, finite in every component.
struct Slabs {
    origin: [f32x8; 3],
    inverse: [f32x8; 3],
    /// Per axis: which of a box's two planes the ray crosses first.
    first: [usize; 3],
}

impl Slabs {
    #[inline(always)]
    fn new(ray: &Ray) -> Self {
        let least = |d: f32| if d.abs() < LEAST_COMPONENT { LEAST_COMPONENT.copysign(d) } else { d };
        let direction = axes(|i| least(ray.direction[i]));
        Self {
            origin: axes(|i| f32x8::splat(ray.origin[i])),
            inverse: axes(|i| f32x8::splat(1.0 / direction[i])),
            first: axes(|i| usize::from(direction[i] < 0.0)),
        }
    }

    /// Which boxes the ray hits before `t_max` (a bit each), and where it enters them.
    #[inline(always)]
    fn enter(&self, node: &Node, t_max: f32) -> (u32, f32x8) {
        let (mut near, mut far) = (f32x8::ZERO, f32x8::splat(f32::INFINITY));
        for axis in 0..3 {
            let first = self.first[axis] & 1;
            let (a, b) = (node.planes[first][axis], node.planes[1 - first][axis]);
            near = near.fast_max((a - self.origin[axis]) * self.inverse[axis]);
            far = far.fast_min((b - self.origin[axis]) * self.inverse[axis]);
        }
        let far = (far * BOX_WIDENING).fast_min(f32x8::splat(t_max));
        (near.simd_le(far).to_bitmask(), near)
    }
}

/// A subtree yet to be visited: where the ray enters its box, and what it is.
type Entry = (f32, u32);

/// Room for the siblings that rays leave behind on their way down ordinary trees.
const SHALLOW: usize = 64;

/// The stack has no room for the children of one more node.
#[derive(Debug)]
pub(super) struct Full;

impl Tree {
    /// The nearest hit with t in (0, `t_max`).
    #[inline]
    pub(super) fn closest(&self, ray: &Ray) -> Option<Hit> {
        match self.form {
            Form::List => self.closest_of_list(ray),
            Form::Nodes => self.closest_of_nodes::<false>(ray),
            Form::CurvedList => self.closest_of_mixed_list(ray),
            Form::CurvedNodes => self.closest_of_mixed_nodes(ray),
        }
    }

    /// True if anything is hit with t in (0, `t_max`).
    #[inline]
    pub(super) fn occluded(&self, ray: &Ray) -> bool {
        match self.form {
            Form::List => self.occluded_by_list(ray),
            Form::Nodes => self.occluded_by_nodes::<false>(ray),
            Form::CurvedList => self.occluded_by_mixed_list(ray),
            Form::CurvedNodes => self.occluded_by_mixed_nodes(ray),
        }
    }

    #[inline]
    fn closest_of_nodes<const CURVED: bool>(&self, ray: &Ray) -> Option<Hit> {
        let found = self.closest_below::<CURVED>(ray, &mut [(0.0, 0); SHALLOW]);
        found.unwrap_or_else(|Full| self.closest_deep::<CURVED>(ray))
    }

    #[inline(never)]
    fn closest_of_mixed_nodes(&self, ray: &Ray) -> Option<Hit> {
        self.closest_of_nodes::<true>(ray)
    }

    /// In very deep trees: with as much room as it takes.
    #[inline(never)]
    fn closest_deep<const CURVED: bool>(&self, ray: &Ray) -> Option<Hit> {
        let mut room = 2 * SHALLOW;
        loop {
            match self.closest_below::<CURVED>(ray, &mut vec![(0.0, 0); room]) {
                Ok(hit) => return hit,
                Err(Full) => room *= 2,
            }
        }
    }

    #[inline]
    fn occluded_by_nodes<const CURVED: bool>(&self, ray: &Ray) -> bool {
        let found = self.occluded_below::<CURVED>(ray, &mut [0; SHALLOW]);
        found.unwrap_or_else(|Full| self.occluded_deep::<CURVED>(ray))
    }

    #[inline(never)]
    fn occluded_by_mixed_nodes(&self, ray: &Ray) -> bool {
        self.occluded_by_nodes::<true>(ray)
    }

    /// In very deep trees: with as much room as it takes.
    #[inline(never)]
    pub(super) fn occluded_deep<const CURVED: bool>(&self, ray: &Ray) -> bool {
        let mut room = 2 * SHALLOW;
        loop {
            match self.occluded_below::<CURVED>(ray, &mut vec![0; room]) {
                Ok(found) => return found,
                Err(Full) => room *= 2,
            }
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
        let (curved, [shape, primitive]) = &self.curved[index];
        let hit = |[t, u, v]: [f32; 3]| Hit { t, shape: *shape, primitive: *primitive, u, v };
        curved.closest(ray, t_max).map(hit)
    }

    /// What `index` of a reference to a [`ROUND`] refers to, in a tree with `CURVED` primitives or without.
    #[inline(always)]
    fn closest_of_round<const CURVED: bool>(&self, index: usize, ray: &Ray, t_max: f32) -> Option<Hit> {
        if CURVED && index & BEYOND as usize != 0 {
            return self.closest_of_curved(index & !(BEYOND as usize), ray, t_max);
        }
        self.balls[index].closest(ray, t_max)
    }

    pub(super) fn closest_below<const CURVED: bool>(
        &self,
        ray: &Ray,
        stack: &mut [Entry],
    ) -> Result<Option<Hit>, Full> {
        let (wide, slabs) = (WideRay::new(ray), Slabs::new(ray));
        let mut best = Best::new(ray);
        let (mut current, mut height) = (INNER, 0);
        loop {
            let index = (current & !KIND) as usize;
            let nearest = match current & KIND {
                INNER if height + WIDTH > stack.len() => return Err(Full),
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
                return Ok(best.hit);
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
            let slot = mask.trailing_zeros() as usize % WIDTH;
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

    fn occluded_below<const CURVED: bool>(&self, ray: &Ray, stack: &mut [u32]) -> Result<bool, Full> {
        let (wide, slabs) = (WideRay::new(ray), Slabs::new(ray));
        let mut height = 1;
        stack[0] = INNER;
        while height > 0 {
            height -= 1;
            if height + WIDTH > stack.len() {
                return Err(Full);
            }
            let node = &self.nodes[(stack[height] & !KIND) as usize];
            let (mut mask, _) = slabs.enter(node, ray.t_max);
            while mask != 0 {
                let child = node.child[mask.trailing_zeros() as usize % WIDTH];
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
                    return Ok(true);
                }
            }
        }
        Ok(false)
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
