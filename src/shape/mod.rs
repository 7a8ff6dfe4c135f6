//! Shapes: one file a model; this page is the registry, and [`ShapeModel`] the contract.
//!
//! A shape is a list of primitives (parallelograms, triangles, spheres, and curved ones, which are shapes themselves).
//! Positions are f32, relative to the
//! scene's recentring point; everything before that is f64. The f32 geometry is then exact by definition:
//! error bounds speak of rounding after it.

mod area;
mod composed;
mod cube;
mod cylinder;
mod disk;
mod flat;
mod instance;
mod mesh;
mod model;
mod obj;
mod orientation;
mod parallelogram;
mod patch;
mod placement;
mod ply;
mod ply_attributes;
mod point;
mod rectangle;
mod serialized;
mod smoke;
mod smooth;
mod sphere;
mod spherical_rectangle;

use crate::{
    description::{Object, Params, Plugin, Registry, models},
    error::Result,
    math::{Attribute, Bounds, Corners, DMat4, Vec3},
    sampling::Stream,
};
use std::collections::BTreeMap;

pub use composed::{COMPOSED, Composed};
pub use cylinder::Cylinder;
pub use disk::Disk;
pub use flat::Flat;
pub use instance::{Instance, Shared};
pub use mesh::Mesh;
pub use model::{Curved, CurvedModel, Primitive, ShapeModel};
pub use parallelogram::{Parallelogram, Parallelograms};
pub use patch::Patch;
pub use point::{Hit, Ray, SurfacePoint};
pub use smoke::{SMOKE, SMOKE_TABLE};
pub use sphere::Sphere;

/// Builds a shape from its geometry parameters and no others (materials, media and emitters remain for the scene to
/// read, which calls `finish`); the matrix takes the file's world to the scene's.
pub type BuildShape = fn(&Params<'_>, DMat4) -> Result<Shape>;

/// Makes the enum, its dispatch and the registry from one row a kind: its type, and each of its names with the module
/// that builds it and has the table of its parameters, those in [`model::COMMON`] included.
macro_rules! shapes {
    ($($model:ident: $($name:literal => $file:ident),*;)*) => {
        models! {
            /// Any shape.
            Shape: ShapeModel [$($model)*]
            #[inline] fn primitive_count() -> usize;
            #[inline] fn primitive(index: usize) -> Primitive;
            #[inline] fn surface(index: usize, ray: &Ray, hit: &Hit) -> SurfacePoint;
            fn partials(index: usize, point: &SurfacePoint) -> (Vec3, Vec3);
            fn area() -> f32;
            fn sample_area(stream: &mut Stream) -> SurfacePoint;
            fn sample_toward(reference: Vec3, stream: &mut Stream) -> (SurfacePoint, f32);
            fn pdf_area_toward(reference: Vec3, point: &SurfacePoint) -> f32;
        }

        /// All shapes.
        pub const ROWS: Registry<Plugin<BuildShape>> = Registry::new("a shape", &[
            $($(($name, Plugin {
                table: $file::TABLE,
                build: |params, world| $file::build(params, world).map(Shape::$model),
            }),)*)*
        ]);
    };
}

shapes! {
    Parallelograms: "rectangle" => rectangle, "cube" => cube;
    Sphere: "sphere" => sphere;
    Disk: "disk" => disk;
    Cylinder: "cylinder" => cylinder;
    Mesh: "obj" => obj, "ply" => ply, "serialized" => serialized;
    Instance: ;
}

/// True if `object` goes where shapes go.
pub fn is_shape(object: &Object) -> bool {
    ROWS.has(object) || COMPOSED.has(object)
}

impl Shape {
    /// True if it has an inside that no line leaves but through it.
    pub fn is_closed(&self) -> bool {
        match self {
            Self::Sphere(_) => true,
            Self::Mesh(mesh) => mesh.is_closed(),
            // A cube; a rectangle is one.
            Self::Parallelograms(faces) => faces.primitive_count() == 6,
            Self::Disk(_) | Self::Cylinder(_) | Self::Instance(_) => false,
        }
    }

    /// What closes it, flat and facing as it does; nothing where that holds no space.
    pub fn lids(&self) -> Vec<Self> {
        match self {
            Self::Cylinder(cylinder) => cylinder.lids().map(Self::Disk).into(),
            Self::Mesh(mesh) => mesh.lid().map(Self::Mesh).into_iter().collect(),
            Self::Parallelograms(_) | Self::Disk(_) | Self::Sphere(_) | Self::Instance(_) => Vec::new(),
        }
    }

    /// The colours that it has of its own.
    pub fn attributes(&self) -> &[Attribute] {
        match self {
            Self::Mesh(mesh) => mesh.attributes(),
            Self::Instance(instance) => instance.attributes(),
            _ => &[],
        }
    }

    /// Where these are looked up at `point`.
    pub fn corners(&self, point: &SurfacePoint) -> Corners {
        match self {
            Self::Mesh(mesh) => mesh.corners(point),
            Self::Instance(instance) => instance.corners(point),
            _ => Corners::default(),
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
            Self::Instance(_) => self.clone(),
        }
    }

    /// The box around it.
    pub fn bounds(&self) -> Bounds {
        let boxes = (0..self.primitive_count()).map(|index| self.primitive(index).bounds());
        boxes.fold(Bounds::EMPTY, Bounds::union)
    }
}
