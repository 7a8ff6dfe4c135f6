//! The same radiance from all directions at infinity.

use crate::{
    description::Params,
    error::Result,
    math::{Spectrum, Vec3, warp},
    sampling::Stream,
};

/// A constant environment.
#[derive(Clone, Debug)]
pub struct Constant {
    /// Radiance [W/(m^2 sr)].
    pub radiance: Spectrum,
}

impl Constant {
    /// Reads `radiance`.
    pub fn build(params: &Params<'_>) -> Result<Self> {
        Ok(Self { radiance: params.emission("radiance", 1.0)? })
    }

    /// A direction, uniform.
    #[inline]
    pub fn sample(&self, stream: &mut Stream) -> Vec3 {
        warp::to_sphere(stream.square())
    }

    /// Density of `sample` [1/sr].
    #[inline]
    pub fn pdf_sr(&self) -> f32 {
        warp::SPHERE_PDF
    }
}
