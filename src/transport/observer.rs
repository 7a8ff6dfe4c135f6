//! Observers see the walks of the estimator and what they contribute. An image is rendered with one, and instruments
//! inspect the walks with one. The estimator is compiled for its observer: what an observer does not look at costs
//! nothing. No observer knows how paths are weighted, so that it need not be compiled for every profile.

use super::{
    event::{Arrival, Event, Leg},
    strategy::StrategyKind,
};
use crate::{
    math::{Spectrum, Vec2, Vec3},
    scene::lights::{EmissionSample, EmitterSample},
};
use std::ops::{Div, Mul};

/// What the last vertex of one walk was connected to.
#[derive(Clone, Copy, Debug)]
pub enum Meeting<'a> {
    /// s = 0: the camera subpath hit this point of an emitter.
    Met(Arrival, &'a EmitterSample),
    /// s = 1: a point of an emitter, picked for the last vertex.
    Emitter(&'a EmitterSample),
    /// s >= 2: a point of an emitter, connected by way of smooth surfaces.
    Bent {
        /// Unit direction from the last vertex to the first smooth surface.
        towards: Vec3,
        /// The point on the last smooth surface, where the light arrives.
        last: Vec3,
        /// The point of the emitter.
        sample: &'a EmitterSample,
    },
    /// s >= 2: a vertex of a light subpath, and its place in the pool of the hero channel.
    Light(usize, Event<'a>),
    /// t = 1: the lens, through this film position (pixels).
    Lens(Vec2),
    /// Equiangular sampling: a vertex on the primary ray that does not belong to the walk, and a point of an emitter.
    Pivot(Leg, Event<'a>, &'a EmitterSample),
}

impl Meeting<'_> {
    /// The kind of the strategy of `s` light and `t` camera vertices with this meeting.
    #[inline]
    pub fn kind(&self, s: u32, t: u32) -> StrategyKind {
        match self {
            Self::Pivot(..) => StrategyKind::Equiangular,
            _ => StrategyKind::of(s, t),
        }
    }
}

/// The contribution of a strategy to one path.
#[derive(Clone, Copy, Debug)]
pub struct Contribution {
    /// The weighted contribution of one sample; the caller may take several.
    pub value: Spectrum,
    /// The weight in it, times the number of channels.
    pub weight: f32,
    /// What the strategy would contribute if it ran alone: [`Self::share`] of it is `value`.
    pub alone: Spectrum,
    /// The weight that it would have then.
    pub weight_alone: f32,
    /// Transmittance of the connecting segment; 1 where there is none.
    pub transmittance: Spectrum,
    /// The same without random estimates, as the weights use it.
    pub expected: Spectrum,
    /// See [`super::MisSums::shares`].
    pub shares: [f32; StrategyKind::ALL.len()],
}

impl Contribution {
    /// The weight among all strategies, in [0, 1]: over those that run the weights of one path sum to 1.
    #[inline]
    pub fn share(&self) -> f32 {
        self.weight / self.weight_alone
    }
}

impl Mul<f32> for Contribution {
    type Output = Self;
    #[inline]
    fn mul(self, factor: f32) -> Self {
        Self { value: self.value * factor, alone: self.alone * factor, ..self }
    }
}

impl Div<f32> for Contribution {
    type Output = Self;
    #[inline]
    fn div(self, divisor: f32) -> Self {
        Self { value: self.value / divisor, alone: self.alone / divisor, ..self }
    }
}

/// Sees the walks of one pixel sample, or light subpaths, and all their contributions.
pub trait Observer {
    /// The strategy of `s` light and `t` camera vertices, the lens among these, contributes a path; none
    /// where it is blocked or nothing scatters along it. The sum of all values is the estimate.
    fn contribute(&mut self, s: u32, t: u32, meeting: Meeting<'_>, contribution: Option<&Contribution>);

    /// True if a contribution at `film` (pixels) can count.
    #[inline]
    fn covers(&self, _film: Vec2) -> bool {
        true
    }

    /// The preview `gather` adds learnt radiance.
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

    /// A camera subpath left the scene, opposite to `incoming` of this arrival at infinity.
    #[inline]
    fn escape(&mut self, _arrival: &Arrival) {}

    /// The last vertex of the current light subpath was put into the cache at `place`, over any vertex there.
    #[inline]
    fn keep(&mut self, _place: usize) {}
}

/// Puts a `value` where the cache has a vertex.
pub fn put<T>(all: &mut Vec<T>, place: usize, value: T) {
    match all.get_mut(place) {
        Some(old) => *old = value,
        None => all.push(value),
    }
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
    fn keep(&mut self, place: usize) {
        (**self).keep(place);
    }
}
