//! Which faces touch: of shapes whose boxes meet, the primitives in the boxes' intersection.

use crate::{
    math::{Bounds, DVec3, Vec3, offset::gamma},
    shape::{Patch, Shape, ShapeModel as _},
};
use obvhs::{
    BvhBuildParams,
    aabb::Aabb,
    bvh2::{Bvh2, builder::build_bvh2},
};
use rayon::prelude::*;
use std::time::Duration;

/// The largest distance of touching faces, relative to coordinates: shapes that are farther apart are not compared.
const MOST: f64 = 3e-5;
/// Rays from farther away, relative to the coordinates of two shapes, cannot resolve their places.
const BEYOND: f64 = 100.0;
/// How near faces may come, over their [`Patch::skew`].
const SKEW: f64 = gamma(48) as f64;

/// Two faces in one place.
pub(super) struct Pair {
    pub shapes: [u32; 2],
    pub primitives: [usize; 2],
    pub patches: [Patch; 2],
    /// Nearer than this, along the normal, rays may step over one of them (m).
    pub reach: f64,
}

/// Two shapes whose boxes meet.
struct Near<'a> {
    shapes: [&'a Shape; 2],
    /// The intersection of their boxes.
    common: Aabb,
    /// By how much boxes are widened (m).
    slack: Vec3,
    /// How near faces may come, per axis (m).
    reach: DVec3,
    /// The size of the smaller shape (m).
    smaller: f64,
}

/// A primitive with the box around it.
struct Boxed {
    primitive: usize,
    bounds: Aabb,
}

/// All pairs of faces of different shapes that are nearer than they may be. The shapes have these `bounds`; `closeness`
/// is the limit for two shapes, relative to the coordinates of rays to them; `farthest` are the largest of the scene.
pub(super) fn pairs(
    shapes: &[Shape],
    bounds: &[Bounds],
    farthest: DVec3,
    closeness: &dyn Fn([u32; 2]) -> f64,
) -> Vec<Pair> {
    let is_patched = |shape: &u32| !matches!(shapes[*shape as usize], Shape::Instance(_));
    let mut order: Vec<u32> = (0..shapes.len() as u32).filter(is_patched).collect();
    order.sort_by(|a, b| bounds[*a as usize].low.x.total_cmp(&bounds[*b as usize].low.x));
    let mut found = Vec::new();
    for (index, &a) in order.iter().enumerate() {
        let end = f64::from(bounds[a as usize].high.x) + farthest.x * MOST;
        let meets = |b: &&u32| f64::from(bounds[**b as usize].low.x) <= end;
        for &b in order[index + 1..].iter().take_while(meets) {
            let pair = [a.min(b), a.max(b)];
            if let Some(near) = Near::of(shapes, bounds, pair, farthest, closeness(pair)) {
                found.extend(near.touching(pair));
            }
        }
    }
    found
}

/// The largest coordinate per axis.
pub(super) fn far(Bounds { low, high }: &Bounds) -> DVec3 {
    low.abs().max(high.abs()).as_dvec3()
}

impl<'a> Near<'a> {
    fn of(
        shapes: &'a [Shape],
        bounds: &[Bounds],
        pair: [u32; 2],
        farthest: DVec3,
        closeness: f64,
    ) -> Option<Self> {
        let [a, b] = pair.map(|shape| bounds[shape as usize]);
        let far = far(&a).max(far(&b));
        let far = far.max(farthest.min(DVec3::splat(BEYOND * far.max_element())));
        let slack = (far * MOST).as_vec3();
        let (low, high) = (a.low.max(b.low) - slack, a.high.min(b.high) + slack);
        if low.cmpgt(high).any() {
            return None;
        }
        let size = |bounds: Bounds| f64::from(bounds.size().length());
        Some(Self {
            shapes: pair.map(|shape| &shapes[shape as usize]),
            common: Aabb::new(low.into(), high.into()),
            slack,
            reach: far * closeness,
            smaller: size(a).min(size(b)),
        })
    }

    /// The faces that touch; the shapes are those of `pair`.
    fn touching(&self, pair: [u32; 2]) -> Vec<Pair> {
        let [one, other] = self.shapes;
        meeting(&self.within(one), &self.within(other), &|a, met| {
            let Some(first) = one.primitive(a).patch() else { return Vec::new() };
            let touch = |b: &usize| {
                let patches = [first.clone(), other.primitive(*b).patch()?];
                let reach = self.along_normal(&patches);
                patches[0].height_of(&patches[1], reach)?;
                Some(Pair { shapes: pair, primitives: [a, *b], patches, reach })
            };
            met.iter().filter_map(touch).collect()
        })
    }

    /// The primitives of a shape that reach into the common box.
    fn within(&self, shape: &Shape) -> Vec<Boxed> {
        let boxed = |primitive: usize| {
            let Bounds { low, high } = shape.primitive(primitive).bounds().grown(self.slack);
            Boxed { primitive, bounds: Aabb::new(low.into(), high.into()) }
        };
        let all = (0..shape.primitive_count()).map(boxed);
        all.filter(|boxed| boxed.bounds.intersect_aabb(&self.common)).collect()
    }

    /// How near two patches may come along their normal (m); round ones have all normals. No more than a thousandth of the
    /// smaller shape, so that nothing thin is turned inside out, but more than rounding.
    fn along_normal(&self, [one, other]: &[Patch; 2]) -> f64 {
        let along =
            one.plane_normal().map_or(self.reach.max_element(), |normal| normal.abs().dot(self.reach));
        let along = along + SKEW * one.skew().max(other.skew());
        along.min((1e-3 * self.smaller).max(0.2 * along))
    }
}

/// What `find` finds of each primitive of `a` and some of `b`, in the order of `a`: at least those whose boxes meet its own.
fn meeting(a: &[Boxed], b: &[Boxed], find: &(dyn Fn(usize, &[usize]) -> Vec<Pair> + Sync)) -> Vec<Pair> {
    const FEW: usize = 1 << 14;
    if a.len() * b.len() <= FEW {
        let of = |one: &Boxed| {
            let met = b.iter().filter(|other| other.bounds.intersect_aabb(&one.bounds));
            find(one.primitive, &met.map(|other| other.primitive).collect::<Vec<_>>())
        };
        return a.iter().flat_map(of).collect();
    }
    let tree = tree(b);
    let of = |one: &Boxed| {
        let mut met = Vec::new();
        tree.aabb_traverse(one.bounds, |tree, node| {
            let node = &tree.nodes[node as usize];
            let first = node.first_index as usize;
            let indices = &tree.primitive_indices[first..first + node.prim_count as usize];
            met.extend(indices.iter().map(|index| b[*index as usize].primitive));
            true
        });
        find(one.primitive, &met)
    };
    a.par_iter().flat_map_iter(of).collect()
}

fn tree(boxed: &[Boxed]) -> Bvh2 {
    let boxes: Vec<Aabb> = boxed.iter().map(|boxed| boxed.bounds).collect();
    build_bvh2(&boxes, BvhBuildParams::fast_build(), &mut Duration::default())
}
