//! Rays, where they meet shapes, and what surfaces are like there.

use crate::math::{
    Frame, Uv, Vec3,
    offset::{Lift, leave_surface, side_of},
};

/// A ray; t in (0, `t_max`).
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Where it starts.
    pub origin: Vec3,
    /// Unit vector.
    pub direction: Vec3,
    /// Where it ends (m), itself excluded.
    pub t_max: f32,
}

/// Where a ray met a primitive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance (m).
    pub t: f32,
    /// The number of its shape in the geometry.
    pub shape: u32,
    /// And its own in the shape.
    pub primitive: u32,
    /// First surface coordinate (see [`super::ShapeModel::surface`]).
    pub u: f32,
    /// Second surface coordinate.
    pub v: f32,
}

/// A point on a surface and what the surface is like there.
///
/// `normal` and `shading.normal` follow Mitsuba to the letter: they can point to opposite sides (a mirrored
/// rectangle or cube, a mesh whose vertex normals disagree with its winding). In Mitsuba `normal` decides
/// which medium a ray enters, `shading.normal` which side reflects and emits.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint {
    /// Where it is.
    pub position: Vec3,
    /// Bound on the rounding error of `position`, per axis (see [`crate::math::offset::leave_surface`]).
    pub error: Vec3,
    /// Geometric normal, unit.
    pub normal: Vec3,
    /// Around the interpolated shading normal; the tangent points along growing u.
    pub shading: Frame,
    /// Texture coordinates.
    pub uv: Uv<'static>,
    /// Which shape of the geometry, in order of addition.
    pub shape: u32,
    /// Which primitive of the shape; of an instance, of what it shares.
    pub primitive: u32,
}

impl SurfacePoint {
    /// The ray from here in unit `direction`, clear of the surface.
    #[inline]
    pub fn leaving(&self, direction: Vec3) -> Ray {
        let origin = leave_surface(self.position, self.error, self.normal, direction);
        Ray { origin, direction, t_max: f32::INFINITY }
    }

    /// How the end of a segment here, which comes from where unit `towards` points, keeps clear of the surface.
    #[inline]
    pub fn lift(&self, towards: Vec3) -> Lift {
        Lift::off(side_of(self.normal, towards), matches!(self.uv, Uv::OnSphere(_)))
    }

    /// The normal of the side that emits: geometric, turned to the side that the shading normal names.
    #[inline]
    pub fn front(&self) -> Vec3 {
        if self.normal.dot(self.shading.normal) < 0.0 { -self.normal } else { self.normal }
    }
}
