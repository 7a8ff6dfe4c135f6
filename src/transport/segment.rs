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

/// The rest of a ray beyond a surface point that it crosses, and how far beyond the surface it starts [m]: what was
/// skipped to be clear of the surface still counts as way through a homogeneous medium there. In media whose mean free
/// path is some hundreds of rounding errors, light would otherwise always start too deep.
#[inline]
fn past(ray: &Ray, point: &SurfacePoint) -> (Ray, f32) {
    let origin = offset::leave_surface(point.position, point.error, point.normal, ray.direction);
    let t_max = ray.t_max - (origin - ray.origin).dot(ray.direction);
    let skipped = (origin - point.position).dot(ray.direction).max(0.0);
    (Ray { origin, direction: ray.direction, t_max }, skipped)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        sampling::{Stream, stream::Purpose},
        scene::build::Setup,
        transport::{profile::Bounded, twin::scenes},
    };

    /// A cube of the mean free path 1e-6, its face one metre from the camera, which is the origin: 16 steps of what
    /// single precision can tell there.
    fn dense() -> Setup {
        let sensor = r#""sensor": {"type": "perspective", "near_clip": 1e-3, "to_world":
            [{"type": "lookat", "origin": [0, 0, 2], "target": [0, 0, 0], "up": [0, 1, 0]}]}"#;
        let cube = r#""cube": {"type": "cube", "bsdf": {"type": "null"}, "interior":
            {"type": "homogeneous", "sigma_t": 1e6}}"#;
        scenes::build(&[sensor, cube, r#""sky": {"type": "constant"}"#])
    }

    const INTO: Ray = Ray { origin: Vec3::ZERO, direction: Vec3::NEG_Z, t_max: f32::INFINITY };

    #[test]
    fn what_is_skipped_behind_a_boundary_counts_as_way() {
        let Setup { scene, .. } = &dense();
        const FLIGHTS: u64 = 20_000;
        let mut sum = 0.0;
        for index in 0..FLIGHTS {
            let mut stream = Stream::new(3, index, 0, Purpose::Study);
            let outside = scene.sensor_medium;
            let flight = fly::<Bounded>(scene, INTO, outside, false, 0, &mut stream, &mut |_, _| ());
            let Landing::Medium(position, _) = flight.landing else { panic!("{flight:?}") };
            assert!(position.z < -1.0, "a collision before the boundary");
            sum += f64::from(-1.0 - position.z);
        }
        let free_paths = sum / FLIGHTS as f64 * 1e6;
        assert!((free_paths - 1.0).abs() < 0.06, "{free_paths} mean free paths");
        let ray = Ray { t_max: 1.0 + 4e-6, ..INTO };
        let mut stream = Stream::new(3, 0, 0, Purpose::Study);
        let passage = pass::<Bounded>(scene, ray, 0.0, scene.sensor_medium, false, &mut stream).unwrap();
        let expected = -f64::from(ray.t_max - 1.0) * 1e6;
        let found = f64::from(passage.density).ln();
        assert!((found - expected).abs() < 0.07, "ln T {found}, not {expected}");
    }
}
