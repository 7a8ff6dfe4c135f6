//! What a medium is like at a point.

use crate::math::Spectrum;

/// Index of a medium in its scene. Vacuum is a medium like any other, with nothing in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct MediumIndex(pub u32);

impl MediumIndex {
    /// Every scene's medium 0.
    pub const VACUUM: Self = Self(0);
}

/// The properties of a medium at a point.
#[derive(Clone, Copy, Debug)]
pub struct MediumProperties {
    /// Extinction coefficient (1/m).
    pub sigma_t: Spectrum,
    /// sigma_s / sigma_t, in [0, 1].
    pub albedo: Spectrum,
    /// The medium whose phase function scatters; one of several where media overlap.
    pub medium: MediumIndex,
}

impl MediumProperties {
    /// None.
    pub const NOTHING: Self = Self::of(Spectrum::ZERO, Spectrum::ZERO);

    /// Of a medium that has no place among others yet.
    #[inline]
    pub const fn of(sigma_t: Spectrum, albedo: Spectrum) -> Self {
        Self { sigma_t, albedo, medium: MediumIndex::VACUUM }
    }

    /// Probability that a walk goes on after a collision (LW96 eq. 8): the largest channel of the albedo.
    #[inline]
    pub fn survival(&self) -> f32 {
        self.albedo.max_element()
    }
}
