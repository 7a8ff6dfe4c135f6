//! What holds for every sensor, and values of Mitsuba 3.9.1.

use super::*;
use crate::{
    description::{TransformStep, Value},
    math::{DMat4, vec2, vec3},
    testing::object,
};

const CROP: Crop = Crop { film: [200, 100], offset: [30, 10] };

fn built(plugin: &str, properties: &[(&str, Value)], crop: Crop) -> Result<Sensor> {
    let (object, library) = (object(plugin, properties), Library::default());
    let (params, build) = ROWS.read(&object, &library)?;
    let site = Site { recentre: DVec3::ZERO, crop, shapes: &[], places: &HashMap::new() };
    let sensor = build(&params, &site)?;
    params.finish()?;
    Ok(sensor)
}

/// Sensors of one pixel: parallel rays on a disc, and what is seen on shapes.
fn meters() -> Vec<Sensor> {
    let vector = |x| Value::Vector(x);
    let turn = vec![TransformStep::Rotate { axis: [1.0, 2.0, -0.5], angle: 70.0 }];
    let on = |plugin: &str| {
        let (object, library) =
            (object(plugin, &[("to_world", Value::Transform(turn.clone()))]), Library::default());
        let (params, build) = shape::ROWS.read(&object, &library).unwrap();
        Sensor::Irradiance(Box::new(Irradiance::on(build(&params, DMat4::IDENTITY).unwrap(), 0)))
    };
    let distant = built("distant", &[("direction", vector([1.0, 2.0, -0.5]))], CROP).unwrap();
    vec![distant, on("rectangle"), on("sphere"), on("disk")]
}

fn examples() -> Vec<Sensor> {
    let number = |name: &'static str, x: f64| (name, Value::Float(x));
    let turn = TransformStep::Rotate { axis: [1.0, 2.0, -0.5], angle: 70.0 };
    let place = vec![turn.clone(), TransformStep::Translate([1.0, -2.0, 3.0])];
    let stretched = [vec![TransformStep::Scale([2.0, 3.0, 4.0])], place.clone()].concat();
    let mirrored = [vec![TransformStep::Scale([-1.0, 1.0, 1.0])], place.clone()].concat();
    let to_world = |steps: &Vec<TransformStep>| ("to_world", Value::Transform(steps.clone()));
    let lens = [number("aperture_radius", 0.2), number("focus_distance", 3.0), number("fov", 60.0)];
    [
        built("perspective", &[to_world(&place), number("fov", 50.0)], CROP),
        built("perspective", &[to_world(&mirrored), number("principal_point_offset_x", 0.2)], CROP),
        built("thinlens", &[lens.to_vec(), vec![to_world(&place)]].concat(), CROP),
        built("orthographic", &[to_world(&stretched), number("near_clip", 0.5)], CROP),
    ]
    .into_iter()
    .map(Result::unwrap)
    .collect()
}

const FILMS: [Vec2; 4] = [vec2(0.0, 0.0), vec2(70.0, 40.0), vec2(169.5, 12.25), vec2(3.0, 89.0)];
const APERTURE: Vec2 = vec2(0.05, -0.13);

#[test]
fn a_point_on_a_ray_is_seen_where_the_ray_starts() {
    for sensor in examples() {
        for film in FILMS {
            let SensorRay { ray, pdf, position } = sensor.ray(film, APERTURE);
            for t in [0.1, 3.0, 100.0] {
                let point = ray.origin + ray.direction * t;
                let seen = sensor.project(point, APERTURE).unwrap();
                assert!((seen.film - film).length() < 2e-2, "{} {film}: {}", sensor.name(), seen.film);
                assert!((seen.ray.direction - ray.direction).length() < 1e-4);
                assert!((seen.ray.origin - ray.origin).length() < 1e-3);
                assert!((seen.pdf / pdf - 1.0).abs() < 1e-3);
                let squared = if sensor.is_parallel() { 1.0 } else { point.distance_squared(position) };
                assert!((seen.distance_squared / squared - 1.0).abs() < 1e-3);
            }
            if let Some(seen) = sensor.project_direction(ray.direction, APERTURE) {
                assert!((seen.film - film).length() < 2e-2, "{} {film}: {}", sensor.name(), seen.film);
            }
        }
    }
}

