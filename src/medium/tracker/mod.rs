//! How flights are sampled and optical depths found in a varying medium: one file a method (transport.md, Media).

mod closed_form;
mod exact;
mod march;
mod null_collision;
mod pilot;
#[cfg(test)]
mod tests;

pub use march::March;
pub use pilot::choose;

use super::Extinction;
use crate::{
    density::{Coarse, Volume, VolumeModel},
    math::{Lanes, Section, Spectrum},
    sampling::Stream,
};

/// A distance sampled along a section: where it ended in a collision, or that it passed.
#[derive(Clone, Copy, Debug)]
pub struct DistanceSample<L> {
    /// Where it collided [m]; none where it passed the section.
    pub collision: Option<f32>,
    /// Deterministic optical depth up to there: what the weights know (the stand-in where transmittance is random).
    pub depth: L,
    /// Transmittance of every lane over the hero's, and the hero's sigma_t over that by which the collision was
    /// sampled, were it only in the mean: with sigma_t at the collision over the hero's, the factor of the throughput.
    pub ratio: L,
    /// What of the hero's optical depth that was to go is used up.
    pub spent: f32,
}

/// A method, forced by name or chosen by cost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Choice {
    /// The cheapest of those that are unbiased.
    Auto,
    /// Closed-form optical depth, inverted by a bracketed Newton step.
    ClosedForm,
    /// Exact depth of a grid's interpolant, cell by cell.
    Exact,
    /// Ray marching (LW96 sec. 5).
    March,
    /// Delta tracking for distances, ratio tracking for transmittance, by local majorants.
    NullCollision,
}

impl Choice {
    /// As printed and as typed.
    pub const NAMES: [(&'static str, Self); 5] = [
        ("auto", Self::Auto),
        ("closed_form", Self::ClosedForm),
        ("exact", Self::Exact),
        ("march", Self::March),
        ("null_collision", Self::NullCollision),
    ];

    /// As printed and as typed.
    pub fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(_, choice)| *choice == self).map_or("", |(name, _)| name)
    }

    /// True if the method works for `volume`.
    pub fn applies_to(self, volume: &Volume) -> bool {
        match self {
            Self::Auto | Self::March | Self::NullCollision => true,
            Self::ClosedForm => volume.has_integral() && volume.grid().is_none(),
            Self::Exact => volume.grid().is_some(),
        }
    }
}

/// A method at work.
#[derive(Clone, Debug)]
pub enum Tracker {
    /// See [`Choice::ClosedForm`].
    ClosedForm,
    /// See [`Choice::Exact`].
    Exact,
    /// See [`Choice::March`].
    March(March),
    /// See [`Choice::NullCollision`].
    NullCollision(Box<Coarse>),
}

impl Tracker {
    /// Deterministic optical depth per lane, the same from either end.
    #[inline]
    pub fn depth<L: Lanes>(&self, medium: &Extinction, section: &Section) -> L {
        match self {
            Self::ClosedForm => closed_form::depth(medium, section),
            Self::Exact => exact::depth(medium, section),
            Self::March(march) => march.depth(medium, section),
            Self::NullCollision(coarse) => null_collision::stand_in(medium, coarse, section),
        }
    }

    /// What of radiance remains along `section`, whose [`Self::depth`] is `depth`: exp(-depth), or an unbiased random
    /// estimate of what it really is.
    #[inline]
    pub fn transmittance<L: Lanes>(
        &self,
        medium: &Extinction,
        section: &Section,
        depth: L,
        stream: &mut Stream,
    ) -> L {
        match self {
            Self::NullCollision(coarse) => null_collision::transmittance(medium, coarse, section, stream),
            _ => depth.exp_neg(),
        }
    }

