//! Segments between path vertices: `flight` samples one, `passage` goes along a given one. They own distances, optical
//! depths and boundary crossings; media enter transport here and nowhere else.

pub mod flight;
pub mod forced;
pub mod passage;

pub use flight::{Flight, Flown, Landing, fly};
pub use forced::{force, sure_depth};
pub use passage::pass;

use crate::{
    math::{Lanes, Spectrum, Vec3, offset},
    scene::Scene,
    shape::{Ray, SurfacePoint},
};

/// Optical depth of a distance that may be infinite: nothing times infinity is nothing.
#[inline]
fn depth_of<L: Lanes>(sigma_t: L, distance: f32) -> L {
    if distance < f32::INFINITY {
        return sigma_t.scaled(distance);
    }
    let sigma_t = sigma_t.to_spectrum();
    let lane = |s: f32| if s > 0.0 { f32::INFINITY } else { 0.0 };
    L::from_spectrum(Spectrum::new(lane(sigma_t.x), lane(sigma_t.y), lane(sigma_t.z)))
}

/// The part of light that passes a surface point undeflected.
#[inline]
fn passed(scene: &Scene, point: &SurfacePoint, direction: Vec3, hidden: bool) -> Spectrum {
    if hidden && scene.surface(point.shape).emitter.is_some() {
        return Spectrum::ONE;
    }
    scene.null_transmission(point, direction)
}

/// The rest of a ray beyond a surface point that it crosses.
#[inline]
fn past(ray: &Ray, point: &SurfacePoint) -> Ray {
    let origin = offset::leave_surface(point.position, point.error, point.normal, ray.direction);
    let t_max = ray.t_max - (origin - ray.origin).dot(ray.direction);
    Ray { origin, direction: ray.direction, t_max }
}
