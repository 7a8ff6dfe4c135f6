//! `tyndall pixel --outliers`: what makes single bright pixels is found, and told of as it was.

use crate::{
    common::{self, Stage, pieces::*, strategies},
    html,
    sandbox::Sandbox,
};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use tyndall::{
    analysis::pixel::{
        outliers::{self, Outliers, Plan},
        sample::PixelSample,
    },
    film::sharing::FilmSamples,
    math::{Spectrum, SpectrumExt},
    render::instrument::Instrument,
    transport::Strategies,
};

const SIZE: u32 = 9;
const SAMPLES: u32 = 3;

fn room_with(fog: Option<Value>, filter: &str) -> Value {
    let mut scene = scene(&[
        ("sensor", camera([0.0, 0.0, 0.9], [0.0, 0.0, -1.0], SIZE)),
        ("room", room(0.6, fog)),
        ("lamp", lamp_ball([0.2, 0.3, -0.3], 0.3, rgb(2.0, 3.0, 1.0))),
        ("point", point([-0.5, 0.5, 0.0], 0.3)),
        ("sky", sky(0.1)),
    ]);
    scene["sensor"]["film"]["rfilter"] = json!({"type": filter});
    scene
}

fn search(stage: &Stage, set: Strategies, most: usize) -> Outliers {
    let plan = Plan { most, first: 0, samples: SAMPLES };
    outliers::examine(&stage.setup, &stage.settings(set, SAMPLES.into(), 3), &plan, &mut |_| {}).unwrap()
}

/// A contribution of a sample.
#[derive(Clone, Copy, Debug)]
struct Part {
    pixel: usize,
    sample: usize,
    order: [u32; 2],
    value: Spectrum,
}

fn luminance(value: Spectrum) -> f64 {
    f64::from(value.luminance())
}

/// All samples of all pixels, one by one.
fn samples(stage: &Stage, set: Strategies) -> Vec<Vec<PixelSample>> {
    let settings = stage.settings(set, SAMPLES.into(), 3);
    let instrument = Instrument::new(&stage.setup.scene, &stage.setup.film, &settings);
    let of = |pixel| (0..SAMPLES as usize).map(|pass| PixelSample::of(&instrument, pass, pixel)).collect();
    (0..(SIZE * SIZE) as usize).map(of).collect()
}

/// The brightest contribution to each pixel. A light subpath's counts in the pixel that gets most of it.
fn brightest(samples: &[Vec<PixelSample>]) -> Vec<Option<Part>> {
    let (mut parts, mut splats) = (Vec::new(), BTreeMap::<_, Part>::new());
    for (pixel, passes) in samples.iter().enumerate() {
        for (sample, one) in passes.iter().enumerate() {
            let part = |order, value| Part { pixel, sample, order, value };
            parts.extend(one.tries.iter().filter_map(|tried| {
                Some(part([tried.s, tried.t], tried.contribution.as_ref()?.value * one.factor))
            }));
            for splat in &one.splats {
                let next = part([splat.s, 1], splat.value());
                let kept = splats.entry((sample, splat.walk, splat.s)).or_insert(next);
                if luminance(next.value).abs() > luminance(kept.value).abs() {
                    *kept = next;
                }
            }
        }
    }
    let size = |part: &Part| luminance(part.value).abs();
    let mut best = vec![None::<Part>; samples.len()];
    for part in parts.into_iter().chain(splats.into_values()) {
        let best = &mut best[part.pixel];
        if size(&part) > best.as_ref().map_or(0.0, size) {
            *best = Some(part);
        }
    }
    best
}

/// Sum of the squared deviations from the mean.
fn deviations(values: &[f64]) -> f64 {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    values.iter().map(|value| (value - mean).powi(2)).sum()
}

/// By how much less a pixel deviates without a contribution.
fn less(passes: &[f64], part: &Part) -> f64 {
    let mut without = passes.to_vec();
    without[part.sample] -= luminance(part.value);
    deviations(passes) - deviations(&without)
}

