//! When a run has sent enough photons (P03T A.2.3).

use super::tally::{SCATTERED, Tally};
use statrs::distribution::{ContinuousCDF, Normal};

/// Ends a run once its scattered light is known within a relative error.
#[derive(Clone, Copy, Debug)]
pub struct Stop {
    relative_error: f64,
    /// Standard errors on either side of the mean that hold the truth with the confidence.
    errors: f64,
}

/// Photons between two looks at the estimate, and before the first: so many that Student's t is the normal distribution.
const EVERY: u64 = 1000;

/// So many photons none of which leaves scattered are enough to say that none does (P03T's `maxNoSamplesEq0`).
const MOST_ZEROS: u64 = 100_000;

impl Stop {
    /// Within `relative_error` > 0 of the mean, with a probability of `confidence` in (0, 1): P03T eq. A.8, which has 2 for
    /// the 1.96 of a confidence of 0.95.
    pub fn new(relative_error: f64, confidence: f64) -> Self {
        Self { relative_error, errors: Normal::standard().inverse_cdf(0.5 + 0.5 * confidence) }
    }

    /// The same with half of the error.
    pub fn halved(self) -> Self {
        Self { relative_error: 0.5 * self.relative_error, ..self }
    }

    /// True if the run is over; it is looked at now and then.
    pub fn ends(self, tally: &Tally) -> bool {
        tally.photons.is_multiple_of(EVERY) && self.is_reached(tally)
    }

    /// True if the error is as small as it should be.
    pub fn is_reached(self, tally: &Tally) -> bool {
        let estimate = tally.estimate(SCATTERED);
        if estimate.mean == 0.0 {
            return tally.photons >= MOST_ZEROS;
        }
        tally.photons >= EVERY && self.errors * estimate.standard_error <= self.relative_error * estimate.mean
    }
}
