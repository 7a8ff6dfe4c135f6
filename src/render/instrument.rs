//! A scene with its compiled estimator, whose passes are rendered or inspected one by one. Blocks, streams and
//! the order of sums are those of a render with the same seed.

use super::{
    image::Precision,
    layers::{self, Sorter},
    sums::halves::FIRST_LOOK,
};
use crate::{
    film::{Film, layer::Layer},
    learning::training::{self, LATER_ROUNDS, ROUNDS},
    math::Spectrum,
    passes::{
        Settings,
        blocks::PIXELS_PER_BLOCK,
        compiled::{self, Compiled},
        observe::BlockObserver,
        pass::{Outcome, Pass},
    },
    scene::Scene,
    transport::{Interaction, Options, needs::Needs, profiles::ProfileName},
};
use rayon::prelude::*;
use std::{
    ops::Range,
    sync::{
        OnceLock,
        atomic::{AtomicUsize, Ordering},
        mpsc,
    },
    time::{Duration, Instant},
};

/// Blocks rendered between two readings of the clock: enough to keep the threads of any machine busy, and independent
/// of their number.
pub(super) const BLOCKS_AT_ONCE: usize = 64;

/// How much of a guide is learnt.
#[derive(Clone, Copy)]
enum Learning {
    /// Enough to begin; nothing if walks follow no guide.
    ToBegin,
    /// More for later samples.
    Growing,
    /// So many rounds for samples after the first look, however little time there is.
    Rounds(usize),
}

/// An estimator ready to make passes over `film`.
pub struct Instrument<'a> {
    /// What is shown.
    pub scene: &'a Scene,
    /// Where.
    pub film: &'a Film,
    pub(super) settings: Settings,
    /// The estimator with what was learnt before the first sample.
    pub compiled: Box<dyn Compiled + 'a>,
    learning: Learning,
    /// The estimators with what is learnt in later rounds.
    later: [OnceLock<Box<dyn Compiled + 'a>>; LATER_ROUNDS],
    per_block: usize,
    /// Sorts contributions into layers.
    sorter: Option<Sorter>,
}

impl<'a> Instrument<'a> {
    /// Prepares to render `scene` onto `film`. The budget of `settings` does not count.
    pub fn new(scene: &'a Scene, film: &'a Film, settings: &Settings) -> Self {
        Self::of_blocks(PIXELS_PER_BLOCK, scene, film, settings)
    }

    /// The same with blocks of so many pixels.
    pub(super) fn of_blocks(per_block: usize, scene: &'a Scene, film: &'a Film, settings: &Settings) -> Self {
        let learnt = training::learn_for(scene, film, settings);
        let learning = if learnt.guide.is_some() { Learning::Growing } else { Learning::ToBegin };
        let compiled = compiled::choose(scene, film, settings, learnt, per_block);
        let (settings, later, sorter) = (*settings, Default::default(), None);
        Self { scene, film, settings, compiled, learning, later, per_block, sorter }
    }

