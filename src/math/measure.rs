//! The only place where a density changes its measure: every cos/d^2 and 1/d^2 is here.

use super::Vec3;

/// Geometry factor from solid angle to the measure of the reached vertex (LW96 eq. 13):
/// |cos|/d^2 (1/m^2) on a surface, 1/d^2 in a medium (`cosine` = 1). `distance_squared` in m^2.
#[inline]
pub fn solid_angle_to_vertex(cosine: f32, distance_squared: f32) -> f32 {
    cosine.abs() / distance_squared
}

/// Unit direction, distance and squared distance from `a` to `b`; none for coincident points.
#[inline]
pub fn between(a: Vec3, b: Vec3) -> Option<(Vec3, f32, f32)> {
    let d = b - a;
    let distance_squared = d.length_squared();
    if distance_squared > 0.0 {
        let distance = distance_squared.sqrt();
        Some((d / distance, distance, distance_squared))
    } else {
        None
    }
}
