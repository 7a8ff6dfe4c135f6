//! A medium whose extinction, albedo and phase function are the same everywhere.

use crate::{
    description::Params,
    error::Result,
    math::{Spectrum, SpectrumExt},
    phase::{self, Phase},
};

/// Extinction and albedo per channel, and a phase function. Transmittance is exp(-sigma_t d), closed form.
#[derive(Clone, Debug)]
pub struct Homogeneous {
    /// Extinction coefficient, kappa in LW96 [1/m], >= 0.
    pub sigma_t: Spectrum,
    /// sigma_s / sigma_t, in [0, 1].
    pub albedo: Spectrum,
    /// Directions after scattering.
    pub phase: Phase,
}

impl Homogeneous {
    /// Nothing: no extinction.
    pub fn vacuum() -> Self {
        Self { sigma_t: Spectrum::ZERO, albedo: Spectrum::ZERO, phase: Phase::Isotropic(phase::Isotropic) }
    }

    /// Reads `sigma_t` [1/m], `albedo`, `scale` and the phase function, with Mitsuba's defaults.
    pub fn build(params: &Params<'_>) -> Result<Self> {
        let scale = params.float_within("scale", 1.0, 0.0, f64::MAX)? as f32;
        let sigma_t = params.color("sigma_t", 1.0)? * scale;
        if !sigma_t.is_finite() {
            return Err(params.complain("sigma_t", "a finite product with scale", format!("{sigma_t}")));
        }
        let albedo = params.color("albedo", 0.75)?;
        if albedo.max_element() > 1.0 {
            return Err(params.complain("albedo", "values from 0 to 1", format!("{albedo}")));
        }
        params.accept_unused(&["sample_emitters", "has_spectral_extinction"], "the scene itself decides");
        let phase = match params.children(|child| phase::is_phase(child.object))?.as_slice() {
            [] => Phase::Isotropic(phase::Isotropic),
            [one] => phase::build(one.object, params.library)?,
            [_, second, ..] => return Err(second_phase(second)),
        };
        Ok(Self { sigma_t, albedo, phase })
    }

    /// Probability that a walk goes on after a collision (LW96 eq. 8): the largest channel of the albedo.
    #[inline]
    pub fn survival(&self) -> f32 {
        self.albedo.max_element()
    }

    /// True if extinction differs between channels, so that flights need a hero channel.
    pub fn is_chromatic(&self) -> bool {
        !self.sigma_t.is_grey()
    }
}

fn second_phase(second: &crate::description::params::Child<'_>) -> crate::error::Error {
    crate::error::Error::new(
        second.location,
        "one phase function in a medium",
        "a second one",
        "blend them with a blendphase, or remove one",
    )
}
