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

/// The turn at `t` in [0, 1], from straight on to straight back with all of sharp peaks in view, its cosine and
/// the slope of that.
fn stretched(t: f64) -> (Deflection, f64, f64) {
    let near = |t: f64| ((2.0 * t).powi(4), 8.0 * (2.0 * t).powi(3));
    if t < 0.5 {
        let (d, slope) = near(t);
        (Deflection::of(d, 1.0), 1.0 - d, slope)
    } else {
        let (d, slope) = near(1.0 - t);
        (Deflection::of(d, -1.0), d - 1.0, slope)
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
            let (turn, cosine, slope) = stretched(low + (f64::from(i) + 0.5) * step);
            TAU * slope * step * f64::from(phase.pdf_sr(turn)) * f(cosine)
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
        let (mean, reported) = (whole(&phase, |c| c), phase.mean_cosine());
        assert!((mean - f64::from(reported)).abs() < 1e-4, "{phase:?}: {mean}, told {reported}");
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
    build(&object(plugin, properties), &Library::default(), &Place::new(DVec3::ZERO, 0.0))
}

fn at_cosine(cosine: f64) -> Deflection {
    Deflection::of(1.0 - cosine, 1.0)
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
            let found = phase.pdf_sr(at_cosine(*cosine));
            assert!((found / value - 1.0).abs() < 1e-5, "{phase:?} at {cosine}: {found} for {value}");
        }
    }
}

/// Fresnel's reflectance of an index of 1.33, as the textbook prints it.
fn printed_reflectance(cosine: f64) -> f64 {
    let n: f64 = 1.33;
    let inside = (1.0 - (1.0 - cosine * cosine) / (n * n)).sqrt();
    let across = (cosine - n * inside) / (cosine + n * inside);
    let along = (n * cosine - inside) / (n * cosine + inside);
    0.5 * (across * across + along * along)
}

/// The functions as P03T prints them, over 4 pi; of those it leaves unnormalised, up to a factor.
#[test]
fn values_are_those_printed() {
    let number = |name, x| (name, Value::Float(x));
    let two_terms = [number("r", 0.12), number("g1", -0.5), number("g2", 0.7)];
    let hg = |g: f64, t: f64| (1.0 - g * g) / (1.0 - 2.0 * g * t + g * g).powf(1.5);
    let schlick = |g: f64, t: f64| (1.0 - g * g) / (1.0 - g * t).powi(2);
    type Row<'a> = (&'a str, Vec<(&'a str, Value)>, Box<dyn Fn(f64) -> f64 + 'a>);
    let rows: Vec<Row<'_>> = vec![
        ("linear", vec![number("g", 0.5)], Box::new(|x| 1.0 + 0.5 * x.cos())),
        ("two_term_hg", two_terms.to_vec(), Box::new(|x| 0.12 * hg(-0.5, x.cos()) + 0.88 * hg(0.7, x.cos()))),
        (
            "two_term_schlick",
            two_terms.to_vec(),
            Box::new(|x| 0.12 * schlick(-0.5, x.cos()) + 0.88 * schlick(0.7, x.cos())),
        ),
        (
            "cornette_shanks",
            vec![number("g", 0.6)],
            Box::new(|x| 1.5 * (1.0 + x.cos().powi(2)) / 2.36 * hg(0.6, x.cos())),
        ),
        (
            "cornette_shanks",
            // Its g is 0.7, by the mean cosine: 0.6 g (4 + g^2) / (2 + g^2).
            vec![number("u", 0.6 * 0.7 * 4.49 / 2.49)],
            Box::new(|x| 1.5 * (1.0 + x.cos().powi(2)) / 2.49 * hg(0.7, x.cos())),
        ),
        (
            "mie",
            vec![number("m", 3.0), number("n", 5.0)],
            Box::new(|x| 7.0 / 13.0 * (1.0 + 3.0 * (0.5 * x).cos().powi(5))),
        ),
        (
            "mie_reflecting",
            vec![],
            Box::new(|x| 0.6 * ((1.0 - 0.5 * x.cos()).powi(2) + (x.cos() - 0.5).powi(2))),
        ),
        ("mie_hazy", vec![], Box::new(|x| 0.5 * (1.0 + 9.0 * (0.5 * x).cos().powi(16)))),
        ("mie_murky", vec![], Box::new(|x| 33.0 / 83.0 * (1.0 + 50.0 * (0.5 * x).cos().powi(64)))),
        (
            "mie_murky",
            vec![("form", Value::String("blasi".into()))],
            Box::new(|x| 0.5 + 16.5 * (0.5 + 0.5 * x.cos()).powi(32)),
        ),
        ("sakas", vec![number("n", 5.0)], Box::new(|x| 6.0 / 7.0 * (1.0 + x.cos().abs().powi(5)))),
        // The integral of exp(-theta^2 / 2) sin(theta) over [0, pi], by the midpoint rule in 400 000 steps.
        ("gaussian", vec![number("gamma", 0.5)], Box::new(|x| 2.0 * (-0.5 * x * x).exp() / 0.725_319_69)),
        (
            "diffuse_sphere",
            vec![],
            Box::new(|x| 8.0 / (3.0 * std::f64::consts::PI) * (x.sin() - x * x.cos())),
        ),
        // The average reflectance of an index of 1.33, by the same rule.
        (
            "specular_sphere",
            vec![number("eta", 1.33)],
            Box::new(|x| printed_reflectance((0.5 * x).sin()) / 0.065_930_85),
        ),
    ];
    for (plugin, properties, printed) in rows {
        let phase = built(plugin, &properties).unwrap();
        for angle in [0.05f64, 0.7, 1.5, 2.4, 3.1] {
            let exact = printed(angle) / (2.0 * TAU);
            let found = f64::from(phase.pdf_sr(Deflection::of(2.0 * (0.5 * angle).sin().powi(2), 1.0)));
            assert!((found - exact).abs() < 1e-4 * exact, "{plugin} at {angle}: {found} for {exact}");
        }
    }
}

