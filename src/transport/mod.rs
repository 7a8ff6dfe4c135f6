//! The estimator on one page (LW96 sec. 4).
//!
//! # The path and what it contributes
//! A path x_0 x_1 .. x_k leads from a point of an emitter, or a direction to one at infinity, over points that scatter,
//! on surfaces or in media, to the lens x_k. Index-matched boundaries are no vertices: they only change the medium along a
//! segment. The pixel measures the integral over all paths of
//!
//! ```text
//! C(x_0 .. x_k) = L_e(x_0 -> x_1) |cos_0| G(x_0, x_1) g(x_1) G(x_1, x_2) g(x_2) .. G(x_k-1, x_k) W(x_k-1 -> x_k)
//!
//! G(x, y) = T(x, y) / d^2          T: transmittance, 0 where a surface is in the way; d: the distance, 1 at infinity
//! g(x)    = sigma_t albedo phase   in a medium
//!           bsdf |cos| |cos'|      on a surface
//! ```
//! (LW96 eq. 10, with the sigma_s that it leaves out of g in a medium). L_e is the emitted radiance; in an emissive
//! medium it is the radiance emitted per metre, for a point light the intensity. W is the pixel's filter over the film.
//!
//! # The sum over (s, t)
//! A light subpath makes x_0 .. x_s-1, a camera subpath x_k .. x_s (t = k + 1 - s vertices), and a segment
//! connects the two. With p> and p< the densities by which the walks make a vertex (LW96 eq. 13), strategy
//! (s, t) makes a path with the density
//!
//! ```text
//! p_s = p>(x_0) p>(x_1) .. p>(x_s-1)  p<(x_s) .. p<(x_k-1) p<(x_k)                                        LW96 eq. 11, 12
//! ```
//! and n_s expected samples a pixel sample ([`Counts`]). The estimate is
//!
//! ```text
//! sum over s >= 0, t >= 1 of   w_s C / (n_s p_s)      for each sample of the strategy
//! w_s = n_s p_s / sum_i n_i p_i                       over all strategies i that can make the path       LW96 eq. 14
//! ```
//! | s, t | what happens | where |
//! |---|---|---|
//! | s = 0 | the camera subpath hits an emitter | [`camera_path::CameraPath::emitter_hit`] |
//! | s = 1, t >= 2 | next-event estimation: a fresh point of an emitter | [`camera_path::CameraPath::join_emitter`] |
//! | s >= 2, t >= 2 | connection with a light vertex drawn from a cache, or with all of one walk ([`Connections`]) | [`camera_path::CameraPath::connect_with`] |
//! | s >= 2, t >= 2 over Dirac lobes | the path of a lamp's light over a smooth shape is solved for | [`camera_path::CameraPath::connect_bent`] |
//! | s >= 1, t = 1 | the light subpath is connected to the lens, through any pixel | [`light_path::LightPath::connect_to_lens`] |
//! | s = 1, t = 2 in media | a distance along the primary ray, likely near an emitter, then as s = 1 | [`equiangular`] |
//!
//! A pixel sample is one camera subpath. The light subpaths of a block of pixels fill the cache, or each belongs to one
//! pixel. `pt` and `lt` leave out strategies ([`Strategies`]). Heuristics other than eq. 14 sum n p differently
//! ([`MisSums`]). In all of them p contains the flight densities.
//!
//! # From equation to function
//! | equation | function |
//! |---|---|
//! | LW96 eq. 3, L_e at the end of a camera subpath | [`camera_path::CameraPath::emitter_hit`] |
//! | LW96 eq. 4, one random walk through media and surfaces | [`walk::walk`], [`segment::sample_free_flight`] |
//! | LW96 eq. 5 and 8, scattering in a medium | `collide` in [`walk::scatter`] |
//! | LW96 eq. 6, p_medium | [`Medium::sample_distance`](crate::medium::Medium::sample_distance) |
//! | LW96 eq. 7, P_surface | [`segment::transmittance`], [`Medium::optical_depth`](crate::medium::Medium::optical_depth) |
//! | LW96 eq. 9, reflection | `reflect` in [`walk::scatter`] |
//! | LW96 eq. 10, the contribution | [`connect::connect_along`]; its g is [`vertex::Vertex::scatter_towards`] |
//! | LW96 eq. 11 and 12, densities of paths | [`vertex::Subpath`]: as ratios, by [`walk::arrive`] and [`walk::set_out`] |
//! | LW96 eq. 13, density of a vertex | [`walk::arrive`] |
//! | LW96 eq. 14, the weight | [`mis::connection_weight`], [`mis::Strategy::weight`], [`mis::Balance`] |
//! | LW96 sec. 5, media that vary | [`crate::medium::distance`] |
//! | P03 eq. 11, emission of a medium | [`crate::medium::Emission`], sampled in [`camera_path::CameraPath::meet`] |
//! | P03T eq. 2.9, media that only absorb | [`crate::medium::MediumOverrides`] |
//! | P03T sec. A.2.2, forced interactions | [`forced::sample`], [`segment::force`] |
//! | P03T sec. 5.3, the local gather | [`gather::sample`] |
//! | BMA02 eq. 5 and 6, the fog blend | `render::fog` |
//! | BMA02 eq. 7, extinction as a sum | `volume::sum` |

