//! A rough interface between two dielectrics: Mitsuba's `roughdielectric`.

use super::dielectric::{Dielectric, TINTS, Tints, choose};
use super::microfacet::{ANISOTROPY, Microfacets, ROUGHNESS, Roughness};
use super::{Bsdf, BsdfModel, BsdfSample, BsdfValue, Transport, index};
use crate::description::{Params, Table, table};
use crate::error::Result;
use crate::math::fresnel::{Interface, Interfaces};
use crate::math::{Uv, Vec3, vec3};
use crate::sampling::Stream;

/// Microfacets that each reflect and refract as a smooth interface does (Walter et al. 2007, eq. 20-21).
#[derive(Clone, Debug)]
pub struct RoughDielectric {
    smooth: Dielectric,
    roughness: Roughness,
}

/// Below this spread (rad) of the refracted lobe, f32 directions cannot resolve which microfacet refracted.
const LEAST_SPREAD: f32 = 1e-5;

/// A pair of directions as the microfacets see it, in the frame turned so that wi.z > 0.
pub(super) struct Facet {
    wi: Vec3,
    wo: Vec3,
    /// The normal of the facets that connect the two, z > 0.
    m: Vec3,
    interface: Interface,
    /// Squared length of the half vector before it was made unit.
    half_square: f32,
}

/// What the facets that connect two directions do with light.
pub(super) struct Meeting {
    /// The part that they reflect; the rest they refract.
    pub fresnel: f32,
    /// f (1/sr) if all light took the way that connects the directions.
    pub value: f32,
    /// Density of `wo` given `wi` (1/sr) under the same condition, of visible normals.
    pub pdf_fwd: f32,
    /// Density of `wi` given `wo` (1/sr).
    pub pdf_rev: f32,
}

impl RoughDielectric {
    pub(super) const TABLE: Table = table! {
        "Frosted glass.";
        index::inside("bk7"), index::OUTSIDE;
        TINTS, ROUGHNESS, ANISOTROPY
    };

    /// A rough interface, or the smooth one that it cannot be distinguished from: nearly equal indices bend
    /// light by less than directions resolve.
    pub(super) fn build(params: &Params<'_>) -> Result<Bsdf> {
        let smooth = Dielectric { interfaces: index::interfaces(params)?, tints: Tints::build(params)? };
        if let Some(rough) = Self::of(&smooth, Roughness::build(params)?) {
            return Ok(rough.into());
        }
        let text = "the indices are so close that this is the smooth \"dielectric\"";
        params.library.warn(params.location(), text);
        Ok(smooth.into())
    }

    /// The rough surface of the same material; none that can be distinguished from the smooth one.
    pub(super) fn of(smooth: &Dielectric, roughness: Roughness) -> Option<Self> {
        let bends = (smooth.interfaces.outside.ratio - 1.0).abs() * roughness.max();
        (bends >= LEAST_SPREAD).then(|| Self { smooth: smooth.clone(), roughness })
    }

    /// Value and densities where `facet` connects the two directions; none where its lobes are all black.
    #[inline]
    fn evaluate_with(
        &self,
        microfacets: &Microfacets,
        uv: Uv,
        facet: &Facet,
        transport: Transport,
    ) -> Option<BsdfValue> {
        let Meeting { fresnel, value, pdf_fwd, pdf_rev } = facet.meeting(microfacets, transport);
        let (reflectance, transmittance) = self.smooth.tints.at(uv);
        let (reflect, transmit) = choose(fresnel, reflectance, transmittance)?;
        let (tint, part, chance) = if facet.wo.z > 0.0 {
            (reflectance, fresnel, reflect)
        } else {
            (transmittance, 1.0 - fresnel, transmit)
        };
        Some(BsdfValue { value: tint * (part * value), pdf_fwd: chance * pdf_fwd, pdf_rev: chance * pdf_rev })
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        let pairs = [(1.5, 1.0), (1.0, 1.33), (1.05, 1.0)];
        let tints = Tints::examples();
        let pair = |(i, roughness): (usize, Roughness)| {
            let (inside, outside) = pairs[i % 3];
            let smooth =
                Dielectric { interfaces: Interfaces::new(inside, outside), tints: tints[i % 2].clone() };
            Self { smooth, roughness }
        };
        Roughness::examples().into_iter().enumerate().map(pair).collect()
    }
}

