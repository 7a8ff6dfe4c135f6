//! Scattering alike into all directions (P03 eq. 1).

use super::{Deflection, PhaseModel};
use crate::description::{Params, Table, table};
use crate::error::Result;
use crate::math::{Vec3, warp};
use crate::sampling::Stream;

/// The constant phase function 1/(4 pi).
#[derive(Clone, Copy, Debug)]
pub struct Isotropic;

impl Isotropic {
    pub(super) const TABLE: Table = table! {
    "The same in all directions: 1 / (4 pi) (P03 eq. 1)."; };

    pub(super) fn build(_: &Params<'_>) -> Result<Self> {
        Ok(Self)
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        vec![Self]
    }
}

impl PhaseModel for Isotropic {
    #[inline]
    fn pdf_sr(&self, _: Deflection) -> f32 {
        warp::SPHERE_PDF
    }

    #[inline]
    fn sample(&self, _: Vec3, stream: &mut Stream) -> Vec3 {
        warp::to_sphere(stream.square())
    }

    fn mean_cosine(&self) -> f32 {
        0.0
    }
}
