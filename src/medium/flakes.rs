//! Extinction that depends on the direction of flight. Along a ray it is that of flakes of unit area, times the area
//! that they show. This is the same as a flight along a ray stretched by that area. Only profiles with flakes check for
//! it.

use super::{DistanceSample, MediaProfile, Medium, MediumInterval};
use crate::{
    math::{RaySegment, Spectrum, Vec3},
    phase::{Phase, Sggx},
};

impl Medium {
    /// Flakes that are the same everywhere. Others do not stretch all of a ray alike (see [`super::varying_flakes`]).
    #[inline(always)]
    fn even_flakes(&self) -> Option<&Sggx> {
        match &self.phase {
            Phase::Sggx(flakes) if !flakes.varies() => Some(flakes),
            _ => None,
        }
    }

    #[inline(always)]
    pub(super) fn has_flakes<M: MediaProfile>(&self) -> bool {
        M::FLAKES && self.depends_on_direction()
    }

    /// Factor on extinction at a world position for light in unit `direction` or back: the area that flakes show; else 1.
    #[inline(always)]
    pub fn area<M: MediaProfile>(&self, position: Vec3, direction: Vec3) -> f32 {
        match &self.phase {
            Phase::Sggx(flakes) if M::FLAKES => flakes.area_at(position, direction),
            _ => 1.0,
        }
    }

    /// The interval stretched so that its extinction is that of flakes of unit area.
    #[inline(always)]
    pub(super) fn stretched<M: MediaProfile>(&self, interval: &MediumInterval) -> MediumInterval {
        match self.even_flakes() {
            Some(flakes) if M::FLAKES => interval.stretched(flakes.area(interval.segment.direction)),
            _ => *interval,
        }
    }

    /// A sample of the `stretched` interval, converted back to metres of `interval`.
    #[inline(always)]
    pub(super) fn shrunk<M: MediaProfile>(
        &self,
        interval: &MediumInterval,
        sample: DistanceSample<M::Channels>,
    ) -> DistanceSample<M::Channels> {
        match self.even_flakes() {
            Some(flakes) if M::FLAKES => {
                let RaySegment { direction, length, .. } = interval.segment;
                let collision = sample.collision.map(|t| (t / flakes.area(direction)).min(length));
                DistanceSample { collision, ..sample }
            }
            _ => sample,
        }
    }

    /// True if extinction is not the same in all directions.
    pub fn depends_on_direction(&self) -> bool {
        matches!(self.phase, Phase::Sggx(_))
    }

    /// The greatest extinction (1/m) in any direction.
    pub fn densest(&self) -> Spectrum {
        let sigma_t = self.bound().sigma_t;
        if let Phase::Sggx(flakes) = &self.phase { sigma_t * flakes.greatest_area() } else { sigma_t }
    }

    /// The segment stretched in the same way, for any profile.
    pub(super) fn stretched_segment(&self, segment: &RaySegment) -> RaySegment {
        self.even_flakes().map_or(*segment, |flakes| segment.stretched(flakes.area(segment.direction)))
    }
}
