//! How long each strategy takes: the time of its joins, and that of the walks.

use super::{
    bench::{Bench, Ready},
    parts::Cells,
};
use crate::{
    film::Film,
    math::Vec2,
    transport::{
        Joined, Sums,
        profile::Profile,
        record::{Meeting, Recorder},
    },
};
use std::time::Instant;

/// Processor time of passes, summed over threads.
#[derive(Clone, Debug)]
pub struct Times {
    /// Of the joins of every cell [s].
    pub joins: Vec<f64>,
    /// How often each was tried.
    pub tries: Vec<u64>,
    /// Of eye walks without their joins [s].
    pub eye_walks: f64,
    /// Of light walks without their joins [s].
    pub light_walks: f64,
}

impl Times {
    fn new(cells: Cells) -> Self {
        let count = cells.count();
        Self { joins: vec![0.0; count], tries: vec![0; count], eye_walks: 0.0, light_walks: 0.0 }
    }

    fn add(&mut self, other: &Self) {
        self.joins.iter_mut().zip(&other.joins).for_each(|(sum, time)| *sum += time);
        self.tries.iter_mut().zip(&other.tries).for_each(|(sum, tries)| *sum += tries);
        self.eye_walks += other.eye_walks;
        self.light_walks += other.light_walks;
    }

    /// All of it [s].
    pub fn total(&self) -> f64 {
        self.joins.iter().sum::<f64>() + self.eye_walks + self.light_walks
    }
}

/// The times of a block.
pub(super) fn block<P: Profile>(ready: &Ready<'_, P>, cells: Cells, pass: usize, block: usize) -> Times {
    let Ready { estimator, blocks, film, seed } = ready;
    let mut watch = Watch::new(film, cells);
    let mut recorder: &mut dyn Recorder<P::Sums> = &mut watch;
    let started = Instant::now();
    let cache = blocks.trace_light(estimator, *seed, pass, block, &mut recorder);
    watch.times.light_walks = watch.rest_of(started);
    let started = Instant::now();
    for pixel in blocks.pixels(block) {
        let recorder: &mut dyn Recorder<P::Sums> = &mut watch;
        blocks.eye_start(estimator, film, *seed, pass, pixel).trace(estimator, &cache, recorder);
    }
    watch.times.eye_walks = watch.rest_of(started);
    watch.times
}

/// Looks at the clock before and after every join.
struct Watch<'a> {
    film: &'a Film,
    cells: Cells,
    times: Times,
    started: Instant,
    /// What a look at the clock takes [s].
    look: f64,
    /// Time of all joins since the last [`Self::rest_of`], looks at the clock included [s].
    joining: f64,
}

impl<'a> Watch<'a> {
    fn new(film: &'a Film, cells: Cells) -> Self {
        let started = Instant::now();
        const LOOKS: u32 = 100;
        let last = (0..LOOKS).fold(started, |_, _| Instant::now());
        let look = last.duration_since(started).as_secs_f64() / f64::from(LOOKS);
        Self { film, cells, times: Times::new(cells), started, look, joining: 0.0 }
    }

    /// The time since `started` in which nothing was joined.
    fn rest_of(&mut self, started: Instant) -> f64 {
        let joining = std::mem::take(&mut self.joining);
        (started.elapsed().as_secs_f64() - joining).max(0.0)
    }
}

impl<S: Sums> Recorder<S> for Watch<'_> {
    fn covers(&self, film: Vec2) -> bool {
        self.film.covers(film)
    }

    fn contribute(&mut self, _: u32, _: u32, _: Meeting<'_, S>, _: Option<&Joined>) {}

    fn start(&mut self) {
        self.started = Instant::now();
    }

    fn stop(&mut self, s: u32, t: u32) {
        let elapsed = self.started.elapsed().as_secs_f64();
        let cell = self.cells.index(s, t);
        // Of the two looks at the clock one lies between start and stop, one outside.
        self.times.joins[cell] += (elapsed - self.look).max(0.0);
        self.times.tries[cell] += 1;
        self.joining += elapsed + self.look;
    }
}

impl Bench<'_> {
    /// The times of `passes` passes.
    pub fn times(&self, cells: Cells, passes: usize, tell: &mut dyn FnMut(usize)) -> Times {
        let (mut times, mut done) = (Times::new(cells), 0);
        let work = |pass, block| self.compiled.time(cells, pass, block);
        self.in_order(0..passes, work, |block, ends_pass| {
            times.add(&block);
            if ends_pass {
                done += 1;
                tell(done);
            }
        });
        times
    }
}
