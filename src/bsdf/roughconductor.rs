//! A rough metal: Mitsuba's `roughconductor`.

use super::conductor::{METAL, Metal};
use super::microfacet::{ANISOTROPY, Microfacets, ROUGHNESS, Roughness};
use super::{BsdfModel, BsdfSample, BsdfValue, Transport};
use crate::description::{Params, Table, table};
use crate::error::Result;
use crate::math::{Uv, Vec3};
use crate::sampling::Stream;

/// Microfacets that each reflect as a smooth metal does (Walter et al. 2007, eq. 20); the lower side is black.
#[derive(Clone, Debug)]
pub struct RoughConductor {
    metal: Metal,
    roughness: Roughness,
}

impl RoughConductor {
    pub(super) const TABLE: Table = table! {
        "A rough metal."; ; METAL, ROUGHNESS, ANISOTROPY
    };

    pub(super) fn build(params: &Params<'_>) -> Result<Self> {
        Ok(Self::of(Metal::build(params)?, Roughness::build(params)?))
    }

    pub(super) fn of(metal: Metal, roughness: Roughness) -> Self {
        Self { metal, roughness }
    }

    #[inline]
    fn evaluate_with(&self, microfacets: &Microfacets, uv: Uv, wi: Vec3, wo: Vec3) -> BsdfValue {
        let Some(m) = (wi + wo).try_normalize() else { return BsdfValue::ZERO };
        if wi.z <= 0.0 || wo.z <= 0.0 {
            return BsdfValue::ZERO;
        }
        let masking = microfacets.masking_over_cosine(wi) * microfacets.masking_over_cosine(wo);
        BsdfValue {
            value: self.metal.reflectance(uv, wi.dot(m)) * (0.25 * microfacets.distribution(m) * masking),
            pdf_fwd: 0.25 * microfacets.visible_pdf_over_cosine(wi, m),
            pdf_rev: 0.25 * microfacets.visible_pdf_over_cosine(wo, m),
        }
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        let rough = Roughness::examples();
        let metals = Metal::examples();
        let pair = |(i, roughness): (usize, Roughness)| Self { metal: metals[i % 3].clone(), roughness };
        rough.into_iter().enumerate().map(pair).collect()
    }
}

impl BsdfModel for RoughConductor {
    #[inline]
    fn evaluate(&self, uv: Uv, wi: Vec3, wo: Vec3, _: Transport) -> BsdfValue {
        self.evaluate_with(&self.roughness.at(uv), uv, wi, wo)
    }

    #[inline]
    fn sample(&self, uv: Uv, wi: Vec3, _: Transport, stream: &mut Stream) -> Option<BsdfSample> {
        if wi.z <= 0.0 {
            return None;
        }
        let microfacets = self.roughness.at(uv);
        let m = microfacets.sample_visible(wi, stream.square());
        let wo = (m * (2.0 * wi.dot(m)) - wi).normalize();
        let found = self.evaluate_with(&microfacets, uv, wi, wo);
        found.sampled(wo)
    }

    #[inline]
    fn survival(&self, uv: Uv, wi: Vec3) -> f32 {
        self.metal.survival(uv, wi)
    }

    fn is_connectible(&self) -> bool {
        true
    }
}
