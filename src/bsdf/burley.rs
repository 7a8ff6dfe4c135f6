//! What Burley's materials share (Burley 2012 and 2015): the diffuse lobe with its retroreflection, the sheen, and the tint and
//! the roughness of the specular lobe.

use super::bounded;
use super::microfacet::{Kind, Microfacets};
use crate::description::{Params, parameter::Parameter, rows};
use crate::error::Result;
use crate::math::fresnel::Interface;
use crate::math::{Spectrum, SpectrumExt, Uv};
use crate::texture::Texture;
use std::f32::consts::FRAC_1_PI;

/// The least roughness of the specular lobe.
const LEAST_ALPHA: f32 = 1e-3;

/// Where both directions graze more than this, the flattened lobe, which is over the sum of their cosines, stays finite.
const LEAST_COSINES: f32 = 1e-6;

/// What both materials have.
pub(super) const BURLEY: &[Parameter] = rows! {
    texture("base_color", 1.0, Is(0.5), "The colour."),
    texture("roughness", 1.0, Is(0.5), "Square root of the roughness of the specular lobe; also strengthens retroreflection."),
    texture("anisotropic", 1.0, Is(0.0), "0: the same in all directions. Greater: highlights are longer along u."),
    texture("spec_trans", 1.0, Is(0.0), "Share of the specular lobes in what does not reflect as a metal."),
    texture("spec_tint", 1.0, Is(0.0), "Share of the base colour in the colour of reflections."),
    texture("sheen", 1.0, Is(0.0), "Strength of the lobe of cloth towards grazing angles."),
    texture("sheen_tint", 1.0, Is(0.0), "Share of the base colour in the colour of the sheen."),
    texture("flatness", 1.0, Is(0.0), "Blends the diffuse lobe with one that looks as if light scattered below the surface."),
};

/// The parameters as given.
#[derive(Clone, Debug)]
pub(super) struct Textures {
    base: Texture,
    roughness: Texture,
    anisotropic: Texture,
    spec_trans: Texture,
    spec_tint: Texture,
    sheen: Texture,
    sheen_tint: Texture,
    flatness: Texture,
}

/// The parameters at one point of a surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Look {
    pub base: Spectrum,
    /// The base colour at a luminance of 1; white where it is black.
    tint: Spectrum,
    pub roughness: f32,
    anisotropic: f32,
    pub spec_trans: f32,
    pub spec_tint: f32,
    /// Strength and colour.
    pub sheen: Spectrum,
    flatness: f32,
}

impl Textures {
    pub(super) fn build(params: &Params<'_>) -> Result<Self> {
        let texture = |name| bounded(params, name, "");
        Ok(Self {
            base: super::reflectance(params, "base_color")?,
            roughness: texture("roughness")?,
            anisotropic: texture("anisotropic")?,
            spec_trans: texture("spec_trans")?,
            spec_tint: texture("spec_tint")?,
            sheen: texture("sheen")?,
            sheen_tint: texture("sheen_tint")?,
            flatness: texture("flatness")?,
        })
    }

    pub(super) fn at(&self, uv: Uv) -> Look {
        let base = self.base.eval(uv);
        let luminance = base.luminance();
        let tint = if luminance > 0.0 { base / luminance } else { Spectrum::ONE };
        let sheen = Spectrum::ONE.lerp(tint, self.sheen_tint.number(uv)) * self.sheen.number(uv);
        Look {
            base,
            tint,
            roughness: self.roughness.number(uv),
            anisotropic: self.anisotropic.number(uv),
            spec_trans: self.spec_trans.number(uv),
            spec_tint: self.spec_tint.number(uv),
            sheen,
            flatness: self.flatness.number(uv),
        }
    }

    /// The base colour alone.
    pub(super) fn base(&self, uv: Uv) -> Spectrum {
        self.base.eval(uv)
    }

    /// True if light passes by the specular lobe anywhere.
    pub(super) fn transmits(&self) -> bool {
        self.spec_trans.max().max_element() > 0.0
    }

    #[cfg(test)]
    pub(super) fn example(base: Spectrum, numbers: [f32; 7]) -> Self {
        let [roughness, anisotropic, spec_trans, spec_tint, sheen, sheen_tint, flatness] =
            numbers.map(|x| Texture::constant(Spectrum::splat(x)));
        let base = Texture::constant(base);
        Self { base, roughness, anisotropic, spec_trans, spec_tint, sheen, sheen_tint, flatness }
    }
}

/// Schlick's (1 - cos)^5.
#[inline]
pub(super) fn weight(cosine: f32) -> f32 {
    let m = (1.0 - cosine).clamp(0.0, 1.0);
    m * m * m * m * m
}

/// Schlick's reflectance at `cosine` in [0, 1] to the near side, `least` straight on; from the denser side by the refracted
/// direction.
#[inline]
pub(super) fn schlick(least: Spectrum, interface: &Interface, cosine: f32) -> Spectrum {
    let rarer =
        if interface.is_into_denser() { cosine } else { interface.refracted_cosine(cosine).unwrap_or(0.0) };
    least.lerp(Spectrum::ONE, weight(rarer))
}

impl Look {
    /// The facets of a roughness, by this anisotropy.
    #[inline]
    pub(super) fn microfacets(&self, roughness: f32) -> Microfacets {
        let (alpha, aspect) = (roughness * roughness, (1.0 - 0.9 * self.anisotropic).sqrt());
        Microfacets::new(Kind::Ggx, (alpha / aspect).max(LEAST_ALPHA), (alpha * aspect).max(LEAST_ALPHA))
    }

    /// Reflectance of a dielectric at `cosine` to the facet, tinted by the base colour where that is wanted; `fresnel` is the
    /// untinted one.
    #[inline]
    pub(super) fn tinted(&self, fresnel: f32, interface: &Interface, cosine: f32) -> Spectrum {
        if self.spec_tint == 0.0 {
            return Spectrum::splat(fresnel);
        }
        let amplitude = (interface.ratio - 1.0) / (interface.ratio + 1.0);
        let tinted = schlick(self.tint * (amplitude * amplitude), interface, cosine);
        Spectrum::splat(fresnel).lerp(tinted, self.spec_tint)
    }

    /// f (1/sr) of the diffuse lobe between directions at these cosines > 0, at `cos_d` to the vector between.
    #[inline]
    pub(super) fn diffuse(&self, cos_i: f32, cos_o: f32, cos_d: f32) -> Spectrum {
        let (fi, fo) = (weight(cos_i), weight(cos_o));
        let retro = 2.0 * self.roughness * cos_d * cos_d;
        let lobe = (1.0 - 0.5 * fi) * (1.0 - 0.5 * fo) + retro * (fo + fi + fo * fi * (retro - 1.0));
        let shape = if self.flatness == 0.0 {
            lobe
        } else {
            let towards = |f: f32| 1.0 + (0.5 * retro - 1.0) * f;
            let flat = towards(fi) * towards(fo) * (1.0 / (cos_i + cos_o).max(LEAST_COSINES) - 0.5) + 0.5;
            lobe + (1.25 * flat - lobe) * self.flatness
        };
        self.base * (FRAC_1_PI * shape)
    }

    /// f (1/sr) of the sheen.
    #[inline]
    pub(super) fn sheen(&self, cos_d: f32) -> Spectrum {
        self.sheen * weight(cos_d)
    }

    /// About what the diffuse lobe and the sheen reflect of even light.
    #[inline]
    pub(super) fn matt(&self) -> Spectrum {
        self.base + self.sheen * 0.1
    }
}
