//! Burley's material of many lobes: Mitsuba's `principled`.

use super::burley::{BURLEY, Look, Textures, schlick};
use super::microfacet::Microfacets;
use super::roughdielectric::{Facet, Meeting, thrown};
use super::{BsdfModel, BsdfSample, BsdfValue, Transport, bounded, index};
use crate::description::{Params, Table, table};
use crate::error::{Error, Result};
use crate::math::fresnel::Interfaces;
use crate::math::{Spectrum, Uv, Vec3, vec3, warp};
use crate::sampling::Stream;
use crate::texture::Texture;
use std::f32::consts::{PI, TAU};
use std::sync::Arc;

/// A diffuse lobe with sheen, a specular one that is a metal's or a dielectric's, which may refract, and a clear coat.
///
/// It has no physical model behind it: towards grazing angles it may give back more light than it gets.
#[derive(Clone, Debug)]
pub struct Principled(Arc<Parts>);

#[derive(Debug)]
struct Parts {
    textures: Textures,
    metallic: Texture,
    clearcoat: Texture,
    gloss: Texture,
    interfaces: Interfaces,
    /// Fresnel's reflectance of even light from outside.
    even: f32,
    /// True if light may be refracted anywhere.
    transmits: bool,
}

/// The parameters at one point of a surface.
struct Here {
    look: Look,
    metallic: f32,
    clearcoat: f32,
    facets: Microfacets,
    coat: Coat,
}

/// The facets of the clear coat (Burley 2012, sec. 5.6: GTR1).
struct Coat {
    alpha: f32,
}

/// Probabilities of the lobes for light from one side.
struct Choices {
    diffuse: f32,
    coat: f32,
    specular: f32,
    /// That the specular lobe refracts what its facets let in.
    enters: f32,
}

/// A dielectric's reflection counts this many times its light when lobes are chosen: connections find little of narrow
/// lobes.
const FAVOURED: f32 = 4.0;

/// Indices closer to 1 than this would bend light by less than a narrow lobe is wide.
const LEAST_CONTRAST: f64 = 1e-3;

/// The coat's albedo straight on: a quarter of that of an index of 1.5.
const COAT_REFLECTANCE: f32 = 0.01;

/// Roughness that masks the coat, whatever its gloss.
const COAT_MASKING: f32 = 0.25;

impl Principled {
    pub(super) const TABLE: Table = table! {
        "A material of many lobes after Burley (Disney): plastic, metal, glass, cloth, coated.";
        texture("metallic", 1.0, Is(0.0), "0: a dielectric. 1: a metal in the base colour."),
        number("specular", "", within(0.0, 10.0), Optional, "Reflectance straight on over 8 %, in place of `eta`; 0.5 if neither is given."),
        number("eta", "", index::LIMITS, Optional, "Index of refraction of the inside over that of the outside."),
        texture("clearcoat", 1.0, Is(0.0), "Strength of a second, colourless reflection."),
        texture("clearcoat_gloss", 1.0, Is(0.0), "0: the coat is satin. 1: it is glossy."),
        ignored("main_specular_sampling_rate", "lobes are sampled by the light that they reflect"),
        ignored("clearcoat_sampling_rate", "lobes are sampled by the light that they reflect"),
        ignored("diffuse_reflectance_sampling_rate", "lobes are sampled by the light that they reflect");
        BURLEY
    };

    pub(super) fn build(params: &Params<'_>) -> Result<Self> {
        let textures = Textures::build(params)?;
        let eta = eta(params, textures.transmits())?;
        let texture = |name| bounded(params, name, "");
        let others = [texture("metallic")?, texture("clearcoat")?, texture("clearcoat_gloss")?];
        Ok(Self::new(textures, others, eta))
    }

