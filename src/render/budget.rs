//! When a render stops.

use crate::film::accumulator::MOST_PASSES;
use std::{ops::Range, time::Duration};

/// Samples per pixel, time, or an interruption, whichever comes first.
#[derive(Clone, Copy, Debug)]
pub struct Budget {
    /// Number of the first sample; others belong to other renders of the same image.
    pub first_sample: u64,
    /// Most samples per pixel; none for no limit.
    pub samples_per_pixel: Option<u64>,
    /// Most time; none for no limit.
    pub time: Option<Duration>,
    /// True once the user wants the render to end.
    pub interrupted: fn() -> bool,
}

impl Budget {
    /// No limit.
    pub const ENDLESS: Self =
        Self { first_sample: 0, samples_per_pixel: None, time: None, interrupted: || false };

    /// So many samples of every pixel.
    pub fn samples(samples_per_pixel: u64) -> Self {
        Self { samples_per_pixel: Some(samples_per_pixel), ..Self::ENDLESS }
    }

    /// The samples of every pixel, as far as time allows; no image has more than [`MOST_PASSES`].
    pub(super) fn wanted(&self) -> Range<u64> {
        let count = self.samples_per_pixel.unwrap_or(MOST_PASSES).min(MOST_PASSES);
        self.first_sample..self.first_sample.saturating_add(count)
    }

    /// True if no further block should start after this time.
    pub(super) fn is_over(&self, elapsed: Duration) -> bool {
        self.time.is_some_and(|limit| elapsed >= limit) || (self.interrupted)()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_and_time_end_exactly() {
        let second = Duration::from_secs(1);
        let samples = Budget { first_sample: 5, ..Budget::samples(3) };
        assert_eq!((samples.wanted(), Budget::ENDLESS.wanted().end), (5..8, MOST_PASSES));
        assert!(!samples.is_over(1000 * second));
        let time = Budget { time: Some(2 * second), ..Budget::ENDLESS };
        assert!(time.is_over(2 * second) && !time.is_over(Duration::from_millis(1999)));
        assert!(Budget { interrupted: || true, ..samples }.is_over(Duration::ZERO));
    }
}
