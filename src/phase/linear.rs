//! Linear anisotropic scattering: the linear-anisotropic phase function (P03T 2.3.2).

use super::{Deflection, PhaseModel, deflect};
use crate::description::{Params, Table, table};
use crate::error::Result;
use crate::math::{Vec3, warp};
use crate::sampling::Stream;
use std::f32::consts::TAU;

/// (1 + g cos) / (4 pi).
#[derive(Clone, Copy, Debug)]
pub struct Linear {
    g: f32,
}

impl Linear {
    /// `g` from -1 (backward) to 1 (forward); the mean cosine is g / 3.
    pub fn new(g: f32) -> Self {
        Self { g }
    }

    pub(super) const TABLE: Table = table! {
        "Linear anisotropic scattering: (1 + g cos) / (4 pi) (P03T 2.3.2).";
        number("g", "", within(-1.0, 1.0), Is(0.0), "The slope; the mean cosine is a third of it."),
    };

    pub(super) fn build(params: &Params<'_>) -> Result<Self> {
        Ok(Self::new(params.float("g")? as f32))
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        [0.0, 1.0, -1.0, 0.5, -1e-6].map(Self::new).to_vec()
    }
}

impl PhaseModel for Linear {
    #[inline]
    fn pdf_sr(&self, turn: Deflection) -> f32 {
        warp::SPHERE_PDF * (1.0 + self.g * turn.cosine())
    }

    #[inline]
    fn sample(&self, direction: Vec3, stream: &mut Stream) -> Vec3 {
        let u = stream.square();
        let cosine = 2.0 * warp::linear(1.0 - self.g, 1.0 + self.g, u.x) - 1.0;
        deflect(direction, warp::spherical(cosine, TAU * u.y))
    }

    fn mean_cosine(&self) -> f32 {
        self.g / 3.0
    }
}