mod cache;
mod camera_path;
mod connect;
pub mod coverage;
mod equiangular;
mod estimator;
mod event;
mod forced;
mod gather;
mod interaction;
pub mod lengths;
mod light_path;
mod manifold;
mod mis;
pub mod needs;
pub mod observer;
mod profile;
pub mod profiles;
pub mod roulette;
mod segment;
pub mod strategy;
#[cfg(test)]
mod tests;
mod thinning;
mod vertex;
mod walk;

pub use cache::LightCache;
pub use equiangular::applies as equiangular_applies;
pub use estimator::Estimator;
pub use event::{Arrival, Event, Leg};
pub use interaction::{Interaction, Scattering};
pub use mis::MisSums;
pub use observer::Contribution;
pub use profile::Profile;
pub use segment::{NullCrossing, Segment};
pub(crate) use segment::{sample_free_flight, transmittance};
pub use vertex::Vertex;

pub use crate::{
    settings::heuristic::Heuristic,
    settings::options::{
        Algorithm, Connections, Effort, FirstPass, Guiding, LightStarts, Options, Sky, Strategies, Survival,
    },
};

use crate::{
    guide::Learnt,
    math::{Channels, Spectrum, Vec2},
    sampling::{Stream, stream::Purpose},
    scene::Scene,
    shape::Ray,
};
use estimator::Counts;
use manifold::Manifold;
use observer::{Meeting, Observer};
use roulette::Roulette;
use thinning::Thinning;

/// Most vertices in the cache of a block, on average: it has to fit the processor's caches.
const CACHE_VERTICES: f32 = 16_384.0;
/// Number of light subpaths that measure the vertices per light subpath.
const PILOT_WALKS: u64 = 2_048;

impl<'a, P: Profile> Estimator<'a, P> {
    /// Prepares to render `scene`. There are `walks_per_pass` light subpaths for one sample of all pixels together, and
    /// `walks_per_block` of them fill one cache. Walks start and scatter as `learnt`; `seed` is for the pilot walks.
    pub fn new(
        scene: &'a Scene,
        options: Options,
        learnt: Learnt,
        seed: u64,
        walks_per_pass: u64,
        walks_per_block: u64,
    ) -> Self {
        let Options { strategies, effort, connections, heuristic, max_depth, min_depth, .. } = options;
        let Options { hide_emitters, forced_interaction, .. } = options;
        let lit = !scene.lights.is_empty();
        let count = |on: bool, n: f32| if on && lit { n } else { 0.0 };
        let max_edges = max_depth.unwrap_or(u32::MAX).min(P::MisSums::MOST_EDGES);
        let skipped = min_depth.saturating_sub(1).min(max_edges);
        let equiangular = strategies.equiangular && skipped < 2;
        let mut estimator = Self {
            scene,
            counts: Counts {
                emitter_hit: count(strategies.emitter_hit, 1.0),
                next_event: count(strategies.next_event, 1.0),
                connection: 0.0,
                lens: count(strategies.lens, walks_per_pass as f32),
                equiangular: count(P::MEDIA && equiangular && equiangular_applies(scene), 1.0),
            },
            heuristic,
            survival: effort.survival,
            roulette: Roulette::AtOnce(effort.survival),
            thinning: Thinning::of(scene),
            connections_per_vertex: 0,
            connections,
            keep: 0.0,
            max_edges,
            skipped,
            counted: max_edges - skipped,
            hide_emitters,
            forced_interaction: P::MEDIA && forced_interaction,
            starts: learnt.starts,
            manifold: if strategies.connection && lit { Manifold::of(scene) } else { None },
            sky: effort.sky,
            guide: learnt.guide.filter(|_| P::GUIDED),
            ending: learnt.ending.filter(|_| P::GUIDED),
            profile: std::marker::PhantomData,
        };
        match connections {
            _ if !(strategies.connection && lit) => {}
            Connections::Cached => estimator.plan_connections(effort.connections, seed, walks_per_block),
            // Every strategy takes one sample of each pair of subpaths, as LW96 eq. 14 has it.
            Connections::All => (estimator.keep, estimator.counts.connection) = (1.0, 1.0),
        }
        // Pilots record the survival probability at every vertex; their walks may follow a guide.
        let is_recorded = P::GUIDED && !options.algorithm.ends_in_first_pass();
        if lit && !is_recorded && !estimator.needs_light_walks() {
            estimator.roulette = Roulette::alone(&mut estimator);
        }
        estimator
    }

