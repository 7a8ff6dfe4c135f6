//! Lambert's reflector: Mitsuba's `diffuse`.

use super::{BsdfModel, BsdfSample, BsdfValue, Transport, reflectance};
use crate::description::{Params, Table, table};
use crate::error::Result;
use crate::math::{Spectrum, Uv, Vec3, warp};
use crate::sampling::Stream;
use crate::texture::Texture;
use std::f32::consts::FRAC_1_PI;

/// Reflects alike into the whole upper hemisphere: f = reflectance / pi. The lower side is black.
#[derive(Clone, Debug)]
pub struct Diffuse {
    reflectance: Texture,
}

impl Diffuse {
    /// A grey reflector of reflectance in [0, 1].
    pub fn grey(reflectance: f32) -> Self {
        Self { reflectance: Texture::constant(Spectrum::splat(reflectance)) }
    }

    pub(super) const TABLE: Table = table! {
        "A Lambertian surface.";
        texture("reflectance", 1.0, Is(0.5), "Fraction of light reflected."),
    };

    pub(super) fn build(params: &Params<'_>) -> Result<Self> {
        Ok(Self { reflectance: reflectance(params, "reflectance")? })
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        let colored = Self { reflectance: Texture::constant(Spectrum::new(0.2, 0.9, 0.0)) };
        vec![Self::grey(0.5), Self::grey(1.0), colored]
    }
}

impl BsdfModel for Diffuse {
    // The model that most surfaces have: worth its room in every dispatch.
    #[inline(always)]
    fn evaluate(&self, uv: Uv, wi: Vec3, wo: Vec3, _: Transport) -> BsdfValue {
        if wi.z <= 0.0 || wo.z <= 0.0 {
            return BsdfValue::ZERO;
        }
        BsdfValue {
            value: self.reflectance.eval(uv) * FRAC_1_PI,
            pdf_fwd: warp::cosine_hemisphere_pdf(wo.z),
            pdf_rev: warp::cosine_hemisphere_pdf(wi.z),
        }
    }

    #[inline]
    fn sample(&self, uv: Uv, wi: Vec3, _: Transport, stream: &mut Stream) -> Option<BsdfSample> {
        let wo = warp::to_cosine_hemisphere(stream.square());
        (wi.z > 0.0 && wo.z > 0.0).then(|| BsdfSample {
            wo,
            weight: self.reflectance.eval(uv),
            pdf_fwd: warp::cosine_hemisphere_pdf(wo.z),
            pdf_rev: warp::cosine_hemisphere_pdf(wi.z),
            dirac: false,
        })
    }

    #[inline(always)]
    fn survival(&self, uv: Uv, wi: Vec3) -> f32 {
        if wi.z > 0.0 { self.reflectance.eval(uv).max_element() } else { 0.0 }
    }

    fn is_connectible(&self) -> bool {
        true
    }
}
