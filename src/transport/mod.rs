//! The estimator on one page (LW96 sec. 4).
//!
//! A pixel sample is one eye walk. At each of its vertices: emitters met (s = 0), next-event estimation
//! (s = 1), and joins with a fixed number of vertices drawn from a cache of light walks (s >= 2). Light walks
//! also join the lens (t = 1). Every contribution is weighted by a heuristic, the balance heuristic unless another is
//! asked for, over all strategies that could have made its path, flight densities included. `pt` and `lt` are the same
//! with strategies left out.

mod cache;
mod connect;
mod eye;
mod forced;
mod light;
pub mod profile;
pub mod record;
mod segment;
#[cfg(test)]
mod twin;
mod vertex;
mod walk;
mod weight;

pub use cache::LightCache;
pub use connect::Joined;
pub use vertex::{Site, Vertex};
pub use walk::Departure;
pub use weight::Sums;

pub use crate::scene::heuristic::Heuristic;

use crate::{
    math::{Lanes, Spectrum, Vec2},
    sampling::{Sampler, Stream, stream::Purpose},
    scene::Scene,
    shape::Ray,
};
use profile::Profile;
use record::{Meeting, Recorder};
use weight::Strategy;

/// Which strategies run. Their weights sum to one over those that do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Strategies {
    /// s = 0: eye walks meet emitters.
    pub hit: bool,
    /// s = 1, t >= 2: next-event estimation.
    pub next_event: bool,
    /// s >= 2, t >= 2: joins of eye and light walks.
    pub join: bool,
    /// t = 1: light walks join the lens.
    pub lens: bool,
}

impl Strategies {
    /// None at all: an estimator that is asked about primary rays only.
    pub const NONE: Self = Self { hit: false, next_event: false, join: false, lens: false };
    /// Bidirectional path tracing.
    pub const BDPT: Self = Self { hit: true, next_event: true, join: true, lens: true };
    /// Path tracing with next-event estimation.
    pub const PT: Self = Self { hit: true, next_event: true, join: false, lens: false };
    /// Light tracing.
    pub const LT: Self = Self { hit: false, next_event: false, join: false, lens: true };
}

/// What an estimator is asked to do.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Which strategies run.
    pub strategies: Strategies,
    /// By which they share the paths that several of them can make. All but [`Heuristic::Balance`] run on the profile
    /// that [`profile::ProfileName::weighing`] names.
    pub heuristic: Heuristic,
    /// Most segments of a path, null boundaries not counted; none for no limit. Paths beyond
    /// [`Heuristic::most_edges`] are never made.
    pub max_depth: Option<u32>,
    /// The camera does not see emitters, but what is behind them.
    pub hide_emitters: bool,
    /// Seed of the pilot walks.
    pub seed: u64,
    /// Where the random numbers of walks come from.
    pub sampler: Sampler,
    /// Primary rays that cross media are followed both from a collision in them and from what lies behind.
    pub forced_interaction: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            strategies: Strategies::BDPT,
            heuristic: Heuristic::default(),
            max_depth: None,
            hide_emitters: false,
            seed: 0,
            sampler: Sampler::default(),
            forced_interaction: false,
        }
    }
}

/// Expected samples of each kind of strategy per pixel sample: n in the balance heuristic.
#[derive(Clone, Copy, Debug)]
pub struct Counts {
    hit: f32,
    next_event: f32,
    join: f32,
    lens: f32,
}

/// Draws from the light cache at every eye vertex.
const JOINS_PER_VERTEX: u32 = 1;
/// Vertices that the cache of a block should hold at most, on average: it has to stay near the processor.
const CACHE_VERTICES: f32 = 16_384.0;
/// Light walks that measure how many vertices a light walk leaves.
const PILOT_WALKS: u64 = 2_048;

/// The estimator for one scene, compiled for profile `P`.
pub struct Estimator<'a, P: Profile> {
    scene: &'a Scene,
    counts: Counts,
    heuristic: Heuristic,
    joins_per_vertex: u32,
    /// Probability that a light vertex is kept for joins.
    keep: f32,
    max_edges: u32,
    hide_emitters: bool,
    forced_interaction: bool,
    profile: std::marker::PhantomData<P>,
}

