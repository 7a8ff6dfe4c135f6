//! Ray queries over all shapes: the nearest hit, occlusion, and the surface at a hit.

mod pack;
mod traversal;
mod tree;
mod widening;

use crate::{
    math::{Attribute, Bounds, Corners, Vec3},
    sampling::Stream,
    shape::{Hit, Primitive, Ray, Shape, ShapeModel, Shared, SurfacePoint},
};
use tree::{Label, Tree};

#[cfg(test)]
thread_local! {
    /// Rays that this thread has traced: tests hold their number.
    pub static RAYS: std::cell::Cell<u64> = const { std::cell::Cell::new(0) };
}

/// All shapes of a scene, ready for ray queries.
#[derive(Clone, Debug)]
pub struct Geometry {
    shapes: Vec<Shape>,
    tree: Tree,
}

impl Geometry {
    /// Shapes keep their numbers: the index in `shapes`.
    pub fn build(shapes: Vec<Shape>) -> Self {
        let mut primitives: Vec<(Label, Primitive)> = Vec::new();
        for (number, shape) in (0..).zip(&shapes) {
            primitives.extend((0..shape.primitive_count()).map(|i| ([number, i as u32], shape.primitive(i))));
        }
        let tree = Tree::build(&primitives);
        Self { shapes, tree }
    }

    /// The shapes it was built from.
    pub fn into_shapes(self) -> Vec<Shape> {
        self.shapes
    }

    /// All shapes, in order of addition.
    pub fn shapes(&self) -> &[Shape] {
        &self.shapes
    }

    /// The nearest hit with t in (0, `t_max`).
    #[inline]
    pub fn closest(&self, ray: &Ray) -> Option<Hit> {
        #[cfg(test)]
        RAYS.set(RAYS.get() + 1);
        self.tree.closest(ray)
    }

    /// True if anything is hit with t in (0, `t_max`).
    #[inline]
    pub fn occluded(&self, ray: &Ray) -> bool {
        #[cfg(test)]
        RAYS.set(RAYS.get() + 1);
        self.tree.occluded(ray)
    }

    /// All surfaces along `ray`, one after the other.
    pub fn march(&self, mut ray: Ray) -> impl Iterator<Item = SurfacePoint> {
        // A ray meets each primitive once, a sphere twice. The bound ends even a faulty loop.
        const MOST_SURFACES: usize = 10_000;
        let next = move || {
            let point = self.surface(&ray, &self.closest(&ray)?);
            let beyond = point.leaving(ray.direction);
            let t_max = ray.t_max - (beyond.origin - ray.origin).dot(ray.direction);
            ray = Ray { t_max, ..beyond };
            Some(point)
        };
        std::iter::from_fn(next).take(MOST_SURFACES)
    }

    /// The surface at `hit`, which `ray` found.
    #[inline]
    pub fn surface(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        let Hit { shape, primitive, .. } = *hit;
        let point = self.shapes[shape as usize].surface(primitive as usize, ray, hit);
        SurfacePoint { shape, ..point }
    }

    /// How position changes with the texture coordinates u and v (m) at `point`.
    pub fn partials(&self, point: &SurfacePoint) -> (Vec3, Vec3) {
        self.shapes[point.shape as usize].partials(point.primitive as usize, point)
    }

    /// The box around everything; the origin for an empty scene.
    pub fn bounds(&self) -> Bounds {
        self.tree.bounds()
    }

    /// Area of a shape (m^2).
    pub fn area(&self, shape: u32) -> f32 {
        self.shapes[shape as usize].area()
    }

    /// A point on `shape`, uniform by area: density 1 / `area` (1/m^2).
    #[inline]
    pub fn sample_area(&self, shape: u32, stream: &mut Stream) -> SurfacePoint {
        let point = self.shapes[shape as usize].sample_area(stream);
        SurfacePoint { shape, ..point }
    }

    /// Samples a point on `shape` to light `reference`, and its density per area (1/m^2); none where that is useless
    /// (the point is seen edge-on).
    pub fn sample_toward(
        &self,
        shape: u32,
        reference: Vec3,
        stream: &mut Stream,
    ) -> Option<(SurfacePoint, f32)> {
        let (point, pdf) = self.shapes[shape as usize].sample_toward(reference, stream);
        (pdf > 0.0 && pdf.is_finite()).then_some((SurfacePoint { shape, ..point }, pdf))
    }

    /// The density of `point` by `sample_toward` (1/m^2).
    pub fn pdf_area_toward(&self, shape: u32, reference: Vec3, point: &SurfacePoint) -> f32 {
        self.shapes[shape as usize].pdf_area_toward(reference, point)
    }
}

/// A geometry of a single shape, which instances share.
impl Shared for Geometry {
    fn closest(&self, ray: &Ray) -> Option<Hit> {
        self.tree.closest(ray)
    }

    fn surface(&self, ray: &Ray, primitive: u32, t: f32) -> SurfacePoint {
        let mut hit = Hit { t, shape: 0, primitive, u: 0.0, v: 0.0 };
        if let Primitive::Flat(flat) = self.shapes[0].primitive(primitive as usize) {
            let point = ray.origin.as_dvec3() + ray.direction.as_dvec3() * f64::from(t);
            [hit.u, hit.v] = flat.coordinates(point).map(|x| x as f32);
        }
        self.surface(ray, &hit)
    }

    fn partials(&self, point: &SurfacePoint) -> (Vec3, Vec3) {
        self.shapes[0].partials(point.primitive as usize, point)
    }

    fn attributes(&self) -> &[Attribute] {
        self.shapes[0].attributes()
    }

    fn corners(&self, point: &SurfacePoint) -> Corners {
        self.shapes[0].corners(point)
    }

    fn bounds(&self) -> Bounds {
        self.tree.bounds()
    }

    fn area(&self) -> f32 {
        self.shapes[0].area()
    }

    fn sample_area(&self, stream: &mut Stream) -> SurfacePoint {
        self.sample_area(0, stream)
    }
}

#[cfg(test)]
mod tests;
