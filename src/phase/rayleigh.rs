//! Rayleigh's phase function for particles much smaller than the wavelength (P03 eq. 5).

use super::{Deflection, PhaseModel, deflect};
use crate::description::{Params, Table, table};
use crate::error::Result;
use crate::math::{Vec3, warp};
use crate::sampling::Stream;
use std::f32::consts::{PI, TAU};

/// 3 (1 + cos^2) / (16 pi).
#[derive(Clone, Copy, Debug)]
pub struct Rayleigh;

impl Rayleigh {
    pub(super) const TABLE: Table = table! {
    "Rayleigh scattering, by particles much smaller than the wavelength: 3 (1 + cos^2) / (16 pi) (P03 eq. 5)."; };

    pub(super) fn build(_: &Params<'_>) -> Result<Self> {
        Ok(Self)
    }

    /// The cosine for a uniform `u`: the real root of c^3 + 3 c = 8 u - 4, by Cardano, on the side of zero
    /// where no difference of near-equal numbers arises.
    #[inline]
    fn invert(u: f32) -> f32 {
        let half = 4.0 * u - 2.0;
        let size = half.abs();
        let root = (size + (size * size + 1.0).sqrt()).cbrt();
        (root - 1.0 / root).clamp(0.0, 1.0).copysign(half)
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        vec![Self]
    }
}

impl PhaseModel for Rayleigh {
    #[inline]
    fn pdf_sr(&self, turn: Deflection) -> f32 {
        const SCALE: f32 = 3.0 / (16.0 * PI);
        let cosine = turn.cosine();
        SCALE * (1.0 + cosine * cosine)
    }

    #[inline]
    fn sample(&self, direction: Vec3, stream: &mut Stream) -> Vec3 {
        let u = stream.square();
        deflect(direction, warp::spherical(Self::invert(u.x), TAU * u.y))
    }

    fn mean_cosine(&self) -> f32 {
        0.0
    }
}
