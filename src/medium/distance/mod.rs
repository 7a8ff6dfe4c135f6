//! How flights are sampled and optical depths found in a varying medium: one file a method.

mod choose;
mod closed_form;
mod null_collision;
mod ray_marching;
mod regular_tracking;
#[cfg(test)]
mod tests;

pub use choose::choose;
pub use null_collision::NullCollision;
pub use ray_marching::RayMarching;

use super::Extinction;
use crate::{
    math::{Channels, RaySegment, Spectrum},
    sampling::Stream,
    volume::{Volume, VolumeModel},
};

/// A distance sampled along a segment: a collision, or none.
#[derive(Clone, Copy, Debug)]
pub struct DistanceSample<L> {
    /// Distance of the collision (m); none where the flight passed the segment.
    pub collision: Option<f32>,
    /// Which of several media that overlap has collided; 0 where there is one.
    pub component: usize,
    /// Deterministic optical depth up to there: what the weights use (the stand-in where transmittance is random).
    pub depth: L,
    /// Transmittance of every channel over the hero's, times the hero's sigma_t over the one that sampled the
    /// collision, exactly or in the mean. This times sigma_t at the collision over the hero's is the factor of the
    /// throughput.
    pub ratio: L,
    /// How much of the hero's remaining optical depth is used up.
    pub spent: f32,
}

/// What a medium leaves of light that crosses a segment.
#[derive(Clone, Copy, Debug)]
pub struct Attenuation<L> {
    /// Deterministic optical depth per channel, the same from either end: what the weights use.
    pub depth: L,
    /// The fraction of radiance that remains: exp(-depth), or an unbiased random estimate of the true one.
    pub transmittance: L,
}

/// A method, forced by name or chosen by cost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DistanceMethod {
    /// The cheapest of those that are unbiased.
    Auto,
    /// Closed-form optical depth, inverted by a bracketed Newton step.
    ClosedForm,
    /// Exact depth of a grid's interpolant, cell by cell.
    RegularTracking,
    /// Ray marching (LW96 sec. 5).
    RayMarching,
    /// Delta tracking for distances, ratio tracking for transmittance, by local majorants.
    RatioTracking,
    /// Delta tracking for distances, residual ratio tracking for transmittance, by local means and ranges.
    ResidualRatioTracking,
}

impl DistanceMethod {
    /// Name in scene files and on the command line.
    pub const NAMES: [(&'static str, Self); 6] = [
        ("auto", Self::Auto),
        ("closed_form", Self::ClosedForm),
        ("exact", Self::RegularTracking),
        ("march", Self::RayMarching),
        ("null_collision", Self::RatioTracking),
        ("residual_ratio", Self::ResidualRatioTracking),
    ];

    /// Name in scene files and on the command line.
    pub fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(_, choice)| *choice == self).map_or("", |(name, _)| name)
    }

    /// True if the method works for `volume`.
    pub fn applies_to(self, volume: &Volume) -> bool {
        match self {
            Self::Auto | Self::RayMarching | Self::RatioTracking | Self::ResidualRatioTracking => true,
            Self::ClosedForm => volume.has_integral() && volume.grid().is_none(),
            Self::RegularTracking => volume.grid().is_some(),
        }
    }
}

/// A method at work.
#[derive(Clone, Debug)]
pub enum DistanceSampler {
    /// See [`DistanceMethod::ClosedForm`].
    ClosedForm,
    /// See [`DistanceMethod::RegularTracking`].
    RegularTracking,
    /// See [`DistanceMethod::RayMarching`].
    RayMarching(RayMarching),
    /// See [`DistanceMethod::RatioTracking`] and [`DistanceMethod::ResidualRatioTracking`].
    NullCollision(Box<NullCollision>),
}

impl DistanceSampler {
    /// Deterministic optical depth per channel, the same from either end.
    #[inline]
    pub fn depth<L: Channels>(&self, medium: &Extinction, segment: &RaySegment) -> L {
        match self {
            Self::ClosedForm => closed_form::depth(medium, segment),
            Self::RegularTracking => regular_tracking::depth(medium, segment),
            Self::RayMarching(march) => march.depth(medium, segment),
            Self::NullCollision(tracking) => tracking.stand_in(medium, segment),
        }
    }

    /// Attenuation along `segment`; none where transmittance is certain to be 0, or a random estimate of it is.
    #[inline]
    pub fn attenuation<L: Channels>(
        &self,
        medium: &Extinction,
        segment: &RaySegment,
        stream: &mut Stream,
    ) -> Option<Attenuation<L>> {
        if let Self::NullCollision(tracking) = self {
            return tracking.attenuation(medium, segment, stream);
        }
        let depth: L = self.depth(medium, segment);
        Some(Attenuation { depth, transmittance: depth.exp_neg() })
    }

