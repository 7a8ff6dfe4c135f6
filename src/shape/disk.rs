//! `disk`: the unit disk in the xy plane, facing +z; any affine transform makes it an ellipse.

use super::{
    flat::{Flat, flat_error},
    model::{COMMON, Curved, CurvedModel, Primitive, ShapeModel},
    placement::{Placement, is_in_range},
    point::{Hit, Ray, SurfacePoint},
};
use crate::{
    description::{Params, Table, table},
    error::{Error, Result},
    math::{
        Bounds, DMat4, DVec3, Frame, Vec2, Vec3,
        offset::{SEAM, gamma},
        vec2, warp,
    },
    sampling::Stream,
};
use std::f32::consts::{FRAC_1_PI, PI};

/// center + x `edge_u` + y `edge_v` for x^2 + y^2 <= 1.
#[derive(Clone, Copy, Debug)]
pub struct Disk {
    /// x = y = 0.
    pub center: Vec3,
    /// To x = 1.
    edge_u: Vec3,
    /// To y = 1.
    edge_v: Vec3,
    /// Unit normal, the very one that surface points report (see [`super::Flat::normal`]).
    normal: Vec3,
    /// Reciprocal to the edges: x of a point relative to the centre, and y.
    axes: [Vec3; 2],
    /// Greatest length of the reciprocal axes (1/m).
    reach: f32,
    area: f32,
}

/// Its parameters.
pub(super) const TABLE: Table = table! {
    "An analytic disk of radius 1 around the origin, facing +z."; ; COMMON
};

pub(super) fn build(params: &Params<'_>, world: DMat4) -> Result<Disk> {
    let placement = Placement::read(params, world)?;
    let disk = Disk::place(&placement);
    if disk.fits() {
        return Ok(disk);
    }
    Err(Error::new(
        params.location(),
        "a disk with finite axes and an area",
        "one that f32 coordinates cannot hold (too large, too small or too flat)",
        "correct \"to_world\"",
    ))
}

impl Disk {
    /// As in Mitsuba, a mirrored disk keeps facing where its transformed normal points.
    fn place(placement: &Placement) -> Self {
        let (edge_u, edge_v) = (placement.vector(DVec3::X), placement.vector(DVec3::Y));
        let turn = if placement.is_mirrored() != placement.flip_normals { -1.0 } else { 1.0 };
        let turn = turn * placement.handedness;
        Self::spanned(placement.point(DVec3::ZERO), edge_u, edge_v, edge_u.cross(edge_v) * turn)
    }

    /// The disk about `center` with these edges, on the side of `facing`.
    pub fn spanned(center: DVec3, edge_u: DVec3, edge_v: DVec3, facing: DVec3) -> Self {
        let (center, edge_u, edge_v) = (center.as_vec3(), edge_u.as_vec3(), edge_v.as_vec3());
        // From the rounded edges, so that the plane is that of the points.
        let cross = edge_u.as_dvec3().cross(edge_v.as_dvec3());
        let normal = (cross.normalize() * cross.dot(facing).signum()).as_vec3();
        let axes = [edge_v.as_dvec3().cross(cross), cross.cross(edge_u.as_dvec3())]
            .map(|axis| axis / cross.length_squared());
        let reach = axes[0].length().max(axes[1].length()) as f32;
        let (axes, area) = (axes.map(|axis| axis.as_vec3()), PI * cross.length() as f32);
        Self { center, edge_u, edge_v, normal, axes, reach, area }
    }

    /// f32 can hold it.
    fn fits(&self) -> bool {
        self.area.is_normal()
            && [self.center, self.edge_u, self.edge_v, self.normal].into_iter().all(is_in_range)
    }

    /// The same, moved along its normal by `by` (m).
    pub fn lifted(&self, by: f64) -> Self {
        let center = (self.center.as_dvec3() + self.normal.as_dvec3() * by).as_vec3();
        Self { center, ..*self }
    }

    /// The parallelogram around it.
    pub fn square(&self) -> Flat {
        let Self { center, edge_u, edge_v, normal, .. } = *self;
        let (corner, edge_u, edge_v) = (center - edge_u - edge_v, 2.0 * edge_u, 2.0 * edge_v);
        Flat { corner, edge_u, edge_v, normal, triangle: false }
    }

    /// The point (`x`, `y`) of the unit disk. Texture coordinates are polar: distance from the centre, and
    /// angle in turns.
    #[inline]
    pub fn point(&self, x: f32, y: f32) -> SurfacePoint {
        let (along_u, along_v) = (self.edge_u * x, self.edge_v * y);
        let turn = y.atan2(x) * (0.5 * FRAC_1_PI);
        SurfacePoint {
            position: self.center + (along_u + along_v),
            error: flat_error(self.center, along_u, along_v),
            normal: self.normal,
            shading: Frame::along(self.normal, along_u + along_v),
            uv: vec2(x.hypot(y), if turn < 0.0 { turn + 1.0 } else { turn }).into(),
            shape: 0,
            primitive: 0,
        }
    }
}

impl CurvedModel for Disk {
    fn bounds(&self) -> Bounds {
        let reach = |u: f32, v: f32| u.hypot(v);
        let (u, v) = (self.edge_u, self.edge_v);
        let half = Vec3::new(reach(u.x, v.x), reach(u.y, v.y), reach(u.z, v.z));
        Bounds::of(self.center).grown(half)
    }

    fn rounding(&self) -> Vec3 {
        gamma(5) * (self.center.abs() + self.edge_u.abs() + self.edge_v.abs())
    }

    /// As for flat packs: plane first, then the position in it relative to the centre.
    fn closest(&self, ray: &Ray, t_max: f32) -> Option<[f32; 3]> {
        let from = ray.origin - self.center;
        let t = -self.normal.dot(from) / self.normal.dot(ray.direction);
        if !(t > 0.0 && t < t_max) {
            return None;
        }
        let at = from + t * ray.direction;
        let [u, v] = self.axes.map(|axis| axis.dot(at));
        let limit = 1.0 + SEAM * (1.0 + self.reach * t);
        (u * u + v * v <= limit * limit).then_some([t, u, v])
    }

    fn distance(&self, p: DVec3) -> f64 {
        let normal = self.edge_u.as_dvec3().cross(self.edge_v.as_dvec3()).normalize();
        (p - self.center.as_dvec3()).dot(normal).abs()
    }
}

impl ShapeModel for Disk {
    fn primitive(&self, _: usize) -> Primitive {
        Primitive::Curved(Curved::Disk(*self))
    }

    #[inline]
    fn surface(&self, _: usize, _: &Ray, hit: &Hit) -> SurfacePoint {
        self.point(hit.u, hit.v)
    }

    /// u is the distance from the centre, v the angle in turns.
    fn partials(&self, _: usize, point: &SurfacePoint) -> (Vec3, Vec3) {
        let Vec2 { x: distance, y: turn } = point.uv.get();
        let (y, x) = (2.0 * PI * turn).sin_cos();
        let (x, y) = (x * distance, y * distance);
        let out = (self.edge_u * x + self.edge_v * y) / x.hypot(y).max(f32::MIN_POSITIVE);
        (out, (self.edge_v * x - self.edge_u * y) * (2.0 * PI))
    }

    fn area(&self) -> f32 {
        self.area
    }

    fn sample_area(&self, stream: &mut Stream) -> SurfacePoint {
        let at = warp::to_disk(stream.square());
        self.point(at.x, at.y)
    }
}