impl<'a, P: Profile> Estimator<'a, P> {
    /// Prepares to render `scene` with `walks_per_pass` light walks for each sample of all pixels together and
    /// `walks_per_block` of them behind one cache.
    pub fn new(scene: &'a Scene, options: Options, walks_per_pass: u64, walks_per_block: u64) -> Self {
        let Options { strategies, heuristic, max_depth, hide_emitters, seed, forced_interaction, .. } =
            options;
        let lit = !scene.lights.is_empty();
        let count = |on: bool, n: f32| if on && lit { n } else { 0.0 };
        let mut estimator = Self {
            scene,
            counts: Counts {
                hit: count(strategies.hit, 1.0),
                next_event: count(strategies.next_event, 1.0),
                join: 0.0,
                lens: count(strategies.lens, walks_per_pass as f32),
            },
            heuristic,
            joins_per_vertex: 0,
            keep: 0.0,
            max_edges: max_depth.unwrap_or(u32::MAX).min(P::Sums::MOST_EDGES),
            hide_emitters,
            forced_interaction: P::MEDIA && forced_interaction,
            profile: std::marker::PhantomData,
        };
        if strategies.join && lit {
            estimator.plan_joins(seed, walks_per_block);
        }
        estimator
    }

    /// Measures how many vertices a light walk leaves: n of a join is draws over vertices per walk, however many
    /// of them are kept. The weights need a constant that does not depend on the very walks they weight, hence a
    /// measurement beforehand.
    fn plan_joins(&mut self, seed: u64, walks_per_block: u64) {
        self.keep = 1.0;
        let mut cache = LightCache::new(P::Lanes::COUNT);
        // Compiled for instruments anyhow; pilot walks are few.
        let mut recorder: &mut dyn Recorder<P::Sums> = &mut Nowhere;
        for walk in 0..PILOT_WALKS {
            let mut stream = Stream::new(seed, walk, 0, Purpose::Pilot);
            let hero = walk as usize % P::Lanes::COUNT;
            light::trace(self, &mut cache, &mut recorder, hero, &mut stream);
        }
        let per_walk = (cache.len() as f32 / PILOT_WALKS as f32).max(1.0 / PILOT_WALKS as f32);
        self.keep = (CACHE_VERTICES / (per_walk * walks_per_block as f32)).min(1.0);
        self.joins_per_vertex = JOINS_PER_VERTEX;
        self.counts.join = JOINS_PER_VERTEX as f32 / per_walk;
    }

    /// The strategy of `count` expected samples.
    #[inline]
    fn strategy(&self, count: f32) -> Strategy {
        Strategy { count, heuristic: self.heuristic }
    }

    /// True if light walks have something to do.
    pub fn needs_light_walks(&self) -> bool {
        self.joins_per_vertex > 0 || self.counts.lens > 0.0
    }

    /// Traces one light walk of channel `hero` into `cache`; what it brings goes to `recorder`.
    pub fn trace_light(
        &self,
        cache: &mut LightCache<P::Sums>,
        recorder: &mut impl Recorder<P::Sums>,
        hero: usize,
        stream: &mut Stream,
    ) {
        light::trace(self, cache, recorder, hero, stream);
    }

    /// What remains of radiance along a primary ray (its `t_max` is its length); 0 where something blocks it.
    pub fn transmittance(&self, primary: Ray, stream: &mut Stream) -> Spectrum {
        let passage = segment::pass::<P>(
            self.scene,
            primary,
            0.0,
            self.scene.sensor_medium,
            self.hide_emitters,
            stream,
        );
        passage.map_or(Spectrum::ZERO, |passage| passage.transmittance)
    }

    /// One eye walk of channel `hero` through `film` [pixels] and a point of the aperture; what it brings goes to
    /// `recorder`.
    pub fn sample_pixel<R: Recorder<P::Sums>>(
        &self,
        cache: &LightCache<P::Sums>,
        film: Vec2,
        aperture: Vec2,
        hero: usize,
        recorder: R,
        stream: &mut Stream,
    ) -> R {
        if P::MEDIA && self.forced_interaction {
            return forced::sample(self, cache, film, aperture, hero, recorder, stream);
        }
        eye::sample(self, cache, film, aperture, hero, recorder, stream)
    }
}

/// A film that nothing reaches, for pilot walks.
struct Nowhere;

impl<S: Sums> Recorder<S> for Nowhere {
    fn covers(&self, _: Vec2) -> bool {
        false
    }
    fn contribute(&mut self, _: u32, _: u32, _: Meeting<'_, S>, _: Option<&Joined>) {}
}
