//! Diffuse emission from the side of a shape that its normal points to.

use super::sampling_weight;
use crate::{
    description::Params,
    error::Result,
    math::{Spectrum, Vec3, warp},
    sampling::Stream,
};

/// Emits `radiance` in every direction above the surface.
#[derive(Clone, Debug)]
pub struct Area {
    /// Radiance [W/(m^2 sr)].
    pub radiance: Spectrum,
    /// Factor on the probability of being chosen.
    pub sampling_weight: f32,
}

impl Area {
    /// Reads `radiance`.
    pub fn build(params: &Params<'_>) -> Result<Self> {
        Ok(Self { radiance: params.emission("radiance", 1.0)?, sampling_weight: sampling_weight(params)? })
    }

    /// Radiance leaving at `cosine` to the normal: none behind.
    #[inline]
    pub fn radiance(&self, cosine: f32) -> Spectrum {
        if cosine > 0.0 { self.radiance } else { Spectrum::ZERO }
    }

    /// A direction in the frame of the normal, cosine-weighted.
    #[inline]
    pub fn sample(&self, stream: &mut Stream) -> Vec3 {
        warp::to_cosine_hemisphere(stream.square())
    }

    /// Density of `sample` [1/sr].
    #[inline]
    pub fn density(&self, cosine: f32) -> f32 {
        warp::cosine_hemisphere_density(cosine)
    }
}
