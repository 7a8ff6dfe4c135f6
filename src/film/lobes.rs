//! Filters with negative lobes: their integrals piece by piece, and positions distributed by their magnitude.

use super::filter::Filter;
use crate::sampling::{Discrete, Stream};

/// Steps of the staircase above a filter, per pixel.
const STEPS: u32 = 128;

/// Draws positions distributed by the magnitude of a filter: under a staircase that nowhere lies below it,
/// then by rejection, so exactly.
#[derive(Clone, Debug)]
pub(super) struct Lobes {
    filter: Filter,
    steps: Discrete,
    heights: Vec<f32>,
}

impl Lobes {
    /// Builds the staircase above `filter`, whose radius is a whole number.
    pub(super) fn new(filter: Filter) -> Self {
        let count = 2 * filter.radius().round() as u32 * STEPS;
        // No point of a step is further than half its width from the nearer end.
        let rise = filter.steepness() * 0.5 / STEPS as f32;
        let at = |i: u32| filter.value(i as f32 / STEPS as f32 - filter.radius()).abs();
        let heights: Vec<f32> = (0..count).map(|i| at(i).max(at(i + 1)) + rise).collect();
        Self { filter, steps: Discrete::new(heights.iter().map(|h| f64::from(*h))), heights }
    }

    /// A position (pixels) and the sign of the filter there.
    #[inline]
    pub(super) fn sample(&self, stream: &mut Stream) -> (f32, f32) {
        loop {
            let (step, _) = self.steps.sample(stream.uniform());
            let within = stream.square();
            let x = (step as f32 + within.x) / STEPS as f32 - self.filter.radius();
            let value = self.filter.value(x);
            if within.y * self.heights[step] < value.abs() {
                break (x, value.signum());
            }
        }
    }
}

/// Integrals of `filter` from `low` to `high` over each of its pieces of one sign.
pub(super) fn integrals(filter: &Filter, low: f64, high: f64) -> Vec<f64> {
    let knots = filter.knots();
    let mirrored = knots.iter().rev().map(|knot| -knot);
    let all: Vec<f64> = mirrored.chain(knots.iter().skip(1).copied()).collect();
    all.windows(2)
        .map(|pair| (pair[0].max(low), pair[1].min(high)))
        .filter(|(from, to)| from < to)
        .map(|(from, to)| filter.integral(from, to))
        .collect()
}

/// Simpson's rule, exact for cubics; for a lobe of a Lanczos filter to 1e-9.
pub(super) fn simpson(low: f64, high: f64, f: impl Fn(f64) -> f64) -> f64 {
    const PANELS: u32 = 64;
    let h = (high - low) / f64::from(2 * PANELS);
    let weight = |i: u32| match i {
        _ if i == 0 || i == 2 * PANELS => 1.0,
        _ if i % 2 == 1 => 4.0,
        _ => 2.0,
    };
    (0..=2 * PANELS).map(|i| weight(i) * f(low + f64::from(i) * h)).sum::<f64>() * h / 3.0
}
