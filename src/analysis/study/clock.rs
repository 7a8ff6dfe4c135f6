//! Processor time beside the time of the wall: of all threads of this process, user and system together.

/// Processor time that this process has taken so far (s); none where the system does not say.
#[cfg(unix)]
pub fn cpu_seconds() -> Option<f64> {
    let taken = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Some(taken.tv_sec as f64 + 1e-9 * taken.tv_nsec as f64)
}

/// Processor time that this process has taken so far (s); none where the system does not say.
#[cfg(not(unix))]
pub fn cpu_seconds() -> Option<f64> {
    None
}

/// A clock of processor time that stands still while it is held.
#[derive(Clone, Copy, Debug)]
pub struct CpuClock {
    /// What it showed at the start, and all that was held since.
    zero: Option<f64>,
}

impl CpuClock {
    /// Starts now, at `head` (s).
    pub fn start(head: f64) -> Self {
        Self { zero: cpu_seconds().map(|now| now - head) }
    }

    /// Time since the start (s), less that of what did not count.
    pub fn seconds(&self) -> Option<f64> {
        Some((cpu_seconds()? - self.zero?).max(0.0))
    }

    /// Does something; its time does not count.
    pub fn hold<T>(&mut self, work: impl FnOnce() -> T) -> T {
        let before = cpu_seconds();
        let done = work();
        self.zero = (|| Some(self.zero? + cpu_seconds()? - before?))();
        done
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::{Duration, Instant};

    fn work() {
        let started = Instant::now();
        while started.elapsed() < Duration::from_millis(60) {}
    }

    #[test]
    #[cfg(unix)]
    fn it_counts_work_alone_and_stands_while_it_is_held() {
        let mut clock = CpuClock::start(10.0);
        work();
        let worked = clock.seconds().unwrap();
        assert!(worked > 10.01, "{worked}");
        // Other tests work in this process meanwhile: what is held is no less than this.
        let before = cpu_seconds().unwrap();
        clock.hold(work);
        let held = cpu_seconds().unwrap() - before;
        let all = clock.seconds().unwrap();
        assert!(all < worked + held - 0.01, "{worked} {held} {all}");
    }
}
