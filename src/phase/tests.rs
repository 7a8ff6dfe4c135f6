//! What holds for every phase function, over every model's examples.

use super::*;
use crate::description::Value;
use crate::math::{DVec3, vec3};
use crate::sampling::stream::Purpose;
use crate::testing::{chi_square, object, significance};
use std::f64::consts::TAU;

/// Bins between straight on and straight back, finest at both ends, and around.
const BINS: usize = 64;
const SECTORS: usize = 8;

/// The cosine at `t` in [0, 1], from 1 down to -1 with all of sharp peaks in view, and its slope's size.
fn stretched(t: f64) -> (f64, f64) {
    let near = |t: f64| ((2.0 * t).powi(4), 8.0 * (2.0 * t).powi(3));
    if t < 0.5 {
        let (d, slope) = near(t);
        (1.0 - d, slope)
    } else {
        let (d, slope) = near(1.0 - t);
        (d - 1.0, slope)
    }
}

/// The inverse of `stretched` for a pair of unit vectors, precise at both ends.
fn unstretched(a: DVec3, b: DVec3) -> f64 {
    let half = |v: DVec3| (0.5 * v.length_squared()).min(1.0).powf(0.25) * 0.5;
    if a.dot(b) > 0.0 { half(a - b) } else { 1.0 - half(a + b) }
}

/// Integral of the density times `f`(cos) over the directions with `t` between `low` and `high`.
fn integral(phase: &Phase, low: f64, high: f64, f: impl Fn(f64) -> f64) -> f64 {
    let n = 256;
    let step = (high - low) / f64::from(n);
    (0..n)
        .map(|i| {
            let (cosine, slope) = stretched(low + (f64::from(i) + 0.5) * step);
            TAU * slope * step * f64::from(phase.density(cosine as f32)) * f(cosine)
        })
        .sum()
}

fn whole(phase: &Phase, f: impl Fn(f64) -> f64 + Copy) -> f64 {
    (0..BINS).map(|i| integral(phase, i as f64 / BINS as f64, (i + 1) as f64 / BINS as f64, f)).sum()
}

#[test]
fn every_phase_function_is_normalised() {
    for phase in examples() {
        let total = whole(&phase, |_| 1.0);
        assert!((total - 1.0).abs() < 1e-4, "{phase:?}: {total}");
    }
}

#[test]
fn every_mean_cosine_is_that_of_the_density() {
    for phase in examples() {
        let (mean, told) = (whole(&phase, |c| c), phase.mean_cosine());
        assert!((mean - f64::from(told)).abs() < 1e-4, "{phase:?}: {mean}, told {told}");
    }
}

/// Counts of sampled directions per cell, in the same order as `expected_counts`.
fn sampled_counts(phase: &Phase, direction: Vec3, samples: u64) -> Vec<u64> {
    let mut stream = Stream::new(7, 0, 0, Purpose::Study);
    let frame = Frame::around(direction);
    let mut counts = vec![0; BINS * SECTORS];
    for _ in 0..samples {
        let sampled = phase.sample(direction, &mut stream);
        assert!((sampled.length() - 1.0).abs() < 1e-6, "{phase:?}: {sampled} is not unit");
        let local = frame.to_local(sampled);
        let around = (f64::from(local.y).atan2(f64::from(local.x)) / TAU).rem_euclid(1.0);
        let along = unstretched(direction.as_dvec3().normalize(), sampled.as_dvec3().normalize());
        let bin = ((along * BINS as f64) as usize).min(BINS - 1);
        counts[bin * SECTORS + ((around * SECTORS as f64) as usize).min(SECTORS - 1)] += 1;
    }
    counts
}

fn expected_counts(phase: &Phase, samples: u64) -> Vec<f64> {
    let edge = |i: usize| i as f64 / BINS as f64;
    let share = |i| samples as f64 * integral(phase, edge(i), edge(i + 1), |_| 1.0) / SECTORS as f64;
    (0..BINS * SECTORS).map(|cell| share(cell / SECTORS)).collect()
}