    /// Transmittance of every channel over the hero's along `segment`, whose [`Self::depth`] is `depth`, or an
    /// unbiased random estimate of that.
    #[inline]
    pub fn ratio<L: Channels>(
        &self,
        medium: &Extinction,
        segment: &RaySegment,
        depth: L,
        hero: usize,
        stream: &mut Stream,
    ) -> L {
        match self {
            Self::NullCollision(tracking) => tracking.transmittance_ratio(medium, segment, hero, stream),
            _ => depth.flight_ratio(L::splat(1.0), hero),
        }
    }

    /// Flies along `segment` until the `hero` channel's optical depth is `remaining` (an exponential variate; random
    /// methods draw their own).
    #[inline]
    pub fn sample_distance<L: Channels>(
        &self,
        medium: &Extinction,
        segment: &RaySegment,
        hero: usize,
        remaining: f32,
        stream: &mut Stream,
    ) -> DistanceSample<L> {
        match self {
            Self::ClosedForm => closed_form::sample_distance(medium, segment, hero, remaining),
            Self::RegularTracking => regular_tracking::sample_distance(medium, segment, hero, remaining),
            Self::RayMarching(march) => march.sample_distance(medium, segment, hero, remaining),
            Self::NullCollision(tracking) => tracking.sample_distance(medium, segment, hero, stream),
        }
    }

    /// The optical depth along `segment` by which forced collisions are drawn: that of the `hero` channel in `depth`
    /// (from [`Self::depth`]), or the stand-in where it is not known.
    pub fn forced_depth<L: Channels>(
        &self,
        medium: &Extinction,
        segment: &RaySegment,
        depth: L,
        hero: usize,
    ) -> f32 {
        match self {
            Self::NullCollision(tracking) => tracking.forced_depth::<L>(medium, segment, hero),
            _ => depth.hero(hero),
        }
    }

    /// A collision of the `hero` channel in `segment` where its [`Self::forced_depth`] is `remaining`; none where there
    /// is nothing to collide with. The ratio of the sample is the contribution over a density of exp(-`remaining`)
    /// times the hero's sigma_t.
    pub fn force<L: Channels>(
        &self,
        medium: &Extinction,
        segment: &RaySegment,
        hero: usize,
        remaining: f32,
        stream: &mut Stream,
    ) -> Option<DistanceSample<L>> {
        match self {
            Self::NullCollision(tracking) => tracking.force(medium, segment, hero, remaining, stream),
            _ => Some(self.sample_distance(medium, segment, hero, remaining, stream)),
        }
        .filter(|sample| sample.collision.is_some())
    }

    /// Which method it is.
    pub fn choice(&self) -> DistanceMethod {
        match self {
            Self::ClosedForm => DistanceMethod::ClosedForm,
            Self::RegularTracking => DistanceMethod::RegularTracking,
            Self::RayMarching(_) => DistanceMethod::RayMarching,
            Self::NullCollision(tracking) => tracking.method(),
        }
    }
}

impl<L: Channels> DistanceSample<L> {
    /// A sample of a method that computes depths exactly.
    #[inline]
    pub(super) fn exact(collision: Option<f32>, depth: L, hero: usize) -> Self {
        let ratio = depth.flight_ratio(L::splat(1.0), hero);
        Self { collision, component: 0, depth, ratio, spent: depth.hero(hero) }
    }

    /// A segment in which there is nothing.
    #[inline]
    fn empty() -> Self {
        Self { collision: None, component: 0, depth: L::splat(0.0), ratio: L::splat(1.0), spent: 0.0 }
    }
}

/// Optical depth along `segment`, for display and not for measurement: never random.
pub fn quick_depth<L: Channels>(tracker: &DistanceSampler, medium: &Extinction, segment: &RaySegment) -> L {
    match tracker {
        DistanceSampler::NullCollision(_) if medium.volume.has_integral() => {
            closed_form::depth(medium, segment)
        }
        tracker => tracker.depth(medium, segment),
    }
}

/// sigma_t of every channel over the hero's, where a collision of the hero happened: its own is not 0.
#[inline]
pub fn collision_ratio<L: Channels>(sigma_t: Spectrum, hero: usize) -> L {
    L::splat(0.0).flight_ratio(L::from_spectrum(sigma_t), hero)
}
