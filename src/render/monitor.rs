//! Watches a render: receives its progress, and the image at requested marks.

use super::{
    image::{Progress, Snapshot},
    sums::Sums,
};
use std::time::{Duration, Instant};

/// Marks at which the image is requested, and who receives it.
pub(super) struct Monitor<'a> {
    /// Called now and then, with the sums so far; its time counts.
    pub watch: &'a mut dyn FnMut(Progress, &Sums),
    /// Samples per pixel, in growing order.
    pub marks: &'a [u64],
    /// Shown the image at every mark.
    pub show: &'a mut dyn FnMut(Snapshot),
}

impl Monitor<'_> {
    /// `wanted` tasks (`per_pass` blocks each pass), cut at the next mark after `done` passes: the time of a mark must
    /// not include work beyond it.
    pub(super) fn limit_tasks(&self, wanted: usize, done: u64, per_pass: usize) -> usize {
        let next = self.marks.iter().find(|mark| **mark > done);
        next.map_or(wanted, |mark| wanted.min((*mark as usize).saturating_mul(per_pass)))
    }

    /// True if the image is requested after `passes`.
    pub(super) fn is_mark(&self, passes: u64) -> bool {
        self.marks.contains(&passes)
    }
}

/// A clock that can be paused.
pub(super) struct Stopwatch {
    started: Instant,
    held: Duration,
}

impl Stopwatch {
    /// Starts now.
    pub(super) fn start() -> Self {
        Self { started: Instant::now(), held: Duration::ZERO }
    }

    /// Time since the start, less that of what did not count.
    pub(super) fn elapsed(&self) -> Duration {
        self.started.elapsed().saturating_sub(self.held)
    }

    /// Does something; its time does not count.
    pub(super) fn hold(&mut self, work: impl FnOnce()) {
        let started = Instant::now();
        work();
        self.held += started.elapsed();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_ends_at_every_mark() {
        let marks = [1, 4];
        let monitor = Monitor { watch: &mut |_, _| {}, marks: &marks, show: &mut |_| {} };
        assert_eq!(monitor.limit_tasks(64, 0, 10), 10);
        assert_eq!(monitor.limit_tasks(7, 0, 10), 7);
        assert_eq!(monitor.limit_tasks(74, 1, 10), 40);
        assert_eq!(monitor.limit_tasks(104, 4, 10), 104, "no mark is left");
        assert!(monitor.is_mark(4) && !monitor.is_mark(2));
    }

    #[test]
    fn a_held_clock_stands() {
        let mut stopwatch = Stopwatch::start();
        stopwatch.hold(|| std::thread::sleep(Duration::from_millis(200)));
        assert!(stopwatch.elapsed() < Duration::from_millis(150), "{:?}", stopwatch.elapsed());
    }
}