    fn new(textures: Textures, [metallic, clearcoat, gloss]: [Texture; 3], eta: f64) -> Self {
        let interfaces = Interfaces::new(eta, 1.0);
        let transmits = textures.transmits();
        let even = interfaces.outside.diffuse_reflectance() as f32;
        Self(Arc::new(Parts { textures, metallic, clearcoat, gloss, interfaces, even, transmits }))
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        let copper = Spectrum::new(0.8, 0.3, 0.1);
        let with = |base, numbers, others: [f32; 3], eta| {
            let others = others.map(|x| Texture::constant(Spectrum::splat(x)));
            Self::new(Textures::example(base, numbers), others, eta)
        };
        vec![
            with(Spectrum::splat(0.5), [0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0], 1.5),
            with(copper, [0.4, 0.6, 0.0, 0.3, 0.2, 0.5, 0.3], [0.4, 0.3, 0.5], 1.4),
            with(copper, [0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0], 1.5),
            with(copper, [0.6, 0.3, 0.8, 0.2, 0.0, 0.0, 0.0], [0.2, 0.5, 0.0], 1.5),
            with(copper, [0.7, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0], 0.7),
        ]
    }
}

/// The relative index of refraction: as given, or of the reflectance that is.
fn eta(params: &Params<'_>, transmits: bool) -> Result<f64> {
    let eta = match (params.optional_float("eta")?, params.optional_float("specular")?) {
        (Some(_), Some(_)) => {
            let expected = "either \"eta\" or \"specular\"";
            return Err(Error::new(params.location(), expected, "both", "drop one of the two"));
        }
        (Some(eta), None) => eta,
        (None, specular) => {
            let specular = specular.unwrap_or(0.5);
            // As in Mitsuba, for light to be refracted.
            let specular = if transmits && specular == 0.0 { 1e-3 } else { specular };
            2.0 / (1.0 - (0.08 * specular).sqrt()) - 1.0
        }
    };
    // As in Mitsuba for an index of 1 itself.
    Ok(if transmits && (eta - 1.0).abs() < LEAST_CONTRAST { 1.0 + LEAST_CONTRAST } else { eta })
}

impl Coat {
    /// D(m) (1/sr).
    #[inline]
    fn distribution(&self, m: Vec3) -> f32 {
        let square = self.alpha * self.alpha;
        let below = m.x * m.x + m.y * m.y + square * m.z * m.z;
        (square - 1.0) / (PI * square.ln() * below)
    }

    /// A normal, with density D(m) m.z (1/sr).
    #[inline]
    fn sample(&self, stream: &mut Stream) -> Vec3 {
        let (u, square) = (stream.square(), self.alpha * self.alpha);
        let sine_square = ((square.ln() * u.x).exp() - square) / (1.0 - square);
        warp::near_pole(warp::one_minus_cos(sine_square.clamp(0.0, 1.0)), TAU * u.y)
    }

    /// Smith's masking of `w`, z > 0, as GGX has it.
    #[inline]
    fn masking(w: Vec3) -> f32 {
        let flat = COAT_MASKING * COAT_MASKING * (w.x * w.x + w.y * w.y);
        2.0 * w.z / (w.z + (flat + w.z * w.z).sqrt())
    }

    /// Density (1/sr) of the direction that it reflects `w` to about `m`.
    #[inline]
    fn pdf(&self, w: Vec3, m: Vec3) -> f32 {
        0.25 * self.distribution(m) * m.z / w.dot(m).max(f32::MIN_POSITIVE)
    }
}

impl Here {
    /// Share of the diffuse lobe and of that of glass.
    #[inline]
    fn shares(&self) -> [f32; 2] {
        let dielectric = 1.0 - self.metallic;
        [dielectric * (1.0 - self.look.spec_trans), dielectric * self.look.spec_trans]
    }
}

impl Parts {
    fn at(&self, uv: Uv) -> Here {
        let look = self.textures.at(uv);
        let gloss = self.gloss.number(uv);
        Here {
            look,
            metallic: self.metallic.number(uv),
            clearcoat: self.clearcoat.number(uv),
            facets: look.microfacets(look.roughness),
            coat: Coat { alpha: 0.1 + (1e-3 - 0.1) * gloss },
        }
    }

