//! Flat primitives.

use crate::math::{DVec3, Vec3, offset::gamma};

/// The points corner + u `edge_u` + v `edge_v`: u, v in [0, 1], and u + v <= 1 for a triangle.
#[derive(Clone, Copy, Debug)]
pub struct Flat {
    /// u = v = 0.
    pub corner: Vec3,
    /// To u = 1.
    pub edge_u: Vec3,
    /// To v = 1.
    pub edge_v: Vec3,
    /// Unit normal, the very one (or its opposite) that surface points report: both must agree bit for bit on
    /// which side a direction leaves to.
    pub normal: Vec3,
    /// Triangle or parallelogram.
    pub triangle: bool,
}

impl Flat {
    /// u and v of a point near it.
    pub fn coordinates(&self, point: DVec3) -> [f64; 2] {
        let [corner, u, v] = [self.corner, self.edge_u, self.edge_v].map(|p| p.as_dvec3());
        let (at, cross) = (point - corner, u.cross(v));
        [v.cross(cross), cross.cross(u)].map(|axis| at.dot(axis) / cross.length_squared())
    }
}

/// Bound on how far corner + (`along_u` + `along_v`) and the ray tracer's idea of the plane there can be
/// apart, per axis: one rounding of the sum against `corner`; of the rest, two roundings here, one in each
/// edge, one in the plane's normal, and five in the ray tracer's normal . (origin - corner).
#[inline]
pub(super) fn flat_error(corner: Vec3, along_u: Vec3, along_v: Vec3) -> Vec3 {
    gamma(2) * corner.abs() + gamma(12) * (along_u.abs() + along_v.abs())
}