    /// An instrument for `scene`, the same scene at another time, with what is learnt for `pass`. Where things have
    /// moved, learning helps less, but nothing is biased.
    pub(super) fn seeing<'b>(&self, scene: &'b Scene, pass: usize) -> Instrument<'b>
    where
        'a: 'b,
    {
        let Self { film, per_block, .. } = *self;
        let Options { heuristic, hide_emitters, .. } = self.settings.options;
        let profile = match self.settings.profile {
            ProfileName::Everything => ProfileName::Everything,
            _ => ProfileName::leanest(Needs::of(scene, hide_emitters)).weighing(heuristic),
        };
        let settings = Settings { profile, ..self.settings };
        let learnt = training::learn_rounds(self.scene, film, &self.settings, self.rounds_for(pass));
        let compiled = compiled::choose(scene, film, &settings, learnt.fitting(&scene.lights), per_block);
        let (learning, later) = (Learning::ToBegin, Default::default());
        Instrument { scene, film, settings, compiled, learning, later, per_block, sorter: None }
    }

    /// The same whose blocks have the layers among `layers` that contributions are sorted into.
    pub(super) fn sorting(self, layers: &[Layer]) -> Self {
        Self { sorter: Sorter::new(self.scene, layers), ..self }
    }

    /// The same for renders to a `precision`. Their passes leave out pixels and so do not tell the number of samples:
    /// all after the first look follow the same guide.
    pub(super) fn with_precision(self, precision: Precision) -> Self {
        let learning = match self.learning {
            Learning::Growing => Learning::Rounds(training::rounds_to(precision.error)),
            other => other,
        };
        Self { learning, ..self }
    }

    /// The first interaction of a camera subpath through each pixel, see [`Estimator::first_interaction`].
    ///
    /// [`Estimator::first_interaction`]: crate::transport::Estimator::first_interaction
    pub fn first_interactions(&self) -> Vec<Option<Interaction>> {
        let Self { scene, film, compiled, .. } = self;
        let first = |pixel: usize| {
            let mut start = compiled.camera_start(0, pixel);
            let ray = scene.sensor.ray(start.position, start.aperture).ray;
            compiled.first_interaction(ray, &mut start.stream)
        };
        (0..film.len()).into_par_iter().map(first).collect()
    }

    /// Rounds of learning for `pass`.
    fn rounds_for(&self, pass: usize) -> usize {
        match self.learning {
            Learning::ToBegin => ROUNDS,
            Learning::Rounds(_) if (pass as u64) < 2 * FIRST_LOOK => ROUNDS,
            Learning::Growing => training::rounds_for(self.film, &self.settings, pass),
            Learning::Rounds(rounds) => rounds,
        }
    }

    /// The estimator of `pass`, with what is learnt for it. Tasks of a render must find this [learnt](Self::learn), for
    /// learning takes all threads.
    pub fn at(&self, pass: usize) -> &(dyn Compiled + 'a) {
        let Self { scene, film, settings, per_block, .. } = self;
        let rounds = self.rounds_for(pass);
        let compile = || {
            let learnt = training::learn_rounds(scene, film, settings, rounds);
            compiled::choose(scene, film, settings, learnt, *per_block)
        };
        let later = rounds.checked_sub(ROUNDS + 1).map(|later| &self.later[later]);
        later.map_or(&*self.compiled, |later| &**later.get_or_init(compile))
    }

    /// Learns what it takes for `pass`; false if it `is_over` before.
    pub(super) fn learn(&self, pass: usize, is_over: &(dyn Fn() -> bool + Sync)) -> bool {
        let rounds = self.rounds_for(pass);
        let is_known = rounds == ROUNDS || self.later[rounds - ROUNDS - 1].get().is_some();
        is_known
            || training::learn_until(self.scene, self.film, &self.settings, rounds, is_over) && {
                self.at(pass);
                true
            }
    }

    /// One sample of every pixel of `block` that `wants` one.
    pub(super) fn render(&self, pass: usize, block: usize, wants: &dyn Fn(usize) -> bool) -> Outcome {
        match &self.sorter {
            None => self.at(pass).render(pass, block, wants),
            Some(sorter) => layers::block(self.at(pass), sorter, [pass, block], wants),
        }
    }

    /// Runs `work` on tasks on all threads until none are left or `is_over`; the results in order of tasks. A task is a
    /// block of the pass that `pass` returns. Threads take tasks in order and finish those they took, so the finished
    /// ones are the first ones. At least one is finished, unless it is over before its pass is learnt. This thread runs
    /// `meanwhile` before it takes any task.
    pub(super) fn work_until<T: Send>(
        &self,
        tasks: Range<usize>,
        pass: impl Fn(usize) -> usize + Sync,
        is_over: impl Fn() -> bool + Sync,
        work: impl Fn(usize, usize) -> T + Sync,
        meanwhile: impl FnOnce(),
    ) -> Vec<T> {
        let blocks = self.compiled.blocks().count();
        let end = tasks.clone().find(|task| !self.learn(pass(*task), &is_over)).unwrap_or(tasks.end);
        let next = AtomicUsize::new(tasks.start);
        let (done, results) = mpsc::channel();
        let work_on = || {
            while next.load(Ordering::Relaxed) == tasks.start || !is_over() {
                let task = next.fetch_add(1, Ordering::Relaxed);
                if task >= end {
                    break;
                }
                // The other end is open as long as this function runs.
                let _ = done.send((task, work(pass(task), task % blocks)));
            }
        };
        rayon::in_place_scope(|scope| {
            scope.spawn_broadcast(|_, _| work_on());
            meanwhile();
        });
        let mut done: Vec<_> = results.try_iter().collect();
        done.sort_unstable_by_key(|(task, _)| *task);
        done.into_iter().map(|(_, outcome)| outcome).collect()
    }

    /// The same for all tasks.
    pub fn work<T: Send>(&self, tasks: Range<usize>, work: impl Fn(usize, usize) -> T + Sync) -> Vec<T> {
        let blocks = self.compiled.blocks().count();
        self.work_until(tasks, |task| task / blocks, || false, work, || ())
    }

    /// Shows `see` the image of every one of `passes`, in order; the time that making them took.
    pub fn passes(&self, passes: Range<usize>, see: &mut dyn FnMut(&[Spectrum])) -> Duration {
        let mut image = Pass::new(self.film.len());
        let work = |pass, block| self.at(pass).render(pass, block, &|_| true);
        let mut pass = passes.start;
        self.in_order(passes, work, |outcome, ends_pass| {
            image.add(&outcome);
            if ends_pass {
                image.finish(self.at(pass).sharing(pass).as_ref(), &mut *see);
                pass += 1;
            }
        })
    }

    /// Shows all blocks of `passes`, on all threads, each to an observer of its own from `make`. `take` gets these
    /// observers in order, and whether the pass ends with the block.
    pub fn observe<T: BlockObserver + Send>(
        &self,
        passes: Range<usize>,
        make: impl Fn(usize) -> T + Sync,
        take: impl FnMut(T, bool),
    ) -> Duration {
        let work = |pass, block| {
            let mut observer = make(pass);
            self.at(pass).observe(pass, block, &|_| true, &mut observer);
            observer
        };
        self.in_order(passes, work, take)
    }

    /// Runs `work` on all blocks of `passes`, on all threads. `take` gets the results in order, and whether the pass
    /// ends with the block. Returns the time that `work` took.
    pub fn in_order<T: Send>(
        &self,
        passes: Range<usize>,
        work: impl Fn(usize, usize) -> T + Sync,
        mut take: impl FnMut(T, bool),
    ) -> Duration {
        let blocks = self.compiled.blocks().count();
        let (mut next, end) = (passes.start * blocks, passes.end * blocks);
        let mut spent = Duration::ZERO;
        while next < end {
            let tasks = next..(next + BLOCKS_AT_ONCE).min(end);
            let started = Instant::now();
            let done = self.work(tasks.clone(), &work);
            spent += started.elapsed();
            next = tasks.end;
            for (task, outcome) in tasks.zip(done) {
                take(outcome, (task + 1).is_multiple_of(blocks));
            }
        }
        spent
    }
}
