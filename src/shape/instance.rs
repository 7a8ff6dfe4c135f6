//! A mesh in one of many places, which all share its triangles and the hierarchy over them.

use super::{
    model::{Curved, CurvedModel, Primitive, ShapeModel},
    placement::is_in_range,
    point::{Hit, Ray, SurfacePoint},
};
use crate::{
    math::{Attribute, Bounds, Corners, DMat4, DVec3, Frame, Vec3, offset::gamma},
    sampling::Stream,
};
use std::{fmt::Debug, sync::Arc};

/// What instances share, in coordinates of its own around its middle. One call of it is made for each instance whose box
/// a ray enters, and the shapes of a scene without instances make none.
pub trait Shared: Debug + Send + Sync {
    /// The nearest hit with t in (0, `t_max`).
    fn closest(&self, ray: &Ray) -> Option<Hit>;

    /// What the surface is like where `ray` met `primitive` after `t` metres.
    fn surface(&self, ray: &Ray, primitive: u32, t: f32) -> SurfacePoint;

    /// See [`ShapeModel::partials`].
    fn partials(&self, point: &SurfacePoint) -> (Vec3, Vec3);

    /// See [`super::Shape::attributes`].
    fn attributes(&self) -> &[Attribute];

    /// See [`super::Shape::corners`].
    fn corners(&self, point: &SurfacePoint) -> Corners;

    /// The box around it.
    fn bounds(&self) -> Bounds;

    /// Area (m^2).
    fn area(&self) -> f32;

    /// A point of it, uniform by area.
    fn sample_area(&self, stream: &mut Stream) -> SurfacePoint;
}

/// One place of what is shared.
#[derive(Clone, Debug)]
pub struct Instance(Arc<Placed>);

#[derive(Debug)]
struct Placed {
    shared: Arc<dyn Shared>,
    to_world: DMat4,
    to_object: DMat4,
    /// Takes normals to the world.
    of_normals: DMat4,
    /// Around what is shared, in its own coordinates, with room for rounding.
    inner: [DVec3; 2],
    /// Around it in the world.
    outer: Bounds,
    /// How far what is computed in its own coordinates is off in the world (m).
    rounding: f32,
}

/// A ray in the coordinates of what is shared.
struct Inner {
    /// From where it enters the box: its origin is then no farther away than the box is large, and rounded as little.
    ray: Ray,
    /// Where it enters the box, on the ray in the world (m).
    start: f64,
    /// A metre of the world in these coordinates.
    scale: f64,
}

impl Inner {
    #[inline]
    fn of(origin: DVec3, along: DVec3, start: f64, t_max: f32) -> Self {
        let scale = along.length();
        let t_max = ((f64::from(t_max) - start) * scale) as f32;
        let (origin, direction) = ((origin + along * start).as_vec3(), (along / scale).as_vec3());
        Self { ray: Ray { origin, direction, t_max }, start, scale }
    }
}

impl Instance {
    /// What is `shared` where `to_world` takes it; none unless that is affine, can be undone, and stays in range.
    pub fn new(shared: Arc<dyn Shared>, to_world: DMat4) -> Option<Self> {
        let to_object = to_world.inverse();
        let Bounds { low, high } = shared.bounds();
        let extent = f64::from(low.abs().max(high.abs()).max_element());
        let room = DVec3::splat(extent * f64::from(gamma(16)));
        let inner = [low.as_dvec3() - room, high.as_dvec3() + room];
        let corner = |i: usize| DVec3::new(inner[i & 1].x, inner[i >> 1 & 1].y, inner[i >> 2].z);
        let corners = (0..8).map(|i| to_world.transform_point3(corner(i)).as_vec3());
        let outer = corners.map(Bounds::of).fold(Bounds::EMPTY, Bounds::union);
        let rounding = gamma(16) * outer.size().length();
        let is_affine = to_world.row(3) == glam::DVec4::W && to_object.is_finite();
        let fits = is_affine && is_in_range(outer.low) && is_in_range(outer.high);
        let of_normals = to_object.transpose();
        let placed = || Placed { shared, to_world, to_object, of_normals, inner, outer, rounding };
        fits.then(|| Self(Arc::new(placed())))
    }

    /// None where the ray misses the box, or ends before it.
    #[inline]
    fn inner(&self, ray: &Ray, t_max: f32) -> Option<Inner> {
        let Placed { to_object, inner, .. } = &*self.0;
        let origin = to_object.transform_point3(ray.origin.as_dvec3());
        let along = to_object.transform_vector3(ray.direction.as_dvec3());
        let start = entry(inner, origin, along);
        (start < f64::from(t_max)).then(|| Inner::of(origin, along, start, t_max))
    }