    /// Probabilities of the lobes for light at signed `cosine`: by about how much each reflects.
    #[inline]
    fn choices(&self, here: &Here, cosine: f32) -> Choices {
        let [diffuse, glass] = here.shares();
        if cosine < 0.0 {
            let any = if glass > 0.0 { 1.0 } else { 0.0 };
            return Choices { diffuse: 0.0, coat: 0.0, specular: any, enters: any };
        }
        let mirrored = (FAVOURED * self.interfaces.outside.reflectance(cosine)).clamp(0.1, 1.0);
        let specular = here.metallic + glass + diffuse * mirrored;
        let coat = 0.1 * here.clearcoat;
        let matt = (here.look.base * diffuse + here.look.sheen * (0.1 * (1.0 - here.metallic))).max_element();
        let total = specular + coat + matt;
        Choices {
            diffuse: matt / total,
            coat: coat / total,
            specular: specular / total,
            enters: glass / specular,
        }
    }

    /// f and densities between two directions on the outside, but for the specular lobe.
    #[inline]
    fn matt(&self, here: &Here, [wi, wo]: [Vec3; 2], [there, back]: [&Choices; 2]) -> BsdfValue {
        let m = (wi + wo).try_normalize().unwrap_or(Vec3::Z);
        let cos_d = wo.dot(m).clamp(0.0, 1.0);
        let [diffuse, _] = here.shares();
        let mut value =
            here.look.diffuse(wi.z, wo.z, cos_d) * diffuse + here.look.sheen(cos_d) * (1.0 - here.metallic);
        let mut pdf_fwd = there.diffuse * warp::cosine_hemisphere_pdf(wo.z);
        let mut pdf_rev = back.diffuse * warp::cosine_hemisphere_pdf(wi.z);
        if here.clearcoat > 0.0 {
            let fresnel = schlick(Spectrum::splat(0.04), &self.interfaces.outside, cos_d);
            let masking = Coat::masking(wi) * Coat::masking(wo);
            value += fresnel * (0.25 * here.clearcoat * here.coat.distribution(m) * masking);
            pdf_fwd += there.coat * here.coat.pdf(wi, m);
            pdf_rev += back.coat * here.coat.pdf(wo, m);
        }
        BsdfValue { value, pdf_fwd, pdf_rev }
    }

    /// What the facets reflect of light at `cosine` to them, on the side of `wi`. As in Mitsuba, not even a metal reflects where
    /// the index is 1.
    #[inline]
    fn reflected(&self, here: &Here, is_outside: bool, fresnel: f32, cosine: f32) -> Spectrum {
        if !is_outside || fresnel == 0.0 {
            return Spectrum::splat(here.shares()[1] * fresnel);
        }
        let outside = &self.interfaces.outside;
        let metal = schlick(here.look.base, outside, cosine);
        here.look.tinted(fresnel, outside, cosine).lerp(metal, here.metallic)
    }

    /// f and densities of the specular lobe.
    #[inline]
    fn specular(
        &self,
        here: &Here,
        [wi, wo]: [Vec3; 2],
        [there, back]: [&Choices; 2],
        transport: Transport,
    ) -> Option<BsdfValue> {
        let facet = Facet::joining(&self.interfaces, wi, wo)?;
        let Meeting { fresnel, value, pdf_fwd, pdf_rev } = facet.meeting(&here.facets, transport);
        let across = (wi.z > 0.0) != (wo.z > 0.0);
        let tint = if across {
            here.look.base.map(f32::sqrt) * (here.shares()[1] * (1.0 - fresnel))
        } else {
            self.reflected(here, wi.z > 0.0, fresnel, facet.cosine())
        };
        let chance = |from: &Choices| {
            let refract = from.enters * (1.0 - fresnel);
            from.specular * if across { refract } else { 1.0 - refract }
        };
        Some(BsdfValue {
            value: tint * value,
            pdf_fwd: pdf_fwd * chance(there),
            pdf_rev: pdf_rev * chance(back),
        })
    }

