//! The kinds of strategies, and sets of them.

use crate::{
    scene::{Scene, lights::Lights},
    settings::options::{Sky, Strategies},
};

/// The kinds of strategies, as [`Strategies`] switches them on and off.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum StrategyKind {
    /// s = 0: camera subpaths hit emitters.
    EmitterHit,
    /// s = 1, t >= 2: next-event estimation.
    NextEvent,
    /// s >= 2, t >= 2: connections of camera and light subpaths.
    Connection,
    /// t = 1: light subpaths connect to the lens.
    Lens,
    /// s = 1, t = 2 in media: a distance along the primary ray by equiangular sampling, then next-event estimation.
    Equiangular,
}

impl StrategyKind {
    /// Every kind.
    pub const ALL: [Self; 5] =
        [Self::EmitterHit, Self::NextEvent, Self::Connection, Self::Lens, Self::Equiangular];

    /// `f` of each. [`array::map`](array::map) is not inlined into its caller.
    #[inline(always)]
    pub fn each<T>(mut f: impl FnMut(Self) -> T) -> [T; Self::ALL.len()] {
        let [hit, next_event, connection, lens, equiangular] = Self::ALL;
        [f(hit), f(next_event), f(connection), f(lens), f(equiangular)]
    }

    /// The kind of the strategy of `s` light and `t` camera vertices, the lens among these, that connects the walks.
    #[inline]
    pub fn of(s: u32, t: u32) -> Self {
        match (s, t) {
            (0, _) => Self::EmitterHit,
            (_, 1) => Self::Lens,
            (1, _) => Self::NextEvent,
            _ => Self::Connection,
        }
    }

    /// Name in scene files and on the command line.
    pub const NAMES: [(&'static str, Self); 5] = [
        ("hit", Self::EmitterHit),
        ("next-event", Self::NextEvent),
        ("join", Self::Connection),
        ("lens", Self::Lens),
        ("equiangular", Self::Equiangular),
    ];

    /// Name in scene files and on the command line.
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize].0
    }
}

impl Strategies {
    /// True if strategies of `kind` run.
    pub fn has(self, kind: StrategyKind) -> bool {
        match kind {
            StrategyKind::EmitterHit => self.emitter_hit,
            StrategyKind::NextEvent => self.next_event,
            StrategyKind::Connection => self.connection,
            StrategyKind::Lens => self.lens,
            StrategyKind::Equiangular => self.equiangular,
        }
    }

    /// Names of the strategies that run, as in scene files and on the command line.
    pub fn names(self) -> Vec<&'static str> {
        StrategyKind::ALL.into_iter().filter(|kind| self.has(*kind)).map(StrategyKind::name).collect()
    }

    /// True if the strategy of `s` light and `t` camera vertices runs. Emitters in view are left to camera subpaths
    /// that hit them: connections of light subpaths' starts to the lens are far noisier.
    pub fn runs(self, s: u32, t: u32) -> bool {
        self.has(StrategyKind::of(s, t)) && !((s, t) == (1, 1) && self.emitter_hit)
    }

    /// True if any strategy that runs needs light subpaths.
    pub fn need_light_walks(self) -> bool {
        self.connection || self.lens
    }

    /// True if learnt starts change something: light subpaths, or next-event estimation of the environment, which is found
    /// by `sky`.
    pub fn use_starts(self, scene: &Scene, sky: Sky) -> bool {
        let Lights { environment, .. } = &scene.lights;
        let joins_sky = self.next_event && environment.is_some() && scene.lights.connects_to_sky(sky);
        self.need_light_walks() || joins_sky
    }

    /// The same without strategies of `kind`.
    pub fn without(mut self, kind: StrategyKind) -> Self {
        match kind {
            StrategyKind::EmitterHit => self.emitter_hit = false,
            StrategyKind::NextEvent => self.next_event = false,
            StrategyKind::Connection => self.connection = false,
            StrategyKind::Lens => self.lens = false,
            StrategyKind::Equiangular => self.equiangular = false,
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_strategy_is_of_one_kind() {
        let kinds = |length: u32| -> Vec<&str> {
            (0..=length).map(|s| StrategyKind::of(s, length + 1 - s).name()).collect()
        };
        assert_eq!(kinds(1), ["hit", "lens"]);
        assert_eq!(kinds(2), ["hit", "next-event", "lens"]);
        assert_eq!(kinds(4), ["hit", "next-event", "join", "join", "lens"]);
    }
}
