//! Shapes: one file a model; this page is the contract and the registry.
//!
//! A shape is a list of primitives (parallelograms, triangles, spheres, disks, tubes). Positions are f32, relative to the
//! scene's recentring point; everything before that is f64. The f32 geometry is then exact by definition:
//! error bounds speak of rounding after it.

mod area;
mod cube;
mod cylinder;
mod disk;
mod mesh;
mod obj;
mod parallelogram;
mod placement;
mod ply;
mod rectangle;
mod serialized;
mod smooth;
mod sphere;
mod spherical_rectangle;

use crate::{
    description::{Params, Registry},
    error::Result,
    math::{DVec3, Frame, Vec2, Vec3},
    sampling::Stream,
};

pub use cylinder::{Cylinder, Tube};
pub use disk::Disk;
pub use mesh::Mesh;
pub use parallelogram::{Parallelogram, Parallelograms};
pub use sphere::Sphere;

/// A ray; t in (0, `t_max`).
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Where it starts.
    pub origin: Vec3,
    /// Unit vector.
    pub direction: Vec3,
    /// Where it ends [m], itself excluded.
    pub t_max: f32,
}

/// Where a ray met a primitive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance [m].
    pub t: f32,
    /// Which primitive of the geometry.
    pub primitive: u32,
    /// First surface coordinate (see [`Shape::surface`]).
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
    pub uv: Vec2,
    /// Which shape of the geometry, in order of addition.
    pub shape: u32,
}

/// A primitive as the ray tracer needs it.
#[derive(Clone, Copy, Debug)]
pub enum Primitive {
    /// Part of a plane.
    Flat(Flat),
    /// A whole sphere.
    Ball {
        /// Its centre.
        center: Vec3,
        /// Its radius [m].
        radius: f32,
    },
    /// A whole ellipse in a plane.
    Disk(Disk),
    /// The side of a cylinder.
    Tube(Tube),
}

/// The points corner + u `edge_u` + v `edge_v`: u, v in [0, 1], and u + v <= 1 for a triangle.
#[derive(Clone, Copy, Debug)]
pub struct Flat {
    /// u = v = 0.
    pub corner: Vec3,
    /// To u = 1.
    pub edge_u: Vec3,
    /// To v = 1.
    pub edge_v: Vec3,
    /// Unit normal, the very one (or its opposite) that surface points report: both must agree bit for bit on
    /// which side a direction leaves to.
    pub normal: Vec3,
    /// Triangle or parallelogram.
    pub triangle: bool,
}

impl Primitive {
    /// Least and greatest corner of the box around it.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        match self {
            Self::Ball { center, radius } => (center - radius, center + radius),
            Self::Disk(disk) => disk.bounds(),
            Self::Tube(tube) => tube.bounds(),
            Self::Flat(flat) => {
                let Flat { corner, edge_u, edge_v, triangle, .. } = *flat;
                let (u, v) = (corner + edge_u, corner + edge_v);
                let fourth = if triangle { corner } else { u + edge_v };
                (corner.min(u).min(v).min(fourth), corner.max(u).max(v).max(fourth))
            }
        }
    }
}

/// Any shape.
#[derive(Clone, Debug)]
pub enum Shape {
    /// Rectangle, cube.
    Parallelograms(Parallelograms),
    /// Sphere.
    Sphere(Sphere),
    /// Disk.
    Disk(Disk),
    /// Cylinder.
    Cylinder(Cylinder),
    /// Obj, ply, serialized.
    Mesh(Mesh),
}

