//! What holds for every surface model, over every model's examples.

use super::*;
use crate::description::Value;
use crate::math::{DVec3, warp};
use crate::sampling::stream::Purpose;
use crate::testing::{chi_square, object, significance};
use std::f64::consts::TAU;

const UV: Vec2 = Vec2::new(0.3, 0.6);
const BOTH: [Transport; 2] = [Transport::Radiance, Transport::Importance];

/// Cells of the sphere: rows even in cosine to the y axis, columns even in azimuth around it.
const ROWS_OF_CELLS: usize = 24;
const COLUMNS: usize = 48;

/// Directions from straight above to near-grazing, on both sides.
fn incoming() -> Vec<Vec3> {
    let upper = [(1.0, 0.0), (0.7, 0.4), (0.4, 2.0), (0.1, -1.0), (0.02, 3.0)];
    let upper = upper.map(|(cosine, azimuth)| warp::spherical(cosine, azimuth));
    upper.into_iter().chain(upper.map(|w| vec3(w.x, w.y, -w.z))).collect()
}

fn stream(index: u64) -> Stream {
    Stream::new(11, index, 0, Purpose::Study)
}

fn connectible() -> Vec<Bsdf> {
    examples().into_iter().filter(BsdfModel::is_connectible).collect()
}

/// The probability that `sample` gives a direction in `cell`, by quadrature of the forward density over
/// `steps` by `steps` points.
fn expected_share(bsdf: &Bsdf, wi: Vec3, cell: usize, steps: usize) -> f64 {
    let (row, column) = (cell / COLUMNS, cell % COLUMNS);
    let density = |i: usize| {
        let along = (row as f32 + ((i / steps) as f32 + 0.5) / steps as f32) / ROWS_OF_CELLS as f32;
        let around = (column as f32 + ((i % steps) as f32 + 0.5) / steps as f32) / COLUMNS as f32;
        // The poles of the grid, where its cells are long and thin, lie in the horizon, away from all lobes.
        let turned = warp::spherical(2.0 * along - 1.0, TAU as f32 * around);
        let wo = vec3(turned.y, turned.z, turned.x);
        f64::from(bsdf.evaluate(UV, wi, wo, Transport::Radiance).forward)
    };
    let area = 2.0 * TAU / (ROWS_OF_CELLS * COLUMNS * steps * steps) as f64;
    (0..steps * steps).map(density).sum::<f64>() * area
}

/// Counts expected of `samples` samples in each cell; where many are, the quadrature is finer than their
/// noise.
fn expected_counts(bsdf: &Bsdf, wi: Vec3, samples: f64) -> Vec<f64> {
    let count = |cell| match samples * expected_share(bsdf, wi, cell, 16) {
        few if few < 50.0 => few,
        some if some < 1_000.0 => samples * expected_share(bsdf, wi, cell, 64),
        _ => samples * expected_share(bsdf, wi, cell, 160),
    };
    (0..ROWS_OF_CELLS * COLUMNS).map(count).collect()
}

fn cell_of(w: Vec3) -> usize {
    let around = (f64::from(w.x).atan2(f64::from(w.z)) / TAU).rem_euclid(1.0);
    let index = |x: f64, n: usize| ((x * n as f64) as usize).min(n - 1);
    index(0.5 + 0.5 * f64::from(w.y), ROWS_OF_CELLS) * COLUMNS + index(around, COLUMNS)
}

#[test]
fn every_model_samples_its_density() {
    let models = connectible();
    let incoming = incoming();
    let level = significance(models.len() * incoming.len());
    let samples = 50_000;
    for bsdf in &models {
        for (number, wi) in incoming.iter().enumerate() {
            let mut stream = stream(number as u64);
            let expected = expected_counts(bsdf, *wi, f64::from(samples));
            let mut observed = vec![0; expected.len()];
            for _ in 0..samples {
                if let Some(sample) = bsdf.sample(UV, *wi, Transport::Radiance, &mut stream) {
                    observed[cell_of(sample.wo)] += 1;
                }
            }
            let (found, total) = (observed.iter().sum::<u64>() as f64, expected.iter().sum::<f64>());
            let slack = 5.0 * (f64::from(samples) - total).max(1.0).sqrt() + 2e-3 * f64::from(samples);
            assert!((found - total).abs() < slack, "{bsdf:?} from {wi}: {found} samples for {total}");
            let p = chi_square(&observed, &expected);
            assert!(p > level, "{bsdf:?} from {wi}: p-value {p}");
        }
    }
}

