//! The radiance of a clear sky by Hosek and Wilkie 2012, in RGB, and the sun's irradiance below it (2013) as Mitsuba 3.9.1 has
//! it. `validation/sky_model.py` writes the tables. Those of the sky: copyright (c) 2012-2013 Lukas Hosek and Alexander Wilkie,
//! BSD license.

use crate::math::{Spectrum, vec3};
use std::f32::consts::FRAC_PI_2;

static TABLES: &[u8; 4 * 4500] = include_bytes!("tables.bin");

const TURBIDITIES: usize = 10;
const COEFFICIENTS: usize = 9;
/// Control points of the curve over the sun's elevation.
const CONTROL_POINTS: usize = 6;
/// Numbers of one turbidity and albedo: coefficients, radiances.
const SHAPES: usize = CONTROL_POINTS * 3 * COEFFICIENTS;
const RADIANCES: usize = CONTROL_POINTS * 3;
/// Where radiances and irradiances begin.
const FIRST_RADIANCE: usize = TURBIDITIES * 2 * SHAPES;
const FIRST_IRRADIANCE: usize = FIRST_RADIANCE + TURBIDITIES * 2 * RADIANCES;

/// Elevations of the sun for which the irradiance is known: their number, the first and the last (degrees).
const ELEVATIONS: usize = 30;
const LOWEST: f32 = 2.0;
const HIGHEST: f32 = 89.0;

/// Mitsuba's units: luminance over the integral of the CIE 1931 y function (nm).
const NORMALIZATION: f32 = 1.0 / 106.750_26;

/// A clear sky with the sun at one place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sky {
    /// By channel.
    coefficients: [[f32; COEFFICIENTS]; 3],
    /// Mean radiance (W/(m^2 sr)).
    scale: Spectrum,
}

impl Sky {
    /// `turbidity` in [1, 10], `albedo` of the ground in [0, 1], the sun's `elevation` in [0, pi/2].
    pub(super) fn new(turbidity: f32, albedo: Spectrum, elevation: f32) -> Self {
        let t = (elevation / FRAC_PI_2).clamp(0.0, 1.0).cbrt();
        let curve = |start: usize, stride: usize, size: usize, albedo: f32| {
            let at = |level: usize, ground: usize| {
                bezier(t, |point| number(start + (2 * level + ground) * size + point * stride))
            };
            between(turbidity, |level| at(level, 0) + albedo * (at(level, 1) - at(level, 0)))
        };
        let shape = |channel: usize| {
            std::array::from_fn(|i| {
                curve(channel * COEFFICIENTS + i, 3 * COEFFICIENTS, SHAPES, albedo[channel])
            })
        };
        let scale = |channel: usize| curve(FIRST_RADIANCE + channel, 3, RADIANCES, albedo[channel]);
        let scale = vec3(scale(0), scale(1), scale(2)) * NORMALIZATION;
        Self { coefficients: [0, 1, 2].map(shape), scale }
    }

    /// Radiance where the `cosine` to the zenith is >= 0 and the sun is `gamma` radians away (W/(m^2 sr)), >= 0.
    pub(super) fn radiance(&self, cosine: f32, gamma: f32) -> Spectrum {
        let cos_gamma = gamma.cos();
        let shape = |[a, b, c, d, e, f, g, h, i]: &[f32; COEFFICIENTS]| {
            let halo = (1.0 + cos_gamma * cos_gamma) / (1.0 + i * i - 2.0 * i * cos_gamma).powf(1.5);
            let around_sun = c + d * (e * gamma).exp() + f * cos_gamma * cos_gamma + g * halo;
            (1.0 + a * (b / (cosine + 0.01)).exp()) * (around_sun + h * cosine.sqrt())
        };
        let [r, g, b] = [0, 1, 2].map(|channel| shape(&self.coefficients[channel]));
        (vec3(r, g, b) * self.scale).max(Spectrum::ZERO)
    }
}