/// The samples of all pixels, shared, are the pass that a render adds.
#[test]
fn shared_samples_make_the_pass() {
    for filter in ["gaussian", "tent", "lanczos"] {
        let stage = Stage::new(&room_with(Some(medium(1.0, 0.8, 0.3)), filter));
        let rendered = stage.render(Strategies::BDPT, 1, 3);
        let passes = samples(&stage, Strategies::BDPT);
        let light = |sample: &PixelSample| sample.splats.iter().map(|splat| splat.value()).sum::<Spectrum>();
        let mut camera: Vec<Spectrum> =
            passes.iter().map(|samples| samples[0].value - light(&samples[0])).collect();
        let settings = stage.settings(Strategies::BDPT, 1, 3);
        let instrument = Instrument::new(&stage.setup.scene, &stage.setup.film, &settings);
        instrument.compiled.sharing(0).unwrap().share(&mut camera);
        for (pixel, (camera, rendered)) in camera.iter().zip(&rendered).enumerate() {
            let value = *camera + light(&passes[pixel][0]);
            assert!((value - *rendered).abs().max_element() < 1e-4, "{filter} {pixel}: {value} {rendered}");
        }
    }
}

#[test]
fn what_is_found_is_what_all_samples_hold() {
    let fog = medium(1.0, 0.8, 0.3);
    let chromatic = medium(rgb(0.3, 1.0, 2.0), 0.8, 0.3);
    for (name, scene) in [
        ("vacuum", room_with(None, "gaussian")),
        ("negative lobes", room_with(Some(fog.clone()), "lanczos")),
        ("fire", room_with(Some(with(fog, &[("radiance", json!(1))])), "box")),
        ("chromatic", room_with(Some(chromatic), "box")),
    ] {
        let stage = Stage { film_samples: FilmSamples::Own, ..Stage::new(&scene) };
        for set in [Strategies::BDPT, Strategies::LT, strategies("hit+next-event+join")] {
            let what = format!("{name}, {}", common::name_of(set));
            let (found, samples) = (search(&stage, set, 1000), samples(&stage, set));
            let passes: Vec<Vec<f64>> = samples
                .iter()
                .map(|passes| passes.iter().map(|one| luminance(one.value)).collect())
                .collect();
            let error: f64 = passes.iter().map(|passes| deviations(passes)).sum();
            let sum: f64 = passes.iter().flatten().sum();
            let mean = sum / f64::from(SAMPLES * SIZE * SIZE);
            assert!((found.mean / mean - 1.0).abs() < 1e-5, "{what}: {} {mean}", found.mean);
            let brightest = brightest(&samples);
            let mut told = vec![false; samples.len()];
            for one in &found.outliers {
                let pixel = (one.pixel[1] * SIZE + one.pixel[0]) as usize;
                assert!(!std::mem::replace(&mut told[pixel], true), "{what}: {pixel} twice");
                let best = brightest[pixel].unwrap();
                assert_eq!((one.sample, [one.s, one.t]), (best.sample as u64, best.order), "{what}");
                assert_eq!(one.value, best.value.to_array(), "{what}");
                let (own, all) = (luminance(best.value), passes[pixel].iter().sum::<f64>());
                let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-4 * b.abs() + 1e-6, "{what}: {a} {b}");
                near(one.times_mean, own.abs() / mean);
                near(one.pixel_share.unwrap(), own / all);
                near(one.error_share.unwrap(), less(&passes[pixel], &best) / error);
                assert_eq!(one.path.len() as u32, one.s + one.t, "{what}: {one:?}");
                assert_eq!(
                    (one.path[0].kind, one.path.last().unwrap().kind),
                    ("camera", "emitter"),
                    "{what}"
                );
            }
            let shares = found.outliers.iter().map(|one| one.error_share.unwrap());
            assert!(shares.is_sorted_by(|a, b| a >= b), "{what}");
            // Nothing that makes more of the error than all that is told of is left out.
            let few = search(&stage, set, 5).outliers;
            assert_eq!(few.len(), 5, "{what}");
            let kept: Vec<[u32; 2]> = few.iter().map(|one| one.pixel).collect();
            assert!(kept.contains(&found.outliers[0].pixel), "{what}");
        }
    }
}

