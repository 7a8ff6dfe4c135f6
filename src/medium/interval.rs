//! A part of a ray, as a medium sees it.

use crate::math::RaySegment;

/// A stretch of a ray within one medium.
#[derive(Clone, Copy, Debug)]
pub struct MediumInterval {
    /// The stretch.
    pub segment: RaySegment,
    /// Distance from the start of the medium to the stretch (m). It is 0 except behind a boundary, where a ray starts a
    /// rounding error off the surface. In a homogeneous medium it counts, for a mean free path may be as short. Where
    /// coefficients vary it does not.
    pub skipped: f32,
}

impl MediumInterval {
    /// All of `segment`, and nothing before it.
    pub fn of(segment: RaySegment) -> Self {
        Self { segment, skipped: 0.0 }
    }

    #[inline]
    pub(super) fn length(&self) -> f32 {
        self.segment.length + self.skipped
    }

    /// The same interval, stretched `by` a factor.
    #[inline]
    pub(super) fn stretched(&self, by: f32) -> Self {
        Self { segment: self.segment.stretched(by), skipped: self.skipped * by }
    }

    /// All of it, from the boundary on.
    pub(super) fn whole(&self) -> Self {
        let RaySegment { direction, .. } = self.segment;
        let origin = self.segment.at(-self.skipped);
        Self::of(RaySegment { origin, direction, length: self.length() })
    }

    /// Its first `length` metres.
    pub(super) fn up_to(&self, length: f32) -> Self {
        Self { segment: RaySegment { length, ..self.segment }, ..*self }
    }
}