    fn evaluate(&self, here: &Here, wi: Vec3, wo: Vec3, transport: Transport) -> BsdfValue {
        if wi.z == 0.0 || wo.z == 0.0 || (wi.z.min(wo.z) < 0.0 && !self.transmits) {
            return BsdfValue::ZERO;
        }
        let (there, back) = (self.choices(here, wi.z), self.choices(here, wo.z));
        let (pair, choices) = ([wi, wo], [&there, &back]);
        let specular = self.specular(here, pair, choices, transport).unwrap_or(BsdfValue::ZERO);
        if wi.z < 0.0 || wo.z < 0.0 {
            return specular;
        }
        let matt = self.matt(here, pair, choices);
        BsdfValue {
            value: specular.value + matt.value,
            pdf_fwd: specular.pdf_fwd + matt.pdf_fwd,
            pdf_rev: specular.pdf_rev + matt.pdf_rev,
        }
    }

    /// A direction of one of the lobes.
    fn sample(&self, here: &Here, wi: Vec3, stream: &mut Stream) -> Option<Vec3> {
        let choices = self.choices(here, wi.z);
        let chosen = stream.uniform();
        if chosen < choices.diffuse {
            return Some(warp::to_cosine_hemisphere(stream.square()));
        }
        let outside = &self.interfaces.outside;
        if chosen < choices.diffuse + choices.coat {
            let m = here.coat.sample(stream);
            return thrown(outside, wi, m, wi.dot(m), true).filter(|_| wi.dot(m) > 0.0);
        }
        if choices.specular == 0.0 {
            return None;
        }
        let turn = vec3(1.0, 1.0, 1f32.copysign(wi.z));
        let above = wi * turn;
        let interface = self.interfaces.seen_from(wi.z);
        let m = here.facets.sample_visible(above, stream.square());
        let cosine = above.dot(m).max(0.0);
        let refract = choices.enters * (1.0 - interface.reflectance(cosine));
        thrown(&interface, above, m, cosine, stream.uniform() >= refract).map(|wo| wo * turn)
    }

    /// Between the albedo in even light and all: walks that graze it again and again gain little weight.
    fn survival(&self, uv: Uv) -> f32 {
        let here = self.at(uv);
        let [diffuse, glass] = here.shares();
        let metal = here.look.base.lerp(Spectrum::ONE, 1.0 / 21.0) * here.metallic;
        let mirrored = Spectrum::splat(self.even * (1.0 - here.metallic));
        let through = here.look.base.map(f32::sqrt) * (glass * (1.0 - self.even));
        let coat = Spectrum::splat(COAT_REFLECTANCE * here.clearcoat);
        let even = here.look.matt() * diffuse + metal + mirrored + through + coat;
        even.max_element().min(1.0).sqrt()
    }
}

impl BsdfModel for Principled {
    // Never inlined, like all that follow: calls of the common models, which share their dispatch, stay small.
    #[inline(never)]
    fn evaluate(&self, uv: Uv, wi: Vec3, wo: Vec3, transport: Transport) -> BsdfValue {
        self.0.evaluate(&self.0.at(uv), wi, wo, transport)
    }

    #[inline(never)]
    fn sample(&self, uv: Uv, wi: Vec3, transport: Transport, stream: &mut Stream) -> Option<BsdfSample> {
        if wi.z == 0.0 || (wi.z < 0.0 && !self.0.transmits) {
            return None;
        }
        let here = self.0.at(uv);
        let wo = self.0.sample(&here, wi, stream)?;
        self.0.evaluate(&here, wi, wo, transport).sampled(wo)
    }

    #[inline(never)]
    fn survival(&self, uv: Uv, wi: Vec3) -> f32 {
        if wi.z > 0.0 || self.0.transmits { self.0.survival(uv) } else { 0.0 }
    }

    fn albedo(&self, uv: Uv, wi: Vec3) -> Spectrum {
        if wi.z > 0.0 || self.0.transmits { self.0.textures.base(uv) } else { Spectrum::ZERO }
    }

    fn is_connectible(&self) -> bool {
        true
    }

    fn scatters_across(&self) -> bool {
        self.0.transmits
    }
}
