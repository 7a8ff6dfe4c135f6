//! How long each strategy takes: the time of its connections, and that of the walks.

use super::{compiled::Ready, instrument::Instrument, strategy_images::StrategyTable};
use crate::{
    film::Film,
    math::Vec2,
    transport::{
        Contribution, MisSums,
        observer::{Meeting, Observer},
        profile::Profile,
    },
};
use std::time::Instant;

/// Time of passes, summed over threads.
#[derive(Clone, Debug)]
pub struct Times {
    /// Of the connections of every cell [s].
    pub connections: Vec<f64>,
    /// How often each was tried.
    pub tries: Vec<u64>,
    /// Of camera subpaths without their connections [s].
    pub camera_paths: f64,
    /// Of light subpaths without their connections [s].
    pub light_paths: f64,
}

impl Times {
    fn new(table: StrategyTable) -> Self {
        let count = table.count();
        Self { connections: vec![0.0; count], tries: vec![0; count], camera_paths: 0.0, light_paths: 0.0 }
    }

    fn add(&mut self, other: &Self) {
        self.connections.iter_mut().zip(&other.connections).for_each(|(sum, time)| *sum += time);
        self.tries.iter_mut().zip(&other.tries).for_each(|(sum, tries)| *sum += tries);
        self.camera_paths += other.camera_paths;
        self.light_paths += other.light_paths;
    }

    /// All of it [s].
    pub fn total(&self) -> f64 {
        self.connections.iter().sum::<f64>() + self.camera_paths + self.light_paths
    }
}

/// The times of a block.
pub(super) fn block<P: Profile>(
    ready: &Ready<'_, P>,
    table: StrategyTable,
    pass: usize,
    block: usize,
) -> Times {
    let Ready { estimator, blocks, scene, film, seed } = ready;
    let mut timing = TimingObserver::new(film, table);
    let mut observer: &mut dyn Observer<P::MisSums> = &mut timing;
    let cache = blocks.trace_light(estimator, *seed, pass, block, &mut observer);
    let light_paths = timing.rest();
    for pixel in blocks.pixels(block) {
        let observer: &mut dyn Observer<P::MisSums> = &mut timing;
        blocks.camera_start(scene, film, *seed, pass, pixel).trace(estimator, &cache, observer);
    }
    let camera_paths = timing.rest();
    let tries = timing.connections.iter().map(|spans| spans.len() as u64).collect();
    Times {
        connections: timing.connections.iter().map(|spans| total(spans, timing.look)).collect(),
        tries,
        camera_paths,
        light_paths,
    }
}

/// A span longer than this, and than [`OUTLIER`] medians of its kind, held an interruption: other programs
/// take the processor for milliseconds, connections take microseconds [s].
const INTERRUPTION: f32 = 1e-3;
/// See [`INTERRUPTION`].
const OUTLIER: f32 = 50.0;

/// Sum of `spans` [s], a look at the clock taken off each. In place of interrupted ones count as many mean ones.
fn total(spans: &[f32], look: f64) -> f64 {
    let mut sorted = spans.to_vec();
    sorted.sort_by(f32::total_cmp);
    let Some(median) = sorted.get(sorted.len() / 2) else { return 0.0 };
    let limit = INTERRUPTION.max(OUTLIER * median);
    let kept = sorted.partition_point(|span| *span <= limit);
    let sum: f64 = sorted[..kept].iter().map(|span| (f64::from(*span) - look).max(0.0)).sum();
    sum * spans.len() as f64 / kept as f64
}

/// Reads the clock before and after every connection.
struct TimingObserver<'a> {
    film: &'a Film,
    table: StrategyTable,
    /// The last look.
    last: Instant,
    /// What a look takes [s].
    look: f64,
    /// Spans of the connections of every cell [s].
    connections: Vec<Vec<f32>>,
    /// Spans between them [s].
    between: Vec<f32>,
}

impl<'a> TimingObserver<'a> {
    fn new(film: &'a Film, table: StrategyTable) -> Self {
        let (connections, between) = (vec![Vec::new(); table.count()], Vec::new());
        Self { film, table, look: look(), connections, between, last: Instant::now() }
    }

    /// The time since the last look.
    fn span(&mut self) -> f32 {
        let now = Instant::now();
        let span = now.duration_since(self.last).as_secs_f32();
        self.last = now;
        span
    }

    /// The time between connections so far, which is then reset.
    fn rest(&mut self) -> f64 {
        let span = self.span();
        self.between.push(span);
        total(&std::mem::take(&mut self.between), self.look)
    }
}

/// What a look at the clock takes, undisturbed [s].
fn look() -> f64 {
    const LOOKS: u32 = 16;
    let once = |_| {
        let started = Instant::now();
        let last = (1..LOOKS).fold(started, |_, _| Instant::now());
        last.duration_since(started).as_secs_f64() / f64::from(LOOKS - 1)
    };
    (0..LOOKS).map(once).fold(f64::INFINITY, f64::min)
}

impl<S: MisSums> Observer<S> for TimingObserver<'_> {
    fn covers(&self, film: Vec2) -> bool {
        self.film.covers(film)
    }

    fn contribute(&mut self, _: u32, _: u32, _: Meeting<'_, S>, _: Option<&Contribution>) {}

    fn start(&mut self) {
        let span = self.span();
        self.between.push(span);
    }

    fn stop(&mut self, s: u32, t: u32) {
        let span = self.span();
        self.connections[self.table.index(s, t)].push(span);
    }
}

impl Instrument<'_> {
    /// The times of `passes` passes.
    pub fn times(&self, table: StrategyTable, passes: usize, progress: &mut dyn FnMut(usize)) -> Times {
        let (mut times, mut done) = (Times::new(table), 0);
        let work = |pass, block| self.compiled.time(table, pass, block);
        self.in_order(0..passes, work, |block, ends_pass| {
            times.add(&block);
            if ends_pass {
                done += 1;
                progress(done);
            }
        });
        times
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn interruptions_count_as_the_mean_and_long_joins_as_they_are() {
        let close = |a: f64, b: f64| (a - b).abs() < 1e-6 * b;
        assert!(close(total(&[2e-6, 4e-6, 3e-6, 8e-3], 1e-6), 8e-6));
        assert!(close(total(&[2e-3, 4e-3, 3e-3, 8e-3], 0.0), 17e-3));
        assert_eq!((total(&[], 0.0), total(&[1e-7], 1e-6)), (0.0, 0.0));
        assert!(look() < 1e-3);
    }
}
