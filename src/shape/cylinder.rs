//! `cylinder`: the open side of a cylinder, without caps. In f64 throughout: a long thin tube has points far
//! from its axis' base whose f32 roundings would be seen on the small scale of its radius.

use super::{
    disk::Disk,
    model::{COMMON, Curved, CurvedModel, Primitive, ShapeModel},
    patch::Patch,
    placement::{Placement, is_in_range},
    point::{Hit, Ray, SurfacePoint},
};
use crate::{
    description::{Params, Table, table},
    error::{Error, Result},
    math::{
        Bounds, DMat4, DVec3, Frame, Vec3,
        offset::{SEAM, gamma},
        vec2,
    },
    sampling::Stream,
};
use std::f64::consts::TAU;

/// All points at distance `radius` from the segment `base` + z `axis`, z in [0, `length`], beside it; and how it is
/// turned (for its texture coordinates).
#[derive(Clone, Copy, Debug)]
pub struct Cylinder {
    /// z = 0.
    base: DVec3,
    /// Unit vector.
    axis: DVec3,
    /// The greatest z (m).
    length: f64,
    /// Its radius (m).
    radius: f64,
    /// Unit vectors across the axis; with it left-handed where the transform mirrors.
    across: [DVec3; 2],
    /// 1 outwards, -1 inwards.
    facing: f64,
}

/// Its parameters.
pub(super) const TABLE: Table = table! {
    "An analytic cylinder, open at both ends.";
    vector("p0", "m", At([0.0; 3]), "Start of the axis."),
    vector("p1", "m", At([0.0, 0.0, 1.0]), "End of the axis."),
    number("radius", "m", ANY, Is(1.0), "Radius, not 0.");
    COMMON
};

pub(super) fn build(params: &Params<'_>, world: DMat4) -> Result<Cylinder> {
    let p0 = params.vector("p0")?;
    let p1 = params.vector("p1")?;
    let radius = params.float("radius")?;
    let mut placement = Placement::read(params, world)?;
    if radius == 0.0 {
        return Err(params.complain("radius", "a number other than 0", "0"));
    }
    if p0 == p1 {
        return Err(params.complain("p1", "a point other than p0", format!("{p1}")));
    }
    placement.matrix *= unit_to_object(p0, p1, radius);
    Cylinder::place(&placement).ok_or_else(|| {
        let expected = "a transform that keeps a cylinder round and upright, and that f32 can hold";
        let found = "shearing, different scales across its axis, or too large or small a scale";
        let remedy = "use one scale for all axes, or a mesh of the tube";
        Error::new(params.location(), expected, found, remedy)
    })
}

/// From the unit cylinder over [0, 1] along z.
fn unit_to_object(p0: DVec3, p1: DVec3, radius: f64) -> DMat4 {
    let length = (p1 - p0).length();
    let axis = (p1 - p0) / length;
    // Mitsuba's frame, its digits completed.
    let x = Frame::around(axis.as_vec3()).tangent.as_dvec3();
    let x = (x - axis * axis.dot(x)).normalize();
    let y = axis.cross(x);
    DMat4::from_cols(
        (x * radius).extend(0.0),
        (y * radius).extend(0.0),
        (axis * length).extend(0.0),
        p0.extend(1.0),
    )
}

impl Cylinder {
    /// The image of the unit cylinder; none where that is no upright round one. Normals stay outside under
    /// mirroring, as in Mitsuba.
    fn place(placement: &Placement) -> Option<Self> {
        // Matrices typed with six digits are meant to be rotations too.
        const TOLERANCE: f64 = 1e-5;
        let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| placement.vector(axis));
        let (radius, length) = ((x.length() * y.length()).sqrt(), z.length());
        let [x, y, axis] = [x / radius, y / radius, z / length];
        let uneven = (x.length() - 1.0).abs() > TOLERANCE;
        let sheared = [x.dot(y), y.dot(axis), axis.dot(x)].iter().any(|d| d.abs() > TOLERANCE);
        let facing = if placement.flip_normals { -1.0 } else { 1.0 };
        let base = placement.point(DVec3::ZERO);
        let cylinder = Self { base, axis, length, radius, across: [x, y], facing };
        (cylinder.fits() && !uneven && !sheared).then_some(cylinder)
    }

    /// f32 can hold it.
    fn fits(&self) -> bool {
        let Bounds { low, high } = self.bounds();
        is_in_range(low) && is_in_range(high) && (self.radius as f32).is_normal() && self.area().is_normal()
    }

    /// Disks across its ends.
    pub fn lids(&self) -> [Disk; 2] {
        let Self { base, axis, length, radius, across: [x, y], .. } = *self;
        [(0.0, -self.facing), (length, self.facing)]
            .map(|(z, facing)| Disk::spanned(base + axis * z, x * radius, y * radius, axis * facing))
    }

    /// The same with a radius greater by `by` (m).
    pub fn widened(&self, by: f64) -> Self {
        Self { radius: self.radius + by, ..*self }
    }

    /// As far as touching depends on it.
    pub fn patch(&self) -> Patch {
        Patch::Tube { ends: [self.base, self.base + self.axis * self.length], radius: self.radius }
    }

    /// The surface point nearest to `p`.
    #[inline]
    pub fn point_near(&self, p: DVec3) -> SurfacePoint {
        let Self { base, axis, length, .. } = *self;
        let from = p - base;
        let z = axis.dot(from);
        let out = (from - axis * z).normalize_or(self.across[0]);
        self.point(z.clamp(0.0, length), out)
    }

    /// The surface point at height `z` (m) in the unit direction `out` from the axis.
    #[inline]
    fn point(&self, z: f64, out: DVec3) -> SurfacePoint {
        let Self { base, axis, length, radius, .. } = *self;
        let [x, y] = self.across.map(|axis| axis.dot(out));
        let turn = y.atan2(x) / TAU;
        let along_u = self.across[1] * x - self.across[0] * y;
        let normal = (out * self.facing).as_vec3();
        let position = (base + axis * z + out * radius).as_vec3();
        SurfacePoint {
            position,
            error: self.error(position, normal),
            normal,
            shading: Frame::along(normal, along_u.as_vec3()),
            uv: vec2(if turn < 0.0 { turn + 1.0 } else { turn } as f32, (z / length) as f32).into(),
            shape: 0,
            primitive: 0,
        }
    }

    /// The rounding of the position; and room for that of `normal` and of its product with a direction: a ray
    /// that grazes along the axis must not come down on the tube before its end.
    #[inline]
    fn error(&self, position: Vec3, normal: Vec3) -> Vec3 {
        let reach = (self.length + self.radius) as f32;
        gamma(2) * position.abs() + gamma(6) * reach * normal.abs()
    }
}

