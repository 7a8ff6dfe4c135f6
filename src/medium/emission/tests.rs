//! Emission: what it is at a point, and that points come as often as their densities say.

use super::*;
use crate::{
    description::Library,
    math::Channels,
    sampling::stream::Purpose,
    testing::{chi_square, object},
};

const AROUND: MediumBounds =
    MediumBounds { low: vec3(-1.0, 0.0, 0.0), high: vec3(1.0, 1.0, 3.0), is_bound: true };

fn properties(sigma_t: f32, albedo: f32) -> Within {
    Within::Uniform(MediumProperties::of(Spectrum::splat(sigma_t), Spectrum::splat(albedo)))
}

/// What the medium with these parameters emits.
fn emission(parameters: &[(&str, Value)], within: Within) -> Result<Option<Emission>> {
    let object = object("homogeneous", parameters);
    let library = Library::default();
    let place = Place::new(DVec3::ZERO, 0.0);
    let params = crate::medium::ROWS.read(&object, &library)?.0;
    let albedo = volume::parameter(&params, "albedo", &place)?;
    let given = EmissionDescription::read(&params, &place, &albedo)?;
    given.map_or(Ok(None), |given| Emission::new(given, within, &AROUND))
}

fn emitting(parameters: &[(&str, Value)], within: Within) -> Emission {
    emission(parameters, within).unwrap().unwrap()
}

/// exp(-y / 0.2) below y = 0.8.
fn layered() -> Value {
    let bounds = [("min", Value::Vector([-9.0; 3])), ("max", Value::Vector([9.0, 0.8, 9.0]))];
    let properties = [&[("scale_height", Value::Float(0.2))], &bounds[..]].concat();
    Value::Object(object("exponential", &properties))
}

#[test]
fn gain_is_given_or_that_of_kirchhoff() {
    let middle = vec3(0.0, 0.5, 1.0);
    let gain = |name, value: f64, scale: f64, within| {
        emitting(&[(name, Value::Float(value)), ("emission_scale", Value::Float(scale))], within).at(middle)
    };
    assert_eq!(gain("emission", 3.0, 2.0, properties(0.0, 0.0)), Spectrum::splat(6.0));
    assert_eq!(gain("radiance", 3.0, 0.5, properties(4.0, 0.75)), Spectrum::splat(1.5));
    let hot = gain("temperature", 2000.0, 1.0, properties(4.0, 0.75));
    assert_eq!(hot, black_body::radiance(2000.0));
    assert!(
        emitting(&[("emission", Value::Float(1.0))], properties(1.0, 0.0)).at(vec3(0.0, 2.0, 0.0))
            == Spectrum::ZERO
    );
}

#[test]
fn what_is_dark_is_no_emission() {
    for (name, value, within) in [
        ("emission", 0.0, properties(1.0, 0.0)),
        ("radiance", 1.0, properties(0.0, 0.0)),
        ("radiance", 1.0, properties(1.0, 1.0)),
        ("temperature", 0.0, properties(1.0, 0.0)),
        ("temperature", 200.0, properties(1.0, 0.0)),
    ] {
        assert!(emission(&[(name, Value::Float(value))], within).unwrap().is_none(), "{name} {value}");
    }
    let hidden = [("emission", Value::Float(1.0)), ("emission_scale", Value::Float(0.0))];
    assert!(emission(&hidden, properties(1.0, 0.0)).unwrap().is_none());
    assert!(emission(&[], properties(1.0, 0.0)).unwrap().is_none());
}

#[test]
fn spectra_are_those_of_light() {
    let red = Value::Spectrum(vec![(600.0, 1.0), (700.0, 1.0)]);
    let light = emitting(&[("emission", red.clone())], properties(0.0, 0.0)).at(vec3(0.0, 0.5, 1.0));
    let object = object("point", &[("intensity", red)]);
    let library = Library::default();
    assert_eq!(light, crate::emitter::ROWS.read(&object, &library).unwrap().0.color("intensity").unwrap());
}

/// 4 pi times the integral, in closed form; the means of cells are averages over few points of them.
#[test]
fn power_is_the_integral_of_the_gain() {
    let even = emitting(&[("emission", Value::Rgb([1.0, 2.0, 3.0]))], properties(1.0, 0.5)).power();
    assert!((even / (4.0 * PI * 6.0) - DVec3::new(1.0, 2.0, 3.0)).abs().max_element() < 1e-5);
    let layers = emitting(&[("emission", layered())], properties(1.0, 0.5)).power();
    let expected = 4.0 * PI * 6.0 * 0.2 * (1.0 - (-4f64).exp());
    assert!((layers.x / expected - 1.0).abs() < 0.01, "{layers} {expected}");
}

