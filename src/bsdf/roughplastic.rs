//! A diffuse base under a rough coat of clear dielectric: Mitsuba's `roughplastic`.

use super::microfacet::{ANISOTROPY, Microfacets, ROUGHNESS, Roughness};
use super::plastic::{BASE, Base, Shares};
use super::{BsdfModel, BsdfSample, BsdfValue, Transport, index};
use crate::description::{Params, Table, table};
use crate::error::Result;
use crate::math::fresnel::{Interface, Interfaces};
use crate::math::{Spectrum, Uv, Vec3, vec2, vec3, warp};
use crate::sampling::Stream;
use std::sync::Arc;

/// The coat's facets reflect as a smooth interface does; what they let in is scattered by the base until it gets
/// out. The lower side is black.
#[derive(Clone, Debug)]
pub struct RoughPlastic {
    coat: Interface,
    microfacets: Microfacets,
    base: Base,
    /// What the coat lets in from evenly spaced cosines, 0 to 1.
    transmittance: Arc<[f32; ENTRIES]>,
    /// The part of even light from outside that gets in.
    entering: f32,
}

/// As many as in Mitsuba: the interpolation between them is part of the model.
const ENTRIES: usize = 64;

/// Cosine and sine of the direction of entry `i`.
fn entry(i: usize) -> (f32, f32) {
    let cosine = (i as f32 / (ENTRIES - 1) as f32).max(1e-6);
    (cosine, (1.0 - cosine * cosine).sqrt())
}

/// `f`(cosine to the facet, facet, direction) averaged over the facets that the direction of entry `i` sees. The points
/// are denser towards the ends, where slopes grow without bound.
fn average(microfacets: &Microfacets, i: usize, f: impl Fn(f32, Vec3, Vec3) -> f32) -> f32 {
    let (rings, spokes) = (96, 64);
    let (cosine, sine) = entry(i);
    let w = vec3(sine, 0.0, cosine);
    let (mut sum, mut total) = (0.0, 0.0);
    for j in 0..rings * spokes {
        let v = vec2(((j / spokes) as f32 + 0.5) / rings as f32, ((j % spokes) as f32 + 0.5) / spokes as f32);
        let m = microfacets.sample_visible(w, v * v * (3.0 - 2.0 * v));
        let weight = f64::from((v * (1.0 - v)).element_product());
        sum += weight * f64::from(f(w.dot(m).max(0.0), m, w));
        total += weight;
    }
    (sum / total) as f32
}

/// Smith's masking of a direction on either side.
fn masking(microfacets: &Microfacets, w: Vec3) -> f32 {
    let above = vec3(w.x, w.y, w.z.abs());
    microfacets.masking_over_cosine(above) * above.z
}

/// The part of light from the direction of entry `i` that facets refract to the other side.
fn transmittance(microfacets: &Microfacets, interface: &Interface, i: usize) -> f32 {
    average(microfacets, i, |cosine, m, w| {
        let Some(refracted) = interface.refracted_cosine(cosine) else { return 0.0 };
        let wo = m * (cosine / interface.ratio - refracted) - w / interface.ratio;
        if wo.z >= 0.0 { 0.0 } else { masking(microfacets, wo) * (1.0 - interface.reflectance(cosine)) }
    })
}

/// The part of it that they reflect.
fn reflectance(microfacets: &Microfacets, interface: &Interface, i: usize) -> f32 {
    average(microfacets, i, |cosine, m, w| {
        let wo = m * (2.0 * cosine) - w;
        if wo.z <= 0.0 { 0.0 } else { masking(microfacets, wo) * interface.reflectance(cosine) }
    })
}

/// The part of even light from inside that the coat throws back: Mitsuba's plain mean over the entries, which
/// counts both ends in full and comes out 1 to 2% too low.
fn returned(microfacets: &Microfacets, inside: &Interface) -> f32 {
    let at = |i| reflectance(microfacets, inside, i) * entry(i).0;
    (0..ENTRIES).map(at).sum::<f32>() * 2.0 / ENTRIES as f32
}

impl RoughPlastic {
    pub(super) const TABLE: Table =
        table! { "A diffuse base under a rough clear coat."; ; BASE, ROUGHNESS, ANISOTROPY };

    pub(super) fn build(params: &Params<'_>) -> Result<Self> {
        let interfaces = index::interfaces(params)?;
        let microfacets = Roughness::build_even(params)?;
        let returned = returned(&microfacets, &interfaces.inside);
        let base = Base::build(params, interfaces.outside.ratio, returned)?;
        Ok(Self::new(&interfaces, microfacets, base))
    }

