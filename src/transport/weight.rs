//! The balance heuristic (LW96 eq. 14), O(1) per connection.

use crate::math::Lanes;
use crate::math::{Spectrum, Vec3};
use crate::medium::MediumIndex;

/// One end of a join: a vertex with its scattering towards the other end evaluated.
#[derive(Clone, Copy, Debug)]
pub struct End<L> {
    /// Where the joining ray starts.
    pub origin: Vec3,
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
    pub sigma_t: L,
    /// See [`super::vertex::Vertex::reach`].
    pub reach: L,
    /// See [`super::vertex::Vertex::tail`].
    pub tail: L,
}

impl<L: Lanes> End<L> {
    /// D of this end: the strategies that join on its own side, relative to the one at hand. `other_forward` is
    /// the density of the direction from the other end to this one.
    #[inline]
    fn before(&self, other_forward: f32, density: L, inverse_distance_squared: f32) -> L {
        let geometry = other_forward * self.cosine * inverse_distance_squared * self.inverse;
        (self.tail * self.sigma_t * density).scaled(geometry)
    }
}

/// Weight of the join of `a` and `b` by a strategy of `count` expected samples, times the number of lanes:
/// n p^h / ((1/C) sum_c sum_j n_j p_j^c). `density` is the surface flight density of the joining segment.
#[inline]
pub fn join<L: Lanes>(a: &End<L>, b: &End<L>, density: L, inverse_distance_squared: f32, count: f32) -> f32 {
    let before_a = a.before(b.forward, density, inverse_distance_squared);
    let before_b = b.before(a.forward, density, inverse_distance_squared);
    let others = before_a * b.reach + before_b * a.reach;
    L::COUNT as f32 / (a.reach * b.reach + others.scaled(1.0 / count)).sum()
}

/// The same of a strategy that runs alone: only the channels share the path. `reach` is the product of both ends'.
/// The weight among all strategies is that of [`join`] or [`hit`] over this one.
#[inline]
pub fn alone<L: Lanes>(reach: L) -> f32 {
    L::COUNT as f32 / reach.sum()
}

/// The same where an eye walk has met the emitter itself (s = 0): `others` sums n_j p_j over all other
/// strategies in units of the walk's own density, whose lanes are `reach`.
#[inline]
pub fn hit<L: Lanes>(reach: L, others: L) -> f32 {
    L::COUNT as f32 / (reach + others).sum()
}
