//! Batches of tasks in turn: the results of one are taken while all other threads are busy with the next. If they
//! waited, sixteen threads would do the work of eleven.

use super::instrument::{BLOCKS_AT_ONCE, Instrument};
use std::{mem, ops::Range};

/// Least tasks of a batch per thread: the fewer, the longer threads wait for the last of them.
const TASKS_PER_THREAD: usize = 16;

impl Instrument<'_> {
    /// [`Self::work_until`], batch by batch; returns the number of finished tasks. `take` gets the results in order, on
    /// this thread: those of a batch together, with the number of the first.
    pub(super) fn work_in_turn<T: Send>(
        &self,
        tasks: Range<usize>,
        pass: impl Fn(usize) -> usize + Sync,
        is_over: impl Fn() -> bool + Sync,
        work: impl Fn(usize, usize) -> T + Sync,
        mut take: impl FnMut(usize, &[T]),
    ) -> usize {
        let at_once = BLOCKS_AT_ONCE.max(TASKS_PER_THREAD * rayon::current_num_threads());
        let (mut next, mut done) = (tasks.start, Vec::new());
        let mut is_last = tasks.is_empty();
        while !is_last {
            let batch = next..tasks.end.min(next + at_once);
            let meanwhile = || {
                let before = mem::take(&mut done);
                if !before.is_empty() {
                    take(next - before.len(), &before);
                }
            };
            done = self.work_until(batch.clone(), &pass, &is_over, &work, meanwhile);
            next += done.len();
            is_last = done.len() < batch.len() || next == tasks.end;
        }
        take(next - done.len(), &done);
        next - tasks.start
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        film::sharing::FilmSamples,
        format,
        passes::{Settings, budget::Budget},
        sampling::Sampler,
        scene::build,
        settings::Overrides,
        transport::{Options, Strategies, needs::Needs, profiles::ProfileName},
    };
    use std::{
        path::Path,
        sync::atomic::{AtomicUsize, Ordering},
        time::{Duration, Instant},
    };

    /// Shows `see` an instrument whose passes have one block.
    fn with_instrument<T: Send>(threads: usize, see: impl Fn(&Instrument<'_>) -> T + Sync) -> T {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/lampbox_up.xml");
        let overrides = Overrides { size: Some((8, 8)), ..Overrides::default() };
        let setup = build::build(&format::read(&path, &[]).unwrap(), overrides).unwrap();
        let options = Options { strategies: Strategies::BDPT, ..setup.integrator.options };
        let profile = ProfileName::leanest(Needs::of(&setup.scene, false));
        let (sampler, budget) = (Sampler::Independent, Budget::ENDLESS);
        let settings =
            Settings { options, sampler, film_samples: FilmSamples::default(), budget, seed: 0, profile };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| see(&Instrument::new(&setup.scene, &setup.film, &settings)))
    }

    #[test]
    fn all_that_is_done_is_taken_in_order() {
        for (threads, tasks, last) in [(1, 5..6, 1000), (3, 7..7, 1000), (3, 7..500, 1000), (2, 0..500, 300)]
        {
            let begun = AtomicUsize::new(0);
            let (done, taken) = with_instrument(threads, |instrument| {
                let work = |pass, _| {
                    begun.fetch_max(pass, Ordering::Relaxed);
                    pass
                };
                let is_over = || begun.load(Ordering::Relaxed) >= last;
                let mut taken = Vec::new();
                let take = |first, passes: &[usize]| {
                    assert_eq!(first, tasks.start + taken.len());
                    taken.extend_from_slice(passes);
                };
                (instrument.work_in_turn(tasks.clone(), |task| task, is_over, work, take), taken)
            });
            assert!(taken.iter().copied().eq(tasks.start..tasks.start + done), "{taken:?}");
            assert!(if last < tasks.end {
                (last + 1..=last + threads).contains(&done)
            } else {
                done == tasks.len()
            });
        }
    }

    #[test]
    fn threads_go_on_while_results_are_taken() {
        let begun = AtomicUsize::new(0);
        let have_gone_on = with_instrument(2, |instrument| {
            let work = |pass, _| begun.fetch_max(pass, Ordering::Relaxed);
            let mut have_gone_on = false;
            let take = |first: usize, done: &[usize]| {
                let (next, started) = (first + done.len(), Instant::now());
                let waits = || !have_gone_on && begun.load(Ordering::Relaxed) < next;
                while waits() && started.elapsed() < Duration::from_secs(1) {
                    std::thread::yield_now();
                }
                have_gone_on |= begun.load(Ordering::Relaxed) >= next;
            };
            instrument.work_in_turn(0..BLOCKS_AT_ONCE + 5, |task| task, || false, work, take);
            have_gone_on
        });
        assert!(have_gone_on);
    }
}
