//! A ray against one disk or one tube: primitives too rare for lanes of their own.

use crate::{
    math::{DVec3, Vec3, offset::SEAM},
    shape::{Disk, Hit, Ray, Tube},
};

/// A primitive and its number.
#[derive(Clone, Copy, Debug)]
pub enum Curved {
    /// An ellipse in a plane.
    Disk(Plate),
    /// The side of a cylinder.
    Tube(Tube, u32),
}

/// A disk as a plane and two reciprocal axes.
#[derive(Clone, Copy, Debug)]
pub struct Plate {
    center: Vec3,
    normal: Vec3,
    axis_u: Vec3,
    axis_v: Vec3,
    /// Greatest length of the reciprocal axes [1/m].
    reach: f32,
    primitive: u32,
}

impl Curved {
    pub(super) fn disk(primitive: u32, disk: &Disk) -> Self {
        let (u, v) = (disk.edge_u.as_dvec3(), disk.edge_v.as_dvec3());
        let cross = u.cross(v);
        let axis_u = v.cross(cross) / cross.length_squared();
        let axis_v = cross.cross(u) / cross.length_squared();
        Self::Disk(Plate {
            center: disk.center,
            normal: disk.normal,
            axis_u: axis_u.as_vec3(),
            axis_v: axis_v.as_vec3(),
            reach: axis_u.length().max(axis_v.length()) as f32,
            primitive,
        })
    }

    pub(super) fn tube(primitive: u32, tube: Tube) -> Self {
        Self::Tube(tube, primitive)
    }

    /// The nearest hit with t in (0, `t_max`).
    pub(super) fn closest(&self, ray: &Ray, t_max: f32) -> Option<Hit> {
        match self {
            Self::Disk(plate) => plate.closest(ray, t_max),
            Self::Tube(tube, primitive) => {
                let t = closest_of_tube(tube, ray, t_max)?;
                Some(Hit { t, primitive: *primitive, u: 0.0, v: 0.0 })
            }
        }
    }
}

impl Plate {
    /// As for flat packs: plane first, then the position in it relative to the centre.
    fn closest(&self, ray: &Ray, t_max: f32) -> Option<Hit> {
        let from = ray.origin - self.center;
        let t = -self.normal.dot(from) / self.normal.dot(ray.direction);
        if !(t > 0.0 && t < t_max) {
            return None;
        }
        let at = from + t * ray.direction;
        let (u, v) = (self.axis_u.dot(at), self.axis_v.dot(at));
        let limit = 1.0 + SEAM * (1.0 + self.reach * t);
        (u * u + v * v <= limit * limit).then_some(Hit { t, primitive: self.primitive, u, v })
    }
}

/// In f64, where the roots of the plain quadratic are good for every f32 ray; the nearer one between the ends.
fn closest_of_tube(tube: &Tube, ray: &Ray, t_max: f32) -> Option<f32> {
    let direction = ray.direction.as_dvec3();
    let from = ray.origin.as_dvec3() - tube.base;
    let (z, slope) = (tube.axis.dot(from), tube.axis.dot(direction));
    let roots = circle(from - tube.axis * z, direction - tube.axis * slope, tube.radius)?;
    let size = tube.length + tube.radius;
    roots.into_iter().find_map(|t| {
        let height = z + slope * t;
        let slack = f64::from(SEAM) * (size + t);
        let between = height >= -slack && height <= tube.length + slack;
        let t = t as f32;
        (between && t > 0.0 && t < t_max).then_some(t)
    })
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
