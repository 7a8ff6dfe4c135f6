//! Which faces touch: shapes whose boxes meet, and of these the primitives in what the boxes have in common.

use crate::{
    math::{DVec3, Vec3},
    shape::{Patch, Shape, ShapeModel as _},
};
use obvhs::{
    BvhBuildParams,
    aabb::Aabb,
    bvh2::{Bvh2, builder::build_bvh2},
};
use std::time::Duration;

/// The most that `reach` is of coordinates: beyond it boxes are not compared.
const MOST_REACH: f64 = 1e-4;

/// Two faces in one place.
pub struct Pair {
    pub shapes: [u32; 2],
    pub primitives: [usize; 2],
    pub patches: [Patch; 2],
    /// Nearer than this, along the normal, rays may step over one of them [m].
    pub reach: f64,
}

/// A primitive with the box around it.
struct Boxed {
    primitive: usize,
    bounds: Aabb,
}

/// The largest coordinate per axis.
pub fn far((low, high): &(Vec3, Vec3)) -> DVec3 {
    low.abs().max(high.abs()).as_dvec3()
}

/// All pairs of faces of different shapes, in their `bounds`, that are nearer than they may be: by `reach` per axis [m], no more
/// than `MOST_REACH` of their coordinates.
pub fn pairs(shapes: &[Shape], bounds: &[(Vec3, Vec3)], reach: &dyn Fn([u32; 2]) -> DVec3) -> Vec<Pair> {
    let mut order: Vec<u32> = (0..shapes.len() as u32).collect();
    order.sort_by(|a, b| bounds[*a as usize].0.x.total_cmp(&bounds[*b as usize].0.x));
    let farthest = bounds.iter().map(far).fold(DVec3::ZERO, DVec3::max).x * MOST_REACH;
    let mut found = Vec::new();
    for (index, &a) in order.iter().enumerate() {
        let (low, high) = bounds[a as usize];
        for &b in &order[index + 1..] {
            let (l, h) = bounds[b as usize];
            if f64::from(l.x) > f64::from(high.x) + farthest {
                break;
            }
            let pair = [a.min(b), a.max(b)];
            let reach = reach(pair);
            let slack = reach.as_vec3();
            let common = (low.max(l) - slack, high.min(h) + slack);
            if common.0.cmple(common.1).all() {
                touching(shapes, pair, Aabb::new(common.0.into(), common.1.into()), reach, &mut found);
            }
        }
    }
    found
}

/// Adds the faces of two shapes that touch within a box.
fn touching(shapes: &[Shape], pair: [u32; 2], common: Aabb, reach: DVec3, found: &mut Vec<Pair>) {
    let [one, other] = pair.map(|shape| &shapes[shape as usize]);
    let [a, b] = [one, other].map(|shape| within(shape, &common, reach.as_vec3()));
    let size = |shape: &Shape| f64::from((shape.bounds().1 - shape.bounds().0).length());
    let smaller = size(one).min(size(other));
    each_meeting(&a, &b, |a, b| {
        let patches = [Patch::of(&one.primitive(a)), Patch::of(&other.primitive(b))];
        let reach = along_normal(&patches[0], reach, smaller);
        if patches[0].height_of(&patches[1], reach).is_some() {
            found.push(Pair { shapes: pair, primitives: [a, b], patches, reach });
        }
    });
}

/// Calls `test` with every two primitives whose boxes meet.
fn each_meeting(a: &[Boxed], b: &[Boxed], mut test: impl FnMut(usize, usize)) {
    const FEW: usize = 1 << 14;
    if a.len() * b.len() <= FEW {
        for one in a {
            let met = b.iter().filter(|other| one.bounds.intersect_aabb(&other.bounds));
            met.for_each(|other| test(one.primitive, other.primitive));
        }
        return;
    }
    let tree = tree(b);
    for one in a {
        tree.aabb_traverse(one.bounds, |tree, node| {
            let node = &tree.nodes[node as usize];
            let first = node.first_index as usize;
            let indices = &tree.primitive_indices[first..first + node.prim_count as usize];
            indices.iter().for_each(|index| test(one.primitive, b[*index as usize].primitive));
            true
        });
    }
}

fn tree(boxed: &[Boxed]) -> Bvh2 {
    let boxes: Vec<Aabb> = boxed.iter().map(|boxed| boxed.bounds).collect();
    build_bvh2(&boxes, BvhBuildParams::fast_build(), &mut Duration::default())
}

/// The primitives of a shape that reach into a box.
fn within(shape: &Shape, common: &Aabb, slack: Vec3) -> Vec<Boxed> {
    let boxed = |primitive: usize| {
        let (low, high) = shape.primitive(primitive).bounds();
        Boxed { primitive, bounds: Aabb::new((low - slack).into(), (high + slack).into()) }
    };
    (0..shape.primitive_count()).map(boxed).filter(|boxed| boxed.bounds.intersect_aabb(common)).collect()
}

/// What reaches so far per axis, along the normal of a patch; round ones have all normals. No more than a thousandth of the
/// `smaller` shape, so that nothing thin is turned inside out, but more than rounding.
fn along_normal(patch: &Patch, reach: DVec3, smaller: f64) -> f64 {
    let along = patch.plane_normal().map_or(reach.max_element(), |normal| normal.abs().dot(reach));
    along.min((1e-3 * smaller).max(0.2 * along))
}
