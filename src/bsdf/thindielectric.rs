//! A pane of glass too thin to bend light: Mitsuba's `thindielectric`.

use super::dielectric::{TINTS, Tints};
use super::{BsdfModel, BsdfSample, BsdfValue, Side, Smooth, Transport, index, mirror};
use crate::description::{Params, Table, table};
use crate::error::Result;
use crate::math::fresnel::Interfaces;
use crate::math::{Spectrum, Uv, Vec3};
use crate::sampling::Stream;

/// Reflects as a Dirac lobe, inter-reflections between its two faces included; the rest passes straight
/// through and is no scattering.
#[derive(Clone, Debug)]
pub struct ThinDielectric {
    interfaces: Interfaces,
    tints: Tints,
}

impl ThinDielectric {
    pub(super) const TABLE: Table = table! {
        "A pane of glass too thin to bend light.";
        index::inside("bk7"), index::OUTSIDE;
        TINTS
    };

    pub(super) fn build(params: &Params<'_>) -> Result<Self> {
        Ok(Self { interfaces: index::interfaces(params)?, tints: Tints::build(params)? })
    }

    /// R + T R T + T R^3 T + ... = 2 R / (1 + R) for a face that reflects R. The same from both sides, as
    /// the same medium lies on both.
    #[inline]
    fn reflected(&self, cosine: f32) -> f32 {
        let face = self.interfaces.outside.reflectance(cosine.abs());
        2.0 * face / (1.0 + face)
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        let with = |tints: Tints| {
            [1.5, 1.0, 1.0 + 1e-6, 0.8]
                .map(|index| Self { interfaces: Interfaces::new(index, 1.0), tints: tints.clone() })
        };
        Tints::examples().into_iter().flat_map(with).collect()
    }
}

impl BsdfModel for ThinDielectric {
    #[inline]
    fn evaluate(&self, _: Uv, _: Vec3, _: Vec3, _: Transport) -> BsdfValue {
        BsdfValue::ZERO
    }

    #[inline]
    fn sample(&self, uv: Uv, wi: Vec3, _: Transport, _: &mut Stream) -> Option<BsdfSample> {
        let weight = self.tints.reflectance.eval(uv) * self.reflected(wi.z);
        (wi.z != 0.0).then(|| BsdfSample { wo: mirror(wi), weight, pdf_fwd: 1.0, pdf_rev: 1.0, dirac: true })
    }

    /// Of what does not pass straight through, the tint of the reflection is what is not absorbed.
    #[inline]
    fn survival(&self, uv: Uv, _: Vec3) -> f32 {
        self.tints.reflectance.eval(uv).max_element()
    }

    #[inline]
    fn null_transmission(&self, uv: Uv, cosine: f32) -> Spectrum {
        self.tints.transmittance.eval(uv) * (1.0 - self.reflected(cosine))
    }

    fn is_connectible(&self) -> bool {
        false
    }

    fn smooth(&self) -> Option<Smooth> {
        Some(Smooth::Mirror)
    }

    fn dirac(&self, uv: Uv, wi: Vec3, side: Side, _: Transport) -> Option<(Vec3, Spectrum)> {
        (wi.z != 0.0 && side == Side::Reflected)
            .then(|| (mirror(wi), self.tints.reflectance.eval(uv) * self.reflected(wi.z)))
    }

    fn has_null(&self) -> bool {
        true
    }
}
