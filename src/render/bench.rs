//! A bench: a scene with its compiled estimator, whose passes instruments look at one by one. Blocks, streams and
//! the order of sums are those of a render with the same seed.

use super::{
    BLOCKS_AT_ONCE, Settings,
    block::{Blocks, Outcome},
    clock::{self, Times},
    compiled::{self, Work},
    parts::{self, Cells, Part},
    sample::{self, PixelSample},
};
use crate::{
    film::Film,
    math::Spectrum,
    scene::Scene,
    transport::{Estimator, Strategies, profile::Profile},
};
use rayon::prelude::*;
use std::{
    ops::Range,
    time::{Duration, Instant},
};

/// An estimator ready to make passes over `film`.
pub struct Bench<'a> {
    pub(super) film: &'a Film,
    pub(super) strategies: Strategies,
    pub(super) compiled: Box<dyn Compiled + 'a>,
}

/// What every compiled estimator can be asked for, whatever its profile.
pub(super) trait Compiled: Sync {
    /// How many blocks a pass has.
    fn blocks(&self) -> usize;
    /// See [`Blocks::render`].
    fn render(&self, pass: usize, block: usize) -> Outcome;
    /// See [`parts::block`].
    fn parts(&self, cells: Cells, pass: usize, block: usize) -> Vec<Part>;
    /// See [`clock::block`].
    fn time(&self, cells: Cells, pass: usize, block: usize) -> Times;
    /// See [`sample::pixel`].
    fn sample(&self, pass: usize, pixel: usize) -> PixelSample;
}

/// An estimator of profile `P` with all it takes to use it.
pub(super) struct Ready<'a, P: Profile> {
    pub estimator: Estimator<'a, P>,
    pub blocks: Blocks,
    pub film: &'a Film,
    pub seed: u64,
}

/// A bench that waits for its profile.
struct Preparation<'a, 'b> {
    scene: &'a Scene,
    film: &'a Film,
    settings: &'b Settings,
}

impl<'a> Work for Preparation<'a, '_> {
    type Output = Box<dyn Compiled + 'a>;

    fn by<P: Profile>(self) -> Self::Output {
        let Self { scene, film, settings } = self;
        let blocks = Blocks::new::<P>(film.len(), settings.options.sampler);
        let (per_pass, per_block) = (blocks.walks_per_pass(), blocks.walks_per_block());
        let estimator = Estimator::<P>::new(scene, settings.options, per_pass, per_block);
        Box::new(Ready { estimator, blocks, film, seed: settings.seed })
    }
}

impl<P: Profile> Compiled for Ready<'_, P> {
    fn blocks(&self) -> usize {
        self.blocks.count()
    }
    fn render(&self, pass: usize, block: usize) -> Outcome {
        self.blocks.render(&self.estimator, self.film, self.seed, pass, block, |_| true)
    }
    fn parts(&self, cells: Cells, pass: usize, block: usize) -> Vec<Part> {
        parts::block(self, cells, pass, block)
    }
    fn time(&self, cells: Cells, pass: usize, block: usize) -> Times {
        clock::block(self, cells, pass, block)
    }
    fn sample(&self, pass: usize, pixel: usize) -> PixelSample {
        sample::pixel(self, pass, pixel)
    }
}

impl<'a> Bench<'a> {
    /// Prepares to render `scene` onto `film`. The budget of `settings` does not count.
    pub fn new(scene: &'a Scene, film: &'a Film, settings: &Settings) -> Self {
        let compiled = compiled::choose(settings, Preparation { scene, film, settings });
        Self { film, strategies: settings.options.strategies, compiled }
    }

    /// Shows `see` the image of every one of `passes`, in order; the time that making them took.
    pub fn passes(&self, passes: Range<usize>, see: &mut dyn FnMut(&[Spectrum])) -> Duration {
        let mut image = vec![Spectrum::ZERO; self.film.len()];
        let work = |pass, block| self.compiled.render(pass, block);
        self.in_order(passes, work, |outcome, ends_pass| {
            outcome.add_to(&mut image);
            if ends_pass {
                see(&image);
                image.fill(Spectrum::ZERO);
            }
        })
    }

    /// `work` on all blocks of `passes`, on all threads; `take` gets what came of it in order, and whether the
    /// pass ends with it. The time that `work` took.
    pub(super) fn in_order<T: Send>(
        &self,
        passes: Range<usize>,
        work: impl Fn(usize, usize) -> T + Sync,
        mut take: impl FnMut(T, bool),
    ) -> Duration {
        let blocks = self.compiled.blocks();
        let (mut next, end) = (passes.start * blocks, passes.end * blocks);
        let mut spent = Duration::ZERO;
        while next < end {
            let tasks = next..(next + BLOCKS_AT_ONCE).min(end);
            let started = Instant::now();
            let done: Vec<T> =
                tasks.clone().into_par_iter().map(|task| work(task / blocks, task % blocks)).collect();
            spent += started.elapsed();
            next = tasks.end;
            for (task, outcome) in tasks.zip(done) {
                take(outcome, (task + 1).is_multiple_of(blocks));
            }
        }
        spent
    }
}