/// The density is the film area over the solid angle (or area across the rays) that it is seen in.
#[test]
fn densities_are_those_of_the_projection() {
    for sensor in examples() {
        for film in FILMS {
            let at = |dx, dy| {
                let ray = sensor.ray(film + vec2(dx, dy), APERTURE).ray;
                if sensor.is_parallel() { ray.origin } else { ray.direction }.as_dvec3()
            };
            let (across, down) = (at(0.5, 0.0) - at(-0.5, 0.0), at(0.0, 0.5) - at(0.0, -0.5));
            let SensorRay { ray, pdf, .. } = sensor.ray(film, APERTURE);
            let area = across.cross(down).dot(ray.direction.as_dvec3()).abs();
            assert!((area * f64::from(pdf) - 1.0).abs() < 2e-3, "{} {film}", sensor.name());
        }
    }
}

#[test]
fn a_point_on_a_ray_of_a_meter_is_seen_where_the_ray_starts() {
    for sensor in meters() {
        for film in [vec2(0.35, 0.4), vec2(0.85, 0.125), vec2(0.25, 0.875), vec2(0.0625, 0.7)] {
            let SensorRay { ray, pdf, position } = sensor.ray(film, APERTURE);
            let point = ray.origin + ray.direction * 3.0;
            let seen = sensor.project(point, APERTURE).unwrap();
            assert!((seen.film - film).length() < 1e-4, "{} {film}: {}", sensor.name(), seen.film);
            assert!((seen.ray.direction - ray.direction).length() < 1e-4);
            assert!((seen.ray.origin - ray.origin).length() < 1e-3);
            assert!((seen.pdf / pdf - 1.0).abs() < 1e-3);
            let squared = if sensor.is_parallel() { 1.0 } else { point.distance_squared(position) };
            assert!((seen.distance_squared / squared - 1.0).abs() < 1e-3);
            assert!(sensor.project(ray.origin - ray.direction * 0.1, APERTURE).is_none());
            assert!(sensor.project_direction(-ray.direction, APERTURE).is_none());
            // The density is the film area over the solid angle, or area, that it is seen in.
            let at = |dx, dy| {
                let ray = sensor.ray(film + 1e-2 * vec2(dx, dy), APERTURE).ray;
                if sensor.is_parallel() { ray.origin } else { ray.direction }.as_dvec3()
            };
            let (across, down) = (at(0.5, 0.0) - at(-0.5, 0.0), at(0.0, 0.5) - at(0.0, -0.5));
            let area = 1e4 * across.cross(down).dot(ray.direction.as_dvec3()).abs();
            assert!((area * f64::from(pdf) - 1.0).abs() < 2e-3, "{} {film}: {area}", sensor.name());
        }
    }
}

/// Nothing beside a disc of rays, and nothing of one ray.
#[test]
fn what_no_ray_meets_is_not_seen() {
    let distant = &meters()[0];
    assert!(distant.is_connectible() && distant.is_parallel());
    let SensorRay { ray, .. } = distant.ray(vec2(0.0, 0.5), Vec2::ZERO);
    let beside = 1e-3 * (ray.origin - distant.position());
    let at = ray.origin + ray.direction;
    assert!(
        distant.project(at - beside, Vec2::ZERO).is_some()
            && distant.project(at + beside, Vec2::ZERO).is_none()
    );
    let meter = built("radiancemeter", &[], CROP).unwrap();
    let ray = meter.ray(vec2(0.5, 0.5), Vec2::ZERO).ray;
    assert_eq!((ray.origin, ray.direction), (Vec3::ZERO, Vec3::Z));
    assert!(!meter.is_connectible() && meter.project(ray.direction, Vec2::ZERO).is_none());
}

