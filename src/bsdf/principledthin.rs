//! Burley's material for leaves, paper and bubbles: Mitsuba's `principledthin`.

use super::burley::{BURLEY, Look, Textures};
use super::microfacet::Microfacets;
use super::{BsdfModel, BsdfSample, BsdfValue, Transport, bounded};
use crate::description::{Params, Table, table};
use crate::error::Result;
use crate::math::fresnel::{Interface, Interfaces};
use crate::math::{Spectrum, Uv, Vec3, vec3, warp};
use crate::sampling::Stream;
use crate::texture::Texture;
use std::f32::consts::FRAC_1_PI;
use std::sync::Arc;

/// A sheet without thickness, alike from both sides: a diffuse and a specular lobe, each reflected and transmitted.
///
/// What is transmitted specularly is a reflection turned over to the far side, by facets whose roughness depends on the index.
#[derive(Clone, Debug)]
pub struct PrincipledThin(Arc<Parts>);

#[derive(Debug)]
struct Parts {
    textures: Textures,
    eta: Texture,
    /// 0: the diffuse lobe is all reflected. 2: all transmitted.
    diff_trans: Texture,
}

/// The parameters at one point of a surface.
struct Here {
    look: Look,
    interface: Interface,
    /// Share of the diffuse lobe that is transmitted.
    diffuse_through: f32,
    reflecting: Microfacets,
    transmitting: Microfacets,
}

/// Probabilities of the four lobes, the same from both sides.
struct Choices {
    /// Diffuse, reflected and transmitted.
    diffuse: [f32; 2],
    /// Specular, the same.
    specular: [f32; 2],
}

/// The reflectance that decides how often the specular lobe is reflected: of an index of 1.5 in even light, about.
const MEAN_REFLECTANCE: f32 = 0.1;

impl PrincipledThin {
    pub(super) const TABLE: Table = table! {
        "A thin sheet after Burley (Disney): paper, leaves, cloth, bubbles.";
        index_texture("eta", 1e3, 1.5, "Index of refraction of the inside over that of the outside."),
        texture("diff_trans", 2.0, Is(0.0), "0: the diffuse lobe is reflected. 2: it is transmitted."),
        ignored("diffuse_reflectance_sampling_rate", "lobes are sampled by the light that they scatter"),
        ignored("diffuse_transmittance_sampling_rate", "lobes are sampled by the light that they scatter"),
        ignored("specular_reflectance_sampling_rate", "lobes are sampled by the light that they scatter"),
        ignored("specular_transmittance_sampling_rate", "lobes are sampled by the light that they scatter");
        BURLEY
    };

    pub(super) fn build(params: &Params<'_>) -> Result<Self> {
        Ok(Self(Arc::new(Parts {
            textures: Textures::build(params)?,
            eta: bounded(params, "eta", "")?,
            diff_trans: bounded(params, "diff_trans", "")?,
        })))
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        let green = Spectrum::new(0.2, 0.7, 0.1);
        let with = |numbers, eta, diff_trans| {
            let [eta, diff_trans] = [eta, diff_trans].map(|x| Texture::constant(Spectrum::splat(x)));
            Self(Arc::new(Parts { textures: Textures::example(green, numbers), eta, diff_trans }))
        };
        vec![
            with([0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], 1.5, 0.0),
            with([0.6, 0.5, 0.4, 0.3, 0.2, 0.5, 0.5], 1.4, 0.7),
            with([0.4, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0], 1.6, 2.0),
        ]
    }
}

impl Here {
    #[inline]
    fn choices(&self) -> Choices {
        let Look { base, sheen, spec_trans, .. } = self.look;
        let base = base.max_element();
        let (matt, through) = (1.0 - spec_trans, self.diffuse_through);
        let diffuse = [matt * (1.0 - through) * (base + 0.1 * sheen.max_element()), matt * through * base];
        let specular = [spec_trans * MEAN_REFLECTANCE, spec_trans * (1.0 - MEAN_REFLECTANCE) * base];
        let total = diffuse[0] + diffuse[1] + specular[0] + specular[1];
        let scale = if total > 0.0 { 1.0 / total } else { 0.0 };
        Choices { diffuse: diffuse.map(|x| x * scale), specular: specular.map(|x| x * scale) }
    }

    /// Between directions that are both on the upper side, or of which the second has been turned there from the lower side, of
    /// facets of normal `m`: what they scatter diffusely (f, 1/sr) ...
    #[inline]
    fn diffuse(&self, [wi, wo]: [Vec3; 2], m: Vec3, across: bool) -> Spectrum {
        let matt = 1.0 - self.look.spec_trans;
        if across {
            return self.look.base * (matt * self.diffuse_through * FRAC_1_PI);
        }
        let cos_d = wo.dot(m).clamp(0.0, 1.0);
        let lobes = self.look.diffuse(wi.z, wo.z, cos_d) + self.look.sheen(cos_d);
        lobes * (matt * (1.0 - self.diffuse_through))
    }

