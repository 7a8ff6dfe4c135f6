//! When a render stops.

use std::time::Duration;

/// Samples per pixel, or time, whichever ends first. At least one sample per pixel is always taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Budget {
    /// Most samples per pixel; none for no limit.
    pub samples_per_pixel: Option<u64>,
    /// Most time; none for no limit.
    pub time: Option<Duration>,
}

impl Budget {
    /// `wanted` tasks (blocks of `per_pass` each pass), cut where the sample budget ends.
    pub(super) fn limit_tasks(&self, wanted: usize, per_pass: usize) -> usize {
        match self.samples_per_pixel {
            Some(samples) => wanted.min((samples as usize).saturating_mul(per_pass)),
            None => wanted,
        }
    }

    /// True if no further tasks should start. An image consists of whole passes, so time ends with the pass
    /// that would overrun it by more than half.
    pub(super) fn is_spent(&self, tasks: usize, per_pass: usize, elapsed: Duration) -> bool {
        if self.limit_tasks(tasks + 1, per_pass) == tasks {
            return true;
        }
        let Some(limit) = self.time else { return false };
        if tasks < per_pass {
            return false;
        }
        let whole_passes = tasks.is_multiple_of(per_pass) || per_pass < super::BLOCKS_AT_ONCE;
        let half_pass = elapsed.mul_f64(0.5 * per_pass as f64 / tasks as f64);
        elapsed >= limit || (whole_passes && elapsed + half_pass > limit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_end_exactly_and_time_after_a_whole_pass() {
        let second = Duration::from_secs(1);
        let samples = Budget { samples_per_pixel: Some(3), time: None };
        assert_eq!(samples.limit_tasks(64, 10), 30);
        assert!(samples.is_spent(30, 10, second) && !samples.is_spent(29, 10, second));
        let time = Budget { samples_per_pixel: None, time: Some(2 * second) };
        assert!(!time.is_spent(99, 100, 9 * second), "the first pass is always finished");
        assert!(time.is_spent(100, 100, 2 * second));
        assert!(!time.is_spent(100, 100, second), "another pass fits");
        assert!(time.is_spent(100, 100, Duration::from_millis(1900)), "another pass would overrun");
    }
}
