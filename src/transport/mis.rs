//! Weights of strategies (LW96 eq. 14), O(1) per connection. Each file of the folder is a heuristic; `sums` is their
//! common interface.

mod balance;
mod by_kind;
mod compared;
mod cutoff;
mod maximum;
mod power;
mod sums;
mod uniform;

pub(super) use balance::Balance;
pub(super) use by_kind::ByKind;
pub(super) use compared::Compared;
pub(super) use cutoff::Cutoff;
#[cfg(test)]
pub(in crate::transport) use maximum::TIE;
pub use sums::MisSums;

use super::{profile::Profile, strategy::StrategyKind};
use crate::{
    math::{Channels, Spectrum, Vec3, offset::Lift},
    medium::MediumIndex,
    settings::heuristic::Heuristic,
};

/// One end of a connection: a vertex with its scattering towards the other end evaluated.
#[derive(Clone, Copy, Debug)]
pub struct End<S: MisSums> {
    /// Where the connecting ray starts; none at infinity.
    pub origin: Option<Vec3>,
    /// How a segment that ends here keeps clear of the surface.
    pub lift: Lift,
    /// The medium it starts in.
    pub medium: MediumIndex,
    /// True if it is a point of that medium only: no segment through another can end here.
    pub within: bool,
    /// Throughput times scattering towards the other end.
    pub value: Spectrum,
    /// Density of the direction to the other end (1/sr).
    pub pdf_fwd: f32,
    /// See [`super::interaction::Interaction::cosine`]; 1 at an emitter elsewhere than on a surface.
    pub cosine: f32,
    /// 1/p>^h of this vertex.
    pub inv_pdf: f32,
    /// sigma_t per channel in a medium, [`crate::medium::Emission::rate`] where that emits, 1 elsewhere.
    pub sigma_t: S::Channels,
    /// See [`super::vertex::Subpath::pdf_over_hero`].
    pub pdf_over_hero: S::Channels,
    /// See [`super::vertex::Vertex::others_before`].
    pub others_before: S,
    /// One more strategy that makes the same path, but by neither walk, in units of the strategy at hand (see
    /// `equiangular`). Only the first end of a connection has it, and only where there are media.
    pub beside: Option<S>,
}

impl<S: MisSums> End<S> {
    /// D of this end: the strategies that connect on its own side, relative to the one at hand. `other_pdf_fwd` is
    /// the density of the direction from the other end to this one.
    #[inline]
    fn before(&self, other_pdf_fwd: f32, pdf: S::Channels, inverse_distance_squared: f32) -> S {
        let geometry = other_pdf_fwd * self.cosine * inverse_distance_squared * self.inv_pdf;
        self.others_before.times(self.sigma_t).times(pdf).scaled(geometry)
    }
}

/// A strategy as the weights use it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Strategy {
    /// Its kind.
    pub kind: StrategyKind,
    /// Expected samples.
    pub count: f32,
    /// The heuristic by which it shares paths with the others.
    pub heuristic: Heuristic,
}

/// The weight of a strategy's sample of a path.
#[derive(Clone, Copy, Debug)]
pub(super) struct Weight {
    /// Times the number of channels; for the balance heuristic n p^h / ((1/C) sum_c sum_j n_j p_j^c).
    pub value: f32,
    /// See [`MisSums::shares`].
    pub shares: [f32; StrategyKind::ALL.len()],
}

impl Strategy {
    /// Its own n p^c over n p^h; `pdf_over_hero` is the product of both ends'. Equiangular sampling has no flight.
    #[inline]
    pub(super) fn own<P: Profile>(&self, pdf_over_hero: P::Channels) -> P::Channels {
        if P::MEDIA && self.kind == StrategyKind::Equiangular {
            P::Channels::splat(1.0)
        } else {
            pdf_over_hero
        }
    }

    /// The weight of this strategy. `others` are all other strategies and `own` its n p^c, both in units of its n p^h.
    ///
    /// LW96 eq. 14.
    #[inline]
    pub(super) fn weight<S: MisSums>(&self, others: S, own: S::Channels) -> Weight {
        Weight { value: others.weight(self.heuristic, own), shares: others.shares(self.kind, own) }
    }
}

/// Weight of the connection of `a` and `b` by `strategy`. `pdf` is the surface flight density of the connecting segment.
///
/// LW96 eq. 14, all densities in units of the strategy's own.
#[inline]
pub(super) fn connection_weight<P: Profile>(
    a: &End<P::MisSums>,
    b: &End<P::MisSums>,
    pdf: P::Channels,
    inverse_distance_squared: f32,
    strategy: Strategy,
) -> Weight {
    let before_a = a.before(b.pdf_fwd, pdf, inverse_distance_squared);
    let before_b = b.before(a.pdf_fwd, pdf, inverse_distance_squared);
    let others = before_a.times(b.pdf_over_hero).and(before_b.times(a.pdf_over_hero));
    let others = match a.beside {
        Some(beside) if P::MEDIA => others.and(beside),
        _ => others,
    };
    let own = strategy.own::<P>(a.pdf_over_hero * b.pdf_over_hero);
    strategy.weight(others.scaled(1.0 / strategy.count), own)
}

/// The weight of a strategy that runs alone, times the number of channels: only the channels share the path.
/// `pdf_over_hero` is the product of both ends'. The share among all strategies is [`Strategy::weight`] over this.
#[inline]
pub(super) fn weight_alone<L: Channels>(pdf_over_hero: L) -> f32 {
    L::COUNT as f32 / pdf_over_hero.sum()
}
