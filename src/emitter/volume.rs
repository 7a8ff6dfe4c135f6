//! An emissive medium.

use crate::{
    math::{DVec3, warp},
    medium::Emission,
};
use std::sync::Arc;

/// The emission of a medium as an emitter: every point of the medium emits isotropically.
#[derive(Clone, Debug)]
pub struct VolumeEmitter {
    /// Radiance emitted per metre, at every point.
    pub emission: Arc<Emission>,
    /// The part of its power that is emitted within the medium; the rest of its box is not lit.
    pub filled: f64,
}

impl VolumeEmitter {
    /// Density of directions (1/sr).
    pub const PDF_SR: f32 = warp::SPHERE_PDF;

    /// Emitted power (W).
    pub fn power(&self) -> DVec3 {
        self.emission.power() * self.filled
    }
}
