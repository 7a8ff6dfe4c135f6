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

pub use crate::scene::{
    heuristic::Heuristic,
    options::{Options, Strategies},
};

use crate::{
    math::{Lanes, Spectrum, Vec2},
    sampling::{Stream, stream::Purpose},
    scene::Scene,
    shape::Ray,
};
use profile::Profile;
use record::{Meeting, Recorder};
use weight::Strategy;

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
    /// `walks_per_block` of them behind one cache; `seed` is that of its pilot walks.
    pub fn new(
        scene: &'a Scene,
        options: Options,
        seed: u64,
        walks_per_pass: u64,
        walks_per_block: u64,
    ) -> Self {
        let Options { strategies, heuristic, max_depth, hide_emitters, forced_interaction } = options;
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