impl Facet {
    /// None where no facet connects the two directions: they would hit it from behind, or on the wrong sides.
    #[inline]
    pub(super) fn joining(interfaces: &Interfaces, wi: Vec3, wo: Vec3) -> Option<Self> {
        let turn = vec3(1.0, 1.0, 1f32.copysign(wi.z));
        let interface = interfaces.seen_from(wi.z);
        let (wi, wo) = (wi * turn, wo * turn);
        let half = wi + wo * if wo.z > 0.0 { 1.0 } else { interface.ratio };
        let half_square = half.length_squared();
        let m = half / half_square.sqrt().copysign(half.z);
        let joined = wi.z > 0.0 && wo.z != 0.0 && wi.dot(m) > 0.0 && wo.dot(m) * wo.z > 0.0;
        (joined && m.z > 0.0).then_some(Self { wi, wo, m, interface, half_square })
    }

    /// The reflected part. Of a refraction's two cosines that on the rarer side is used, which gives it the
    /// same digits both ways.
    #[inline]
    fn fresnel(&self, cos_i: f32, cos_o: f32) -> f32 {
        if self.wo.z > 0.0 || self.interface.is_into_denser() {
            self.interface.reflectance(cos_i)
        } else {
            self.interface.reversed().reflectance(cos_o)
        }
    }

    /// Of `wi` to the facet.
    #[inline]
    pub(super) fn cosine(&self) -> f32 {
        self.wi.dot(self.m).clamp(0.0, 1.0)
    }

    /// Walter et al. 2007, eq. 20, 21 and 41.
    #[inline]
    pub(super) fn meeting(&self, microfacets: &Microfacets, transport: Transport) -> Meeting {
        let Self { wi, wo, m, interface, half_square } = *self;
        let (cos_i, cos_o) = (wi.dot(m), wo.dot(m));
        // Seen from the other side the same facet has its normal turned, and D is even.
        let above = vec3(wo.x, wo.y, wo.z.abs());
        let masking = microfacets.masking_over_cosine(wi) * microfacets.masking_over_cosine(above);
        let (spread, widening) = if wo.z > 0.0 {
            (0.25, 1.0)
        } else {
            (cos_i * -cos_o / half_square, interface.ratio * interface.ratio)
        };
        let scale = if transport == Transport::Radiance { 1.0 } else { widening };
        Meeting {
            fresnel: self.fresnel(cos_i, cos_o.abs()),
            value: scale * spread * masking * microfacets.distribution(m),
            pdf_fwd: spread * widening * microfacets.visible_pdf_over_cosine(wi, m),
            pdf_rev: spread * microfacets.visible_pdf_over_cosine(above, m),
        }
    }
}

/// Where a facet of normal `m` reflects or refracts light from `above` (z > 0) to, `cosine` to the facet; none in total reflection,
/// and where that is the side to which it does not belong: such light is lost.
#[inline]
pub(super) fn thrown(
    interface: &Interface,
    above: Vec3,
    m: Vec3,
    cosine: f32,
    reflected: bool,
) -> Option<Vec3> {
    let wo = if reflected {
        m * (2.0 * cosine) - above
    } else {
        m * (cosine / interface.ratio - interface.refracted_cosine(cosine)?) - above / interface.ratio
    };
    ((wo.z > 0.0) == reflected).then(|| wo.normalize())
}

impl BsdfModel for RoughDielectric {
    #[inline]
    fn evaluate(&self, uv: Uv, wi: Vec3, wo: Vec3, transport: Transport) -> BsdfValue {
        Facet::joining(&self.smooth.interfaces, wi, wo)
            .and_then(|facet| self.evaluate_with(&self.roughness.at(uv), uv, &facet, transport))
            .unwrap_or(BsdfValue::ZERO)
    }

    #[inline]
    fn sample(&self, uv: Uv, wi: Vec3, transport: Transport, stream: &mut Stream) -> Option<BsdfSample> {
        if wi.z == 0.0 {
            return None;
        }
        let microfacets = self.roughness.at(uv);
        let turn = vec3(1.0, 1.0, 1f32.copysign(wi.z));
        let above = wi * turn;
        let interface = self.smooth.interfaces.seen_from(wi.z);
        let m = microfacets.sample_visible(above, stream.square());
        let cosine = above.dot(m).max(0.0);
        let (reflectance, transmittance) = self.smooth.tints.at(uv);
        let (reflect, _) = choose(interface.reflectance(cosine), reflectance, transmittance)?;
        let reflected = stream.uniform() < reflect;
        let wo = thrown(&interface, above, m, cosine, reflected)? * turn;
        self.evaluate(uv, wi, wo, transport).sampled(wo)
    }

    #[inline]
    fn survival(&self, uv: Uv, _: Vec3) -> f32 {
        self.smooth.tints.max(uv)
    }

    fn is_connectible(&self) -> bool {
        true
    }

    fn scatters_across(&self) -> bool {
        true
    }
}
