//! The innermost loop: a ray against four flat primitives at once, or against one sphere.

use super::tree::Label;
use crate::{
    math::{Vec3, axes, offset::SEAM},
    shape::{Flat, Hit, Ray},
};
use glam::{BVec4A, Vec4};

/// The same component of four vectors, x, y and z.
#[derive(Clone, Copy, Debug, Default)]
struct Lanes([Vec4; 3]);

impl Lanes {
    fn set(&mut self, lane: usize, v: Vec3) {
        for (axis, component) in self.0.iter_mut().zip(v.to_array()) {
            axis[lane] = component;
        }
    }

    /// Summed in the order of `Vec3::dot`: signs of direction . normal must come out as elsewhere.
    #[inline(always)]
    fn dot(&self, v: &[Vec4; 3]) -> Vec4 {
        (self.0[0] * v[0] + self.0[1] * v[1]) + self.0[2] * v[2]
    }
}

/// A ray spread over four lanes.
#[derive(Clone, Copy, Debug)]
pub(super) struct WideRay {
    pub(super) origin: [Vec4; 3],
    pub(super) direction: [Vec4; 3],
}

impl WideRay {
    #[inline(always)]
    pub(super) fn new(ray: &Ray) -> Self {
        Self {
            origin: axes(|i| Vec4::splat(ray.origin[i])),
            direction: axes(|i| Vec4::splat(ray.direction[i])),
        }
    }
}

/// Up to four flat primitives, each as a plane and two reciprocal axes. Empty lanes are never hit. They are four whole cache
/// lines, not parts of five.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
pub(super) struct FlatPack {
    corner: Lanes,
    normal: Lanes,
    axis_u: Lanes,
    axis_v: Lanes,
    /// 1 for triangles, 0 for parallelograms.
    fold: Vec4,
    /// Greatest length of the reciprocal axes (1/m): how fast errors in position become errors in u and v.
    reach: Vec4,
    labels: [Label; 4],
}

/// What four lanes found.
struct Found {
    hit: BVec4A,
    t: Vec4,
    u: Vec4,
    v: Vec4,
}

impl FlatPack {
    /// From at most four primitives.
    pub(super) fn new(flats: &[(Label, Flat)]) -> Self {
        let mut pack = Self::default();
        for (lane, (label, flat)) in flats.iter().enumerate() {
            pack.set(lane, *label, flat);
        }
        pack
    }

    fn set(&mut self, lane: usize, label: Label, flat: &Flat) {
        let (u, v) = (flat.edge_u.as_dvec3(), flat.edge_v.as_dvec3());
        let cross = u.cross(v);
        let (axis_u, axis_v) =
            (v.cross(cross) / cross.length_squared(), cross.cross(u) / cross.length_squared());
        self.corner.set(lane, flat.corner);
        self.normal.set(lane, flat.normal);
        self.axis_u.set(lane, axis_u.as_vec3());
        self.axis_v.set(lane, axis_v.as_vec3());
        self.fold[lane] = if flat.triangle { 1.0 } else { 0.0 };
        self.reach[lane] = axis_u.length().max(axis_v.length()) as f32;
        self.labels[lane] = label;
    }

    /// Plane first, then (u, v) of the point where the ray hits it: both relative to the corner, so that
    /// nothing cancels near the primitive however far it is from the origin of space.
    #[inline(always)]
    fn test(&self, ray: &WideRay, t_max: f32) -> Found {
        let from = axes(|i| ray.origin[i] - self.corner.0[i]);
        let t = -self.normal.dot(&from) / self.normal.dot(&ray.direction);
        let at = axes(|i| from[i] + t * ray.direction[i]);
        let (u, v) = (self.axis_u.dot(&at), self.axis_v.dot(&at));
        let slack = Vec4::splat(SEAM) + Vec4::splat(SEAM) * self.reach * t;
        let (low, high) = (u.min(v), u.max(v));
        let inside = low.cmpge(-slack) & (high + self.fold * low).cmple(Vec4::ONE + slack);
        let hit = inside & t.cmpgt(Vec4::ZERO) & t.cmplt(Vec4::splat(t_max));
        Found { hit, t, u, v }
    }

    /// The nearest hit with t in (0, `t_max`).
    #[inline(always)]
    pub(super) fn closest(&self, ray: &WideRay, t_max: f32) -> Option<Hit> {
        let found = self.test(ray, t_max);
        if !found.hit.any() {
            return None;
        }
        let t = Vec4::select(found.hit, found.t, Vec4::INFINITY);
        let nearest = t.min_element();
        let lane = t.cmpeq(Vec4::splat(nearest)).bitmask().trailing_zeros() as usize & 3;
        let (u, v) = (found.u.to_array()[lane], found.v.to_array()[lane]);
        let [shape, primitive] = self.labels[lane];
        Some(Hit { t: nearest, shape, primitive, u, v })
    }

    /// True if anything is hit with t in (0, `t_max`).
    #[inline(always)]
    pub(super) fn occluded(&self, ray: &WideRay, t_max: f32) -> bool {
        self.test(ray, t_max).hit.any()
    }
}

/// One sphere.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ball {
    /// Its centre.
    pub center: Vec3,
    /// Its radius (m).
    pub radius: f32,
    /// Whose it is.
    pub label: Label,
}

impl Ball {
    /// The nearest hit with t in (0, `t_max`). From outside, the discriminant comes from the ray's distance to
    /// the centre and the roots without subtraction (Haines et al. 2019, "Precision improvements for
    /// ray/sphere intersection"). From inside every ray hits: there b^2 - c is a sum and cannot vanish.
    #[inline(always)]
    pub(super) fn closest(&self, ray: &Ray, t_max: f32) -> Option<Hit> {
        let to_center = self.center - ray.origin;
        let squared = self.radius * self.radius;
        let b = to_center.dot(ray.direction);
        let c = to_center.length_squared() - squared;
        let across = to_center - b * ray.direction;
        let outside = c > 0.0;
        let discriminant = if outside { squared - across.length_squared() } else { b * b - c };
        if discriminant < 0.0 {
            return None;
        }
        let q = b + discriminant.sqrt().copysign(b);
        let (near, far) = if q > 0.0 { (c / q, q) } else { (q, c / q) };
        let t = if outside { near } else { far };
        let [shape, primitive] = self.label;
        (t > 0.0 && t < t_max).then_some(Hit { t, shape, primitive, u: 0.0, v: 0.0 })
    }
}