#[test]
fn every_model_samples_its_density() {
    let examples = examples();
    let directions = [Vec3::Z, -Vec3::Z, vec3(0.3, -0.5, 0.7).normalize()];
    let level = significance(examples.len() * directions.len());
    let samples = 100_000;
    for phase in &examples {
        let expected = expected_counts(phase, samples);
        for direction in directions {
            let p = chi_square(&sampled_counts(phase, direction, samples), &expected);
            assert!(p > level, "{phase:?} around {direction}: p-value {p}");
        }
    }
}

fn built(plugin: &str, properties: &[(&str, Value)]) -> Result<Phase> {
    build(&object(plugin, properties), &Library::default())
}

/// Values of Mitsuba 3.9.1 at these cosines (there measured to the direction back, hence the order).
#[test]
fn values_are_those_of_mitsuba() {
    let cosines = [1.0, 0.6, 0.0, -0.3, -1.0];
    let hg = || Value::Object(object("hg", &[("g", Value::Float(0.5))]));
    let rows: [(Phase, [f32; 5]); 4] = [
        (
            built("hg", &[("g", Value::Float(0.5))]).unwrap(),
            [0.477_464_8, 0.113_888_9, 0.042_705_75, 0.030_928_14, 0.017_683_88],
        ),
        (
            built("rayleigh", &[]).unwrap(),
            [0.119_366_2, 0.081_169_02, 0.059_683_1, 0.065_054_58, 0.119_366_2],
        ),
        (
            built("tabphase", &[("values", Value::String("0.5, 1.0, 1.5, 3".into()))]).unwrap(),
            [0.168_517, 0.117_961_9, 0.070_215_41, 0.057_576_66, 0.028_086_17],
        ),
        (
            built(
                "blendphase",
                &[
                    ("weight", Value::Float(0.25)),
                    ("a", hg()),
                    ("b", Value::Object(object("isotropic", &[]))),
                ],
            )
            .unwrap(),
            [0.377_993, 0.105_311, 0.051_923_68, 0.043_090_47, 0.033_157_28],
        ),
    ];
    for (phase, values) in rows {
        for (cosine, value) in cosines.iter().zip(values) {
            let found = phase.density(*cosine);
            assert!((found / value - 1.0).abs() < 1e-5, "{phase:?} at {cosine}: {found} for {value}");
        }
    }
}

#[test]
fn a_positive_k_scatters_forward() {
    let schlick = built("schlick", &[("k", Value::Float(0.5))]).unwrap();
    assert!(schlick.density(1.0) > schlick.density(-1.0) && schlick.mean_cosine() > 0.0);
}

#[test]
fn parameters_out_of_range_are_errors() {
    let number = |x| Value::Float(x);
    let text = |s: &str| Value::String(s.into());
    let part = || ("", Value::Object(object("isotropic", &[])));
    let cases: Vec<(&str, Vec<(&str, Value)>)> = vec![
        ("hg", vec![("g", number(1.0))]),
        ("hg", vec![("g", number(-1.5))]),
        ("hg", vec![("g", number(f64::NAN))]),
        ("hg", vec![("k", number(0.5))]),
        ("schlick", vec![("k", number(-1.0))]),
        ("tabphase", vec![]),
        ("tabphase", vec![("values", text("1"))]),
        ("tabphase", vec![("values", text("0, 0, 0"))]),
        ("tabphase", vec![("values", text("1, -2"))]),
        ("tabphase", vec![("values", text("1, NaN"))]),
        ("tabphase", vec![("values", text("1, two"))]),
        ("blendphase", vec![part(), part()]),
        ("blendphase", vec![("weight", number(1.5)), part(), part()]),
        ("blendphase", vec![("weight", number(0.5)), part()]),
        ("blendphase", vec![("weight", number(0.5)), part(), part(), part()]),
        ("henyey", vec![]),
    ];
    for (plugin, properties) in cases {
        assert!(built(plugin, &properties).is_err(), "{plugin} {properties:?}");
    }
}
