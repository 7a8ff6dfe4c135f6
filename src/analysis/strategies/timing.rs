//! What each strategy costs: number and time of its connections, and vertices and time of the walks.

use super::images::StrategyTable;
use crate::{
    film::Film,
    math::Vec2,
    passes::{blocks::CameraStart, observe::BlockObserver},
    render::instrument::Instrument,
    transport::{
        Contribution, Event,
        observer::{Meeting, Observer},
        strategy::StrategyKind,
    },
};
use std::time::Instant;

/// Time of passes, summed over threads.
#[derive(Clone, Debug)]
pub(super) struct Times {
    /// Of the connections of every cell (s).
    pub connections: Vec<f64>,
    /// How often each was tried.
    pub tries: Vec<u64>,
    /// Of camera subpaths without their connections (s).
    pub camera_paths: f64,
    /// Of light subpaths without their connections (s).
    pub light_paths: f64,
    /// Vertices of camera subpaths at which light may scatter on.
    pub camera_vertices: u64,
    /// Those of light subpaths.
    pub light_vertices: u64,
}

impl Times {
    fn new(table: StrategyTable) -> Self {
        let (connections, tries) = (vec![0.0; table.count()], vec![0; table.count()]);
        let (camera_vertices, light_vertices) = (0, 0);
        Self { connections, tries, camera_paths: 0.0, light_paths: 0.0, camera_vertices, light_vertices }
    }

    fn add(&mut self, other: &Self) {
        self.connections.iter_mut().zip(&other.connections).for_each(|(sum, time)| *sum += time);
        self.tries.iter_mut().zip(&other.tries).for_each(|(sum, tries)| *sum += tries);
        self.camera_paths += other.camera_paths;
        self.light_paths += other.light_paths;
        self.camera_vertices += other.camera_vertices;
        self.light_vertices += other.light_vertices;
    }

    /// All of it (s).
    pub(super) fn total(&self) -> f64 {
        self.connections.iter().sum::<f64>() + self.camera_paths + self.light_paths
    }
}

/// A span longer than this, and than [`OUTLIER`] medians of its kind, held an interruption: other programs
/// take the processor for milliseconds, connections take microseconds (s).
const INTERRUPTION: f32 = 1e-3;
/// See [`INTERRUPTION`].
const OUTLIER: f32 = 50.0;

/// Sum of `spans` (s), a look at the clock taken off each. In place of interrupted ones count as many mean ones.
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
    /// What a look takes (s).
    look: f64,
    /// Spans of the connections of every cell (s).
    connections: Vec<Vec<f32>>,
    /// Spans between them, of light subpaths and of camera subpaths (s).
    between: [Vec<f32>; 2],
    /// Where they may scatter on.
    vertices: [u64; 2],
    /// Which of both are at hand.
    walks: usize,
}

impl<'a> TimingObserver<'a> {
    fn new(film: &'a Film, table: StrategyTable) -> Self {
        let (connections, between) = (vec![Vec::new(); table.count()], [Vec::new(), Vec::new()]);
        let (vertices, walks) = ([0; 2], 0);
        Self { film, table, look: look(), connections, between, vertices, walks, last: Instant::now() }
    }

    /// The time since the last look.
    fn span(&mut self) -> f32 {
        let now = Instant::now();
        let span = now.duration_since(self.last).as_secs_f32();
        self.last = now;
        span
    }

    /// Since the last look, no connection was tried.
    fn walked(&mut self) {
        let span = self.span();
        self.between[self.walks].push(span);
    }

    fn times(&self) -> Times {
        let [light_paths, camera_paths] = self.between.each_ref().map(|spans| total(spans, self.look));
        let [light_vertices, camera_vertices] = self.vertices;
        Times {
            connections: self.connections.iter().map(|spans| total(spans, self.look)).collect(),
            tries: self.connections.iter().map(|spans| spans.len() as u64).collect(),
            camera_paths,
            light_paths,
            camera_vertices,
            light_vertices,
        }
    }
}

impl BlockObserver for TimingObserver<'_> {
    fn light(&mut self, _: u64) -> &mut dyn Observer {
        self
    }

    fn lit(&mut self) {
        self.walked();
        self.walks = 1;
    }

    fn camera(&mut self, _: usize, _: &CameraStart) -> &mut dyn Observer {
        self
    }

    fn ended(&mut self, _: usize) {
        self.walked();
    }
}

