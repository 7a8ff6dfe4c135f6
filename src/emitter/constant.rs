//! The same radiance from everywhere at infinity.

use super::sampling_weight;
use crate::{description::Params, error::Result, math::Spectrum};

/// A constant environment.
#[derive(Clone, Debug)]
pub struct Constant {
    /// Radiance [W/(m^2 sr)].
    pub radiance: Spectrum,
    /// Factor on the probability of being chosen.
    pub sampling_weight: f32,
}

impl Constant {
    /// Reads `radiance`.
    pub fn build(params: &Params<'_>) -> Result<Self> {
        Ok(Self { radiance: params.emission("radiance", 1.0)?, sampling_weight: sampling_weight(params)? })
    }
}
