//! What is recorded of photons, and its mean and error.

use serde::Serialize;

/// What leaves or stays, as shares of the power sent in, and how often it is scattered.
pub const QUANTITIES: &[&str; COUNT] = &[
    "reflected",
    "transmitted, scattered",
    "sides, scattered",
    "scattered, all faces",
    "transmitted, unscattered",
    "sides, unscattered",
    "absorbed",
    "scatterings",
];

/// How many they are.
pub const COUNT: usize = 8;

/// One photon's record, in the order of [`QUANTITIES`].
pub type Record = [f64; COUNT];

/// Index in a record of light that is scattered and leaves where it came in.
pub const REFLECTED: usize = 0;
/// Scattered light through the far face.
pub const TRANSMITTED: usize = 1;
/// Scattered light through the sides.
pub const SIDES: usize = 2;
/// Scattered light through any face.
pub const SCATTERED: usize = 3;
/// Unscattered light through the far face.
pub const DIRECT: usize = 4;
/// Unscattered light through the sides.
pub const DIRECT_SIDES: usize = 5;
/// Absorbed.
pub const ABSORBED: usize = 6;
/// Scatterings, each counted by the power that is left.
pub const SCATTERINGS: usize = 7;

/// Sums over photons.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tally {
    /// How many were added.
    pub photons: u64,
    sums: Record,
    squares: Record,
}

impl Tally {
    /// Adds a photon.
    pub fn add(&mut self, record: &Record) {
        self.photons += 1;
        for (i, value) in record.iter().enumerate() {
            self.sums[i] += value;
            self.squares[i] += value * value;
        }
    }

    /// Means and standard errors.
    pub fn estimates(&self) -> Vec<Estimate> {
        (0..COUNT).map(|quantity| self.estimate(quantity)).collect()
    }

    /// The same of one quantity, by its index.
    pub fn estimate(&self, quantity: usize) -> Estimate {
        let n = self.photons as f64;
        let mean = self.sums[quantity] / n;
        let variance = (self.squares[quantity] / n - mean * mean).max(0.0);
        // What is left of equal values is rounding.
        let variance = if variance < 1e-14 * mean * mean { 0.0 } else { variance };
        Estimate { mean, standard_error: (variance / (n - 1.0)).sqrt() }
    }
}

/// A mean and its standard error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Estimate {
    /// The mean.
    pub mean: f64,
    /// Its standard error; 0 for what is known exactly.
    pub standard_error: f64,
}

/// Differences of sums of up to millions of numbers that are rounding alone.
const ROUNDING: f64 = 1e-6;

impl Estimate {
    /// What is known.
    pub fn exact(mean: f64) -> Self {
        Self { mean, standard_error: 0.0 }
    }

    /// The same for judging: values of `photons` that are all equal do not make their mean certain. What one photon in
    /// as many does may not have happened yet, and such a photon changes the mean by about 1 / `photons`.
    pub fn at_best(self, photons: u64) -> Self {
        let least = 1.0 / photons as f64;
        Self { standard_error: if self.standard_error > 0.0 { self.standard_error } else { least }, ..self }
    }

    /// How many standard errors of both it is above `other`.
    pub fn z(&self, other: &Self) -> f64 {
        let off = self.mean - other.mean;
        let error = self.standard_error.hypot(other.standard_error);
        if off.abs() <= ROUNDING * other.mean.abs().max(1e-12) { 0.0 } else { off / error }
    }
}