#[test]
fn points_come_as_their_density_says() {
    let emission = emitting(&[("emission", layered())], properties(1.0, 0.5));
    let mut stream = Stream::new(3, 0, 0, Purpose::Study);
    let (n, bins) = (40_000, 40);
    let mut counts = vec![0; bins];
    let mut mean = 0.0;
    for _ in 0..n {
        let point = emission.sample(&mut stream);
        counts[((point.y / 0.8 * bins as f32) as usize).min(bins - 1)] += 1;
        mean += f64::from(emission.at(point).x / emission.pdf_vol(point)) / f64::from(n);
    }
    let steps = 200;
    let expected = |bin: usize| {
        let at = |i: usize| (bin as f32 + (i as f32 + 0.5) / steps as f32) * 0.8 / bins as f32;
        let sum: f64 = (0..steps).map(|i| f64::from(emission.pdf_vol(vec3(0.2, at(i), 1.0)))).sum();
        // 6 is the area across.
        sum / steps as f64 * 0.8 / bins as f64 * 6.0 * f64::from(n)
    };
    let expected: Vec<f64> = (0..bins).map(expected).collect();
    let total = expected.iter().sum::<f64>() / f64::from(n);
    assert!((total - 1.0).abs() < 1e-3, "{total}");
    assert!(chi_square(&counts, &expected) > 1e-3);
    let truth = 6.0 * 0.2 * (1.0 - (-4f64).exp());
    assert!((mean / truth - 1.0).abs() < 0.005, "{mean} {truth}");
}

/// The mean of gain over density is the integral along any part of any line.
#[test]
fn points_along_a_section_integrate_the_gain() {
    let emission = emitting(&[("emission", layered())], properties(1.0, 0.5));
    for (index, (origin, direction, length)) in [
        (vec3(0.0, -1.0, 1.0), vec3(0.6, 0.8, 0.0), f32::INFINITY),
        (vec3(0.0, 0.1, 1.0), vec3(0.6, 0.8, 0.0), 0.3),
        (vec3(-5.0, 0.3, 1.0), Vec3::X, 4.5),
        (vec3(0.3, 5.0, 1.0), Vec3::NEG_Y, 6.0),
    ]
    .into_iter()
    .enumerate()
    {
        let segment = RaySegment { origin, direction, length };
        let (n, steps) = (20_000, 200_000);
        let mut stream = Stream::new(4, index as u64, 0, Purpose::Study);
        let values: Vec<f64> = (0..n)
            .map(|_| {
                let (t, pdf) = emission.sample_along(&segment, &mut stream).unwrap();
                assert!(t >= 0.0 && t <= length);
                f64::from(emission.at(segment.at(t)).x / pdf)
            })
            .collect();
        let step = 10.0f32.min(length) / steps as f32;
        let at = |i: i32| f64::from(emission.at(segment.at((i as f32 + 0.5) * step)).x);
        let expected = (0..steps).map(at).sum::<f64>() * f64::from(step);
        let mean = values.iter().sum::<f64>() / f64::from(n);
        let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / f64::from(n * n);
        let error = (mean - expected).abs();
        assert!(error < 4.0 * variance.sqrt() + 1e-4 * expected, "{index}: {mean} {expected}");
    }
    let beside = RaySegment { origin: vec3(0.0, 2.0, 0.0), direction: Vec3::X, length: 9.0 };
    assert!(emission.sample_along(&beside, &mut Stream::new(4, 9, 0, Purpose::Study)).is_none());
}

/// A grey medium's channel of the rate: what a line through the middle of the box would be sampled by, and
/// extinction.
#[test]
fn rates_are_those_of_a_mean_line_and_of_collisions() {
    let even = emitting(&[("emission", Value::Float(2.0))], properties(5.0, 0.5));
    // 4 V / S of a box of 2 x 1 x 3.
    let chord = 4.0 * 6.0 / 22.0;
    let rate: f32 = f32::from_spectrum(even.rate(vec3(0.0, 0.5, 1.0)));
    assert!((rate - (1.0 / chord + 5.0)).abs() < 1e-4, "{rate}");
}

#[test]
fn temperatures_have_no_colour_and_light_has_a_limit() {
    let colour = [("temperature", Value::Rgb([1000.0, 2000.0, 3000.0]))];
    assert!(emission(&colour, properties(1.0, 0.0)).unwrap_err().expected.contains("one number"));
    for name in ["emission", "radiance", "temperature"] {
        let error = emission(&[(name, Value::Float(3e38))], properties(9.0, 0.0)).unwrap_err();
        assert!(error.expected.contains("1e30"), "{error}");
    }
    let both = [("emission", Value::Float(1.0)), ("radiance", Value::Float(1.0))];
    assert!(emission(&both, properties(1.0, 0.0)).unwrap_err().remedy.contains("remove one"));
    assert!(emission(&[("emission_scale", Value::Float(2.0))], properties(1.0, 0.0)).is_err());
}
