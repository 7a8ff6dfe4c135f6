//! Participating media: coefficients, a phase function, what they emit, and where they vary, how flights are sampled.

mod blueprint;
mod emission;
mod extinction;
mod heterogeneous;
pub mod tracker;
mod treatment;

use crate::{
    error::Result,
    math::{Spectrum, SpectrumExt},
    phase::{self, Phase},
};
pub use blueprint::{Around, Blueprint, ROWS, build};
pub use emission::Emission;
use emission::{Given, Within};
pub use extinction::Extinction;
pub use heterogeneous::Heterogeneous;
use std::sync::Arc;
pub use tracker::{Choice, Leg};
pub use treatment::Treatment;

/// Index of a medium in its scene. Vacuum is a medium like any other, with nothing in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct MediumIndex(pub u32);

impl MediumIndex {
    /// Every scene's medium 0.
    pub const VACUUM: Self = Self(0);
}

/// A medium: the same everywhere, or varying in space.
#[derive(Clone, Debug)]
pub struct Medium {
    /// Extinction coefficient, kappa in LW96 [1/m], >= 0; where it varies, a bound on it.
    pub sigma_t: Spectrum,
    /// sigma_s / sigma_t, in [0, 1]; where it varies, a bound on it.
    pub albedo: Spectrum,
    /// Directions after scattering.
    pub phase: Phase,
    /// What varies; none in a homogeneous medium, whose transmittance is exp(-sigma_t d).
    pub varying: Option<Box<Heterogeneous>>,
    /// What it emits.
    pub emission: Option<Arc<Emission>>,
    /// What that was made of, to be made anew for another time.
    given: Option<Box<(Given, Around)>>,
}

/// What a medium is made of at a point.
#[derive(Clone, Copy, Debug)]
pub struct Matter {
    /// Extinction coefficient [1/m].
    pub sigma_t: Spectrum,
    /// sigma_s / sigma_t, in [0, 1].
    pub albedo: Spectrum,
}

impl Matter {
    /// None.
    pub const NOTHING: Self = Self { sigma_t: Spectrum::ZERO, albedo: Spectrum::ZERO };

    /// Probability that a walk goes on after a collision (LW96 eq. 8): the largest channel of the albedo.
    #[inline]
    pub fn survival(&self) -> f32 {
        self.albedo.max_element()
    }
}

impl Medium {
    /// Nothing: no extinction.
    pub fn vacuum() -> Self {
        Self {
            sigma_t: Spectrum::ZERO,
            albedo: Spectrum::ZERO,
            phase: Phase::Isotropic(phase::Isotropic),
            varying: None,
            emission: None,
            given: None,
        }
    }

    /// The medium as it is at `time` [s]; none where it is the same at all times.
    pub fn at_time(&self, time: f64) -> Result<Option<Self>> {
        let varying = self.varying.as_ref().map(|varying| varying.at_time(time)).transpose()?.flatten();
        let given = self.given.as_ref().and_then(|given| given.0.at_time(time));
        if varying.is_none() && given.is_none() {
            return Ok(None);
        }
        let medium = match varying {
            Some(varying) => self.clone().with(varying),
            None => self.clone(),
        };
        let Some(before) = &self.given else { return Ok(Some(medium)) };
        medium.shining(given.unwrap_or_else(|| before.0.clone()), before.1).map(Some)
    }

    /// The medium with an emission.
    fn shining(self, given: Given, around: Around) -> Result<Self> {
        let within = match &self.varying {
            Some(varying) => varying.within(),
            None => Within::Uniform(self.matter()),
        };
        let emission = Emission::new(given.clone(), within, &around)?.map(Arc::new);
        Ok(Self { emission, given: Some(Box::new((given, around))), ..self })
    }

    /// The medium with coefficients that vary.
    fn with(self, varying: Heterogeneous) -> Self {
        let (sigma_t, albedo) = varying.bounds();
        Self { sigma_t, albedo, varying: Some(Box::new(varying)), ..self }
    }

    /// What a homogeneous medium is made of, and a bound on a varying one.
    #[inline]
    pub fn matter(&self) -> Matter {
        Matter { sigma_t: self.sigma_t, albedo: self.albedo }
    }

    /// What remains of light along an infinite way through it: 1 where it varies, for then it ends somewhere.
    #[inline]
    pub fn from_infinity(&self) -> Spectrum {
        let lane = |sigma_t: f32| if sigma_t > 0.0 && self.varying.is_none() { 0.0 } else { 1.0 };
        Spectrum::new(lane(self.sigma_t.x), lane(self.sigma_t.y), lane(self.sigma_t.z))
    }

    /// True if extinction differs between channels, so that flights need a hero channel.
    pub fn is_chromatic(&self) -> bool {
        match &self.varying {
            None => !self.sigma_t.is_grey(),
            Some(varying) => varying.is_chromatic(),
        }
    }
}
