//! `sphere`: centre and radius, under a transform that keeps it a sphere.

use super::{
    model::{COMMON, Primitive, ShapeModel},
    placement::{Placement, is_in_range},
    point::{Hit, Ray, SurfacePoint},
};
use crate::{
    description::{Params, Table, table},
    error::{Error, Result},
    math::{
        DMat4, DVec3, Frame, Uv, Vec3, measure,
        offset::{ON_SPHERE, gamma},
        vec3, warp,
    },
    sampling::Stream,
};
use std::f32::consts::{PI, TAU};

/// A sphere, and how it is turned (for its texture coordinates).
#[derive(Clone, Copy, Debug)]
pub struct Sphere {
    center: Vec3,
    radius: f32,
    /// Object axes in world space, unit; left-handed where the transform mirrors.
    axes: [Vec3; 3],
    /// 1 outwards, -1 inwards.
    facing: f32,
}

/// Its parameters.
pub(super) const TABLE: Table = table! {
    "An analytic sphere.";
    vector("center", "m", At([0.0; 3]), "Centre."),
    number("radius", "m", ANY, Is(1.0), "Radius, not 0; if negative, the normals face inwards.");
    COMMON
};

pub(super) fn build(params: &Params<'_>, world: DMat4) -> Result<Sphere> {
    let center = params.vector("center")?;
    let radius = params.float("radius")?;
    let mut placement = Placement::read(params, world)?;
    if radius == 0.0 {
        return Err(params.complain("radius", "a number other than 0", "0"));
    }
    placement.matrix *= DMat4::from_translation(center) * DMat4::from_scale(DVec3::splat(radius));
    Sphere::place(&placement).ok_or_else(|| {
        let expected = "a transform that keeps a sphere a sphere and that f32 can hold";
        let found = "shearing, different scales on different axes, or too large or small a scale";
        Error::new(
            params.location(),
            expected,
            found,
            "use one scale for all axes, or a mesh of an ellipsoid",
        )
    })
}

impl Sphere {
    /// The image of the unit sphere; none where that is no sphere. Mitsuba turns the normals of a mirrored
    /// sphere inwards.
    fn place(placement: &Placement) -> Option<Self> {
        // Matrices typed with six digits are meant to be rotations too.
        const TOLERANCE: f64 = 1e-5;
        let columns = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| placement.vector(axis));
        let radius = placement.matrix.determinant().abs().cbrt();
        let axes = columns.map(|c| c / radius);
        let [x, y, z] = axes;
        let uneven = axes.iter().any(|a| (a.length() - 1.0).abs() > TOLERANCE);
        let sheared = [x.dot(y), y.dot(z), z.dot(x)].iter().any(|d| d.abs() > TOLERANCE);
        let inwards = placement.is_mirrored() != placement.flip_normals;
        let sphere = Self {
            center: placement.point(DVec3::ZERO).as_vec3(),
            radius: radius as f32,
            axes: axes.map(|a| a.as_vec3()),
            facing: if inwards { -1.0 } else { 1.0 },
        };
        let fits = is_in_range(sphere.center)
            && is_in_range(Vec3::splat(sphere.radius))
            && sphere.area().is_normal();
        (fits && !uneven && !sheared).then_some(sphere)
    }

    /// The same with a radius greater by `by` (m).
    pub fn widened(&self, by: f64) -> Self {
        Self { radius: (f64::from(self.radius) + by) as f32, ..*self }
    }

    /// The surface point nearest to `p`.
    #[inline]
    pub fn point_near(&self, p: Vec3) -> SurfacePoint {
        self.point((p - self.center).normalize_or(Vec3::Z))
    }

    /// The surface point in the unit direction `out` from the centre.
    #[inline]
    fn point(&self, out: Vec3) -> SurfacePoint {
        let normal = out * self.facing;
        let local = vec3(out.dot(self.axes[0]), out.dot(self.axes[1]), out.dot(self.axes[2]));
        let along = self.axes[1] * local.x - self.axes[0] * local.y;
        SurfacePoint {
            position: self.center + out * self.radius,
            error: self.error(out),
            normal,
            shading: Frame::along(normal, along),
            uv: Uv::OnSphere(local),
            shape: 0,
            primitive: 0,
        }
    }

    /// Along the normal this adds up to the rounding of the position, of a normal that is not quite unit, and
    /// of the ray tracer's |origin - centre|^2 - radius^2.
    #[inline]
    fn error(&self, out: Vec3) -> Vec3 {
        gamma(2) * self.center.abs() + gamma(12) * self.radius * out.abs()
    }

    /// 1 - cos of the half angle of the cone that `reference` sees the sphere in; none from inside.
    fn cone(&self, reference: Vec3) -> Option<f32> {
        let squared = reference.distance_squared(self.center);
        let sine_squared = self.radius * self.radius / squared;
        (sine_squared < 1.0 - ON_SPHERE).then(|| warp::one_minus_cos(sine_squared))
    }

    /// Uniform in the cone, as a density per area (1/m^2); 0 on the far side.
    fn cone_pdf_area(&self, one_minus_cos: f32, reference: Vec3, point: &SurfacePoint) -> f32 {
        let Some((direction, _, squared)) = measure::between(point.position, reference) else { return 0.0 };
        let cosine = direction.dot(point.normal) * self.facing;
        if cosine <= 0.0 {
            return 0.0;
        }
        measure::solid_angle_to_vertex(cosine, squared) * warp::cone_pdf(one_minus_cos)
    }
}