/// A ball of glass throws the light of a small lamp onto the floor.
fn caustic() -> Value {
    let glass =
        json!({"type": "sphere", "center": [0.0, 0.0, 0.0], "radius": 0.4, "bsdf": {"type": "dielectric"}});
    scene(&[
        ("sensor", camera([0.0, 0.6, 2.5], [0.0, -0.5, 0.0], 16)),
        ("floor", floor(-0.6, 1.0, 0.5)),
        ("glass", glass),
        ("lamp", lamp_panel([0.0, 2.0, 0.0], 0.1, 1000.0)),
    ])
}

#[test]
fn the_strategy_of_a_caustic_is_named() {
    let sandbox = Sandbox::with_scene(&caustic());
    let words = "pixel scene.json --outliers 3 --samples 64 --integrator pt --seed 1";
    let (code, out, err) = sandbox.run(words).reported();
    assert_eq!(code, Some(0), "{err}");
    let told: Value = serde_json::from_str(&out).unwrap();
    let worst = &told["outliers"][0];
    assert_eq!(
        (&worst["strategy"], &worst["s"], &worst["t"]),
        (&json!("hit"), &json!(0), &json!(5)),
        "{worst}"
    );
    let path = worst["path"].as_array().unwrap();
    let kinds: Vec<&str> = path.iter().map(|vertex| vertex["kind"].as_str().unwrap()).collect();
    assert_eq!(kinds, ["camera", "surface", "surface", "surface", "emitter"]);
    let dirac: Vec<bool> = path.iter().map(|vertex| vertex["dirac"].as_bool().unwrap()).collect();
    assert_eq!(dirac, [false, false, true, true, false]);
    let shapes: Vec<&Value> = path[1..4].iter().map(|vertex| &vertex["surface"]["shape"]["name"]).collect();
    assert_eq!(shapes, ["floor", "glass", "glass"]);
    assert!(worst["times_mean"].as_f64().unwrap() > 20.0 && worst["pixel_share"].as_f64().unwrap() > 0.5);
    // Light subpaths find it by chance less.
    let (_, out, _) = sandbox.run(&words.replace("pt", "bdpt")).reported();
    let less: Value = serde_json::from_str(&out).unwrap();
    assert!(less["outliers"][0]["times_mean"].as_f64() < worst["times_mean"].as_f64());
}

/// What is as bright in every sample is no noise.
#[test]
fn a_lamp_that_is_seen_is_none() {
    let wall = scene(&[
        ("sensor", camera([0.0, 0.0, 1.0], [0.0, 0.0, 0.0], 4)),
        ("wall", json!({"type": "rectangle", "emitter": {"type": "area", "radiance": 5.0}})),
    ]);
    let sandbox = Sandbox::with_scene(&wall);
    let run = |words: &str| sandbox.run(&format!("pixel scene.json --outliers {words}")).reported();
    let (code, out, _) = run("-o a.json");
    assert_eq!((code, out.contains("no contribution stands out")), (Some(0), true), "{out}");
    // A single sample tells of no error: what is brightest counts.
    let (_, out, _) = run("2 --samples 1");
    let told: Value = serde_json::from_str(&out).unwrap();
    assert_eq!(told["outliers"].as_array().unwrap().len(), 2);
    let times = told["outliers"][0]["times_mean"].as_f64().unwrap();
    assert!(told["outliers"][0]["error_share"].is_null() && (times - 1.0).abs() < 1e-5, "{told}");
}