/// Directions rounded to f32 are still directions: the density of a pair is that of what they are.
#[test]
fn sharp_peaks_have_their_density_for_every_pair_of_directions() {
    for g in [0.999f64, 0.9999, -0.9999] {
        let phase = Phase::from(HenyeyGreenstein::new(g));
        let mut stream = Stream::new(3, 0, 0, Purpose::Study);
        for _ in 0..20_000 {
            let before = crate::math::warp::to_sphere(stream.square()).normalize();
            let after = phase.sample(before, &mut stream);
            let [a, b] = [before, after].map(|w| w.as_dvec3().normalize());
            let near = 0.5 * (b - g.signum() * a).length_squared();
            let size = g.abs();
            let exact =
                (1.0 - size * size) / ((1.0 - size).powi(2) + 2.0 * size * near).powf(1.5) / (2.0 * TAU);
            let found = f64::from(phase.pdf_sr(Deflection::between(before, after)));
            assert!((found / exact - 1.0).abs() < 2e-5, "{g}: {before} to {after}, {found} for {exact}");
        }
    }
}

#[test]
fn angles_keep_their_digits_at_both_ends() {
    for angle in [1e-6f64, 1e-3, 1.0, 3.0] {
        let d = 2.0 * (0.5 * angle).sin().powi(2);
        let near = Deflection::of(d, 1.0);
        assert!((f64::from(near.angle()) / angle - 1.0).abs() < 1e-6);
        assert!((f64::from(near.from_peak(1.0)) / d - 1.0).abs() < 1e-6);
        assert!((f64::from(Deflection::of(d, -1.0).from_peak(-1.0)) / d - 1.0).abs() < 1e-6);
        assert!((f64::from(near.cosine()) - angle.cos()).abs() < 1e-6);
    }
}

