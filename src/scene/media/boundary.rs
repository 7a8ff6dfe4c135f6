//! The media on the two sides of shapes, and what the sides that a ray hits say about the medium it runs
//! through.

use crate::{
    math::{Vec3, vec2, warp},
    medium::MediumIndex,
    scene::{accel::Geometry, surface::Surface},
    shape::{Ray, SurfacePoint},
};

/// The media on the two sides of a shape; none where nothing is known about a side.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Boundary {
    /// Behind the surface, where the normal points away from.
    pub interior: Option<MediumIndex>,
    /// In front of the surface.
    pub exterior: Option<MediumIndex>,
}

impl Boundary {
    /// The boundary that a file states. Light that passes a surface must be in some medium behind it: if one side is
    /// stated, the other is vacuum, as in Mitsuba. Nothing passes an opaque surface, so its unstated side stays
    /// unknown.
    pub fn stated(interior: Option<MediumIndex>, exterior: Option<MediumIndex>, transmits: bool) -> Self {
        if !transmits || (interior.is_none() && exterior.is_none()) {
            return Self { interior, exterior };
        }
        let side = |stated: Option<MediumIndex>| Some(stated.unwrap_or(MediumIndex::VACUUM));
        Self { interior: side(interior), exterior: side(exterior) }
    }

    /// True if a medium is known on some side.
    pub fn is_known(&self) -> bool {
        self.interior.is_some() || self.exterior.is_some()
    }

    /// Only one of the sides is known.
    pub fn is_half_known(&self) -> bool {
        self.interior.is_some() != self.exterior.is_some()
    }

    /// The medium on the side whose directions have this `cosine` to the normal.
    #[inline]
    pub fn side(&self, cosine: f32) -> Option<MediumIndex> {
        if cosine > 0.0 { self.exterior } else { self.interior }
    }
}

/// A side of a boundary that a ray has hit.
#[derive(Clone, Copy, Debug)]
pub struct Side {
    /// The medium of the ray.
    pub medium: MediumIndex,
    /// The shape.
    pub shape: u32,
    /// Where.
    pub position: Vec3,
}

/// What a ray hits that has to do with media. Surfaces that light passes and that separate no media do not count.
#[derive(Clone, Copy, Debug)]
pub(super) enum Met {
    /// A side of which the medium is known.
    Side(Side),
    /// An opaque surface of which this side's medium is not known.
    Wall {
        /// The point.
        point: SurfacePoint,
        /// The other side's medium is known: as in Mitsuba this one's is then vacuum, unless there is evidence.
        half_known: bool,
    },
    /// Nothing up to the end of the ray.
    Nothing,
}

/// The first thing that `ray` hits. Where `through_walls`, opaque surfaces are passed if they say nothing.
pub(super) fn first(geometry: &Geometry, surfaces: &[Surface], ray: Ray, through_walls: bool) -> Met {
    let met = geometry.march(ray).find_map(|point| {
        let Surface { boundary, transmits, .. } = surfaces[point.shape as usize];
        let (shape, position) = (point.shape, point.position);
        match boundary.side(-point.normal.dot(ray.direction)) {
            Some(medium) => Some(Met::Side(Side { medium, shape, position })),
            None if transmits || through_walls => None,
            None => Some(Met::Wall { point, half_known: boundary.is_half_known() }),
        }
    });
    met.unwrap_or(Met::Nothing)
}

/// Directions of [`direction`], spread evenly over the sphere.
pub(super) const DIRECTIONS: u32 = 32;

/// Direction `index` of a golden-angle spiral.
pub(crate) fn direction(index: u32) -> Vec3 {
    let turn = (index as f32 * 0.618_034).fract();
    warp::to_sphere(vec2((index as f32 + 0.5) / DIRECTIONS as f32, turn))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_unstated_side_is_vacuum_only_where_light_gets_through() {
        let fog = Some(MediumIndex(1));
        assert_eq!(Boundary::stated(fog, None, true).exterior, Some(MediumIndex::VACUUM));
        assert_eq!(Boundary::stated(None, fog, true).interior, Some(MediumIndex::VACUUM));
        assert_eq!(Boundary::stated(fog, None, false), Boundary { interior: fog, exterior: None });
        assert_eq!(Boundary::stated(None, None, true), Boundary::default());
    }
}
