//! Extinction that varies: a volume, a factor, and the box that it fills.

use crate::{
    math::{Channels, RaySegment, Spectrum, Vec3},
    volume::{Volume, VolumeModel},
};

/// sigma_t in space (1/m): `scale` times `volume`, nothing outside the volume and the box from `low` to `high`.
#[derive(Clone, Debug)]
pub struct Extinction {
    /// What varies.
    pub volume: Volume,
    /// A factor on it (1/m).
    pub scale: f32,
    /// The box's corner with the smallest coordinates (m).
    pub low: Vec3,
    /// The one with the largest.
    pub high: Vec3,
}

impl Extinction {
    /// sigma_t at `position` (1/m).
    #[inline]
    pub fn at<L: Channels>(&self, position: Vec3) -> L {
        let inside = position.cmpge(self.low).all() && position.cmple(self.high).all();
        if inside { self.volume.inside::<L>(position).scaled(self.scale) } else { L::splat(0.0) }
    }

    /// Optical depth along the part of `segment` from `first` to `last` (m), both within the box: by the volume's own
    /// integral, which must exist.
    #[inline]
    pub fn depth_between<L: Channels>(&self, segment: &RaySegment, first: f32, last: f32) -> L {
        let part =
            RaySegment { origin: segment.at(first), direction: segment.direction, length: last - first };
        self.volume.integral::<L>(&part).scaled(self.scale)
    }

    /// The part of `segment` within the box; none where they do not overlap.
    #[inline]
    pub fn clip(&self, segment: &RaySegment) -> Option<[f32; 2]> {
        segment.within(self.low, self.high)
    }

    /// The largest sigma_t of every channel, or a little more (1/m).
    pub fn bound(&self) -> Spectrum {
        self.volume.range(self.low, self.high)[1] * self.scale
    }
}
