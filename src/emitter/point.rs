//! A point that emits alike in all directions.

use super::{point_position, sampling_weight};
use crate::{
    description::Params,
    error::Result,
    math::{DVec3, Spectrum},
};

/// An isotropic point light.
#[derive(Clone, Debug)]
pub struct Point {
    /// Where it stands, in the file's coordinates.
    pub position: DVec3,
    /// Intensity [W/sr].
    pub intensity: Spectrum,
    /// Factor on the probability of being chosen.
    pub sampling_weight: f32,
}

impl Point {
    /// Reads `intensity` and `position` or `to_world`.
    pub fn build(params: &Params<'_>) -> Result<Self> {
        Ok(Self {
            position: point_position(params)?,
            intensity: params.emission("intensity", 1.0)?,
            sampling_weight: sampling_weight(params)?,
        })
    }
}