impl ShapeModel for Cylinder {
    fn primitive(&self, _: usize) -> Primitive {
        Primitive::Curved(Curved::Cylinder(*self))
    }

    #[inline]
    fn surface(&self, _: usize, ray: &Ray, hit: &Hit) -> SurfacePoint {
        self.point_near(ray.origin.as_dvec3() + ray.direction.as_dvec3() * f64::from(hit.t))
    }

    fn partials(&self, _: usize, point: &SurfacePoint) -> (Vec3, Vec3) {
        let around = point.shading.tangent * (TAU as f32 * self.radius as f32);
        (around, (self.axis * self.length).as_vec3())
    }

    fn area(&self) -> f32 {
        (TAU * self.radius * self.length) as f32
    }

    fn sample_area(&self, stream: &mut Stream) -> SurfacePoint {
        let at = stream.square();
        let (sin, cos) = (TAU * f64::from(at.x)).sin_cos();
        let [x, y] = self.across;
        self.point(f64::from(at.y) * self.length, x * cos + y * sin)
    }
}

impl CurvedModel for Cylinder {
    /// That of the circles at its ends.
    fn bounds(&self) -> Bounds {
        let Self { base, axis, length, radius, .. } = *self;
        let half = (DVec3::ONE - axis * axis).max(DVec3::ZERO).map(f64::sqrt) * radius;
        let end = base + axis * length;
        Bounds { low: (base.min(end) - half).as_vec3(), high: (base.max(end) + half).as_vec3() }
    }

    /// Of its corners, and the seams at its ends.
    fn rounding(&self) -> Vec3 {
        let Bounds { low, high } = self.bounds();
        gamma(2) * low.abs().max(high.abs()) + SEAM * (self.length + self.radius) as f32
    }

    /// In f64, where the roots of the plain quadratic are good for every f32 ray; the nearer one between the ends.
    fn closest(&self, ray: &Ray, t_max: f32) -> Option<[f32; 3]> {
        let Self { base, axis, length, radius, .. } = *self;
        let direction = ray.direction.as_dvec3();
        let from = ray.origin.as_dvec3() - base;
        let (z, slope) = (axis.dot(from), axis.dot(direction));
        let roots = circle(from - axis * z, direction - axis * slope, radius)?;
        roots.into_iter().find_map(|t| {
            let height = z + slope * t;
            let slack = f64::from(SEAM) * (length + radius + t);
            let between = height >= -slack && height <= length + slack;
            let t = t as f32;
            (between && t > 0.0 && t < t_max).then_some([t, 0.0, 0.0])
        })
    }

    fn distance(&self, p: DVec3) -> f64 {
        let from = p - self.base;
        ((from - self.axis * self.axis.dot(from)).length() - self.radius).abs()
    }
}

/// Where from + t along, both in a plane through the origin, is at distance `radius`: smaller t first. The
/// discriminant comes from the line's distance to the origin, and no root from a difference.
fn circle(from: DVec3, along: DVec3, radius: f64) -> Option<[f64; 2]> {
    let a = along.length_squared();
    if a == 0.0 {
        return None;
    }
    let b = -from.dot(along);
    let across = from + along * (b / a);
    let discriminant = (radius - across.length()) * (radius + across.length());
    if discriminant < 0.0 {
        return None;
    }
    let c = from.length_squared() - radius * radius;
    let q = b + (a * discriminant).sqrt().copysign(b);
    // b = 0 and a tangent: both roots are where the line is nearest.
    if q == 0.0 {
        return Some([0.0, 0.0]);
    }
    let (one, other) = (c / q, q / a);
    Some([one.min(other), one.max(other)])
}