/// Agreement to `tolerance` relative, or of two numbers that are both next to nothing.
fn close(a: f32, b: f32, tolerance: f32) -> bool {
    (a - b).abs() <= tolerance * a.abs().max(b.abs()) + 1e-7
}

fn close_colors(a: Spectrum, b: Spectrum, tolerance: f32) -> bool {
    (0..3).all(|i| close(a[i], b[i], tolerance))
}

/// Random pairs of directions: some free, most sampled, so that narrow lobes are met.
fn pairs(bsdf: &Bsdf) -> Vec<(Vec3, Vec3)> {
    let mut stream = stream(1);
    let mut pairs = Vec::new();
    for wi in incoming() {
        for _ in 0..200 {
            pairs.push((wi, warp::to_sphere(stream.square())));
            pairs.extend(bsdf.sample(UV, wi, Transport::Radiance, &mut stream).map(|s| (wi, s.wo)));
        }
    }
    pairs
}

#[test]
fn backward_densities_are_those_of_the_reversed_call() {
    for bsdf in connectible() {
        for (wi, wo) in pairs(&bsdf) {
            let there = bsdf.evaluate(UV, wi, wo, Transport::Radiance);
            let back = bsdf.evaluate(UV, wo, wi, Transport::Importance);
            let agree =
                close(there.backward, back.forward, 2e-3) && close(there.forward, back.backward, 2e-3);
            assert!(agree, "{bsdf:?}, {wi} to {wo}: {there:?}, back {back:?}");
        }
    }
}

#[test]
fn importance_is_the_adjoint_of_radiance() {
    for bsdf in connectible() {
        for (wi, wo) in pairs(&bsdf) {
            let radiance = bsdf.evaluate(UV, wi, wo, Transport::Radiance).value;
            let importance = bsdf.evaluate(UV, wo, wi, Transport::Importance).value;
            assert!(close_colors(radiance, importance, 2e-3), "{bsdf:?}, {wi} to {wo}");
            let same_side = wi.z * wo.z > 0.0;
            let reversed = bsdf.evaluate(UV, wo, wi, Transport::Radiance).value;
            assert!(!same_side || close_colors(radiance, reversed, 2e-3), "{bsdf:?}, {wi} to {wo}");
        }
    }
}

#[test]
fn samples_tell_what_evaluation_tells() {
    for bsdf in connectible() {
        for (number, wi) in incoming().into_iter().enumerate() {
            for transport in BOTH {
                let mut stream = stream(number as u64);
                for sample in (0..200).filter_map(|_| bsdf.sample(UV, wi, transport, &mut stream)) {
                    let told = bsdf.evaluate(UV, wi, sample.wo, transport);
                    let flow = told.value * sample.wo.z.abs();
                    assert!(close(told.forward, sample.forward, 1e-4), "{bsdf:?} {sample:?} {told:?}");
                    assert!(close(told.backward, sample.backward, 1e-4), "{bsdf:?} {sample:?} {told:?}");
                    assert!(close_colors(sample.weight * sample.forward, flow, 1e-4), "{bsdf:?} {sample:?}");
                    assert!(!sample.dirac && (sample.wo.length() - 1.0).abs() < 1e-5);
                }
            }
        }
    }
}

/// A Dirac lobe: the way back must be among the lobes there, with the probability that was told.
#[test]
fn dirac_lobes_lead_back_with_the_probability_told() {
    for bsdf in examples().iter().filter(|bsdf| bsdf.has_dirac()) {
        for (number, wi) in incoming().into_iter().enumerate() {
            let (mut stream, mut other) = (stream(number as u64), stream(99));
            for sample in (0..50).filter_map(|_| bsdf.sample(UV, wi, Transport::Radiance, &mut stream)) {
                let mut back = (0..1_000)
                    .filter_map(|_| bsdf.sample(UV, sample.wo, Transport::Importance, &mut other))
                    .filter(|back| back.wo.dot(wi) > 0.999);
                let found = back.next().map(|back| back.forward);
                let rare = sample.backward < 0.02;
                assert!(
                    rare || found.is_some_and(|p| close(p, sample.backward, 1e-3)),
                    "{bsdf:?} from {wi}: {sample:?}, back {found:?}"
                );
            }
        }
    }
}

