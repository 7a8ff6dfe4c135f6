//! A smooth metal: Mitsuba's `conductor`.

use super::fresnel;
use super::{BsdfModel, BsdfSample, BsdfValue, Transport, metals, mirror, reflectance};
use crate::description::Params;
use crate::error::{Error, Result};
use crate::math::{Spectrum, Vec2, Vec3};
use crate::sampling::Stream;
use crate::texture::Texture;

/// Reflects as Fresnel says, as a Dirac lobe; the lower side is black.
#[derive(Clone, Debug)]
pub struct Conductor {
    metal: Metal,
}

/// What smooth and rough metals share: index of refraction and tint.
#[derive(Clone, Debug)]
pub(super) struct Metal {
    eta: Spectrum,
    k: Spectrum,
    tint: Texture,
    /// The reflectance averaged over the hemisphere by cosine: what a walk survives with.
    average: Spectrum,
}

impl Metal {
    /// `eta` and `k` are relative to the outside, >= 0.
    pub(super) fn new(eta: Spectrum, k: Spectrum, tint: Texture) -> Self {
        // Midpoint rule in cos^2, whose differential is 2 cos d cos.
        let steps = 256;
        let at = |i| fresnel::conductor(((i as f32 + 0.5) / steps as f32).sqrt(), eta, k);
        let average = (0..steps).map(at).sum::<Spectrum>() / steps as f32;
        Self { eta, k, tint, average }
    }

    /// `material` (a perfect mirror where not given) or `eta` (0) and `k` (1), and `specular_reflectance`.
    pub(super) fn build(params: &Params<'_>) -> Result<Self> {
        let own = params.has("eta") || params.has("k");
        if own && params.has("material") {
            return Err(Error::new(
                params.location(),
                "either a \"material\" or \"eta\" and \"k\"",
                "both",
                "drop one of the two",
            ));
        }
        let (eta, k) = match params.optional_string("material")? {
            Some(name) if name != "none" => metals::named(params, name)?,
            _ => (params.index("eta", 0.0)?, params.index("k", 1.0)?),
        };
        Ok(Self::new(eta, k, reflectance(params, "specular_reflectance", 1.0)?))
    }

    /// Tinted reflectance at `cosine` in [0, 1].
    #[inline]
    pub(super) fn reflectance(&self, uv: Vec2, cosine: f32) -> Spectrum {
        self.tint.eval(uv) * fresnel::conductor(cosine.min(1.0), self.eta, self.k)
    }

    #[inline]
    pub(super) fn survival(&self, uv: Vec2, wi: Vec3) -> f32 {
        if wi.z > 0.0 { (self.average * self.tint.eval(uv)).max_element().min(1.0) } else { 0.0 }
    }

    #[cfg(test)]
    pub(super) fn examples() -> [Self; 3] {
        let tint = Texture::constant(Spectrum::new(1.0, 0.5, 0.25));
        let gold = (Spectrum::new(0.143, 0.375, 1.442), Spectrum::new(3.983, 2.386, 1.603));
        [
            Self::new(Spectrum::ZERO, Spectrum::ONE, Texture::constant(Spectrum::ONE)),
            Self::new(gold.0, gold.1, Texture::constant(Spectrum::ONE)),
            Self::new(Spectrum::splat(1.5), Spectrum::ZERO, tint),
        ]
    }
}

impl Conductor {
    pub(super) fn build(params: &Params<'_>) -> Result<Self> {
        Metal::build(params).map(|metal| Self { metal })
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        Metal::examples().map(|metal| Self { metal }).to_vec()
    }
}

impl BsdfModel for Conductor {
    #[inline]
    fn evaluate(&self, _: Vec2, _: Vec3, _: Vec3, _: Transport) -> BsdfValue {
        BsdfValue::ZERO
    }

    #[inline]
    fn sample(&self, uv: Vec2, wi: Vec3, _: Transport, _: &mut Stream) -> Option<BsdfSample> {
        (wi.z > 0.0).then(|| BsdfSample {
            wo: mirror(wi),
            weight: self.metal.reflectance(uv, wi.z),
            forward: 1.0,
            backward: 1.0,
            dirac: true,
        })
    }

    #[inline]
    fn survival(&self, uv: Vec2, wi: Vec3) -> f32 {
        self.metal.survival(uv, wi)
    }

    fn is_connectible(&self) -> bool {
        false
    }
}
