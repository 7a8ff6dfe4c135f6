//! Observers see the walks of the estimator and what they contribute. An image is rendered with one, and instruments
//! inspect the walks with one. The estimator is compiled for its observer: what an observer does not look at costs
//! nothing. No observer knows how paths are weighted, so that it need not be compiled for every profile.

use super::{
    Strategies,
    connect::Contribution,
    event::{Arrival, Event, Leg},
};
use crate::{
    math::{Spectrum, Vec2},
    scene::lights::{EmissionSample, EmitterSample},
};

/// The kinds of strategies, as [`super::Strategies`] switches them on and off.
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

    /// `f` of each. [`array::map`](array::map) is not compiled into what calls it.
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
    /// True if those of `kind` run.
    pub fn has(self, kind: StrategyKind) -> bool {
        match kind {
            StrategyKind::EmitterHit => self.emitter_hit,
            StrategyKind::NextEvent => self.next_event,
            StrategyKind::Connection => self.connection,
            StrategyKind::Lens => self.lens,
            StrategyKind::Equiangular => self.equiangular,
        }
    }

    /// Names of those that run, as in scene files and on the command line.
    pub fn names(self) -> Vec<&'static str> {
        StrategyKind::ALL.into_iter().filter(|kind| self.has(*kind)).map(StrategyKind::name).collect()
    }

    /// True if the strategy of `s` light and `t` camera vertices runs. Emitters in view are left to camera subpaths that hit
    /// them, with far less noise than light subpaths' starts that are connected to the lens.
    pub fn runs(self, s: u32, t: u32) -> bool {
        self.has(StrategyKind::of(s, t)) && !((s, t) == (1, 1) && self.emitter_hit)
    }

    /// True if any of those that run needs light subpaths.
    pub fn need_light_walks(self) -> bool {
        self.connection || self.lens
    }

    /// The same without those of `kind`.
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

/// What the last vertex of one walk was connected to.
#[derive(Clone, Copy, Debug)]
pub enum Meeting<'a> {
    /// s = 0: the camera subpath hit this point of an emitter.
    Met(Arrival, &'a EmitterSample),
    /// s = 1: a point of an emitter, picked for the last vertex.
    Emitter(&'a EmitterSample),
    /// s >= 2: a vertex of a light subpath, and its place in the pool of the hero channel.
    Light(usize, Event<'a>),
    /// t = 1: the lens, through this film position (pixels).
    Lens(Vec2),
    /// Equiangular sampling: a vertex on the primary ray, which is none of the walk, and a point of an emitter.
    Pivot(Leg, Event<'a>, &'a EmitterSample),
}

impl Meeting<'_> {
    /// The kind of the strategy of `s` light and `t` camera vertices that met so.
    #[inline]
    pub fn kind(&self, s: u32, t: u32) -> StrategyKind {
        match self {
            Self::Pivot(..) => StrategyKind::Equiangular,
            _ => StrategyKind::of(s, t),
        }
    }
}

/// Sees the walks of one pixel sample, or those of light, and all that they contribute.
pub trait Observer {
    /// The strategy of `s` light and `t` camera vertices, the lens among these, contributes a path; none
    /// where it is blocked or nothing scatters along it. The sum of all values is the estimate.
    fn contribute(&mut self, s: u32, t: u32, meeting: Meeting<'_>, contribution: Option<&Contribution>);

    /// True if a contribution at `film` (pixels) can count.
    #[inline]
    fn covers(&self, _film: Vec2) -> bool {
        true
    }

    /// The preview `gather` adds what was learnt.
    #[inline]
    fn gather(&mut self, _value: Spectrum) {}

    /// A strategy is tried from here...
    #[inline]
    fn start(&mut self) {}

    /// ... to here, whatever it contributed: the strategy of `s` light and `t` camera vertices, of this kind.
    #[inline]
    fn stop(&mut self, _kind: StrategyKind, _s: u32, _t: u32) {}

    /// A light subpath of channel `hero` begins at an emitter.
    #[inline]
    fn emit(&mut self, _start: &EmissionSample, _hero: usize) {}

    /// A walk leaves its start or a vertex.
    #[inline]
    fn depart(&mut self, _leg: &Leg) {}

    /// A walk reached a vertex that may scatter on.
    #[inline]
    fn arrive(&mut self, _event: Event<'_>) {}

    /// A camera subpath left the scene: the `incoming` of its arrival at infinity, reversed, is the direction it left in.
    #[inline]
    fn escape(&mut self, _arrival: &Arrival) {}

    /// The last vertex of the light subpath at hand was added to the cache.
    #[inline]
    fn keep(&mut self) {}
}

/// The observer of ordinary camera subpaths: it adds up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sum {
    /// Radiance estimate.
    pub radiance: Spectrum,
}

impl Observer for Sum {
    #[inline]
    fn contribute(&mut self, _: u32, _: u32, _: Meeting<'_>, contribution: Option<&Contribution>) {
        self.radiance += contribution.map_or(Spectrum::ZERO, |contribution| contribution.value);
    }

    #[inline]
    fn gather(&mut self, value: Spectrum) {
        self.radiance += value;
    }
}

/// Instruments need not be fast: their observers are chosen at run time, and share one compiled estimator.
impl Observer for &mut (dyn Observer + '_) {
    fn contribute(&mut self, s: u32, t: u32, meeting: Meeting<'_>, contribution: Option<&Contribution>) {
        (**self).contribute(s, t, meeting, contribution);
    }
    fn covers(&self, film: Vec2) -> bool {
        (**self).covers(film)
    }
    fn gather(&mut self, value: Spectrum) {
        (**self).gather(value);
    }
    fn start(&mut self) {
        (**self).start();
    }
    fn stop(&mut self, kind: StrategyKind, s: u32, t: u32) {
        (**self).stop(kind, s, t);
    }
    fn emit(&mut self, start: &EmissionSample, hero: usize) {
        (**self).emit(start, hero);
    }
    fn depart(&mut self, leg: &Leg) {
        (**self).depart(leg);
    }
    fn arrive(&mut self, event: Event<'_>) {
        (**self).arrive(event);
    }
    fn escape(&mut self, arrival: &Arrival) {
        (**self).escape(arrival);
    }
    fn keep(&mut self) {
        (**self).keep();
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