impl ShapeModel for Sphere {
    fn primitive(&self, _: usize) -> Primitive {
        Primitive::Ball { center: self.center, radius: self.radius }
    }

    #[inline]
    fn surface(&self, _: usize, ray: &Ray, hit: &Hit) -> SurfacePoint {
        self.point_near(ray.origin + ray.direction * hit.t)
    }

    /// u runs along the parallels, v from pole to pole.
    fn partials(&self, _: usize, point: &SurfacePoint) -> (Vec3, Vec3) {
        let out = (point.position - self.center) / self.radius;
        let du = point.shading.tangent * (2.0 * PI * self.radius * (PI * point.uv.get().y).sin());
        let along = out.cross(point.shading.tangent) * (PI * self.radius);
        let further = self.point_near(point.position + along * 1e-3).uv.get().y > point.uv.get().y;
        (du, if further { along } else { -along })
    }

    fn area(&self) -> f32 {
        4.0 * PI * self.radius * self.radius
    }

    fn sample_area(&self, stream: &mut Stream) -> SurfacePoint {
        self.point(warp::to_sphere(stream.square()))
    }

    /// Uniform in the visible cone from outside, by area from inside; with its density (1/m^2).
    fn sample_toward(&self, reference: Vec3, stream: &mut Stream) -> (SurfacePoint, f32) {
        let Some(one_minus_cos) = self.cone(reference) else {
            return (self.sample_area(stream), 1.0 / self.area());
        };
        let u = stream.square();
        let to_reference = reference - self.center;
        let distance = to_reference.length();
        let h = u.x * one_minus_cos;
        let (cosine, sine_squared) = (1.0 - h, h * (2.0 - h));
        // Where the direction first hits the sphere, as an angle at its centre (pbrt-v4, 6.2.4).
        let sine_max = self.radius / distance;
        let ratio = (sine_squared / (sine_max * sine_max)).min(1.0);
        let cos_alpha = sine_squared / sine_max + cosine * (1.0 - ratio).sqrt();
        let out = warp::spherical(cos_alpha.clamp(-1.0, 1.0), TAU * u.y);
        let point = self.point(Frame::around(to_reference / distance).to_world(out));
        (point, self.cone_pdf_area(one_minus_cos, reference, &point))
    }

    fn pdf_area_toward(&self, reference: Vec3, point: &SurfacePoint) -> f32 {
        match self.cone(reference) {
            Some(one_minus_cos) => self.cone_pdf_area(one_minus_cos, reference, point),
            None => 1.0 / self.area(),
        }
    }
}
