//! A smooth metal: Mitsuba's `conductor`.

use super::microfacet::Roughness;
use super::roughconductor::RoughConductor;
use super::{Bsdf, BsdfModel, BsdfSample, BsdfValue, Side, Smooth, Transport, metals, mirror, reflectance};
use crate::description::{Params, Table, parameter::Parameter, rows, table};
use crate::error::{Error, Result};
use crate::math::fresnel;
use crate::math::{Spectrum, Uv, Vec3};
use crate::sampling::Stream;
use crate::texture::{self, Texture};

/// Least survival where the index varies, as the mean may say nothing about a place.
const LEAST_SURVIVAL: f32 = 0.1;

/// Reflects as Fresnel says, as a Dirac lobe; the lower side is black.
#[derive(Clone, Debug)]
pub struct Conductor {
    metal: Metal,
}

/// What smooth and rough metals share: index of refraction and tint.
#[derive(Clone, Debug)]
pub(super) struct Metal {
    eta: Texture,
    k: Texture,
    tint: Texture,
    /// Cosine-weighted mean of the reflectance over the hemisphere, by which walks survive; of the mean index where
    /// that varies.
    average: Spectrum,
}

/// No metal has more, and the square of its square is still an f32.
const LARGEST_INDEX: f64 = 1e4;

impl Metal {
    /// `eta` and `k` are relative to the outside, >= 0.
    pub(super) fn new(eta: Texture, k: Texture, tint: Texture) -> Self {
        let mean = (eta.mean(), k.mean());
        // Midpoint rule in cos^2, whose differential is 2 cos d cos.
        let steps = 256;
        let at = |i| fresnel::conductor(((i as f32 + 0.5) / steps as f32).sqrt(), mean.0, mean.1);
        let average = (0..steps).map(at).sum::<Spectrum>() / steps as f32;
        let varies = !matches!((&eta, &k), (Texture::Uniform(_), Texture::Uniform(_)));
        // A mean index of 1 reflects nothing, though what it is the mean of may.
        let least = if varies { LEAST_SURVIVAL } else { 0.0 };
        Self { eta, k, tint, average: average.max(Spectrum::splat(least)) }
    }

    pub(super) fn build(params: &Params<'_>) -> Result<Self> {
        let own = params.has("eta") || params.has("k");
        let material = Some(params.string("material")?).filter(|name| *name != "none");
        if own && material.is_some() {
            return Err(Error::new(
                params.location(),
                "either a \"material\" or \"eta\" and \"k\"",
                "both",
                "drop one of the two",
            ));
        }
        let (eta, k) = match material {
            Some(name) => {
                let (eta, k) = metals::named(params, name)?;
                (Texture::constant(eta), Texture::constant(k))
            }
            None => (texture::parameter(params, "eta")?, texture::parameter(params, "k")?),
        };
        for (name, texture) in [("eta", &eta), ("k", &k)] {
            let most = texture.max().max_element();
            if let Some(expected) = params.expected(name, f64::from(most)) {
                return Err(params.complain(name, expected, most.to_string()));
            }
        }
        Ok(Self::new(eta, k, reflectance(params, "specular_reflectance")?))
    }

    /// Tinted reflectance at `cosine` in [0, 1].
    #[inline]
    pub(super) fn reflectance(&self, uv: Uv, cosine: f32) -> Spectrum {
        self.tint.eval(uv) * fresnel::conductor(cosine.min(1.0), self.eta.eval(uv), self.k.eval(uv))
    }

    #[inline]
    pub(super) fn survival(&self, uv: Uv, wi: Vec3) -> f32 {
        if wi.z > 0.0 { (self.average * self.tint.eval(uv)).max_element().min(1.0) } else { 0.0 }
    }

    #[cfg(test)]
    pub(super) fn examples() -> [Self; 3] {
        let constant = Texture::constant;
        let tint = constant(Spectrum::new(1.0, 0.5, 0.25));
        let white = || constant(Spectrum::ONE);
        let gold = (Spectrum::new(0.143, 0.375, 1.442), Spectrum::new(3.983, 2.386, 1.603));
        [
            Self::new(constant(Spectrum::ZERO), white(), white()),
            Self::new(constant(gold.0), constant(gold.1), white()),
            Self::new(constant(Spectrum::splat(1.5)), constant(Spectrum::ZERO), tint),
        ]
    }
}

/// What metals have.
pub(super) const METAL: &[Parameter] = rows! {
    text("material", "the name of a metal", Word("none"), "A metal by name, such as Au; none is a perfect mirror."),
    index_texture("eta", LARGEST_INDEX, 0.0, "Real part of the index of refraction, in place of `material`."),
    index_texture("k", LARGEST_INDEX, 1.0, "Imaginary part of the index of refraction."),
    texture("specular_reflectance", 1.0, Is(1.0), "Scales the reflection; physically 1."),
};

impl Conductor {
    pub(super) const TABLE: Table = table! { "A polished metal."; ; METAL };

    pub(super) fn build(params: &Params<'_>) -> Result<Bsdf> {
        let metal = Metal::build(params)?;
        Ok(match params.library.soften {
            Some(alpha) => RoughConductor::of(metal, Roughness::even(alpha)).into(),
            None => Self { metal }.into(),
        })
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        Metal::examples().map(|metal| Self { metal }).to_vec()
    }
}

impl BsdfModel for Conductor {
    #[inline]
    fn evaluate(&self, _: Uv, _: Vec3, _: Vec3, _: Transport) -> BsdfValue {
        BsdfValue::ZERO
    }

    #[inline]
    fn sample(&self, uv: Uv, wi: Vec3, _: Transport, _: &mut Stream) -> Option<BsdfSample> {
        (wi.z > 0.0).then(|| BsdfSample {
            wo: mirror(wi),
            weight: self.metal.reflectance(uv, wi.z),
            pdf_fwd: 1.0,
            pdf_rev: 1.0,
            dirac: true,
        })
    }

    #[inline]
    fn survival(&self, uv: Uv, wi: Vec3) -> f32 {
        self.metal.survival(uv, wi)
    }

    fn is_connectible(&self) -> bool {
        false
    }

    fn smooth(&self) -> Option<Smooth> {
        Some(Smooth::Mirror)
    }

    fn dirac(&self, uv: Uv, wi: Vec3, side: Side, _: Transport) -> Option<(Vec3, Spectrum)> {
        (wi.z > 0.0 && side == Side::Reflected).then(|| (mirror(wi), self.metal.reflectance(uv, wi.z)))
    }
}