    /// Transmittance of every lane over the hero's along `section`, whose [`Self::depth`] is `depth`, or an unbiased
    /// random estimate of that.
    #[inline]
    pub fn ratio<L: Lanes>(
        &self,
        medium: &Extinction,
        section: &Section,
        depth: L,
        hero: usize,
        stream: &mut Stream,
    ) -> L {
        match self {
            Self::NullCollision(coarse) => {
                null_collision::transmittance_ratio(medium, coarse, section, hero, stream)
            }
            _ => depth.flight_ratio(L::splat(1.0), hero),
        }
    }

    /// Flies along `section` until the `hero` lane's optical depth is `remaining` (an exponential variate; random
    /// methods draw their own).
    #[inline]
    pub fn sample_distance<L: Lanes>(
        &self,
        medium: &Extinction,
        section: &Section,
        hero: usize,
        remaining: f32,
        stream: &mut Stream,
    ) -> DistanceSample<L> {
        match self {
            Self::ClosedForm => closed_form::sample_distance(medium, section, hero, remaining),
            Self::Exact => exact::sample_distance(medium, section, hero, remaining),
            Self::March(march) => march.sample_distance(medium, section, hero, remaining),
            Self::NullCollision(coarse) => {
                null_collision::sample_distance(medium, coarse, section, hero, stream)
            }
        }
    }

    /// The optical depth along `section`, whose [`Self::depth`] is `depth`, by which forced collisions are drawn: the
    /// `hero` lane's, or what stands in for it where it is not known.
    pub fn forced_depth<L: Lanes>(
        &self,
        medium: &Extinction,
        section: &Section,
        depth: L,
        hero: usize,
    ) -> f32 {
        match self {
            Self::NullCollision(coarse) => null_collision::forced_depth::<L>(medium, coarse, section, hero),
            _ => depth.hero(hero),
        }
    }

    /// A collision of the `hero` lane in `section` where its [`Self::forced_depth`] is `remaining`; none where there is
    /// nothing to collide with. DistanceSample's ratio is that of the contribution to a density of exp(-`remaining`) times the
    /// hero's sigma_t.
    pub fn force<L: Lanes>(
        &self,
        medium: &Extinction,
        section: &Section,
        hero: usize,
        remaining: f32,
        stream: &mut Stream,
    ) -> Option<DistanceSample<L>> {
        match self {
            Self::NullCollision(coarse) => {
                null_collision::force(medium, coarse, section, hero, remaining, stream)
            }
            _ => Some(self.sample_distance(medium, section, hero, remaining, stream)),
        }
        .filter(|sample| sample.collision.is_some())
    }

    /// Which method it is.
    pub fn choice(&self) -> Choice {
        match self {
            Self::ClosedForm => Choice::ClosedForm,
            Self::Exact => Choice::Exact,
            Self::March(_) => Choice::March,
            Self::NullCollision(_) => Choice::NullCollision,
        }
    }
}

impl<L: Lanes> DistanceSample<L> {
    /// A sample of a method that knows depths exactly.
    #[inline]
    pub(super) fn exact(collision: Option<f32>, depth: L, hero: usize) -> Self {
        Self { collision, depth, ratio: depth.flight_ratio(L::splat(1.0), hero), spent: depth.hero(hero) }
    }

    /// A section in which there is nothing.
    #[inline]
    fn empty() -> Self {
        Self { collision: None, depth: L::splat(0.0), ratio: L::splat(1.0), spent: 0.0 }
    }
}

/// Optical depth along `section`, to be seen and not to be measured: never random.
pub fn quick_depth<L: Lanes>(tracker: &Tracker, medium: &Extinction, section: &Section) -> L {
    match tracker {
        Tracker::NullCollision(_) if medium.volume.has_integral() => closed_form::depth(medium, section),
        tracker => tracker.depth(medium, section),
    }
}

/// sigma_t of every lane over the hero's, where a collision of the hero happened: its own is not 0.
#[inline]
pub fn collision_ratio<L: Lanes>(sigma_t: Spectrum, hero: usize) -> L {
    L::splat(0.0).flight_ratio(L::from_spectrum(sigma_t), hero)
}
