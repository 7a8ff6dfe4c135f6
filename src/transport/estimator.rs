//! An estimator: its scene, its strategies, and the learnt data that it uses.

use super::{
    cache::{LightCache, Partners},
    manifold::Manifold,
    mis::Strategy,
    profile::Profile,
    roulette::Roulette,
    strategy::StrategyKind,
    thinning::Thinning,
};
use crate::{
    guide::{Guide, solution::Ending},
    math::Vec3,
    scene::{
        Scene,
        lights::{Aim, Densities, EmitterSample, Start, Starts},
    },
    settings::{
        heuristic::Heuristic,
        options::{Connections, Sky, Survival},
    },
};
use std::sync::Arc;

/// Expected samples of each kind of strategy per pixel sample: n in the balance heuristic.
#[derive(Clone, Copy, Debug)]
pub(super) struct Counts {
    pub(super) emitter_hit: f32,
    pub(super) next_event: f32,
    pub(super) connection: f32,
    pub(super) lens: f32,
    pub(super) equiangular: f32,
}

/// The estimator for one scene, compiled for profile `P`.
pub struct Estimator<'a, P: Profile> {
    pub(super) scene: &'a Scene,
    pub(super) counts: Counts,
    pub(super) heuristic: Heuristic,
    /// When walks end, as requested,
    pub(super) survival: Survival,
    /// and as actually done.
    pub(super) roulette: Roulette,
    /// Russian roulette of walks that are long or far away.
    pub(super) thinning: Thinning,
    pub(super) connections_per_vertex: u32,
    pub(super) connections: Connections,
    /// Probability that a light vertex is kept for connections.
    pub(super) keep: f32,
    /// Most segments of a path.
    pub(super) max_edges: u32,
    /// Paths of this many segments or fewer do not count.
    pub(super) skipped: u32,
    /// Number of path lengths that count.
    pub(super) counted: u32,
    pub(super) hide_emitters: bool,
    pub(super) forced_interaction: bool,
    /// Learnt starts of light subpaths; none if each starts by its emitter's own density.
    pub(super) starts: Option<Arc<Starts>>,
    /// Connections by way of smooth surfaces; none where the scene has no use for them.
    pub(super) manifold: Option<Manifold>,
    /// How the environment is found.
    pub(super) sky: Sky,
    /// The guide that walks follow.
    pub(super) guide: Option<Arc<Guide>>,
    /// The radiance that camera subpaths end in (previews).
    pub(super) ending: Option<Arc<Ending>>,
    pub(super) profile: std::marker::PhantomData<P>,
}

impl<P: Profile> Estimator<'_, P> {
    /// True if a path counts whose subpaths have this many segments together, the connecting segment apart.
    #[inline]
    pub(super) fn joins(&self, edges: u32) -> bool {
        edges.wrapping_sub(self.skipped) < self.counted
    }

    /// The strategies of `kind`, as the weights use them.
    #[inline]
    pub(super) fn strategy(&self, kind: StrategyKind) -> Strategy {
        let count = match kind {
            StrategyKind::EmitterHit => self.counts.emitter_hit,
            StrategyKind::NextEvent => self.counts.next_event,
            StrategyKind::Connection => self.counts.connection,
            StrategyKind::Lens => self.counts.lens,
            StrategyKind::Equiangular => self.counts.equiangular,
        };
        Strategy { kind, count, heuristic: self.heuristic }
    }

    /// How next-event estimation aims at emitters.
    #[inline]
    pub(super) fn aim(&self) -> Aim<'_> {
        Aim { sky: self.sky, starts: self.starts.as_deref() }
    }

    /// Density with which a light subpath starts at `sample` towards `other`, in unit `direction`.
    #[inline]
    pub(super) fn pdf_start(&self, sample: &EmitterSample, other: Vec3, direction: Vec3) -> f32 {
        let unlearnt = Densities { point: sample.pdf_start, direction: sample.pdf_direction };
        self.learnt(|| Start::towards(sample.light, &sample.point, other, direction), unlearnt).both()
    }

    /// Densities of a start; `unlearnt` where no starts were learnt.
    #[inline]
    pub(super) fn learnt(&self, start: impl FnOnce() -> Start, unlearnt: Densities) -> Densities {
        match &self.starts {
            Some(starts) if self.needs_light_walks() => {
                starts.densities(&self.scene.lights, &start(), unlearnt)
            }
            _ => unlearnt,
        }
    }

    /// When walks end.
    pub fn survival(&self) -> Survival {
        self.survival
    }

    /// The learnt starts of light subpaths.
    pub fn starts(&self) -> Option<&Starts> {
        self.starts.as_deref()
    }

    /// True if a strategy needs light subpaths.
    pub fn needs_light_walks(&self) -> bool {
        self.counts.connection > 0.0 || self.counts.lens > 0.0
    }

    /// True if the first vertex of a light subpath is connected to the lens, see [`Strategies::runs`](super::Strategies::runs).
    pub(super) fn starts_seen(&self) -> bool {
        self.counts.lens > 0.0 && self.counts.emitter_hit <= 0.0 && self.skipped == 0
    }

    /// The light vertices that a camera subpath of channel `hero` connects to: with [`Connections::All`] those of light
    /// subpath number `walk` of the cache.
    #[inline]
    pub(super) fn partners<'c>(
        &self,
        cache: &'c LightCache<P::MisSums>,
        hero: usize,
        walk: usize,
    ) -> Partners<'c, P::MisSums> {
        match self.connections {
            Connections::Cached => cache.drawn(hero, self.connections_per_vertex),
            Connections::All if self.counts.connection > 0.0 => cache.all_of(walk),
            Connections::All => Partners::NONE,
        }
    }
}