    /// Measures the vertices per light subpath: n of a connection is draws over vertices per walk, however many
    /// vertices are kept. The weights need a constant that does not depend on the walks they weight, so it is measured
    /// beforehand.
    fn plan_connections(&mut self, per_vertex: u32, seed: u64, walks_per_block: u64) {
        self.keep = 1.0;
        let mut vertices = 0;
        // Compiled for instruments in any case; pilot walks are few.
        let mut observer: &mut dyn Observer = &mut Nowhere;
        for walk in 0..PILOT_WALKS {
            // One by one: without absorption, walks are as long as the depth allows, and all of them fill the memory.
            let mut cache = LightCache::new(P::Channels::COUNT);
            let mut stream = Stream::new(seed, walk, 0, Purpose::Pilot);
            let hero = walk as usize % P::Channels::COUNT;
            light_path::trace(self, &mut cache, &mut observer, hero, &mut stream);
            vertices += cache.len();
        }
        let per_walk = (vertices as f32 / PILOT_WALKS as f32).max(1.0 / PILOT_WALKS as f32);
        self.keep = (CACHE_VERTICES / (per_walk * walks_per_block as f32)).min(1.0);
        self.connections_per_vertex = per_vertex;
        self.counts.connection = per_vertex as f32 / per_walk;
    }

    /// Traces one light subpath of channel `hero` into `cache`; what it contributes goes to `observer`.
    pub fn trace_light(
        &self,
        cache: &mut LightCache<P::MisSums>,
        observer: &mut impl Observer,
        hero: usize,
        stream: &mut Stream,
    ) {
        light_path::trace(self, cache, observer, hero, stream);
    }

    /// Transmittance along a primary ray (its `t_max` is its length); 0 where a surface blocks it.
    pub fn transmittance(&self, primary: Ray, stream: &mut Stream) -> Spectrum {
        let medium = self.scene.sensor_medium(&primary);
        let passed = transmittance::<P>(self.scene, primary, 0.0, medium, self.hide_emitters, stream);
        passed.map_or(Spectrum::ZERO, |passed| passed.transmittance)
    }

    /// The first interaction of a primary ray, sampled by channel 0: a collision, or a surface that it does not pass;
    /// none where it leaves the scene.
    #[cold]
    pub fn first_interaction(&self, primary: Ray, stream: &mut Stream) -> Option<Interaction> {
        let medium = self.scene.sensor_medium(&primary);
        let ahead = Segment::along(self.scene, primary, medium, self.hide_emitters);
        sample_free_flight::<P>(ahead, 0, stream, &mut |_, _| ()).interaction
    }

    /// One camera subpath of channel `hero` through `film` (pixels) and a point of the aperture; what it
    /// contributes goes to `observer`. `walk` as in [`Self::partners`].
    pub fn sample_pixel<R: Observer>(
        &self,
        cache: &LightCache<P::MisSums>,
        [film, aperture]: [Vec2; 2],
        (hero, walk): (usize, usize),
        observer: R,
        stream: &mut Stream,
    ) -> R {
        if P::GUIDED
            && let Some(ending) = &self.ending
        {
            return gather::sample(self, ending, [film, aperture], hero, observer, stream);
        }
        let light = self.partners(cache, hero, walk);
        if P::MEDIA && self.forced_interaction {
            return forced::sample(self, light, film, aperture, hero, observer, stream);
        }
        camera_path::sample(self, light, film, aperture, hero, observer, stream)
    }
}

/// A film that nothing reaches, for pilot walks.
struct Nowhere;

impl Observer for Nowhere {
    fn covers(&self, _: Vec2) -> bool {
        false
    }
    fn contribute(&mut self, _: u32, _: u32, _: Meeting<'_>, _: Option<&Contribution>) {}
}