#[test]
fn file_table_and_page_tell_the_same() {
    let sandbox = Sandbox::with_scene(&caustic());
    let run =
        |words: &str| sandbox.run(&format!("pixel scene.json --outliers {words} --samples 4")).reported();
    let (_, printed, _) = run("");
    let (code, out, err) = run("-o told.json --threads 1");
    assert_eq!(code, Some(0), "{err}");
    assert_eq!(sandbox.text("told.json"), printed);
    let told = sandbox.json("told.json");
    let outliers = told["outliers"].as_array().unwrap();
    assert_eq!(outliers.len(), 10);
    let [x, y] = [0, 1].map(|i| outliers[0]["pixel"][i].as_u64().unwrap());
    assert!(out.contains(&format!("1. pixel {x} {y}, sample")) && out.ends_with("told.json\n"), "{out}");
    assert!(out.contains("surface floor of diffuse"), "{out}");
    let (_, _, lines) = run("-o told.json --progress json");
    assert_eq!(lines.lines().last(), Some("{\"done\":1.0}"), "{lines}");
    let (_, again, _) = run("-o told.html");
    assert_eq!(again.replace("told.html", "told.json"), out);
    let page = html::parse(&sandbox.text("told.html"));
    assert_eq!(html::texts(&page, "h2")[0], format!("1. Pixel {x} {y}, sample {}", outliers[0]["sample"]));
    assert_eq!(html::all(&page, "svg").len(), 20);
    let vertices: usize = outliers.iter().map(|one| one["path"].as_array().unwrap().len()).sum();
    assert_eq!(html::all(&page, "circle").len(), 2 * vertices);
    assert_eq!(html::all(&page, "tbody tr").len(), vertices);
    for circle in html::all(&page, "circle") {
        let [x, y] = ["cx", "cy"].map(|name| circle.attribute(name).unwrap().parse::<f64>().unwrap());
        assert!((0.0..=460.0).contains(&x) && (0.0..=260.0).contains(&y), "{x} {y}");
    }
}

#[test]
fn contradictions_are_refused() {
    let sandbox = Sandbox::with_scene(&caustic());
    for (words, hints) in [
        ("pixel scene.json 4 4 --outliers", vec!["--outliers", "X = 4 and Y = 4", "leave out"]),
        ("pixel scene.json --outliers 3 4", vec!["--outliers", "X = 4", "leave out"]),
        ("pixel scene.json --outliers 0", vec!["1 to 1000"]),
        ("pixel scene.json --outliers 1001", vec!["1 to 1000"]),
        ("pixel scene.json --outliers --samples 0", vec!["--samples"]),
        ("pixel scene.json --outliers --integrator fog", vec!["paths", "--integrator bdpt"]),
        ("pixel scene.json 1 1 -o a.html", vec!["--output", "JSON", "--outliers"]),
        ("pixel scene.json", vec!["<X>", "<Y>"]),
    ] {
        let (code, _, err) = sandbox.run(words).reported();
        assert_eq!(code, Some(2), "{words}: {err}");
        assert!(hints.iter().all(|hint| err.contains(hint)) && !err.contains("panicked"), "{words}: {err}");
    }
}

/// Whatever lies where: a page has no number that is none.
#[test]
fn every_path_can_be_drawn() {
    for (name, scene) in [
        (
            "sky",
            scene(&[
                ("sensor", camera([0.0, 0.6, 3.2], [0.0, 0.2, 0.0], 8)),
                ("floor", floor(-0.6, 2.0, 0.5)),
                ("sun", sun([0.3, -1.0, -0.2], 1.0)),
                ("sky", sky(0.5)),
            ]),
        ),
        (
            "meter",
            scene(&[
                (
                    "sensor",
                    json!({"type": "radiancemeter", "sampler": {"type": "independent", "sample_count": 8},
                "to_world": [{"type": "lookat", "origin": [0, 1, 1], "target": [0, -0.6, 0], "up": [0, 1, 0]}]}),
                ),
                ("floor", floor(-0.6, 2.0, 0.5)),
                ("lamp", lamp_ball([0.0, 1.0, -1.0], 0.2, 3.0)),
            ]),
        ),
    ] {
        let sandbox = Sandbox::with_scene(&scene);
        let (code, _, err) = sandbox.run("pixel scene.json --outliers --samples 1 -o a.html").reported();
        assert_eq!(code, Some(0), "{name}: {err}");
        let page = sandbox.text("a.html");
        assert!(!page.contains("NaN"), "{name}");
        let page = html::parse(&page);
        let ends = ["x1", "y1", "x2", "y2"];
        for line in html::all(&page, "line") {
            let ends = ends.map(|name| line.attribute(name).unwrap().parse::<f64>().unwrap());
            assert!(ends.iter().all(|at| (0.0..=460.0).contains(at)), "{name}: {ends:?}");
        }
        assert!(html::all(&page, "circle").len() >= 4, "{name}");
    }
}
