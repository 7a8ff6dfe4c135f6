//! What holds for every surface model, over every model's examples.

mod albedo;
mod burley;
mod mitsuba;
mod parameters;
mod perturbed;
mod sampling;

use super::*;
use crate::description::Value;
use crate::math::{DVec3, Vec2, warp};
use crate::sampling::stream::Purpose;
use crate::testing::object;

const UV: Uv = Uv::At(Vec2::new(0.3, 0.6));
const BOTH: [Transport; 2] = [Transport::Radiance, Transport::Importance];

/// Directions from straight above to near-grazing, on both sides.
fn incoming() -> Vec<Vec3> {
    let upper = [(1.0, 0.0), (0.7, 0.4), (0.4, 2.0), (0.1, -1.0), (0.02, 3.0)];
    let upper = upper.map(|(cosine, azimuth)| warp::spherical(cosine, azimuth));
    upper.into_iter().chain(upper.map(|w| vec3(w.x, w.y, -w.z))).collect()
}

fn stream(index: u64) -> Stream {
    Stream::new(11, index, 0, Purpose::Study)
}

/// True of models that are functions of eye and light, not of two directions alike.
fn is_one_way(bsdf: &Bsdf) -> bool {
    matches!(bsdf, Bsdf::NormalMap(_) | Bsdf::BumpMap(_))
}

fn connectible() -> Vec<Bsdf> {
    examples().into_iter().filter(BsdfModel::is_connectible).collect()
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
            let agree = close(there.pdf_rev, back.pdf_fwd, 2e-3) && close(there.pdf_fwd, back.pdf_rev, 2e-3);
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
            let one_way = !same_side || is_one_way(&bsdf);
            assert!(one_way || close_colors(radiance, reversed, 2e-3), "{bsdf:?}, {wi} to {wo}");
        }
    }
}

#[test]
fn samples_tell_what_evaluation_tells() {
    for bsdf in connectible() {
        for (number, wi) in incoming().into_iter().enumerate() {
            for transport in BOTH {
                let mut stream = stream(number as u64);
                let samples = (0..200).filter_map(|_| bsdf.sample(UV, wi, transport, &mut stream));
                for sample in samples.filter(|sample| !sample.dirac) {
                    let reported = bsdf.evaluate(UV, wi, sample.wo, transport);
                    let flow = reported.value * sample.wo.z.abs();
                    assert!(
                        close(reported.pdf_fwd, sample.pdf_fwd, 1e-4),
                        "{bsdf:?} {sample:?} {reported:?}"
                    );
                    assert!(
                        close(reported.pdf_rev, sample.pdf_rev, 1e-4),
                        "{bsdf:?} {sample:?} {reported:?}"
                    );
                    assert!(close_colors(sample.weight * sample.pdf_fwd, flow, 1e-4), "{bsdf:?} {sample:?}");
                    assert!((sample.wo.length() - 1.0).abs() < 1e-5);
                }
            }
        }
    }
}

/// A Dirac lobe: the way back must be among the lobes there, with the probability that was reported.
#[test]
fn dirac_lobes_lead_back_with_the_probability_told() {
    for bsdf in examples().iter().filter(|bsdf| bsdf.has_dirac()) {
        for (number, wi) in incoming().into_iter().enumerate() {
            let (mut stream, mut other) = (stream(number as u64), stream(99));
            let samples = (0..50).filter_map(|_| bsdf.sample(UV, wi, Transport::Radiance, &mut stream));
            for sample in samples.filter(|sample| sample.dirac) {
                // Lobes of a blend may have one direction in common.
                let mut back = (0..1_000)
                    .filter_map(|_| bsdf.sample(UV, sample.wo, Transport::Importance, &mut other))
                    .filter(|back| back.dirac && back.wo.dot(wi) > 0.999);
                let rare = sample.pdf_rev < 0.02;
                let found = rare || back.any(|back| close(back.pdf_fwd, sample.pdf_rev, 1e-3));
                assert!(found, "{bsdf:?} from {wi}: {sample:?} does not lead back");
            }
        }
    }
}

