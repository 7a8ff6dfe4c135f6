//! Shapes: one file a model; this page is the contract and the registry.
//!
//! A shape is a list of primitives (parallelograms, triangles, spheres, and curved ones, which are shapes themselves).
//! Positions are f32, relative to the
//! scene's recentring point; everything before that is f64. The f32 geometry is then exact by definition:
//! error bounds speak of rounding after it.

mod area;
mod cube;
mod cylinder;
mod disk;
mod flat;
mod mesh;
mod obj;
mod orientation;
mod parallelogram;
mod patch;
mod placement;
mod ply;
mod rectangle;
mod serialized;
mod smoke;
mod smooth;
mod sphere;
mod spherical_rectangle;

use crate::{
    description::{Params, Plugin, Registry, models, parameter::Parameter, rows},
    error::Result,
    math::{
        Bounds, DVec3, Frame, Uv, Vec3,
        offset::{Lift, gamma, leave_surface, side_of},
    },
    sampling::Stream,
};
use std::collections::BTreeMap;

pub use cylinder::Cylinder;
pub use disk::Disk;
pub use flat::Flat;
pub use mesh::Mesh;
pub use parallelogram::{Parallelogram, Parallelograms};
pub use patch::Patch;
pub use smoke::{SMOKE, SMOKE_TABLE};
pub use sphere::Sphere;

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
    pub uv: Uv,
    /// Which shape of the geometry, in order of addition.
    pub shape: u32,
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

/// A primitive as the ray tracer needs it.
#[derive(Clone, Debug)]
pub enum Primitive {
    /// Part of a plane.
    Flat(Flat),
    /// A whole sphere.
    Ball {
        /// Its centre.
        center: Vec3,
        /// Its radius (m).
        radius: f32,
    },
    /// One that is tested against rays by itself: too rare for lanes.
    Curved(Curved),
}

impl Primitive {
    /// As far as touching depends on it.
    pub fn patch(&self) -> Patch {
        match self {
            Self::Flat(flat) => Patch::flat(flat),
            Self::Ball { center, radius } => {
                Patch::Ball { center: center.as_dvec3(), radius: f64::from(*radius) }
            }
            Self::Curved(Curved::Disk(disk)) => Patch::flat(&disk.square()),
            Self::Curved(Curved::Cylinder(cylinder)) => cylinder.patch(),
        }
    }

    /// The box around it.
    pub fn bounds(&self) -> Bounds {
        match self {
            Self::Ball { center, radius } => Bounds::of(*center).grown(Vec3::splat(*radius)),
            Self::Curved(curved) => curved.bounds(),
            Self::Flat(flat) => {
                let Flat { corner, edge_u, edge_v, triangle, .. } = *flat;
                let (u, v) = (corner + edge_u, corner + edge_v);
                let fourth = if triangle { corner } else { u + edge_v };
                Bounds { low: corner.min(u).min(v).min(fourth), high: corner.max(u).max(v).max(fourth) }
            }
        }
    }

    /// The same around all hits, which rounding can take beyond that.
    pub fn hit_bounds(&self) -> Bounds {
        let error = match self {
            Self::Ball { center, radius } => {
                let reach = *radius + gamma(2) * (center.abs() + *radius);
                return Bounds::of(*center).grown(reach);
            }
            Self::Curved(curved) => curved.rounding(),
            Self::Flat(Flat { corner, edge_u, edge_v, .. }) => {
                gamma(3) * (corner.abs() + edge_u.abs() + edge_v.abs())
            }
        };
        self.bounds().grown(error)
    }
}

/// What every curved primitive can do.
pub trait CurvedModel {
    /// The box around it.
    fn bounds(&self) -> Bounds;

    /// How far rounding can take a hit beyond that, per axis.
    fn rounding(&self) -> Vec3;

    /// The nearest hit with t in (0, `t_max`): t, u and v of [`Hit`].
    fn closest(&self, ray: &Ray, t_max: f32) -> Option<[f32; 3]>;

    /// Distance of `p` from the surface that it is a part of (m).
    fn distance(&self, p: DVec3) -> f64;
}

