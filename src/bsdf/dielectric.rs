//! A smooth interface between two dielectrics: Mitsuba's `dielectric`.

use super::microfacet::Roughness;
use super::roughdielectric::RoughDielectric;
use super::{Bsdf, BsdfModel, BsdfSample, BsdfValue, Side, Smooth, Transport, index, mirror, reflectance};
use crate::description::{Params, Table, parameter::Parameter, rows, table};
use crate::error::Result;
use crate::math::fresnel::{Interface, Interfaces};
use crate::math::{Spectrum, Uv, Vec3};
use crate::sampling::Stream;
use crate::texture::Texture;

/// Reflects and refracts as Fresnel says; both lobes are Dirac.
#[derive(Clone, Debug)]
pub struct Dielectric {
    pub(super) interfaces: Interfaces,
    pub(super) tints: Tints,
}

/// Factors on the reflected and the transmitted part: not physical, but Mitsuba has them.
#[derive(Clone, Debug)]
pub(super) struct Tints {
    pub(super) reflectance: Texture,
    pub(super) transmittance: Texture,
}

/// The rows of [`Tints`].
pub(super) const TINTS: &[Parameter] = rows! {
    texture("specular_reflectance", 1.0, Is(1.0), "Scales the reflection; physically 1."),
    texture("specular_transmittance", 1.0, Is(1.0), "Scales the transmission; physically 1."),
};

impl Tints {
    pub(super) fn build(params: &Params<'_>) -> Result<Self> {
        Ok(Self {
            reflectance: reflectance(params, "specular_reflectance")?,
            transmittance: reflectance(params, "specular_transmittance")?,
        })
    }

    #[inline]
    pub(super) fn at(&self, uv: Uv) -> (Spectrum, Spectrum) {
        (self.reflectance.eval(uv), self.transmittance.eval(uv))
    }

    /// The largest channel of either tint: no direction scatters more.
    #[inline]
    pub(super) fn max(&self, uv: Uv) -> f32 {
        let (reflectance, transmittance) = self.at(uv);
        reflectance.max(transmittance).max_element()
    }

    #[cfg(test)]
    pub(super) fn examples() -> [Self; 2] {
        let tints = |r, t| Self { reflectance: Texture::constant(r), transmittance: Texture::constant(t) };
        [
            tints(Spectrum::ONE, Spectrum::ONE),
            tints(Spectrum::new(0.5, 0.3, 0.0), Spectrum::new(0.2, 1.0, 0.8)),
        ]
    }
}

/// Probabilities of reflection and transmission, in proportion to the light that goes each way; none where
/// no light goes anywhere. `fresnel` is the reflected part.
#[inline]
pub(super) fn choose(fresnel: f32, reflectance: Spectrum, transmittance: Spectrum) -> Option<(f32, f32)> {
    let reflected = fresnel * reflectance.max_element();
    let transmitted = (1.0 - fresnel) * transmittance.max_element();
    let total = reflected + transmitted;
    (total > 0.0).then(|| (reflected / total, transmitted / total))
}

/// The factor on what a walk carries as it is refracted: radiance spreads over another solid angle.
#[inline]
fn compression(interface: Interface, transport: Transport) -> f32 {
    match transport {
        Transport::Radiance => 1.0 / (interface.ratio * interface.ratio),
        Transport::Importance => 1.0,
    }
}

impl Dielectric {
    pub(super) const TABLE: Table = table! {
        "Smooth glass or water: reflects and refracts.";
        index::inside("bk7"), index::OUTSIDE;
        TINTS
    };

    pub(super) fn build(params: &Params<'_>) -> Result<Bsdf> {
        let smooth = Self { interfaces: index::interfaces(params)?, tints: Tints::build(params)? };
        let rough =
            params.library.soften.and_then(|alpha| RoughDielectric::of(&smooth, Roughness::even(alpha)));
        Ok(rough.map_or_else(|| smooth.into(), Bsdf::from))
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        let pairs = [(1.5, 1.0), (1.0, 1.33), (1.0, 1.0), (1.0 + 1e-6, 1.0), (1.0, 1.0 + 1e-6), (2.4, 1.0)];
        let with = |tints: &Tints| {
            let tints = tints.clone();
            pairs.map(|(i, o)| Self { interfaces: Interfaces::new(i, o), tints: tints.clone() })
        };
        Tints::examples().iter().flat_map(with).collect()
    }
}

impl BsdfModel for Dielectric {
    #[inline]
    fn evaluate(&self, _: Uv, _: Vec3, _: Vec3, _: Transport) -> BsdfValue {
        BsdfValue::ZERO
    }

    #[inline]
    fn sample(&self, uv: Uv, wi: Vec3, transport: Transport, stream: &mut Stream) -> Option<BsdfSample> {
        if wi.z == 0.0 {
            return None;
        }
        let interface = self.interfaces.seen_from(wi.z);
        let fresnel = interface.reflectance(wi.z.abs());
        let (reflectance, transmittance) = self.tints.at(uv);
        let (reflect, transmit) = choose(fresnel, reflectance, transmittance)?;
        // Fresnel's reflectance is the same on the way back, so the probabilities are too.
        let lobe =
            |wo, weight, chance| BsdfSample { wo, weight, pdf_fwd: chance, pdf_rev: chance, dirac: true };
        if stream.uniform() < reflect {
            return Some(lobe(mirror(wi), reflectance * (fresnel / reflect), reflect));
        }
        let wo = interface.refract(wi)?;
        let compressed = compression(interface, transport) * (1.0 - fresnel);
        Some(lobe(wo, transmittance * (compressed / transmit), transmit))
    }

    #[inline]
    fn survival(&self, uv: Uv, _: Vec3) -> f32 {
        self.tints.max(uv)
    }

    fn is_connectible(&self) -> bool {
        false
    }

    fn smooth(&self) -> Option<Smooth> {
        Some(Smooth::Interface(self.interfaces.outside.ratio))
    }

    fn dirac(&self, uv: Uv, wi: Vec3, side: Side, transport: Transport) -> Option<(Vec3, Spectrum)> {
        let interface = self.interfaces.seen_from(wi.z);
        let fresnel = interface.reflectance(wi.z.abs());
        let (reflectance, transmittance) = self.tints.at(uv);
        match side {
            Side::Reflected => Some((mirror(wi), reflectance * fresnel)),
            Side::Transmitted => {
                let compressed = compression(interface, transport) * (1.0 - fresnel);
                Some((interface.refract(wi)?, transmittance * compressed))
            }
        }
    }

    fn scatters_across(&self) -> bool {
        true
    }
}
