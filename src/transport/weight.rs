//! Weights of strategies (LW96 eq. 14), O(1) per connection. The files of the folder are the heuristics; `sums` is what they
//! have in common.

mod balance;
mod cutoff;
mod maximum;
mod power;
mod sums;
mod uniform;

pub use balance::Balance;
pub use cutoff::Cutoff;
pub use maximum::Maximum;
#[cfg(test)]
pub use maximum::TIE;
pub use power::Power;
pub use sums::Sums;
pub use uniform::Uniform;

use crate::math::{Lanes, Spectrum, Vec3};
use crate::medium::MediumIndex;
use crate::scene::heuristic::Heuristic;

/// One end of a join: a vertex with its scattering towards the other end evaluated.
#[derive(Clone, Copy, Debug)]
pub struct End<S: Sums> {
    /// Where the joining ray starts; none at infinity.
    pub origin: Option<Vec3>,
    /// Unit normal on the side of `origin`; zero where it lies on no surface.
    pub lift: Vec3,
    /// The medium it starts in.
    pub medium: MediumIndex,
    /// True if it is a point of that medium only: no segment through another can end here.
    pub within: bool,
    /// Throughput times scattering towards the other end.
    pub value: Spectrum,
    /// Density of the direction to the other end [1/sr].
    pub forward: f32,
    /// |cos| on a surface, 1 elsewhere.
    pub cosine: f32,
    /// 1/p>^h of this vertex.
    pub inverse: f32,
    /// sigma_t per lane in a medium, [`crate::medium::Emission::rate`] where that shines, 1 elsewhere.
    pub sigma_t: S::Lanes,
    /// See [`super::vertex::Vertex::reach`].
    pub reach: S::Lanes,
    /// See [`super::vertex::Vertex::tail`].
    pub tail: S,
}

impl<S: Sums> End<S> {
    /// D of this end: the strategies that join on its own side, relative to the one at hand. `other_forward` is
    /// the density of the direction from the other end to this one.
    #[inline]
    fn before(&self, other_forward: f32, density: S::Lanes, inverse_distance_squared: f32) -> S {
        let geometry = other_forward * self.cosine * inverse_distance_squared * self.inverse;
        self.tail.times(self.sigma_t).times(density).scaled(geometry)
    }
}

/// A strategy as its weights see it.
#[derive(Clone, Copy, Debug)]
pub struct Strategy {
    /// Expected samples.
    pub count: f32,
    /// By which it shares paths with the others.
    pub heuristic: Heuristic,
}

/// Weight of the join of `a` and `b` by `strategy`, times the number of lanes; for the balance heuristic
/// n p^h / ((1/C) sum_c sum_j n_j p_j^c). `density` is the surface flight density of the joining segment.
///
/// LW96 eq. 14, all densities in units of the strategy's own.
#[inline]
pub fn join<S: Sums>(
    a: &End<S>,
    b: &End<S>,
    density: S::Lanes,
    inverse_distance_squared: f32,
    strategy: Strategy,
) -> f32 {
    let before_a = a.before(b.forward, density, inverse_distance_squared);
    let before_b = b.before(a.forward, density, inverse_distance_squared);
    let others = before_a.times(b.reach).and(before_b.times(a.reach));
    others.scaled(1.0 / strategy.count).weight(strategy.heuristic, a.reach * b.reach)
}

/// The same where an eye walk has met the emitter itself (s = 0): `others` are all other strategies in units of
/// the walk's own density, whose lanes are `reach`.
///
/// LW96 eq. 14.
#[inline]
pub fn hit<S: Sums>(reach: S::Lanes, others: S, heuristic: Heuristic) -> f32 {
    others.weight(heuristic, reach)
}

/// The weight of a strategy that runs alone, times the number of lanes: only the channels share the path. `reach` is the product of both ends'.
/// The weight among all strategies is that of [`join`] or [`hit`] over this one.
#[inline]
pub fn alone<L: Lanes>(reach: L) -> f32 {
    L::COUNT as f32 / reach.sum()
}