models! {
    /// Any curved primitive.
    Curved: CurvedModel [Disk Cylinder]
    fn bounds() -> Bounds;
    fn rounding() -> Vec3;
    #[inline] fn closest(ray: &Ray, t_max: f32) -> Option<[f32; 3]>;
    fn distance(p: DVec3) -> f64;
}

/// What every kind of shape can do.
pub trait ShapeModel {
    /// How many primitives it has.
    fn primitive_count(&self) -> usize {
        1
    }

    /// Its primitive number `index`.
    fn primitive(&self, index: usize) -> Primitive;

    /// The surface where `ray` met primitive `index`. For flat primitives `hit.u` and `hit.v` are those of [`Flat`], for
    /// disks those of the unit disk; spheres and cylinders use `hit.t`.
    fn surface(&self, index: usize, ray: &Ray, hit: &Hit) -> SurfacePoint;

    /// How position changes with the texture coordinates u and v (m) at `point`, where `ray` met primitive `index`.
    fn partials(&self, index: usize, ray: &Ray, hit: &Hit, point: &SurfacePoint) -> (Vec3, Vec3) {
        let Frame { tangent, bitangent, .. } = point.shading;
        let Primitive::Flat(flat) = self.primitive(index) else { return (tangent, bitangent) };
        // Positions and texture coordinates both are linear in those of the primitive.
        let uv = |u: f32, v: f32| self.surface(index, ray, &Hit { u, v, ..*hit }).uv.get();
        let (along_u, along_v) = (uv(1.0, 0.0) - uv(0.0, 0.0), uv(0.0, 1.0) - uv(0.0, 0.0));
        let area = along_u.perp_dot(along_v);
        if area == 0.0 {
            return (tangent, bitangent);
        }
        let du = (flat.edge_u * along_v.y - flat.edge_v * along_u.y) / area;
        let dv = (flat.edge_v * along_u.x - flat.edge_u * along_v.x) / area;
        (du, dv)
    }

    /// Area (m^2).
    fn area(&self) -> f32;

    /// Uniform by area, density 1/area (1/m^2).
    fn sample_area(&self, stream: &mut Stream) -> SurfacePoint;

    /// A point for light to come from to `reference`, and its density (1/m^2).
    fn sample_toward(&self, _reference: Vec3, stream: &mut Stream) -> (SurfacePoint, f32) {
        (self.sample_area(stream), 1.0 / self.area())
    }

    /// Density of [`Self::sample_toward`] at `point` (1/m^2).
    fn pdf_area_toward(&self, _reference: Vec3, _point: &SurfacePoint) -> f32 {
        1.0 / self.area()
    }
}