#[test]
fn a_positive_k_scatters_forward() {
    let schlick = built("schlick", &[("k", Value::Float(0.5))]).unwrap();
    assert!(schlick.pdf_sr(at_cosine(1.0)) > schlick.pdf_sr(at_cosine(-1.0)) && schlick.mean_cosine() > 0.0);
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
        ("blendphase", vec![("weight", Value::Object(object("gridvolume", &[]))), part(), part()]),
        ("linear", vec![("g", number(1.5))]),
        ("two_term_hg", vec![("g1", number(0.5)), ("g2", number(-0.5))]),
        ("two_term_hg", vec![("r", number(0.5)), ("g1", number(0.5)), ("g2", number(-1.0))]),
        ("two_term_schlick", vec![("r", number(1.5)), ("g1", number(0.5)), ("g2", number(-0.5))]),
        ("cornette_shanks", vec![("g", number(-1.0))]),
        ("cornette_shanks", vec![("u", number(1.0))]),
        ("cornette_shanks", vec![("u", number(0.7)), ("g", number(0.7))]),
        ("mie", vec![("m", number(9.0))]),
        ("mie", vec![("m", number(-1.0)), ("n", number(16.0))]),
        ("mie_reflecting", vec![("g", number(0.5))]),
        ("mie_hazy", vec![("form", text("nishita"))]),
        ("mie_murky", vec![("form", text("mie"))]),
        ("sakas", vec![]),
        ("sakas", vec![("n", number(-1.0))]),
        ("gaussian", vec![("gamma", number(-0.1))]),
        ("specular_sphere", vec![("eta", number(1.0))]),
        ("specular_sphere", vec![("eta", number(0.0))]),
        ("henyey", vec![]),
    ];
    for (plugin, properties) in cases {
        assert!(built(plugin, &properties).is_err(), "{plugin} {properties:?}");
    }
}

/// A blend of forward and backward whose weight is that of `weight`.
fn blend_of(weight: Object) -> Result<Phase> {
    let hg = |g| Value::Object(object("hg", &[("g", Value::Float(g))]));
    built("blendphase", &[("weight", Value::Object(weight)), ("a", hg(0.8)), ("b", hg(-0.8))])
}

fn wave() -> Object {
    let wave =
        object("wave", &[("amplitude", Value::Float(2.0)), ("vector", Value::Vector([1.0, 0.0, 0.0]))]);
    object("cosine", &[("constant", Value::Float(0.5)), ("a", Value::Object(wave))])
}

#[test]
fn a_blend_that_varies_is_at_every_point_that_of_the_weight_there() {
    let varying = blend_of(wave()).unwrap();
    assert!(varying.varies() && varying.at_time(3.0).is_none());
    for x in [0.0f32, 1.4, 1.6, 1.8, 3.0] {
        let weight = f64::from(0.5 + 2.0 * x.cos()).clamp(0.0, 1.0);
        let there = blend_of(object("constvolume", &[("value", Value::Float(weight))])).unwrap();
        assert!(!there.varies());
        for turn in [-1.0, 0.3, 0.99].map(at_cosine) {
            let (found, exact) = (varying.pdf_sr_at(vec3(x, 5.0, 0.0), turn), there.pdf_sr(turn));
            assert!((found / exact - 1.0).abs() < 1e-4, "at {x}: {found} for {exact}");
        }
        let [mut found, mut exact] = [(); 2].map(|()| Stream::new(7, 0, 0, Purpose::Study));
        let sampled = varying.sample_at(vec3(x, 5.0, 0.0), Vec3::Z, &mut found);
        assert_eq!(sampled, there.sample(Vec3::Z, &mut exact));
    }
}

#[test]
fn the_weight_of_a_blend_drifts_and_so_does_that_of_a_blend_in_it() {
    let wind = object("wind", &[("velocity", Value::Vector([2.0, 0.0, 0.0])), ("a", Value::Object(wave()))]);
    let drifting = blend_of(wind).unwrap();
    let later = drifting.at_time(0.5).unwrap();
    let turn = at_cosine(0.9);
    let (before, after) =
        (drifting.pdf_sr_at(vec3(1.6, 0.0, 0.0), turn), later.pdf_sr_at(vec3(2.6, 0.0, 0.0), turn));
    assert!((before / after - 1.0).abs() < 1e-4, "{before} {after}");
    let outer = Phase::from(Blend::new(0.5, drifting, Phase::Isotropic(Isotropic)));
    let outer_later = outer.at_time(0.5).unwrap();
    let mean = 0.5 * after + 0.5 * Isotropic.pdf_sr(turn);
    assert!((outer_later.pdf_sr_at(vec3(2.6, 0.0, 0.0), turn) / mean - 1.0).abs() < 1e-4);
}