/// A white furnace: importance neither grows nor, in a sample that ends, is forgotten. A tilted surface gathers more light
/// than its shape lets through, and what it keeps is told by radiance, which refraction makes grow.
#[test]
fn no_model_makes_energy() {
    let samples = 20_000;
    let told = |bsdf: &Bsdf| !is_one_way(bsdf) || !bsdf.scatters_across();
    for bsdf in examples().into_iter().filter(told) {
        let transport = if is_one_way(&bsdf) { Transport::Radiance } else { Transport::Importance };
        for (number, wi) in incoming().into_iter().enumerate() {
            let mut stream = stream(number as u64);
            let (mut sum, mut squares) = (DVec3::ZERO, DVec3::ZERO);
            for _ in 0..samples {
                let sample = bsdf.sample(UV, wi, transport, &mut stream);
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

/// The smoothest rough surfaces, and the weakest rough interface, that there are.
fn sharp() -> Vec<Bsdf> {
    let mut all = Vec::new();
    for kind in ["beckmann", "ggx"] {
        let rough = |plugin, more: (&str, Value)| {
            built(plugin, &[("distribution", text(kind)), ("alpha", number(0.0)), more]).unwrap()
        };
        all.push(rough("roughconductor", ("material", text("Ag"))));
        all.push(rough("roughdielectric", ("int_ior", number(1.5))));
        let alpha = ("alpha", number(1.0));
        let indices = [("int_ior", number(1.000_02)), ("ext_ior", number(1.0))];
        all.push(
            built("roughdielectric", &[&[("distribution", text(kind)), alpha][..], &indices].concat())
                .unwrap(),
        );
    }
    all
}

#[test]
fn extreme_directions_give_finite_numbers() {
    for bsdf in examples().into_iter().chain(sharp()) {
        for wi in extremes() {
            for transport in BOTH {
                let mut stream = stream(5);
                for s in (0..100).filter_map(|_| bsdf.sample(UV, wi, transport, &mut stream)) {
                    let finite = s.wo.is_finite() && s.weight.is_finite() && s.pdf_rev.is_finite();
                    assert!(finite && s.pdf_fwd > 0.0 && s.pdf_fwd.is_finite(), "{bsdf:?} {wi} {s:?}");
                }
                for wo in extremes() {
                    let v = bsdf.evaluate(UV, wi, wo, transport);
                    let finite = v.value.is_finite() && v.pdf_fwd.is_finite() && v.pdf_rev.is_finite();
                    assert!(finite && v.value.min_element() >= 0.0, "{bsdf:?} {wi} {wo} {v:?}");
                }
            }
            assert!(bsdf.null_transmission(UV, wi.z).is_finite());
        }
    }
}

/// A Dirac lobe comes as often as it says.
#[test]
fn dirac_lobes_come_with_the_probability_told() {
    let samples = 20_000;
    for bsdf in examples().iter().filter(|bsdf| bsdf.has_dirac()) {
        for (number, wi) in incoming().into_iter().enumerate() {
            let mut stream = stream(number as u64);
            let mut lobes: Vec<(Vec3, f32, u32)> = Vec::new();
            for _ in 0..samples {
                let Some(s) = bsdf.sample(UV, wi, Transport::Radiance, &mut stream) else { continue };
                let same = |lobe: &&mut (Vec3, f32, u32)| lobe.0 == s.wo && lobe.1 == s.pdf_fwd;
                match lobes.iter_mut().find(same) {
                    _ if !s.dirac => {}
                    Some(lobe) => lobe.2 += 1,
                    None => lobes.push((s.wo, s.pdf_fwd, 1)),
                }
            }
            for (wo, reported, count) in lobes {
                let (n, p) = (f64::from(samples), f64::from(reported));
                let slack = 5.0 * (n * p * (1.0 - p)).sqrt() + 3.0;
                assert!((f64::from(count) - n * p).abs() < slack, "{bsdf:?} {wi} to {wo}: {count} for {p}");
            }
        }
    }
}

#[test]
fn walks_survive_alike_both_ways() {
    for bsdf in examples() {
        for (number, wi) in incoming().into_iter().enumerate() {
            let mut stream = stream(number as u64);
            for s in (0..100).filter_map(|_| bsdf.sample(UV, wi, Transport::Radiance, &mut stream)) {
                let (there, back) = (bsdf.survival(UV, wi), bsdf.survival(UV, s.wo));
                assert_eq!(there, back, "{bsdf:?} from {wi} to {}", s.wo);
            }
        }
    }
}

/// Plastics and blends of surfaces that absorb much leave it to [`BsdfModel::survival`] to end walks.
#[test]
fn what_is_absorbed_ends_no_sample() {
    let dark = |name| (name, Value::Float(0.1));
    let matt = || ("a", nested("diffuse", &[dark("reflectance")]));
    let metal = || ("b", nested("conductor", &[dark("specular_reflectance")]));
    let blend: &[_] = &[("weight", number(0.3)), matt(), metal()];
    for (plugin, properties) in [
        ("plastic", &[dark("diffuse_reflectance")][..]),
        ("roughplastic", &[dark("diffuse_reflectance")]),
        ("blendbsdf", blend),
    ] {
        let bsdf = built(plugin, properties).unwrap();
        let mut stream = stream(3);
        let mut go_on = || bsdf.sample(UV, Vec3::Z, Transport::Radiance, &mut stream).is_some();
        assert!((0..1_000).all(|_| go_on()), "{plugin}");
        let survival = bsdf.survival(UV, Vec3::Z);
        assert!((0.05..0.5).contains(&survival), "{plugin}: {survival}");
    }
}

#[test]
fn survival_is_a_probability_and_blind_to_the_direction() {
    for bsdf in examples() {
        let above = bsdf.survival(UV, Vec3::Z);
        assert!((0.0..=1.0).contains(&above), "{bsdf:?}: {above}");
        for wi in incoming() {
            if wi.z > 0.0 || bsdf.scatters_across() {
                assert_eq!(bsdf.survival(UV, wi), above, "{bsdf:?}");
            }
        }
    }
}

fn built(plugin: &str, properties: &[(&str, Value)]) -> Result<Bsdf> {
    build(&object(plugin, properties), &Library::default())
}

fn nested(plugin: &str, properties: &[(&str, Value)]) -> Value {
    Value::Object(object(plugin, properties))
}

fn number(x: f64) -> Value {
    Value::Float(x)
}

fn text(s: &str) -> Value {
    Value::String(s.into())
}
