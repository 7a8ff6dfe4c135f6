use super::*;
use crate::{
    description::{
        Library, Property,
        keyframes::{Interpolation, Key},
    },
    math::{DVec3, RaySegment, Vec3, vec3},
    testing::{nowhere, object},
    volume::{self, Place, Volume, VolumeModel},
};

fn keyed(keys: &[(f64, Value)]) -> Value {
    let key = |(time, value): &(f64, Value)| {
        let value = Property { name: String::new(), value: value.clone(), location: nowhere() };
        Key { time: *time, value }
    };
    let keys = keys.iter().map(key).collect();
    Value::Keyframes(Keyframes::new(Interpolation::Linear, keys, &nowhere()).unwrap())
}

fn of_numbers(keys: &[(f64, f64)]) -> Value {
    keyed(&keys.iter().map(|(time, x)| (*time, Value::Float(*x))).collect::<Vec<_>>())
}

/// The volume that `object` describes in a scene at `time`.
fn at(object_: &Object, time: f64) -> Volume {
    let root = object("scene", &[("time", Value::Float(time)), ("v", Value::Object(object_.clone()))]);
    let resolved = resolve(&root, time);
    let Value::Object(resolved) = &resolved.properties[1].value else { panic!("no object") };
    let place = Place::new(DVec3::ZERO, time);
    volume::build(resolved, &Library::default(), &place).unwrap()
}

/// A number that is `first` at 1 s and `last` at 3 s.
fn between(first: f64, last: f64, time: f64) -> f64 {
    first + (last - first) * ((time - 1.0) / 2.0).clamp(0.0, 1.0)
}

const TIMES: [f64; 6] = [-2.0, 1.0, 1.3, 2.25, 3.0, 7.0];

type Formula = fn(f64, DVec3) -> f64;

fn wave_at(t: f64, p: DVec3) -> f64 {
    let vector = DVec3::new(between(1.0, 5.0, t), 2.0, between(0.0, 1.0, t));
    1.0 + between(0.2, 0.9, t) * (vector.dot(p) + between(0.0, 1.0, t)).cos()
}

fn polynomial_at(t: f64, p: DVec3) -> f64 {
    let x = p.x - 2.0 * (p.x / 2.0).round();
    between(1.0, 0.8, t) + between(0.0, -1.0, t) * x + between(-2.0, 0.0, t) * x * x + x.powi(4)
}

fn potential_at(t: f64, p: DVec3) -> f64 {
    let center = DVec3::new(between(0.0, 1.0, t), 0.5, between(0.0, -1.0, t));
    between(1.0, 2.0, t) / (1.0 + between(4.0, 1.0, t) * p.distance_squared(center))
}

fn of_values(first: Value, last: Value) -> Value {
    keyed(&[(1.0, first), (3.0, last)])
}

/// Three functions that change in time, each with its formula of time and position.
fn functions() -> Vec<(Object, Formula)> {
    let text = |text: &str| Value::String(text.into());
    let vector = |x, y, z| Value::Vector([x, y, z]);
    let wave = [
        ("amplitude", of_numbers(&[(1.0, 0.2), (3.0, 0.9)])),
        ("vector", of_values(vector(1.0, 2.0, 0.0), vector(5.0, 2.0, 1.0))),
        ("phase", of_numbers(&[(1.0, 0.0), (3.0, 1.0)])),
    ];
    let polynomial = [("x", of_values(text("1, 0, -2, 0, 1"), text("0.8, -1, 0, 0, 1")))];
    let potential = [
        ("center", of_values(vector(0.0, 0.5, 0.0), vector(1.0, 0.5, -1.0))),
        ("strength", of_numbers(&[(1.0, 1.0), (3.0, 2.0)])),
        ("d", of_numbers(&[(1.0, 4.0), (3.0, 1.0)])),
    ];
    let waves = object("cosine", &[("w", Value::Object(object("wave", &wave)))]);
    vec![
        (waves, wave_at as Formula),
        (object("polynomial", &polynomial), polynomial_at),
        (object("equipotential", &potential), potential_at),
    ]
}

#[test]
fn functions_keep_their_closed_forms_at_every_time() {
    let direction = vec3(0.6, -0.48, 0.64);
    let segment = RaySegment { origin: vec3(-1.0, 0.7, 0.2), direction, length: 2.75 };
    for (function, formula) in functions() {
        for time in TIMES {
            let volume = at(&function, time);
            assert!(volume.has_integral());
            const STEPS: u32 = 20_000;
            let step = 2.75 / f64::from(STEPS);
            let value = |i: u32| {
                let t = (f64::from(i) + 0.5) * step;
                formula(time, segment.origin.as_dvec3() + direction.as_dvec3() * t)
            };
            let expected = (0..STEPS).map(value).sum::<f64>() * step;
            let found = f64::from(volume.integral::<f32>(&segment));
            assert!(
                (found - expected).abs() < 2e-6 * expected.abs().max(1.0),
                "{found} {expected} at {time} s"
            );
            let value = formula(time, segment.origin.as_dvec3());
            assert!((f64::from(volume.eval::<f32>(segment.origin)) - value).abs() < 1e-6);
        }
    }
}

/// Against quadrature of the velocity: 0 up to 1 s, then faster until 3 s, then slower, and against x from 5 s on.
#[test]
fn a_wind_that_changes_takes_things_as_far_as_it_adds_up_to() {
    let velocity = |time: f64| match time {
        t if t < 1.0 => 0.0,
        t if t < 3.0 => 2.0 * (t - 1.0),
        t if t < 6.0 => 4.0 - 2.0 * (t - 3.0),
        _ => -2.0,
    };
    let keys = [(1.0, 0.0), (3.0, 4.0), (6.0, -2.0)].map(|(t, x)| (t, Value::Vector([x, 0.0, -0.5 * x])));
    let (still, _) = functions().remove(0);
    let wind = object("wind", &[("velocity", keyed(&keys)), ("volume", Value::Object(still.clone()))]);
    for time in [-1.0, 0.0, 0.5, 2.0, 4.0, 5.5, 9.0] {
        const STEPS: u32 = 10_000;
        let step = time / f64::from(STEPS);
        let drift = (0..STEPS).map(|i| velocity((f64::from(i) + 0.5) * step)).sum::<f64>() * step;
        let (moved, still) = (at(&wind, time), at(&still, time));
        for from in [Vec3::ZERO, vec3(0.3, -0.2, 0.5), vec3(-1.0, 2.0, 0.1)] {
            let to = from + vec3(drift as f32, 0.0, -0.5 * drift as f32);
            let (found, expected) = (moved.eval::<f32>(to), still.eval::<f32>(from));
            assert!((found - expected).abs() < 2e-5, "{found} {expected} at {time} s");
        }
    }
}

#[test]
fn the_time_of_a_scene_does_not_change() {
    let root = object("scene", &[("time", of_numbers(&[(0.0, 1.0)])), ("x", of_numbers(&[(0.0, 1.0)]))]);
    let resolved = resolve(&root, 0.0);
    assert_eq!(resolved.properties[1].value, Value::Float(1.0));
    assert!(matches!(resolved.properties[0].value, Value::Keyframes(_)));
}