/// Builds a shape from its geometry parameters and no others (materials, media and emitters are the scene's); the
/// point `recentre` becomes the origin.
pub type BuildShape = fn(&Params<'_>, DVec3) -> Result<Shape>;

/// All shapes.
pub const ROWS: Registry<BuildShape> = Registry::new(
    "a shape",
    &[
        ("rectangle", rectangle::build),
        ("cube", cube::build),
        ("sphere", sphere::build),
        ("disk", disk::build),
        ("cylinder", cylinder::build),
        ("obj", obj::build),
        ("ply", ply::build),
        ("serialized", serialized::build),
    ],
);

/// Builds the shape that `params` describes. Does not call `finish`: children remain for the scene to read.
pub fn build(params: &Params<'_>, recentre: DVec3) -> Result<Shape> {
    let build = ROWS.find(params.object)?;
    params.accept_unused(&["silhouette_sampling_weight"], "it matters to derivatives only");
    build(params, recentre)
}

impl Shape {
    /// How many primitives it is made of.
    pub fn primitive_count(&self) -> usize {
        match self {
            Self::Parallelograms(p) => p.faces().len(),
            Self::Sphere(_) | Self::Disk(_) | Self::Cylinder(_) => 1,
            Self::Mesh(m) => m.triangle_count(),
        }
    }

    /// Its primitive number `index`.
    pub fn primitive(&self, index: usize) -> Primitive {
        match self {
            Self::Parallelograms(p) => Primitive::Flat(p.faces()[index].flat()),
            Self::Sphere(s) => Primitive::Ball { center: s.center(), radius: s.radius() },
            Self::Disk(d) => Primitive::Disk(*d),
            Self::Cylinder(c) => Primitive::Tube(c.tube()),
            Self::Mesh(m) => Primitive::Flat(m.flat(index)),
        }
    }

    /// Least and greatest corner of the box around it.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        let boxes = (0..self.primitive_count()).map(|index| self.primitive(index).bounds());
        boxes
            .reduce(|all, one| (all.0.min(one.0), all.1.max(one.1)))
            .unwrap_or((Vec3::INFINITY, Vec3::NEG_INFINITY))
    }

    /// The surface where `ray` met primitive `index`. For flat primitives `hit.u` and `hit.v` are those of
    /// [`Flat`], for disks those of the unit disk; spheres and cylinders use `hit.t`.
    #[inline]
    pub fn surface(&self, index: usize, ray: &Ray, hit: &Hit) -> SurfacePoint {
        match self {
            Self::Parallelograms(p) => p.faces()[index].point(hit.u, hit.v),
            Self::Sphere(s) => s.point_near(ray.origin + ray.direction * hit.t),
            Self::Disk(d) => d.point(hit.u, hit.v),
            Self::Cylinder(c) => {
                c.point_near(ray.origin.as_dvec3() + ray.direction.as_dvec3() * f64::from(hit.t))
            }
            Self::Mesh(m) => m.point(index, hit.u, hit.v),
        }
    }

    /// Area [m^2].
    pub fn area(&self) -> f32 {
        match self {
            Self::Parallelograms(p) => p.area(),
            Self::Sphere(s) => s.area(),
            Self::Disk(d) => d.area(),
            Self::Cylinder(c) => c.area(),
            Self::Mesh(m) => m.area(),
        }
    }

    /// Uniform by area, density 1/area [1/m^2].
    pub fn sample_area(&self, stream: &mut Stream) -> SurfacePoint {
        match self {
            Self::Parallelograms(p) => p.sample_area(stream),
            Self::Sphere(s) => s.sample_area(stream),
            Self::Disk(d) => d.sample_area(stream),
            Self::Cylinder(c) => c.sample_area(stream),
            Self::Mesh(m) => m.sample_area(stream),
        }
    }

    /// A point for light to come from to `reference`, and its density [1/m^2]; none where that has no use
    /// (the point is seen edge-on).
    pub fn sample_toward(&self, reference: Vec3, stream: &mut Stream) -> Option<(SurfacePoint, f32)> {
        let (point, pdf) = match self {
            Self::Parallelograms(p) => p.sample_toward(reference, stream),
            Self::Sphere(s) => s.sample_toward(reference, stream),
            Self::Disk(_) | Self::Cylinder(_) | Self::Mesh(_) => {
                (self.sample_area(stream), 1.0 / self.area())
            }
        };
        (pdf > 0.0 && pdf.is_finite()).then_some((point, pdf))
    }

    /// Density of `sample_toward` at `point` [1/m^2].
    pub fn pdf_area_toward(&self, reference: Vec3, point: &SurfacePoint) -> f32 {
        match self {
            Self::Parallelograms(p) => p.pdf_area_toward(reference, point),
            Self::Sphere(s) => s.pdf_area_toward(reference, point),
            Self::Disk(_) | Self::Cylinder(_) | Self::Mesh(_) => 1.0 / self.area(),
        }
    }
}
