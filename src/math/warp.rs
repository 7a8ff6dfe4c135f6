//! From the unit square to discs, hemispheres, spheres, cones and triangles, with densities.

use super::{Vec2, Vec3, angle, vec2, vec3};
use std::f32::consts::{FRAC_1_PI, FRAC_PI_2, FRAC_PI_4, PI, TAU};

/// Density of `to_sphere` (1/sr).
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

/// The inverse of [`to_disk`]; points beyond the disc are taken to its border.
#[inline]
pub fn from_disk(p: Vec2) -> Vec2 {
    let r = p.length().min(1.0);
    // Angle from the x axis in [-pi/4, 7 pi/4), in quarter turns: which side of the square.
    let turn = angle::atan2(p.y, p.x) / FRAC_PI_2;
    let side = (turn + 0.5).floor();
    let across = 2.0 * (turn - side) * r;
    let p = match side as i32 {
        0 => vec2(r, across),
        1 => vec2(-across, r),
        -1 => vec2(across, -r),
        _ => vec2(-r, -across),
    };
    (0.5 * (p + Vec2::ONE)).clamp(Vec2::ZERO, Vec2::splat(1.0 - f32::EPSILON))
}

/// Cosine-weighted on the upper hemisphere; density cos/pi (1/sr).
#[inline]
pub fn to_cosine_hemisphere(u: Vec2) -> Vec3 {
    let d = to_disk(u);
    d.extend((1.0 - d.length_squared()).max(0.0).sqrt())
}

/// Density of `to_cosine_hemisphere` (1/sr); 0 below the horizon.
#[inline]
pub fn cosine_hemisphere_pdf(cosine: f32) -> f32 {
    cosine.max(0.0) * FRAC_1_PI
}

/// Unit vector with the given cosine to z and azimuth (rad).
#[inline]
pub fn spherical(cosine: f32, azimuth: f32) -> Vec3 {
    let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
    let (s, c) = azimuth.sin_cos();
    vec3(sine * c, sine * s, cosine)
}

/// Unit vector with the given 1 - cos (in [0, 2]) to z and azimuth (rad): narrow angles keep their precision.
#[inline]
pub fn near_pole(one_minus_cos: f32, azimuth: f32) -> Vec3 {
    let sine = (one_minus_cos * (2.0 - one_minus_cos)).max(0.0).sqrt();
    let (s, c) = azimuth.sin_cos();
    vec3(sine * c, sine * s, 1.0 - one_minus_cos)
}

/// Uniform on the unit sphere; density 1/(4 pi) (1/sr).
#[inline]
pub fn to_sphere(u: Vec2) -> Vec3 {
    spherical(1.0 - 2.0 * u.x, TAU * u.y)
}

/// The inverse of [`to_sphere`].
#[inline]
pub fn from_sphere(direction: Vec3) -> Vec2 {
    let turn = angle::atan2(direction.y, direction.x) / TAU;
    let turn = if turn < 0.0 { turn + 1.0 } else { turn };
    vec2(0.5 - 0.5 * direction.z, turn).clamp(Vec2::ZERO, Vec2::splat(1.0 - f32::EPSILON))
}

/// 1 - cos of the half angle whose squared sine is this, in [0, 1].
#[inline]
pub fn one_minus_cos(sine_squared: f32) -> f32 {
    sine_squared / (1.0 + (1.0 - sine_squared).sqrt())
}

/// Uniform in the cone of half angle acos(1 - `one_minus_cos`) around z; density 1/(2 pi `one_minus_cos`).
/// The cone is given by 1 - cos so that narrow ones keep their precision.
#[inline]
pub fn to_cone(u: Vec2, one_minus_cos: f32) -> Vec3 {
    near_pole(u.x * one_minus_cos, TAU * u.y)
}

/// Density of `to_cone` inside the cone (1/sr).
#[inline]
pub fn cone_pdf(one_minus_cos: f32) -> f32 {
    1.0 / (2.0 * PI * one_minus_cos)
}

/// A number in [0, 1] of density proportional to that of a line from `a` at 0 to `b` at 1, both >= 0; uniform if both are 0.
#[inline]
pub fn linear(a: f32, b: f32, u: f32) -> f32 {
    let sum = a + b;
    if sum <= 0.0 {
        return u;
    }
    let (a, b) = (a / sum, b / sum);
    let bottom = a + (a * a + u * (b * b - a * a)).max(0.0).sqrt();
    if bottom > 0.0 { (u / bottom).min(1.0) } else { 0.0 }
}

/// Uniform barycentric weights (of the second and third corner) of a triangle; density 1/area.
#[inline]
pub fn to_triangle(u: Vec2) -> Vec2 {
    let r = u.x.sqrt();
    vec2(1.0 - r, u.y * r)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_way_back_from_disc_and_sphere() {
        for index in 0..10_000 {
            let u = (vec2((index % 100) as f32, (index / 100) as f32) + 0.5) / 100.0;
            assert!(from_disk(to_disk(u)).distance(u) < 1e-5, "{u}");
            let error = (from_sphere(to_sphere(u)) - u).abs();
            assert!(error.max_element() < 1e-5, "{u}");
        }
        for p in [Vec2::X, -Vec2::X, Vec2::Y, -Vec2::Y, Vec2::ONE, Vec2::ZERO, 5.0 * Vec2::NEG_ONE] {
            let u = from_disk(p);
            assert!(u.min_element() >= 0.0 && u.max_element() < 1.0, "{p} {u}");
        }
        for w in [Vec3::Z, -Vec3::Z, Vec3::X, -Vec3::X, vec3(-1.0, -0.0, 0.0), vec3(1.0, -1e-30, 0.0)] {
            let u = from_sphere(w);
            assert!(u.min_element() >= 0.0 && u.max_element() < 1.0, "{w} {u}");
        }
    }
}