#[test]
fn nothing_is_seen_beyond_the_clip_distances_or_behind() {
    for sensor in examples() {
        let ray = sensor.ray(vec2(70.0, 40.0), APERTURE).ray;
        for t in [-0.01, -3.0, ray.t_max * 1.001] {
            assert!(
                sensor.project(ray.origin + ray.direction * t, APERTURE).is_none(),
                "{} {t}",
                sensor.name()
            );
        }
        assert!(sensor.project_direction(-ray.direction, APERTURE).is_none());
    }
}

#[test]
fn a_lens_is_sharp_in_its_plane_of_focus() {
    let lens = &examples()[2];
    for film in FILMS {
        let at_focus = |aperture: Vec2| {
            let axis = lens.ray(vec2(70.0, 40.0), Vec2::ZERO).ray.direction;
            let ray = lens.ray(film, aperture).ray;
            let depth = (ray.origin - lens.position()).dot(axis);
            ray.origin + ray.direction * ((3.0 - depth) / ray.direction.dot(axis))
        };
        let sharp = at_focus(Vec2::ZERO);
        for aperture in [vec2(0.2, 0.0), vec2(-0.1, 0.15)] {
            assert!((at_focus(aperture) - sharp).length() < 1e-4, "{film}");
        }
    }
}

/// Rays that Mitsuba 3.9.1 starts at the corners and the middle of the film.
#[test]
fn orthographic_rays_are_those_of_mitsuba() {
    let place = vec![TransformStep::Scale([2.0, 3.0, 4.0]), TransformStep::Translate([1.0, 2.0, 3.0])];
    let properties = [("to_world", Value::Transform(place)), ("near_clip", Value::Float(0.5))];
    let sensor = built("orthographic", &properties, Crop { film: [200, 100], offset: [0, 0] }).unwrap();
    for (film, origin) in [
        (vec2(0.0, 0.0), [3.0, 3.5, 5.0]),
        (vec2(100.0, 50.0), [1.0, 2.0, 5.0]),
        (vec2(200.0, 0.0), [-1.0, 3.5, 5.0]),
        (vec2(0.0, 100.0), [3.0, 0.5, 5.0]),
    ] {
        let ray = sensor.ray(film, Vec2::ZERO).ray;
        assert!((ray.origin - Vec3::from(origin)).length() < 1e-5, "{film}: {}", ray.origin);
        assert_eq!((ray.direction, ray.t_max), (vec3(0.0, 0.0, 1.0), 9999.5));
    }
}

#[test]
fn parameters_out_of_range_are_errors() {
    let number = |name: &'static str, x: f64| (name, Value::Float(x));
    let scale = ("to_world", Value::Transform(vec![TransformStep::Scale([2.0; 3])]));
    for (plugin, properties) in [
        ("perspective", vec![number("fov", 0.0)]),
        ("perspective", vec![number("fov", 180.0)]),
        ("perspective", vec![number("near_clip", -1.0)]),
        ("perspective", vec![number("near_clip", 2.0), number("far_clip", 1.0)]),
        ("perspective", vec![number("fov", 40.0), ("focal_length", Value::String("50mm".into()))]),
        ("perspective", vec![number("aperture_radius", 0.1)]),
        ("perspective", vec![scale.clone()]),
        ("thinlens", vec![]),
        ("thinlens", vec![number("aperture_radius", 0.0)]),
        ("thinlens", vec![number("aperture_radius", 0.1), number("focus_distance", 0.0)]),
        ("orthographic", vec![number("fov", 40.0)]),
        ("fisheye", vec![]),
    ] {
        assert!(built(plugin, &properties, CROP).is_err(), "{plugin} {properties:?}");
    }
}