    fn to_world(&self, point: &SurfacePoint) -> SurfacePoint {
        let Placed { to_world, of_normals, rounding, .. } = &*self.0;
        let vector = |v: Vec3| to_world.transform_vector3(v.as_dvec3());
        let normal = |n: Vec3| of_normals.transform_vector3(n.as_dvec3()).normalize().as_vec3();
        let position = to_world.transform_point3(point.position.as_dvec3()).as_vec3();
        let SurfacePoint { error, .. } = *point;
        let axes = [Vec3::X * error.x, Vec3::Y * error.y, Vec3::Z * error.z];
        let error: Vec3 = axes.map(|axis| vector(axis).abs().as_vec3()).into_iter().sum();
        let tangent = vector(point.shading.tangent).normalize().as_vec3();
        SurfacePoint {
            position,
            error: error + gamma(2) * position.abs() + *rounding,
            normal: normal(point.normal),
            shading: Frame::along(normal(point.shading.normal), tangent),
            ..*point
        }
    }

    /// A point of it as what is shared has it.
    fn to_object(&self, point: &SurfacePoint) -> SurfacePoint {
        let Placed { to_world, to_object, .. } = &*self.0;
        let normal = |n: Vec3| to_world.transpose().transform_vector3(n.as_dvec3()).normalize().as_vec3();
        let tangent = to_object.transform_vector3(point.shading.tangent.as_dvec3()).normalize().as_vec3();
        SurfacePoint {
            position: to_object.transform_point3(point.position.as_dvec3()).as_vec3(),
            normal: normal(point.normal),
            shading: Frame::along(normal(point.shading.normal), tangent),
            ..*point
        }
    }

    /// The colours of what is shared.
    pub fn attributes(&self) -> &[Attribute] {
        self.0.shared.attributes()
    }

    /// Where these are looked up at `point`.
    pub fn corners(&self, point: &SurfacePoint) -> Corners {
        self.0.shared.corners(&self.to_object(point))
    }
}

/// How many times `along` a ray goes from `origin` to a box, 0 from inside of it; infinite where it does not.
fn entry(corners: &[DVec3; 2], origin: DVec3, along: DVec3) -> f64 {
    // A component of 0 would make 0 times infinity of a corner in the ray's plane.
    let inverse = along.abs().max(DVec3::splat(1e-200)).copysign(along).recip();
    let [a, b] = corners.map(|corner| (corner - origin) * inverse);
    let near = a.min(b).max_element().max(0.0);
    if near <= a.max(b).min_element() { near } else { f64::INFINITY }
}

impl CurvedModel for Instance {
    fn bounds(&self) -> Bounds {
        self.0.outer
    }

    fn rounding(&self) -> Vec3 {
        Vec3::splat(self.0.rounding)
    }

    /// In place of u there are the bits of the number of the primitive that was hit.
    fn closest(&self, ray: &Ray, t_max: f32) -> Option<[f32; 3]> {
        let Inner { ray, start, scale } = self.inner(ray, t_max)?;
        let hit = self.0.shared.closest(&ray)?;
        let t = (start + f64::from(hit.t) / scale) as f32;
        (t > 0.0 && t < t_max).then_some([t, f32::from_bits(hit.primitive), 0.0])
    }

    /// No more than that: from the box.
    fn distance(&self, p: DVec3) -> f64 {
        let Bounds { low, high } = self.0.outer;
        p.distance(p.clamp(low.as_dvec3(), high.as_dvec3()))
    }
}

impl ShapeModel for Instance {
    fn primitive(&self, _: usize) -> Primitive {
        Primitive::Curved(Curved::Instance(self.clone()))
    }

    fn surface(&self, _: usize, ray: &Ray, hit: &Hit) -> SurfacePoint {
        // The ray hits, so that it enters the box: at the same place as then.
        let whole = || Inner::of(DVec3::ZERO, DVec3::ONE, 0.0, 0.0);
        let Inner { ray, start, scale } = self.inner(ray, f32::INFINITY).unwrap_or_else(whole);
        let t = ((f64::from(hit.t) - start) * scale) as f32;
        self.to_world(&self.0.shared.surface(&ray, hit.u.to_bits(), t))
    }

    fn partials(&self, _: usize, point: &SurfacePoint) -> (Vec3, Vec3) {
        let (u, v) = self.0.shared.partials(&self.to_object(point));
        let along = |partial: Vec3| self.0.to_world.transform_vector3(partial.as_dvec3()).as_vec3();
        (along(u), along(v))
    }

    /// Right where one scale counts for all axes; no emitter lies on an instance.
    fn area(&self) -> f32 {
        let scale = self.0.to_world.determinant().abs().powf(2.0 / 3.0);
        (f64::from(self.0.shared.area()) * scale) as f32
    }

    fn sample_area(&self, stream: &mut Stream) -> SurfacePoint {
        self.to_world(&self.0.shared.sample_area(stream))
    }
}
