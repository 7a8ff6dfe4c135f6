//! From the unit square to discs, hemispheres, spheres, cones and triangles, with densities.

use super::{Vec2, Vec3, vec2, vec3};
use std::f32::consts::{FRAC_1_PI, FRAC_PI_2, FRAC_PI_4, PI, TAU};

/// Density of `to_sphere` [1/sr].
pub const SPHERE_PDF: f32 = FRAC_1_PI * 0.25;

/// Uniform on the unit disc, by concentric squares (Shirley & Chiu 1997). Density 1/pi.
#[inline]
pub fn to_disk(u: Vec2) -> Vec2 {
    let p = 2.0 * u - Vec2::ONE;
    if p == Vec2::ZERO {
        return Vec2::ZERO;
    }
    let (r, phi) = if p.x.abs() > p.y.abs() {
        (p.x, FRAC_PI_4 * (p.y / p.x))
    } else {
        (p.y, FRAC_PI_2 - FRAC_PI_4 * (p.x / p.y))
    };
    r * vec2(phi.cos(), phi.sin())
}

/// Cosine-weighted on the upper hemisphere; density cos/pi [1/sr].
#[inline]
pub fn to_cosine_hemisphere(u: Vec2) -> Vec3 {
    let d = to_disk(u);
    d.extend((1.0 - d.length_squared()).max(0.0).sqrt())
}

/// Density of `to_cosine_hemisphere` [1/sr]; 0 below the horizon.
#[inline]
pub fn cosine_hemisphere_pdf(cosine: f32) -> f32 {
    cosine.max(0.0) * FRAC_1_PI
}

/// Unit vector with the given cosine to z and azimuth [rad].
#[inline]
pub fn spherical(cosine: f32, azimuth: f32) -> Vec3 {
    let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
    let (s, c) = azimuth.sin_cos();
    vec3(sine * c, sine * s, cosine)
}

/// Unit vector with the given 1 - cos (in [0, 2]) to z and azimuth [rad]: narrow angles keep their precision.
#[inline]
pub fn near_pole(one_minus_cos: f32, azimuth: f32) -> Vec3 {
    let sine = (one_minus_cos * (2.0 - one_minus_cos)).max(0.0).sqrt();
    let (s, c) = azimuth.sin_cos();
    vec3(sine * c, sine * s, 1.0 - one_minus_cos)
}

/// Uniform on the unit sphere; density 1/(4 pi) [1/sr].
#[inline]
pub fn to_sphere(u: Vec2) -> Vec3 {
    spherical(1.0 - 2.0 * u.x, TAU * u.y)
}

/// Uniform in the cone of half angle acos(1 - `one_minus_cos`) around z; density 1/(2 pi `one_minus_cos`).
/// The cone is given by 1 - cos so that narrow ones keep their precision.
#[inline]
pub fn to_cone(u: Vec2, one_minus_cos: f32) -> Vec3 {
    near_pole(u.x * one_minus_cos, TAU * u.y)
}

/// Density of `to_cone` inside the cone [1/sr].
#[inline]
pub fn cone_pdf(one_minus_cos: f32) -> f32 {
    1.0 / (2.0 * PI * one_minus_cos)
}

/// Uniform barycentric weights (of the second and third corner) of a triangle; density 1/area.
#[inline]
pub fn to_triangle(u: Vec2) -> Vec2 {
    let r = u.x.sqrt();
    vec2(1.0 - r, u.y * r)
}
