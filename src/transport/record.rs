//! Recorders: what is done with the contributions of the estimator. All of them pass through one, which an image is
//! made with, and instruments look at the walks with. The estimator is compiled for its recorder: what a recorder
//! does not want to know costs nothing.

use super::{
    Strategies,
    connect::Joined,
    vertex::{Subpath, Vertex},
    walk::Departure,
    weight::Sums,
};
use crate::{
    math::{Spectrum, Vec2},
    scene::lights::{EmissionSample, EmitterSample},
};

/// The kinds of strategies, as [`super::Strategies`] switches them on and off.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum StrategyKind {
    /// s = 0: eye walks meet emitters.
    Hit,
    /// s = 1, t >= 2: next-event estimation.
    NextEvent,
    /// s >= 2, t >= 2: joins of eye and light walks.
    Join,
    /// t = 1: light walks join the lens.
    Lens,
}

impl StrategyKind {
    /// Every kind.
    pub const ALL: [Self; 4] = [Self::Hit, Self::NextEvent, Self::Join, Self::Lens];

    /// The kind of the strategy of `s` light and `t` eye vertices, the lens among these.
    #[inline]
    pub fn of(s: u32, t: u32) -> Self {
        match (s, t) {
            (0, _) => Self::Hit,
            (_, 1) => Self::Lens,
            (1, _) => Self::NextEvent,
            _ => Self::Join,
        }
    }

    /// As printed and as typed.
    pub const NAMES: [(&'static str, Self); 4] =
        [("hit", Self::Hit), ("next-event", Self::NextEvent), ("join", Self::Join), ("lens", Self::Lens)];

    /// As printed and as typed.
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize].0
    }
}

impl Strategies {
    /// True if those of `kind` run.
    pub fn has(self, kind: StrategyKind) -> bool {
        match kind {
            StrategyKind::Hit => self.hit,
            StrategyKind::NextEvent => self.next_event,
            StrategyKind::Join => self.join,
            StrategyKind::Lens => self.lens,
        }
    }

    /// The same without those of `kind`.
    pub fn without(mut self, kind: StrategyKind) -> Self {
        match kind {
            StrategyKind::Hit => self.hit = false,
            StrategyKind::NextEvent => self.next_event = false,
            StrategyKind::Join => self.join = false,
            StrategyKind::Lens => self.lens = false,
        }
        self
    }
}

/// What the last vertex of one walk was joined with.
#[derive(Clone, Copy, Debug)]
pub enum Meeting<'a, S: Sums> {
    /// s = 0: the eye walk came to this point of an emitter.
    Met(&'a Subpath<S>, &'a EmitterSample),
    /// s = 1: a point of an emitter, picked for the last vertex.
    Emitter(&'a EmitterSample),
    /// s >= 2: a vertex of a light walk, and its place in the pool of the hero channel.
    Light(usize, &'a Vertex<S>),
    /// t = 1: the lens, through this film position [pixels].
    Lens(Vec2),
}

/// Sees the walks of one pixel sample, or those of light, and whatever they bring.
pub trait Recorder<S: Sums> {
    /// The strategy of `s` light and `t` eye vertices, the lens among these, brings a path; none where the way is
    /// blocked or nothing scatters along it. The sum over all of the values is the estimate.
    fn contribute(&mut self, s: u32, t: u32, meeting: Meeting<'_, S>, joined: Option<&Joined>);

    /// True if a contribution at `film` [pixels] can count.
    #[inline]
    fn covers(&self, _film: Vec2) -> bool {
        true
    }

    /// A strategy is tried from here...
    #[inline]
    fn start(&mut self) {}

    /// ... to here, whatever it brought: the strategy of `s` light and `t` eye vertices.
    #[inline]
    fn stop(&mut self, _s: u32, _t: u32) {}

    /// A light walk begins at an emitter.
    #[inline]
    fn emit(&mut self, _start: &EmissionSample) {}

    /// A walk leaves its start or a vertex.
    #[inline]
    fn depart(&mut self, _departure: &Departure<S>) {}

    /// A walk came to a vertex that may scatter on.
    #[inline]
    fn arrive(&mut self, _vertex: &Vertex<S>) {}

    /// An eye walk left the scene: the `incoming` of `subpath`, reversed, is the direction it left in.
    #[inline]
    fn escape(&mut self, _subpath: &Subpath<S>) {}

    /// The last vertex of the light walk at hand was added to the cache.
    #[inline]
    fn keep(&mut self) {}
}

/// The recorder of ordinary eye walks: it adds up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sum {
    /// Radiance estimate.
    pub radiance: Spectrum,
}

impl<S: Sums> Recorder<S> for Sum {
    #[inline]
    fn contribute(&mut self, _: u32, _: u32, _: Meeting<'_, S>, joined: Option<&Joined>) {
        self.radiance += joined.map_or(Spectrum::ZERO, |joined| joined.value);
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