/// A white furnace: importance neither grows nor, in a sample that ends, is forgotten.
#[test]
fn no_model_makes_energy() {
    let samples = 20_000;
    for bsdf in examples() {
        for (number, wi) in incoming().into_iter().enumerate() {
            let mut stream = stream(number as u64);
            let (mut sum, mut squares) = (DVec3::ZERO, DVec3::ZERO);
            for _ in 0..samples {
                let sample = bsdf.sample(UV, wi, Transport::Importance, &mut stream);
                let weight = sample.map_or(DVec3::ZERO, |s| s.weight.as_dvec3());
                sum += weight;
                squares += weight * weight;
            }
            let n = f64::from(samples);
            let mean = (sum / n + bsdf.null_transmission(UV, wi.z).as_dvec3()).max_element();
            let deviation = ((squares / n - (sum / n) * (sum / n)).max_element().max(0.0) / n).sqrt();
            assert!(mean <= 1.0 + 5.0 * deviation + 1e-5, "{bsdf:?} from {wi}: {mean}");
        }
    }
}

/// Grazing to the last bit, both zeros, both sides.
fn extremes() -> Vec<Vec3> {
    let mut all = incoming();
    for z in [0.0, -0.0, 1e-45, 1e-38, 1e-20, 1e-7, -1e-45, -1e-20, -1e-7] {
        all.push(vec3(1.0, 0.0, z));
        all.push(vec3(0.6, -0.8, z));
    }
    all
}

#[test]
fn extreme_directions_give_finite_numbers() {
    for bsdf in examples() {
        for wi in extremes() {
            for transport in BOTH {
                let mut stream = stream(5);
                for s in (0..100).filter_map(|_| bsdf.sample(UV, wi, transport, &mut stream)) {
                    let finite = s.wo.is_finite() && s.weight.is_finite() && s.backward.is_finite();
                    assert!(finite && s.forward > 0.0 && s.forward.is_finite(), "{bsdf:?} {wi} {s:?}");
                }
                for wo in extremes() {
                    let v = bsdf.evaluate(UV, wi, wo, transport);
                    let finite = v.value.is_finite() && v.forward.is_finite() && v.backward.is_finite();
                    assert!(finite && v.value.min_element() >= 0.0, "{bsdf:?} {wi} {wo} {v:?}");
                }
            }
            assert!(bsdf.null_transmission(UV, wi.z).is_finite());
        }
    }
}

#[test]
fn survival_is_a_probability_and_blind_to_the_direction() {
    for bsdf in examples() {
        let above = bsdf.survival(UV, Vec3::Z);
        assert!((0.0..=1.0).contains(&above), "{bsdf:?}: {above}");
        for wi in incoming() {
            if wi.z > 0.0 || bsdf.transmits() {
                assert_eq!(bsdf.survival(UV, wi), above, "{bsdf:?}");
            }
        }
    }
}

fn built(plugin: &str, properties: &[(&str, Value)]) -> Result<Bsdf> {
    build(&object(plugin, properties), &Library::default())
}

fn number(x: f64) -> Value {
    Value::Float(x)
}

fn text(s: &str) -> Value {
    Value::String(s.into())
}

/// Cosine and azimuth of wi and wo for the tables below.
const DIRECTIONS: [[(f32, f32); 2]; 6] = [
    [(0.7, 0.4), (0.6, -2.5)],
    [(0.3, 1.0), (0.5, -1.8)],
    [(0.8, 0.4), (-0.75, -2.6)],
    [(-0.6, 2.0), (0.5, -1.3)],
    [(0.05, 0.0), (0.1, 3.0)],
    [(-0.9, 1.0), (-0.8, -2.0)],
];

