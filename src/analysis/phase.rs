//! A phase function by itself (P03T A.2.1, `scatter`): are its samples distributed as its density says?

pub mod described;
pub mod drawing;
pub mod mesh;
pub mod quadrature;
#[cfg(test)]
mod tests;

use super::chi_square::{ChiSquare, chi_square};
use crate::{
    math::{Frame, Vec3, vec3},
    phase::{Phase, PhaseModel},
    sampling::{Stream, stream::Purpose},
};
use quadrature::Slices;
use std::f64::consts::{PI, TAU};

/// How the sphere of directions is divided: P03T fig. A.6, but for where the parallels lie.
///
/// P03T spaces them evenly by angle. Here they are finer at both poles, evenly in the fourth root of 1 - |cos|, so
/// that the sharpest peaks have many cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Division {
    /// Circles of equal angle, the two poles among them; at least 3.
    pub parallels: usize,
    /// Number of meridians that divide the sphere, at least 3.
    pub meridians: usize,
}

/// What samples of a phase function are compared with.
#[derive(Clone, Debug)]
pub struct Check {
    /// Integral of the density over the sphere: 1.
    pub normalisation: f64,
    /// Mean cosine that the density has.
    pub mean_cosine: f64,
    /// Mean cosine that the phase function says it has.
    pub stated_mean_cosine: f64,
    /// Mean cosine of the samples.
    pub sampled_mean_cosine: f64,
    /// Its standard error if the samples follow the density: where few of them are far from a sharp peak, they do not
    /// know their own.
    pub standard_error: f64,
    /// How well the samples fit the density, cell by cell.
    pub fit: ChiSquare,
    /// Samples per cell of the sphere: slice by slice from straight on, in each one cell between two meridians.
    pub cells: Vec<u64>,
    /// Samples per slice of equal angle, from straight on to straight back.
    pub histogram: Vec<u64>,
}

/// Slices of the histogram: 2 degrees each.
const HISTOGRAM: usize = 90;

/// What numbers in f32 and the quadrature may be off.
const ROUNDING: f64 = 1e-3;

impl Check {
    /// Standard errors by which the samples' mean cosine is off.
    pub fn z(&self) -> f64 {
        let off = self.sampled_mean_cosine - self.mean_cosine;
        // Beyond rounding: peaks so sharp that all cosines are 1 have no error to measure by.
        if off.abs() < 1e-6 { 0.0 } else { off / self.standard_error }
    }

    /// What does not hold, each by name; `significance` is the p-value below which samples do not fit.
    pub fn failures(&self, significance: f64) -> Vec<&'static str> {
        use statrs::distribution::{ContinuousCDF, Normal};
        let two_sided = 2.0 * Normal::standard().sf(self.z().abs());
        let claims = [
            ("the pdf is not normalised to 1", (self.normalisation - 1.0).abs() <= ROUNDING),
            (
                "the stated mean cosine is not that of the pdf",
                (self.stated_mean_cosine - self.mean_cosine).abs() <= ROUNDING,
            ),
            ("the mean cosine of the samples is not that of the pdf", two_sided >= significance),
            ("the samples are not distributed according to the pdf", self.fit.p_value >= significance),
        ];
        claims.into_iter().filter(|(_, holds)| !holds).map(|(failure, _)| failure).collect()
    }
}

/// Light flies so before it is scattered: along no axis, as light does.
const BEFORE: Vec3 = vec3(0.3, -0.5, 0.7);

/// Draws `samples` directions (at least 2) of `sampled` and holds them against the density of `pdf`, which is
/// the same phase function except in tests of this test.
pub fn check(sampled: &Phase, pdf: &Phase, division: Division, samples: u64, seed: u64) -> Check {
    let slices = Slices::new(pdf, division.parallels - 1);
    let drawn = Drawn::new(sampled, division, samples, seed);
    let n = samples as f64;
    let expected: Vec<f64> = (0..drawn.cells.len())
        .map(|cell| n * slices.shares[cell / division.meridians] / division.meridians as f64)
        .collect();
    let variance = (slices.square - slices.moment * slices.moment).max(0.0);
    Check {
        normalisation: slices.total(),
        mean_cosine: slices.moment,
        stated_mean_cosine: f64::from(pdf.mean_cosine()),
        sampled_mean_cosine: drawn.sum / n,
        standard_error: (variance / n).sqrt(),
        fit: chi_square(&drawn.cells, &expected),
        cells: drawn.cells,
        histogram: drawn.histogram,
    }
}

/// Where samples fell.
struct Drawn {
    /// Slice by slice from straight on, in each one cell a meridian.
    cells: Vec<u64>,
    histogram: Vec<u64>,
    sum: f64,
}

impl Drawn {
    fn new(phase: &Phase, division: Division, samples: u64, seed: u64) -> Self {
        let Division { parallels, meridians } = division;
        let slices = parallels - 1;
        let before = BEFORE.normalize();
        let frame = Frame::around(before);
        let mut stream = Stream::new(seed, 0, 0, Purpose::Study);
        let mut drawn = Self { cells: vec![0; slices * meridians], histogram: vec![0; HISTOGRAM], sum: 0.0 };
        for _ in 0..samples {
            let after = phase.sample(before, &mut stream);
            let turn = quadrature::Turn::between(before, after);
            let local = frame.to_local(after);
            let around = (f64::from(local.y).atan2(f64::from(local.x)) / TAU).rem_euclid(1.0);
            let slice = ((turn.place * slices as f64) as usize).min(slices - 1);
            drawn.cells[slice * meridians + ((around * meridians as f64) as usize).min(meridians - 1)] += 1;
            drawn.histogram[((turn.angle / PI * HISTOGRAM as f64) as usize).min(HISTOGRAM - 1)] += 1;
            drawn.sum += turn.cosine;
        }
        drawn
    }
}