    fn new(interfaces: &Interfaces, microfacets: Microfacets, base: Base) -> Self {
        let coat = interfaces.outside;
        let transmittance = std::array::from_fn(|i| transmittance(&microfacets, &coat, i).clamp(0.0, 1.0));
        let mut plastic =
            Self { coat, microfacets, base, transmittance: Arc::new(transmittance), entering: 1.0 };
        let steps = 1024;
        let middle = |i| (i as f32 + 0.5) / steps as f32;
        let entering = |i| f64::from(plastic.transmittance(middle(i)) * 2.0 * middle(i));
        plastic.entering = ((0..steps).map(entering).sum::<f64>() / f64::from(steps)) as f32;
        plastic
    }

    /// What the coat lets in from a direction at `cosine` in (0, 1].
    #[inline]
    fn transmittance(&self, cosine: f32) -> f32 {
        let position = cosine * (ENTRIES - 1) as f32;
        let index = (position as usize).min(ENTRIES - 2);
        let t = position - index as f32;
        self.transmittance[index] * (1.0 - t) + self.transmittance[index + 1] * t
    }

    #[inline]
    fn evaluate_with(&self, shares: &Shares, wi: Vec3, wo: Vec3) -> BsdfValue {
        let Some(m) = (wi + wo).try_normalize() else { return BsdfValue::ZERO };
        if wi.z <= 0.0 || wo.z <= 0.0 {
            return BsdfValue::ZERO;
        }
        let facets = &self.microfacets;
        let masking = facets.masking_over_cosine(wi) * facets.masking_over_cosine(wo);
        let reflected = 0.25 * facets.distribution(m) * masking * self.coat.reflectance(wi.dot(m).min(1.0));
        let (into, out) = (self.transmittance(wi.z), self.transmittance(wo.z));
        let pdf = |from: Vec3, into: f32, to: Vec3| {
            let coat = 0.25 * facets.visible_pdf_over_cosine(from, m);
            let base = warp::cosine_hemisphere_pdf(to.z);
            let (reflect, scatter) = shares.choose(into, 1.0);
            reflect * coat + scatter * base
        };
        BsdfValue {
            value: shares.specular * reflected + shares.base * (into * out),
            pdf_fwd: pdf(wi, into, wo),
            pdf_rev: pdf(wo, out, wi),
        }
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        use super::microfacet::Kind;
        let with = |kind, alpha, (inside, outside), i: usize| {
            let interfaces = Interfaces::new(inside, outside);
            let microfacets = Microfacets::new(kind, alpha, alpha);
            let returned = returned(&microfacets, &interfaces.inside);
            let base = Base::examples(interfaces.outside.ratio, returned)[i].clone();
            Self::new(&interfaces, microfacets, base)
        };
        vec![
            with(Kind::Beckmann, 0.2, (1.49, 1.0), 0),
            with(Kind::Ggx, 0.5, (1.9, 1.0), 1),
            with(Kind::Ggx, 0.2, (1.5, 1.0), 2),
            with(Kind::Beckmann, 0.6, (1.0, 1.33), 0),
        ]
    }
}

impl BsdfModel for RoughPlastic {
    #[inline]
    fn evaluate(&self, uv: Uv, wi: Vec3, wo: Vec3, _: Transport) -> BsdfValue {
        self.evaluate_with(&self.base.at(uv, self.entering), wi, wo)
    }

    #[inline]
    fn sample(&self, uv: Uv, wi: Vec3, _: Transport, stream: &mut Stream) -> Option<BsdfSample> {
        if wi.z <= 0.0 {
            return None;
        }
        let shares = self.base.at(uv, self.entering);
        let into = self.transmittance(wi.z);
        let (reflect, _) = shares.choose(into, 1.0);
        let wo = if stream.uniform() < reflect {
            let m = self.microfacets.sample_visible(wi, stream.square());
            (m * (2.0 * wi.dot(m)) - wi).normalize()
        } else {
            warp::to_cosine_hemisphere(stream.square())
        };
        self.evaluate_with(&shares, wi, wo).sampled(wo)
    }

    #[inline]
    fn survival(&self, uv: Uv, wi: Vec3) -> f32 {
        if wi.z > 0.0 { self.base.survival(uv, self.entering) } else { 0.0 }
    }

    fn albedo(&self, uv: Uv, wi: Vec3) -> Spectrum {
        if wi.z > 0.0 { self.base.diffuse.eval(uv) } else { Spectrum::ZERO }
    }

    fn is_connectible(&self) -> bool {
        true
    }
}