/// `table` holds Mitsuba 3.9.1's `eval` (scalar_rgb) divided by |cos wo|, at `DIRECTIONS`.
fn check_against_mitsuba(bsdf: &Bsdf, transport: Transport, table: [[f32; 3]; 6]) {
    for ([wi, wo], expected) in DIRECTIONS.into_iter().zip(table) {
        let (wi, wo) = (warp::spherical(wi.0, wi.1), warp::spherical(wo.0, wo.1));
        let found = bsdf.evaluate(Vec2::ZERO, wi, wo, transport).value;
        for i in 0..3 {
            let agree = (found[i] - expected[i]).abs() <= 3e-4 * expected[i] + 1e-9;
            assert!(agree, "{bsdf:?} {wi} {wo}: {found} for {expected:?}");
        }
    }
}

#[test]
fn rough_dielectrics_are_those_of_mitsuba() {
    let grey = |table: [f32; 6]| table.map(|x| [x; 3]);
    let beckmann = built(
        "roughdielectric",
        &[("alpha", number(0.3)), ("int_ior", number(1.5)), ("ext_ior", number(1.0))],
    )
    .unwrap();
    let radiance = [0.094_104_5, 0.151_395, 3.385_9e-6, 0.017_324_1, 0.005_941_42, 0.066_477_8];
    let importance = [0.094_104_5, 0.151_395, 7.618_27e-6, 0.007_699_6, 0.005_941_42, 0.066_477_8];
    check_against_mitsuba(&beckmann, Transport::Radiance, grey(radiance));
    check_against_mitsuba(&beckmann, Transport::Importance, grey(importance));
    let ggx = built(
        "roughdielectric",
        &[
            ("distribution", text("ggx")),
            ("alpha_u", number(0.2)),
            ("alpha_v", number(0.5)),
            ("int_ior", text("water")),
        ],
    )
    .unwrap();
    let radiance = [0.049_296_9, 0.015_412_2, 0.348_387, 0.963_568, 3.176_23, 0.026_644_4];
    let importance = [0.049_296_9, 0.015_412_2, 0.618_702, 0.542_579, 3.176_23, 0.026_644_4];
    check_against_mitsuba(&ggx, Transport::Radiance, grey(radiance));
    check_against_mitsuba(&ggx, Transport::Importance, grey(importance));
}

#[test]
fn rough_conductors_are_those_of_mitsuba() {
    let black = [0.0; 3];
    let check = |properties: &[(&str, Value)], table| {
        let bsdf = built("roughconductor", properties).unwrap();
        check_against_mitsuba(&bsdf, Transport::Radiance, table);
    };
    let copper = [
        [1.605_15, 1.048_22, 0.873_985],
        [1.227_85, 0.823_358, 0.708_477],
        black,
        black,
        [0.010_16, 0.008_648_24, 0.008_262_72],
        black,
    ];
    check(&[("alpha", number(0.3)), ("material", text("Cu"))], copper);
    let gold = [
        [1.484_35, 1.232_35, 0.525_227],
        [0.177_606, 0.149_553, 0.072_694_9],
        black,
        black,
        [5.828_4, 5.496_51, 4.269_91],
        black,
    ];
    let anisotropic = |u, v| [("alpha_u", number(u)), ("alpha_v", number(v))];
    let ggx = [("distribution", text("ggx")), ("material", text("Au"))];
    check(&[anisotropic(0.2, 0.5), ggx].concat(), gold);
    let tinted = [[0.214_14; 3], [1.109_97; 3], black, black, black, black];
    let metal = [("eta", number(1.2)), ("k", number(2.0)), ("specular_reflectance", number(0.5))];
    check(&[&anisotropic(0.5, 0.15)[..], &metal[..]].concat(), tinted);
}