/// What a look at the clock takes, undisturbed (s).
fn look() -> f64 {
    const LOOKS: u32 = 16;
    let once = |_| {
        let started = Instant::now();
        let last = (1..LOOKS).fold(started, |_, _| Instant::now());
        last.duration_since(started).as_secs_f64() / f64::from(LOOKS - 1)
    };
    (0..LOOKS).map(once).fold(f64::INFINITY, f64::min)
}

impl Observer for TimingObserver<'_> {
    fn covers(&self, film: Vec2) -> bool {
        self.film.covers(film)
    }

    fn contribute(&mut self, _: u32, _: u32, _: Meeting<'_>, _: Option<&Contribution>) {}

    fn arrive(&mut self, _: Event<'_>) {
        self.vertices[self.walks] += 1;
    }

    fn start(&mut self) {
        self.walked();
    }

    fn stop(&mut self, kind: StrategyKind, s: u32, t: u32) {
        let span = self.span();
        self.connections[self.table.index(kind, s, t)].push(span);
    }
}

impl Times {
    /// Those of `passes` passes.
    pub(super) fn of(
        instrument: &Instrument<'_>,
        table: StrategyTable,
        passes: usize,
        progress: &mut dyn FnMut(usize),
    ) -> Self {
        let (mut times, mut done) = (Self::new(table), 0);
        let block = |_| TimingObserver::new(instrument.film, table);
        instrument.observe(0..passes, block, |block, ends_pass| {
            times.add(&block.times());
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
    use crate::{
        film::sharing::FilmSamples,
        format,
        passes::{Settings, budget::Budget},
        sampling::Sampler,
        scene::{accel::RAYS, build},
        settings::Overrides,
        transport::{Options, Strategies, needs::Needs, profiles::ProfileName},
    };
    use std::path::Path;

    /// What all strategies do for a pixel sample of `scene`: vertices of camera and light subpaths, connections, rays.
    fn work(scene: &str) -> [f64; 4] {
        const SIZE: u32 = 32;
        const PASSES: usize = 16;
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(scene);
        let overrides = Overrides { size: Some((SIZE, SIZE)), ..Overrides::default() };
        let setup = build::build(&format::read(&path, &[]).unwrap(), overrides).unwrap();
        let options = Options { strategies: Strategies::BDPT, ..setup.integrator.options };
        let profile = ProfileName::leanest(Needs::of(&setup.scene, false));
        let (sampler, budget) = (Sampler::Independent, Budget::ENDLESS);
        let settings =
            Settings { options, sampler, film_samples: FilmSamples::Own, budget, seed: 0, profile };
        let instrument = Instrument::new(&setup.scene, &setup.film, &settings);
        let table = StrategyTable { depth: 1 };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        let (times, rays) = pool.install(|| {
            let before = RAYS.get();
            (Times::of(&instrument, table, PASSES, &mut |_| ()), RAYS.get() - before)
        });
        let counts = [times.camera_vertices, times.light_vertices, times.tries.iter().sum(), rays];
        counts.map(|count| count as f64 / (PASSES * setup.film.len()) as f64)
    }

    /// Work per sample needs no clock. If it is to be another, say why where these numbers are changed.
    #[test]
    fn samples_take_the_work_that_they_took() {
        let scenes = ["lampbox_up.xml", "efficiency/glass_fog_sky.xml", "crosscheck/grid_sparse.json"];
        let recorded =
            [[4.200, 3.349, 11.576, 13.048], [2.237, 0.378, 3.414, 6.353], [0.897, 0.353, 2.902, 6.524]];
        let found = scenes.map(work);
        let mut pairs = found.iter().flatten().zip(recorded.iter().flatten());
        let is_kept = pairs.all(|(found, recorded)| (found / recorded - 1.0).abs() <= 0.02);
        assert!(is_kept, "{scenes:?}: found {found:.3?}, recorded {recorded:?}");
    }

    #[test]
    fn interruptions_count_as_the_mean_and_long_joins_as_they_are() {
        let close = |a: f64, b: f64| (a - b).abs() < 1e-6 * b;
        assert!(close(total(&[2e-6, 4e-6, 3e-6, 8e-3], 1e-6), 8e-6));
        assert!(close(total(&[2e-3, 4e-3, 3e-3, 8e-3], 0.0), 17e-3));
        assert_eq!((total(&[], 0.0), total(&[1e-7], 1e-6)), (0.0, 0.0));
        assert!(look() < 1e-3);
    }
}