/// Builds a shape from its geometry parameters and no others (materials, media and emitters remain for the scene to
/// read, which calls `finish`); the point `recentre` becomes the origin.
pub type BuildShape = fn(&Params<'_>, DVec3) -> Result<Shape>;

/// What all shapes have.
const COMMON: &[Parameter] = rows! {
    transform("to_world", "Position, orientation and size."),
    boolean("flip_normals", false, "Reverses the normals: `interior`, `exterior` and the front of an emitter change sides."),
    nested("bsdf", Optional, "The surface; default: grey diffuse, on an emitter black."),
    nested("emitter", Optional, "The emitter: `area` or `directionalarea`."),
    object("interior", "medium", "The medium behind the surface, against the normals."),
    object("exterior", "medium", "The medium in front of the surface, where the normals point."),
    ignored("silhouette_sampling_weight", "used for derivatives only"),
};

/// Makes the enum, its dispatch and the registry from one row a kind: its type, and each of its names with the module
/// that builds it and has the table of its parameters, those in [`COMMON`] included.
macro_rules! shapes {
    ($($model:ident: $($name:literal => $file:ident),+;)*) => {
        models! {
            /// Any shape.
            Shape: ShapeModel [$($model)*]
            #[inline] fn primitive_count() -> usize;
            #[inline] fn primitive(index: usize) -> Primitive;
            #[inline] fn surface(index: usize, ray: &Ray, hit: &Hit) -> SurfacePoint;
            fn partials(index: usize, ray: &Ray, hit: &Hit, point: &SurfacePoint) -> (Vec3, Vec3);
            fn area() -> f32;
            fn sample_area(stream: &mut Stream) -> SurfacePoint;
            fn sample_toward(reference: Vec3, stream: &mut Stream) -> (SurfacePoint, f32);
            fn pdf_area_toward(reference: Vec3, point: &SurfacePoint) -> f32;
        }

        /// All shapes.
        pub const ROWS: Registry<Plugin<BuildShape>> = Registry::new("a shape", &[
            $($(($name, Plugin {
                table: $file::TABLE,
                build: |params, recentre| $file::build(params, recentre).map(Shape::$model),
            }),)+)*
        ]);
    };
}

shapes! {
    Parallelograms: "rectangle" => rectangle, "cube" => cube;
    Sphere: "sphere" => sphere;
    Disk: "disk" => disk;
    Cylinder: "cylinder" => cylinder;
    Mesh: "obj" => obj, "ply" => ply, "serialized" => serialized;
}

impl Shape {
    /// True if it has an inside that no line leaves but through it.
    pub fn is_closed(&self) -> bool {
        match self {
            Self::Sphere(_) => true,
            Self::Mesh(mesh) => mesh.is_closed(),
            // A cube; a rectangle is one.
            Self::Parallelograms(faces) => faces.primitive_count() == 6,
            Self::Disk(_) | Self::Cylinder(_) => false,
        }
    }

    /// What closes it, flat and facing as it does; nothing where that holds no space.
    pub fn lids(&self) -> Vec<Self> {
        match self {
            Self::Cylinder(cylinder) => cylinder.lids().map(Self::Disk).into(),
            Self::Mesh(mesh) => mesh.lid().map(Self::Mesh).into_iter().collect(),
            Self::Parallelograms(_) | Self::Disk(_) | Self::Sphere(_) => Vec::new(),
        }
    }

    /// True if it bounds a solid, or the side of one.
    pub fn is_solid(&self) -> bool {
        matches!(self, Self::Cylinder(_)) || self.is_closed()
    }

    /// 1 where the normal of a primitive of a solid ([`Flat::normal`]) points away from what that holds, -1 where into it;
    /// of a mesh, if it is not inside out (see [`Self::turn`]). Round shapes count as if theirs pointed outwards.
    pub fn winding(&self, index: usize) -> f64 {
        if let Self::Parallelograms(faces) = self { faces.winding(index) } else { 1.0 }
    }

    /// -1 for a mesh that is inside out, whatever `flip_normals` says; else 1.
    pub fn turn(&self) -> f64 {
        if let Self::Mesh(mesh) = self { mesh.volume().signum() } else { 1.0 }
    }

    /// The same shape with its primitives moved along their normals, by number (m); the radius of a round one grows by
    /// that. What shares corners with those stays connected.
    pub fn displaced(&self, moves: &BTreeMap<usize, f64>) -> Self {
        let first = moves.values().next().copied().unwrap_or(0.0);
        match self {
            Self::Parallelograms(faces) => Self::Parallelograms(faces.displaced(moves)),
            Self::Mesh(mesh) => Self::Mesh(mesh.displaced(moves)),
            Self::Sphere(sphere) => Self::Sphere(sphere.widened(first)),
            Self::Cylinder(cylinder) => Self::Cylinder(cylinder.widened(first)),
            Self::Disk(disk) => Self::Disk(disk.lifted(first)),
        }
    }

    /// The box around it.
    pub fn bounds(&self) -> Bounds {
        let boxes = (0..self.primitive_count()).map(|index| self.primitive(index).bounds());
        boxes.fold(Bounds::EMPTY, Bounds::union)
    }
}

/// How a corner moves so that the planes through it, each a unit normal and a distance (m), move by these: exactly where at
/// most three are independent, else as far as the planes allow.
fn shift(planes: &[(DVec3, f64)]) -> DVec3 {
    const SWEEPS: usize = 64;
    let mut moved = DVec3::ZERO;
    for _ in 0..SWEEPS {
        for (normal, distance) in planes {
            moved += normal * (distance - normal.dot(moved));
        }
    }
    moved
}