/// Mitsuba 3.9.1's reflectances at these cosines, for an index of 1.5 and for gold.
#[test]
fn smooth_interfaces_are_those_of_mitsuba() {
    let index = [("int_ior", number(1.5)), ("ext_ior", number(1.0))];
    let chance = |plugin, wi, transport, lobe: fn(&BsdfSample) -> bool| {
        let bsdf = built(plugin, &index).unwrap();
        let mut stream = stream(0);
        (0..1_000).filter_map(|_| bsdf.sample(UV, wi, transport, &mut stream)).find(lobe).unwrap()
    };
    let up = warp::spherical(0.8, 0.4);
    let reflected = chance("dielectric", up, Transport::Radiance, |s| s.wo.z > 0.0);
    assert!(close(reflected.forward, 0.043_894_73, 1e-5) && close(reflected.weight.x, 1.0, 1e-5));
    let refracted = chance("dielectric", up, Transport::Radiance, |s| s.wo.z < 0.0);
    assert!(refracted.wo.distance(vec3(-0.368_424, -0.155_767, -0.916_515)) < 1e-5);
    assert!(close(refracted.weight.x, 1.0 / 2.25, 1e-5));
    let from_below = chance("dielectric", -up, Transport::Radiance, |s| s.wo.z > 0.0);
    assert!(close(from_below.forward, 0.885_858_9, 1e-5) && close(from_below.weight.x, 2.25, 1e-5));
    let importance = chance("dielectric", -up, Transport::Importance, |s| s.wo.z > 0.0);
    assert!(close(importance.weight.x, 1.0, 1e-5));
    let pane = built("thindielectric", &index).unwrap();
    for (cosine, reflectance) in [(0.8, 0.084_098), (-0.3, 0.344_036_85), (0.1, 0.727_405_55)] {
        let sample =
            pane.sample(UV, warp::spherical(cosine, 0.4), Transport::Radiance, &mut stream(0)).unwrap();
        assert!(close(sample.weight.x, reflectance, 1e-5));
        assert!(close(pane.null_transmission(UV, cosine).x, 1.0 - reflectance, 1e-5));
    }
    let gold = built("conductor", &[("material", text("Au"))]).unwrap();
    for (cosine, colour) in
        [(0.8, [0.966_069, 0.801_277, 0.329_045]), (0.1, [0.973_435, 0.919_499, 0.718_891])]
    {
        let sample =
            gold.sample(UV, warp::spherical(cosine, 0.4), Transport::Radiance, &mut stream(0)).unwrap();
        assert!(close_colors(sample.weight, Spectrum::from(colour), 1e-5));
    }
}

#[test]
fn parameters_out_of_range_are_errors() {
    let nested = |plugin: &str| ("", Value::Object(object(plugin, &[])));
    let cases: Vec<(&str, Vec<(&str, Value)>)> = vec![
        ("diffuse", vec![("reflectance", number(1.5))]),
        ("diffuse", vec![("reflectanse", number(0.5))]),
        ("dielectric", vec![("int_ior", number(0.0))]),
        ("dielectric", vec![("int_ior", text("watter"))]),
        ("dielectric", vec![("specular_reflectance", number(-0.5))]),
        ("conductor", vec![("material", text("gold"))]),
        ("conductor", vec![("material", text("Au")), ("eta", number(1.0))]),
        ("roughconductor", vec![("alpha_u", number(0.1))]),
        ("roughconductor", vec![("alpha", number(0.1)), ("alpha_u", number(0.1)), ("alpha_v", number(0.1))]),
        ("roughconductor", vec![("alpha", number(-0.1))]),
        ("roughdielectric", vec![("distribution", text("phong"))]),
        ("twosided", vec![]),
        ("twosided", vec![nested("dielectric")]),
        ("twosided", vec![nested("diffuse"), nested("null")]),
        ("twosided", vec![nested("diffuse"), nested("diffuse"), nested("diffuse")]),
    ];
    for (plugin, properties) in cases {
        assert!(built(plugin, &properties).is_err(), "{plugin} {properties:?}");
    }
}

#[test]
fn a_rough_interface_of_equal_indices_is_a_smooth_one() {
    for index in [1.0, 1.0 + 1e-6, 1.0 - 1e-6] {
        let indices = [("int_ior", number(index)), ("ext_ior", number(1.0))];
        let bsdf = built("roughdielectric", &indices).unwrap();
        assert!(matches!(bsdf, Bsdf::Dielectric(_)), "{bsdf:?}");
    }
}
