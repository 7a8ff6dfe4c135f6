//! A diffusely transmitting sheet: Mitsuba 0.6's `difftrans`.

use super::{BsdfModel, BsdfSample, BsdfValue, Transport, reflectance};
use crate::description::{Params, Table, table};
use crate::error::Result;
use crate::math::{Uv, Vec3, vec3, warp};
use crate::sampling::Stream;
use crate::texture::Texture;
use std::f32::consts::FRAC_1_PI;

/// Transmits alike into the whole far hemisphere, from both sides: f = transmittance / pi. Reflects nothing.
#[derive(Clone, Debug)]
pub struct DiffuseTransmitter {
    transmittance: Texture,
}

impl DiffuseTransmitter {
    pub(super) const TABLE: Table = table! {
        "A sheet that transmits diffusely.";
        texture("transmittance", 1.0, Is(0.5), "Fraction of light transmitted."),
    };

    pub(super) fn build(params: &Params<'_>) -> Result<Self> {
        Ok(Self { transmittance: reflectance(params, "transmittance")? })
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        use crate::math::Spectrum;
        let with = |color| Self { transmittance: Texture::constant(color) };
        vec![with(Spectrum::ONE), with(Spectrum::new(0.2, 0.9, 0.0))]
    }
}

impl BsdfModel for DiffuseTransmitter {
    #[inline]
    fn evaluate(&self, uv: Uv, wi: Vec3, wo: Vec3, _: Transport) -> BsdfValue {
        if wi.z * wo.z.signum() >= 0.0 || wo.z == 0.0 {
            return BsdfValue::ZERO;
        }
        BsdfValue {
            value: self.transmittance.eval(uv) * FRAC_1_PI,
            pdf_fwd: warp::cosine_hemisphere_pdf(wo.z.abs()),
            pdf_rev: warp::cosine_hemisphere_pdf(wi.z.abs()),
        }
    }

    #[inline]
    fn sample(&self, uv: Uv, wi: Vec3, transport: Transport, stream: &mut Stream) -> Option<BsdfSample> {
        let w = warp::to_cosine_hemisphere(stream.square());
        let wo = vec3(w.x, w.y, -w.z.copysign(wi.z));
        self.evaluate(uv, wi, wo, transport).sampled(wo)
    }

    #[inline]
    fn survival(&self, uv: Uv, _: Vec3) -> f32 {
        self.transmittance.eval(uv).max_element()
    }

    fn is_connectible(&self) -> bool {
        true
    }

    fn scatters_across(&self) -> bool {
        true
    }
}
