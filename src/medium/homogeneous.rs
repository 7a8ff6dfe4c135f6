//! A medium that is the same everywhere: optical depth is a product, and its inverse a quotient.

use super::{distance::DistanceSample, interval::MediumInterval, properties::MediumProperties};
use crate::math::{Channels, Spectrum};

/// Coefficients that are the same everywhere.
#[derive(Clone, Copy, Debug)]
pub(super) struct Homogeneous(pub MediumProperties);

impl Homogeneous {
    #[inline]
    fn sigma_t<L: Channels>(&self) -> L {
        L::from_spectrum(self.0.sigma_t)
    }

    /// Optical depth of a distance (m) that may be infinite: 0 times infinity counts as 0.
    ///
    /// LW96 eq. 7: kappa d, whose e^-(kappa d) is P_surface.
    #[inline]
    pub(super) fn optical_depth<L: Channels>(&self, distance: f32) -> L {
        if distance < f32::INFINITY {
            return self.sigma_t::<L>().scaled(distance);
        }
        let channel = |sigma_t: f32| if sigma_t > 0.0 { f32::INFINITY } else { 0.0 };
        L::from_spectrum(self.0.sigma_t.map(channel))
    }

    /// Where the `hero` channel's optical depth is `remaining` (m from the start of the medium).
    #[inline]
    pub(super) fn free_path<L: Channels>(&self, hero: usize, remaining: f32) -> f32 {
        remaining / self.sigma_t::<L>().hero(hero)
    }

    /// The same, from where the ray starts. A collision within the `skipped` distance is put at the start: nearer to
    /// the surface it might end up behind it.
    #[inline]
    pub(super) fn collision<L: Channels>(&self, skipped: f32, hero: usize, remaining: f32) -> f32 {
        let path = self.free_path::<L>(hero, remaining);
        if path < skipped { 0.0 } else { path - skipped }
    }

    /// A collision where the `hero` channel's optical depth is `remaining`, if the interval is as long.
    ///
    /// LW96 eq. 6: p_medium, inverted.
    #[inline]
    pub(super) fn sample_distance<L: Channels>(
        &self,
        interval: &MediumInterval,
        hero: usize,
        remaining: f32,
    ) -> DistanceSample<L> {
        let collision = self.collision::<L>(interval.skipped, hero, remaining);
        if collision < interval.segment.length {
            let path = self.free_path::<L>(hero, remaining);
            return DistanceSample::exact(Some(collision), self.optical_depth(path), hero);
        }
        DistanceSample::exact(None, self.optical_depth(interval.length()), hero)
    }

    /// A collision where the `hero` channel's optical depth is `remaining`, which is no more than that of the
    /// interval.
    #[inline]
    pub(super) fn force_collision<L: Channels>(
        &self,
        interval: &MediumInterval,
        hero: usize,
        remaining: f32,
    ) -> DistanceSample<L> {
        let path = self.free_path::<L>(hero, remaining);
        let depth = self.sigma_t::<L>().scaled(path);
        DistanceSample::exact(Some((path - interval.skipped).max(0.0)), depth, hero)
    }

    /// Transmittance of light from infinity through the medium.
    pub(super) fn transmittance_from_infinity(&self) -> Spectrum {
        self.0.sigma_t.map(|sigma_t| if sigma_t > 0.0 { 0.0 } else { 1.0 })
    }
}
