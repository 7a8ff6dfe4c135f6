//! When a render stops.

use crate::film::accumulator::MOST_PASSES;
use std::{ops::Range, time::Duration};

/// Assumed samples of a thread per second: scenes vary from 1e4 to 3e6.
const SAMPLES_PER_SECOND: f64 = 2e5;

/// Samples per pixel, time, or an interruption, whichever comes first.
#[derive(Clone, Copy, Debug)]
pub struct Budget {
    /// Number of the first sample; others belong to other renders of the same image.
    pub first_sample: u64,
    /// Most samples per pixel; none for no limit.
    pub samples_per_pixel: Option<u64>,
    /// Most time; none for no limit.
    pub time: Option<Duration>,
    /// Time that pilots and learning took beforehand. Half of the limit is left to the image, however long they took.
    pub spent: Duration,
    /// True once the user wants the render to end.
    pub interrupted: fn() -> bool,
}

impl Budget {
    /// No limit.
    pub const ENDLESS: Self = Self {
        first_sample: 0,
        samples_per_pixel: None,
        time: None,
        spent: Duration::ZERO,
        interrupted: || false,
    };

    /// So many samples of every pixel.
    pub fn samples(samples_per_pixel: u64) -> Self {
        Self { samples_per_pixel: Some(samples_per_pixel), ..Self::ENDLESS }
    }

    /// The samples wanted of every pixel, if time allows; at most [`MOST_PASSES`].
    pub fn wanted(&self) -> Range<u64> {
        let count = self.samples_per_pixel.unwrap_or(MOST_PASSES).min(MOST_PASSES);
        self.first_sample..self.first_sample.saturating_add(count)
    }

    /// Samples of an image of so many pixels, as far as they are known beforehand; infinite without a limit.
    pub fn samples_of(&self, pixels: usize) -> f64 {
        let wanted = self.samples_per_pixel.map_or(f64::INFINITY, |each| each as f64 * pixels as f64);
        let in_time = self.time.map_or(f64::INFINITY, |time| SAMPLES_PER_SECOND * time.as_secs_f64());
        wanted.min(in_time)
    }

    /// The part of the time that is used, `elapsed` after the image was begun; none without a limit.
    pub fn time_used(&self, elapsed: Duration) -> Option<f64> {
        let used =
            |limit: Duration| (elapsed + self.spent.min(limit / 2)).as_secs_f64() / limit.as_secs_f64();
        self.time.map(used)
    }

    /// True if no further block should start after this time.
    pub fn is_over(&self, elapsed: Duration) -> bool {
        self.time_used(elapsed).is_some_and(|used| used >= 1.0) || (self.interrupted)()
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
        let spent = |spent| Budget { spent, ..time };
        assert!(spent(second / 2).is_over(3 * second / 2) && !spent(second / 2).is_over(second));
        assert!(spent(9 * second).is_over(second) && !spent(9 * second).is_over(second / 2));
        assert!(Budget { interrupted: || true, ..samples }.is_over(Duration::ZERO));
    }
}
