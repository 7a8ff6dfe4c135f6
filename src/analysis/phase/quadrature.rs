//! Integrals of a phase function's density over slices of the sphere, however sharp its peaks are.

use crate::{
    math::Vec3,
    phase::{Deflection, Phase, PhaseModel},
};
use std::f64::consts::TAU;

/// A turn between two directions.
#[derive(Clone, Copy, Debug)]
pub struct Turn {
    /// Cosine of the angle.
    pub cosine: f64,
    /// The angle (rad).
    pub angle: f64,
    /// Where it lies from straight on (0) to straight back (1), stretched at both ends.
    pub place: f64,
}

impl Turn {
    /// The turn from unit `before` to unit `after`, with all digits at both ends.
    pub fn between(before: Vec3, after: Vec3) -> Self {
        let (a, b) = (before.as_dvec3().normalize(), after.as_dvec3().normalize());
        let [near, far] = [a - b, a + b].map(|v| 0.5 * v.length_squared());
        let part = |d: f64| 0.5 * d.min(1.0).powf(0.25);
        let place = if near < far { part(near) } else { 1.0 - part(far) };
        Self { cosine: a.dot(b), angle: 2.0 * near.sqrt().atan2(far.sqrt()), place }
    }
}

/// The angle at a place (rad).
pub fn angle_at(place: f64) -> f64 {
    let angle = |place: f64| 2.0 * (0.5 * one_minus_cos(place)).sqrt().asin();
    if place < 0.5 { angle(place) } else { std::f64::consts::PI - angle(1.0 - place) }
}

/// The density at a place (1/sr).
pub fn pdf_at(phase: &Phase, place: f64) -> f64 {
    let turn = match place < 0.5 {
        true => Deflection::of(one_minus_cos(place), 1.0),
        false => Deflection::of(one_minus_cos(1.0 - place), -1.0),
    };
    f64::from(phase.pdf_sr(turn))
}

/// The solid angle between the places `low` < `high`, all around (sr).
pub fn solid_angle(low: f64, high: f64) -> f64 {
    let height = match (low < 0.5, high <= 0.5) {
        (true, true) => one_minus_cos(high) - one_minus_cos(low),
        (true, false) => 2.0 - one_minus_cos(low) - one_minus_cos(1.0 - high),
        (false, _) => one_minus_cos(1.0 - low) - one_minus_cos(1.0 - high),
    };
    TAU * height
}

/// 1 - |cos| at a place in [0, 1/2].
fn one_minus_cos(place: f64) -> f64 {
    (2.0 * place).powi(4)
}

/// What share of the density falls into each slice between neighbouring parallels.
#[derive(Clone, Debug)]
pub struct Slices {
    /// From straight on to straight back.
    pub shares: Vec<f64>,
    /// Mean cosine.
    pub moment: f64,
    /// Mean of its square.
    pub square: f64,
}

/// Midpoints of all slices together.
const POINTS: usize = 1 << 17;

impl Slices {
    /// By the midpoint rule in each of `count` slices.
    pub fn new(phase: &Phase, count: usize) -> Self {
        let per_slice = (POINTS / count).max(8);
        let step = 1.0 / (count * per_slice) as f64;
        let (mut moment, mut square) = (0.0, 0.0);
        let mut share = |slice: usize| -> f64 {
            let point = |i: usize| {
                let place = (i as f64 + 0.5) * step;
                let (from_pole, sign) = if place < 0.5 { (place, 1.0) } else { (1.0 - place, -1.0) };
                let solid_angle = TAU * 8.0 * (2.0 * from_pole).powi(3) * step;
                let share = solid_angle * pdf_at(phase, place);
                let cosine = sign * (1.0 - one_minus_cos(from_pole));
                moment += share * cosine;
                square += share * cosine * cosine;
                share
            };
            (slice * per_slice..(slice + 1) * per_slice).map(point).sum()
        };
        let shares = (0..count).map(&mut share).collect();
        Self { shares, moment, square }
    }

    /// Integral over the sphere.
    pub fn total(&self) -> f64 {
        self.shares.iter().sum()
    }
}