    /// ... and, seen from `eye`, specularly. As in Mitsuba, facets that the turned light meets from behind transmit none, which
    /// is not the same both ways.
    #[inline]
    fn specular(&self, [eye, light]: [Vec3; 2], m: Vec3, across: bool) -> Spectrum {
        let cosine = eye.dot(m).clamp(0.0, 1.0);
        let fresnel = self.interface.reflectance(cosine);
        let (facets, tint) = if across {
            (&self.transmitting, self.look.base * (1.0 - fresnel))
        } else {
            (&self.reflecting, self.look.tinted(fresnel, &self.interface, cosine))
        };
        if across && vec3(light.x, light.y, -light.z).dot(m) >= 0.0 {
            return Spectrum::ZERO;
        }
        let masking = facets.masking_over_cosine(eye) * facets.masking_over_cosine(light);
        tint * (self.look.spec_trans * 0.25 * facets.distribution(m) * masking)
    }

    fn evaluate(&self, wi: Vec3, wo: Vec3, transport: Transport) -> BsdfValue {
        if wi.z == 0.0 || wo.z == 0.0 {
            return BsdfValue::ZERO;
        }
        let across = (wi.z > 0.0) != (wo.z > 0.0);
        let [eye, light] = if transport == Transport::Radiance { [wi, wo] } else { [wo, wi] };
        // Mitsuba turns the whole sheet so that the eye is above.
        let turn = 1f32.copysign(eye.z);
        let above = |w: Vec3| vec3(w.x * turn, w.y * turn, w.z.abs());
        let (eye, light) = (above(eye), above(light));
        let Some(m) = (eye + light).try_normalize() else { return BsdfValue::ZERO };
        let (choices, side) = (self.choices(), usize::from(across));
        let facets = if across { &self.transmitting } else { &self.reflecting };
        let pdf = |from: Vec3, to: Vec3| {
            let specular = 0.25 * choices.specular[side] * facets.visible_pdf_over_cosine(above(from), m);
            choices.diffuse[side] * warp::cosine_hemisphere_pdf(to.z.abs()) + specular
        };
        BsdfValue {
            value: self.diffuse([eye, light], m, across) + self.specular([eye, light], m, across),
            pdf_fwd: pdf(wi, wo),
            pdf_rev: pdf(wo, wi),
        }
    }

    /// A direction of one of the lobes.
    fn sample(&self, wi: Vec3, stream: &mut Stream) -> Option<Vec3> {
        let Choices { diffuse, specular } = self.choices();
        let turn = vec3(1.0, 1.0, 1f32.copysign(wi.z));
        let above = wi * turn;
        let chosen = stream.uniform();
        let across = |w: Vec3, is: bool| if is { vec3(w.x, w.y, -w.z) } else { w };
        if chosen < diffuse[0] + diffuse[1] {
            let wo = warp::to_cosine_hemisphere(stream.square());
            return Some(across(wo, chosen >= diffuse[0]) * turn);
        }
        if specular[0] + specular[1] <= 0.0 {
            return None;
        }
        let through = chosen >= diffuse[0] + diffuse[1] + specular[0];
        let facets = if through { &self.transmitting } else { &self.reflecting };
        let m = facets.sample_visible(above, stream.square());
        let wo = m * (2.0 * above.dot(m)) - above;
        (wo.z > 0.0).then(|| across(wo.normalize(), through) * turn)
    }
}

impl Parts {
    fn at(&self, uv: Uv) -> Here {
        let look = self.textures.at(uv);
        let eta = self.eta.number(uv);
        Here {
            look,
            interface: Interfaces::new(f64::from(eta), 1.0).outside,
            diffuse_through: 0.5 * self.diff_trans.number(uv),
            reflecting: look.microfacets(look.roughness),
            // Burley 2015, fig. 15.
            transmitting: look.microfacets((0.65 * eta - 0.35) * look.roughness),
        }
    }
}

impl BsdfModel for PrincipledThin {
    // Never inlined, like all that follow: calls of the common models, which share their dispatch, stay small.
    #[inline(never)]
    fn evaluate(&self, uv: Uv, wi: Vec3, wo: Vec3, transport: Transport) -> BsdfValue {
        self.0.at(uv).evaluate(wi, wo, transport)
    }

    #[inline(never)]
    fn sample(&self, uv: Uv, wi: Vec3, transport: Transport, stream: &mut Stream) -> Option<BsdfSample> {
        if wi.z == 0.0 {
            return None;
        }
        let here = self.0.at(uv);
        let wo = here.sample(wi, stream)?;
        here.evaluate(wi, wo, transport).sampled(wo)
    }

    /// Between about the albedo and all: walks that graze it gain little weight.
    #[inline(never)]
    fn survival(&self, uv: Uv, _: Vec3) -> f32 {
        let look = self.0.textures.at(uv);
        let matt = look.matt() * (1.0 - look.spec_trans);
        let specular = Spectrum::splat(MEAN_REFLECTANCE) + look.base * (1.0 - MEAN_REFLECTANCE);
        (matt + specular * look.spec_trans).max_element().min(1.0).sqrt()
    }

    fn albedo(&self, uv: Uv, _: Vec3) -> Spectrum {
        self.0.textures.base(uv)
    }

    fn is_connectible(&self) -> bool {
        true
    }

    fn scatters_across(&self) -> bool {
        true
    }
}
