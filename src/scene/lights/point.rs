//! The first vertex of every light path: a point of an emitter, or a direction to one at infinity.

use crate::{
    math::{Spectrum, Vec3, measure},
    shape::SurfacePoint,
};

/// A point of an emitter.
#[derive(Clone, Copy, Debug)]
pub enum EmitterPoint {
    /// Position of a point light or a spotlight.
    Point(Vec3),
    /// A point on a shape that emits.
    Surface(SurfacePoint),
    /// A point in an emissive medium.
    Volume {
        /// World position.
        position: Vec3,
        /// Rate at which camera subpaths sample emission there (1/m), see [`crate::medium::Emission::rate`].
        rate: Spectrum,
    },
    /// The unit direction towards an emitter at infinity.
    Direction(Vec3),
    /// A point of the disk that a beam leaves. Its light comes from a single direction, as from infinity: which point it
    /// is follows from where that light goes.
    Beam {
        /// World position.
        position: Vec3,
        /// The unit direction in which the light travels.
        direction: Vec3,
    },
}

impl EmitterPoint {
    /// World position; none at infinity.
    #[inline]
    pub fn position(&self) -> Option<Vec3> {
        match self {
            Self::Point(position) | Self::Volume { position, .. } | Self::Beam { position, .. } => {
                Some(*position)
            }
            Self::Surface(point) => Some(point.position),
            Self::Direction(_) => None,
        }
    }

    /// The unit direction to it from `reference`, and the squared distance, which is 1 at infinity and of a beam; none where
    /// the two are the same point.
    #[inline]
    pub fn seen_from(&self, reference: Vec3) -> Option<(Vec3, f32)> {
        let position = match self {
            Self::Direction(towards) => return Some((*towards, 1.0)),
            Self::Beam { direction, .. } => return Some((-*direction, 1.0)),
            Self::Point(position) | Self::Volume { position, .. } => *position,
            Self::Surface(point) => point.position,
        };
        measure::between(reference, position)
            .map(|(direction, _, distance_squared)| (direction, distance_squared))
    }

    /// Where a ray leaves it towards unit `direction`; none at infinity.
    #[inline]
    pub fn ray_origin(&self, direction: Vec3) -> Option<Vec3> {
        match self {
            Self::Surface(point) => Some(point.leaving(direction).origin),
            _ => self.position(),
        }
    }

    /// True at infinity.
    #[inline]
    pub fn is_infinite(&self) -> bool {
        matches!(self, Self::Direction(_))
    }

    /// True where light leaves in parallel, at infinity or not: a density per area of a disk, and no 1/d^2.
    #[inline]
    pub fn is_parallel(&self) -> bool {
        matches!(self, Self::Direction(_) | Self::Beam { .. })
    }

    /// True in an emissive medium.
    #[inline]
    pub fn is_volume(&self) -> bool {
        matches!(self, Self::Volume { .. })
    }
}
