//! No surface at all, only a boundary between media: Mitsuba's `null`.

use super::{BsdfModel, BsdfSample, BsdfValue, Transport};
use crate::description::{Params, Table, table};
use crate::error::Result;
use crate::math::{Spectrum, Uv, Vec3};
use crate::sampling::Stream;

/// All light passes straight through; nothing is scattered.
#[derive(Clone, Copy, Debug)]
pub struct Null;

impl Null {
    pub(super) const TABLE: Table = table! {
        "No surface at all: only a boundary between media.";
    };

    pub(super) fn build(_: &Params<'_>) -> Result<Self> {
        Ok(Self)
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        vec![Self]
    }
}

impl BsdfModel for Null {
    #[inline]
    fn evaluate(&self, _: Uv, _: Vec3, _: Vec3, _: Transport) -> BsdfValue {
        BsdfValue::ZERO
    }

    #[inline]
    fn sample(&self, _: Uv, _: Vec3, _: Transport, _: &mut Stream) -> Option<BsdfSample> {
        None
    }

    #[inline]
    fn survival(&self, _: Uv, _: Vec3) -> f32 {
        0.0
    }

    #[inline]
    fn null_transmission(&self, _: Uv, _: f32) -> Spectrum {
        Spectrum::ONE
    }

    fn is_connectible(&self) -> bool {
        false
    }

    fn has_dirac(&self) -> bool {
        false
    }

    fn has_null(&self) -> bool {
        true
    }
}