/// Irradiance on a surface that faces the sun (W/m^2), >= 0: red light of a low sun is out of the gamut.
pub(super) fn sun_irradiance(turbidity: f32, elevation: f32) -> Spectrum {
    let step = (elevation.to_degrees() - LOWEST) / (HIGHEST - LOWEST) * (ELEVATIONS - 1) as f32;
    let step = step.clamp(0.0, (ELEVATIONS - 1) as f32);
    let below = (step as usize).min(ELEVATIONS - 2);
    let channel = |channel: usize| {
        let at =
            |level: usize, row: usize| number(FIRST_IRRADIANCE + (level * ELEVATIONS + row) * 3 + channel);
        between(turbidity, |level| {
            at(level, below) + (step - below as f32) * (at(level, below + 1) - at(level, below))
        })
    };
    vec3(channel(0), channel(1), channel(2)).max(Spectrum::ZERO)
}

/// What lies between its values at the whole turbidities around.
fn between(turbidity: f32, at: impl Fn(usize) -> f32) -> f32 {
    let level = (turbidity - 1.0).clamp(0.0, (TURBIDITIES - 1) as f32);
    let below = (level as usize).min(TURBIDITIES - 2);
    let (low, high) = (at(below), at(below + 1));
    low + (level - below as f32) * (high - low)
}

/// The Bezier curve of degree 5 at `t` in [0, 1].
fn bezier(t: f32, control: impl Fn(usize) -> f32) -> f32 {
    const BINOMIAL: [f32; CONTROL_POINTS] = [1.0, 5.0, 10.0, 10.0, 5.0, 1.0];
    let weight = |i: usize| BINOMIAL[i] * t.powi(i as i32) * (1.0 - t).powi(5 - i as i32);
    (0..CONTROL_POINTS).map(|i| weight(i) * control(i)).sum()
}

fn number(index: usize) -> f32 {
    let [a, b, c, d] = [0, 1, 2, 3].map(|byte| TABLES[4 * index + byte]);
    f32::from_le_bytes([a, b, c, d])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values of Mitsuba 3.9.1 for a ground of 0.3.
    #[test]
    fn the_sky_is_that_of_mitsuba() {
        for (turbidity, elevation, towards, expected) in [
            (3.0, 0.8, [0.3, 0.2, 0.5], [0.096_557, 0.121_176, 0.166_805]),
            (5.5, 0.3, [-0.3, 0.2, 0.1], [0.059_021, 0.082_352, 0.104_856]),
            (1.0, 1.2, [0.0, 0.0, 1.0], [0.023_413, 0.044_335, 0.100_842]),
            (10.0, 0.05, [1.0, 0.0, 0.02], [0.087_578, 0.039_233, 0.012_938]),
        ] {
            let (sin, cos) = f32::sin_cos(elevation);
            let sun = vec3(cos * 0.3f32.cos(), cos * 0.3f32.sin(), sin);
            let towards = Spectrum::from(towards).normalize();
            let sky = Sky::new(turbidity, Spectrum::splat(0.3), elevation);
            let found = sky.radiance(towards.z, towards.dot(sun).acos());
            let error = (found / Spectrum::from(expected) - 1.0).abs().max_element();
            assert!(error < 1e-3, "{turbidity} {elevation}: {found}, expected {expected:?}");
        }
    }

    #[test]
    fn the_sun_is_that_of_mitsuba() {
        // Rounded as Mitsuba rounds it.
        let solid_angle = 2.0 * std::f32::consts::PI * (1.0 - 0.2679f32.to_radians().cos());
        for (turbidity, degrees, expected) in [
            (3.0, 20.0, [18679.6, 13744.36, 7823.77]),
            (3.0, 60.0, [21873.3, 18316.1, 14105.9]),
            (10.0, 20.0, [5899.84, 3865.77, 2342.5]),
            (3.0, 0.5, [3818.7, 1031.54, 0.0]),
        ] {
            let found = sun_irradiance(turbidity, f32::to_radians(degrees)) / solid_angle;
            let error = (found - Spectrum::from(expected)).abs().max_element();
            assert!(error < 5e-4 * expected[0], "{turbidity} {degrees}: {found}, expected {expected:?}");
        }
    }
}
