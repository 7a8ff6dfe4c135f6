//! The contract: what every shape can do, and the primitives that it is a list of.

use super::{
    cylinder::Cylinder,
    disk::Disk,
    flat::Flat,
    instance::Instance,
    patch::Patch,
    point::{Hit, Ray, SurfacePoint},
};
use crate::{
    description::{models, parameter::Parameter, rows},
    math::{Bounds, DVec3, Frame, Vec3, offset::gamma},
    sampling::Stream,
};

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
    /// As far as touching depends on it; none of an instance, which is as many faces as its mesh.
    pub fn patch(&self) -> Option<Patch> {
        Some(match self {
            Self::Flat(flat) => Patch::flat(flat),
            Self::Ball { center, radius } => {
                Patch::Ball { center: center.as_dvec3(), radius: f64::from(*radius) }
            }
            Self::Curved(Curved::Disk(disk)) => Patch::flat(&disk.square()),
            Self::Curved(Curved::Cylinder(cylinder)) => cylinder.patch(),
            Self::Curved(Curved::Instance(_)) => return None,
        })
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
    Curved: CurvedModel [Disk Cylinder Instance]
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

    /// How position changes with the texture coordinates u and v (m) at `point` of primitive `index`.
    fn partials(&self, index: usize, point: &SurfacePoint) -> (Vec3, Vec3) {
        let Frame { tangent, bitangent, .. } = point.shading;
        let Primitive::Flat(flat) = self.primitive(index) else { return (tangent, bitangent) };
        // Positions and texture coordinates both are linear in those of the primitive.
        let ray = Ray { origin: flat.corner, direction: flat.normal, t_max: 0.0 };
        let uv = |u: f32, v: f32| {
            self.surface(index, &ray, &Hit { t: 0.0, shape: 0, primitive: 0, u, v }).uv.get()
        };
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

/// What all shapes have.
pub(super) const COMMON: &[Parameter] = rows! {
    transform("to_world", "Position, orientation and size."),
    boolean("flip_normals", false, "Reverses the normals: `interior`, `exterior` and the front of an emitter change sides."),
    nested("bsdf", Optional, "The surface; default: grey diffuse, on an emitter black."),
    nested("emitter", Optional, "The emitter: `area` or `directionalarea`."),
    nested("sensor", Optional, "An `irradiancemeter`."),
    object("interior", "medium", "The medium behind the surface, against the normals."),
    object("exterior", "medium", "The medium in front of the surface, where the normals point."),
    ignored("silhouette_sampling_weight", "used for derivatives only"),
};
