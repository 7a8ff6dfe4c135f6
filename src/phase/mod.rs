//! Phase functions: one file a model; this page is the contract and the registry.
//!
//! All depend on the cosine between the directions of flight before and after scattering alone (cos > 0 is
//! forward), are normalised to 1 over the sphere, and are sampled exactly: the density of a sampled direction
//! is the value of the function, both ways.

use crate::math::Vec3;
use crate::sampling::Stream;

/// What every phase function can do.
pub trait PhaseModel {
    /// Value and sampling density [1/sr] for the cosine between old and new direction of flight.
    fn density(&self, cosine: f32) -> f32;

    /// A new direction of flight after `direction`, with exactly `density`.
    fn sample(&self, direction: Vec3, stream: &mut Stream) -> Vec3;

    /// The mean cosine, g, in [-1, 1].
    fn mean_cosine(&self) -> f32;
}
