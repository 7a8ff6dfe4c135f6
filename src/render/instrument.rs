//! A bench: a scene with its compiled estimator; instruments inspect its passes one by one. Blocks, streams and
//! the order of sums are those of a render with the same seed.

use super::{
    Settings,
    compiled::{self, Compiled},
};
use crate::{film::Film, math::Spectrum, scene::Scene};
use rayon::prelude::*;
use std::{
    ops::Range,
    time::{Duration, Instant},
};

/// Blocks that are rendered between two readings of the clock: enough to keep any machine's threads busy, and
/// independent of their number.
pub(super) const BLOCKS_AT_ONCE: usize = 64;

/// An estimator ready to make passes over `film`.
pub struct Instrument<'a> {
    pub(super) scene: &'a Scene,
    pub(super) film: &'a Film,
    pub(super) settings: Settings,
    pub(super) compiled: Box<dyn Compiled + 'a>,
}

impl<'a> Instrument<'a> {
    /// Prepares to render `scene` onto `film`. The budget of `settings` does not count.
    pub fn new(scene: &'a Scene, film: &'a Film, settings: &Settings) -> Self {
        Self { scene, film, settings: *settings, compiled: compiled::choose(scene, film, settings) }
    }

    /// `work` on tasks, each a block of a pass, on all threads; the results in their order.
    pub(super) fn work<T: Send>(
        &self,
        tasks: Range<usize>,
        work: impl Fn(usize, usize) -> T + Sync,
    ) -> Vec<T> {
        let blocks = self.compiled.blocks().count();
        tasks.into_par_iter().map(|task| work(task / blocks, task % blocks)).collect()
    }

    /// Shows `see` the image of every one of `passes`, in order; the time that making them took.
    pub fn passes(&self, passes: Range<usize>, see: &mut dyn FnMut(&[Spectrum])) -> Duration {
        let mut image = vec![Spectrum::ZERO; self.film.len()];
        let work = |pass, block| self.compiled.render(pass, block, &|_| true);
        self.in_order(passes, work, |outcome, ends_pass| {
            outcome.add_to(&mut image);
            if ends_pass {
                see(&image);
                image.fill(Spectrum::ZERO);
            }
        })
    }

    /// `work` on all blocks of `passes`, on all threads; `take` gets the results in order, and whether the
    /// pass ends with it. The time that `work` took.
    pub(super) fn in_order<T: Send>(
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
