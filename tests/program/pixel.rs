//! `tyndall pixel`: a sample made again is the sample that was, and what is told of it adds up.

use crate::{
    common::{self, Stage, pieces::*, strategies},
    sandbox::Sandbox,
};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use tyndall::{
    analysis::pixel::sample::{Partner, PixelSample},
    film::sharing::FilmSamples,
    math::Spectrum,
    render::instrument::Instrument,
    scene::lights::EmissionSample,
    transport::{LightStarts, Strategies},
};

const SIZE: u32 = 40;

/// More pixels than one block has, seen through a filter that spreads what light subpaths bring.
fn foggy_room(fog: Option<Value>, filter: &str) -> Value {
    let mut scene = scene(&[
        ("sensor", camera([5.0, 0.0, 0.9], [5.0, 0.0, -1.0], SIZE)),
        ("room", with(room(0.6, fog), &[("to_world", place([1.0; 3], [5.0, 0.0, 0.0]))])),
        ("lamp", lamp_ball([5.2, 0.3, -0.3], 0.3, rgb(2.0, 3.0, 1.0))),
        ("point", point([4.5, 0.5, 0.0], 0.3)),
    ]);
    scene["sensor"]["film"]["rfilter"] = json!({"type": filter});
    scene
}

fn cloud_under_sky(sigma_t: Value) -> Value {
    scene(&[
        ("sensor", camera([0.0, 0.6, 3.2], [0.0, 0.2, 0.0], SIZE)),
        ("floor", floor(-0.6, 2.0, 0.5)),
        ("cloud", null_box([-0.8, -0.4, -0.8], [0.8, 0.8, 0.8], Some(medium(sigma_t, 0.9, 0.3)))),
        ("sky", sky(0.5)),
        ("sun", sun([0.3, -1.0, -0.2], 1.0)),
    ])
}

fn scenes() -> Vec<(&'static str, Value)> {
    let fog = medium(1.0, 0.8, 0.3);
    let chromatic = rgb(0.3, 1.0, 2.0);
    vec![
        ("vacuum", foggy_room(None, "box")),
        ("fog", foggy_room(Some(fog.clone()), "gaussian")),
        ("negative lobes", foggy_room(Some(fog.clone()), "lanczos")),
        ("fire", foggy_room(Some(with(fog, &[("radiance", json!(1))])), "tent")),
        ("chromatic fog", foggy_room(Some(medium(chromatic.clone(), 0.8, 0.3)), "gaussian")),
        ("chromatic cloud", cloud_under_sky(chromatic)),
    ]
}

/// The same scenes, with a collision forced on every primary ray.
fn forced() -> Vec<(&'static str, Value)> {
    let mut scenes = scenes();
    scenes.remove(0);
    for (_, scene) in &mut scenes {
        scene["integrator"] = json!({"type": "bdpt", "forced_interaction": true});
    }
    scenes
}

/// The same scenes, with a light subpath for every sample.
fn paired() -> Vec<(&'static str, Value)> {
    let mut scenes = scenes();
    for (_, scene) in &mut scenes {
        scene["integrator"] = json!({"type": "bdpt", "connections": "all"});
    }
    scenes
}

fn bits(value: Spectrum) -> [u32; 3] {
    value.to_array().map(f32::to_bits)
}

/// What is told of a sample fits together.
fn assert_consistent(what: &str, sample: &PixelSample) {
    let mut sum = Spectrum::ZERO;
    for one in &sample.tries {
        if !matches!(one.partner, Partner::Met(..)) {
            let vertices = sample.camera[one.walk].stops.len();
            assert!(
                (1..=vertices).contains(&(one.t as usize - 1)),
                "{what}: vertex {} of {vertices}",
                one.t - 1
            );
        }
        if let Partner::Light { walk, edges, position } = &one.partner {
            assert_eq!(one.s, edges + 1, "{what}");
            assert_eq!(
                sample.light[walk].stops[*edges as usize - 1].interaction.position(),
                *position,
                "{what}"
            );
        }
        let Some(joined) = &one.contribution else { continue };
        sum += joined.value * sample.factor;
        let (weight, rest) = (joined.share(), joined.alone * joined.share() - joined.value);
        assert!((0.0..=1.00001).contains(&weight), "{what}: {weight}");
        assert!(rest.abs().max_element() <= 1e-5 * joined.value.max_element(), "{what}: {joined:?}");
    }
    sum += sample.splats.iter().map(|splat| splat.value()).sum::<Spectrum>();
    let error = (sum - sample.value).abs().max_element();
    assert!(error <= 1e-5 * (sample.value.abs().max_element() + 1e-3), "{what}: {sum} {}", sample.value);
}

#[test]
fn a_sample_made_again_is_what_its_pass_adds() {
    let pixels = [0, 17, 20 * SIZE as usize + 13, 35 * SIZE as usize + 39, (SIZE * SIZE - 1) as usize];
    for (name, scene) in scenes().into_iter().chain(forced()).chain(paired()) {
        let stage = Stage { film_samples: FilmSamples::Own, ..Stage::new(&scene) };
        let (mut lit, mut joined, mut splats) = (0, 0, 0);
        for set in [Strategies::BDPT, Strategies::PT, Strategies::LT, strategies("hit+join")] {
            let instrument =
                Instrument::new(&stage.setup.scene, &stage.setup.film, &stage.settings(set, 1, 3));
            let mut passes = Vec::new();
            instrument.passes(0..4, &mut |image| passes.push(image.to_vec()));
            let rendered = stage.render(set, 1, 3);
            for (number, pass) in passes.iter().enumerate() {
                for pixel in pixels {
                    let what = format!("{name}, {}, pass {number}, pixel {pixel}", common::name_of(set));
                    let sample = PixelSample::of(&instrument, number, pixel);
                    assert_eq!(bits(sample.value), bits(pass[pixel]), "{what}");
                    if number == 0 {
                        assert_eq!(bits(sample.value), bits(rendered[pixel]), "{what}");
                    }
                    assert_consistent(&what, &sample);
                    lit += usize::from(sample.value != Spectrum::ZERO);
                    joined +=
                        sample.tries.iter().filter(|one| one.s >= 2 && one.contribution.is_some()).count();
                    splats += sample.splats.len();
                }
            }
        }
        // In the open, few light subpaths leave a vertex, and another's are not connected to.
        let least = if scene["integrator"]["connections"] == "all" { 0 } else { 5 };
        assert!(lit > 20 && joined > least && splats > 5, "{name}: {lit} {joined} {splats}");
    }
}

/// Points of lamps are told to be as dense as starts of light subpaths as they are.
#[test]
fn densities_of_starts_are_those_of_learnt_starts() {
    let mut stage = Stage::new(&foggy_room(Some(medium(1.0, 0.8, 0.3)), "box"));
    stage.setup.integrator.options.effort.starts = LightStarts::Learnt;
    let settings = stage.settings(Strategies::BDPT, 1, 3);
    let instrument = Instrument::new(&stage.setup.scene, &stage.setup.film, &settings);
    let samples: Vec<PixelSample> =
        (0..40).map(|pixel| PixelSample::of(&instrument, 0, 41 * pixel)).collect();
    let starts = samples.iter().flat_map(|sample| sample.light.values()).filter_map(|walk| walk.emitter);
    // All points of a lamp are as dense.
    let starts: BTreeMap<u32, EmissionSample> = starts.map(|start| (start.light, start)).collect();
    assert!(starts.values().any(|start| (start.pdf / start.unlearnt.point - 1.0).abs() > 0.02), "{starts:?}");
    let points = samples.iter().flat_map(|sample| &sample.tries).filter_map(|one| match &one.partner {
        Partner::Met(_, point) | Partner::Emitter(point) => Some((point, starts.get(&point.light)?)),
        Partner::Light { .. } => None,
    });
    let ratios: Vec<f32> = points.map(|(point, start)| point.pdf_start / start.pdf).collect();
    assert!(starts.len() == 2 && ratios.len() > 50 && ratios.iter().all(|ratio| (ratio - 1.0).abs() < 1e-4));
}

impl Sandbox {
    fn pixel(&self, words: &str) -> Value {
        let (code, out, err) = self.run(&format!("pixel scene.json {words}")).reported();
        assert_eq!(code, Some(0), "{words}: {err}");
        serde_json::from_str(&out).unwrap()
    }

    /// Pixel (`x`, `y`) of a render.
    fn rendered(&self, words: &str, x: usize, y: usize) -> [f32; 3] {
        let (code, _, err) = self.run(&format!("render scene.json -o image.pfm {words}")).reported();
        assert_eq!(code, Some(0), "{words}: {err}");
        let bytes = self.bytes("image.pfm");
        let size = SIZE as usize;
        let pixels = &bytes[bytes.len() - size * size * 12..];
        let at = 12 * ((size - 1 - y) * size + x);
        std::array::from_fn(|c| f32::from_le_bytes(pixels[at + 4 * c..at + 4 * c + 4].try_into().unwrap()))
    }
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
}

fn floats(value: &Value) -> [f32; 3] {
    std::array::from_fn(|i| numbers(value)[i] as f32)
}

#[test]
fn the_program_tells_what_a_render_holds() {
    let chromatic = medium(rgb(0.3, 1.0, 2.0), 0.8, 0.3);
    let sandbox = Sandbox::with_scene(&foggy_room(Some(chromatic), "gaussian"));
    for more in ["--seed 5", "--seed 6 --strategies hit,join,lens --max-depth 4", "--integrator pt"] {
        let more = &format!("{more} --film-samples own");
        let rendered = sandbox.rendered(&format!("--spp 1 {more}"), 22, 17);
        let reported = sandbox.pixel(&format!("22 17 {more}"));
        assert_eq!(floats(&reported["samples"][0]["value"]), rendered, "{more}");
        // The mean of two is half the sum.
        let mean = sandbox.rendered(&format!("--spp 2 {more}"), 22, 17);
        let reported = sandbox.pixel(&format!("22 17 --samples 2 {more}"));
        let [a, b] = [0, 1].map(|sample| floats(&reported["samples"][sample]["value"]));
        let halves: [f32; 3] = std::array::from_fn(|c| ((f64::from(a[c]) + f64::from(b[c])) / 2.0) as f32);
        assert_eq!(halves, mean, "{more}");
        let second = sandbox.pixel(&format!("22 17 --sample 1 {more}"));
        assert_eq!(second["samples"][0], reported["samples"][1]);
    }
}

/// A vertex nearer to a lamp than rays stay clear of it: with a length below nothing, the connection was amplified by
/// the medium, infinitely in this one's red.
#[test]
fn no_connection_is_shorter_than_nothing() {
    let view = json!([{"type": "lookat", "origin": [0.1, 0.2, 0.9], "target": [0, 0, -1], "up": [0, 1, 0]}]);
    let film = json!({"type": "hdrfilm", "width": 12, "height": 12, "rfilter": {"type": "box"}});
    let lamp = json!([
        {"type": "scale", "value": 0.3},
        {"type": "lookat", "origin": [0, 0.9, 0], "target": [0, 0, 0.1], "up": [0, 0, 1]},
    ]);
    let walls = json!({"type": "twosided", "side": diffuse(0.5)});
    let scene = scene(&[
        ("integrator", depth(64)),
        ("fog", medium(rgb(1e12, 1.0, 1e3), 1.0, 0.0)),
        (
            "sensor",
            json!({"type": "perspective", "fov": 40, "to_world": view, "film": film, "medium": named("fog")}),
        ),
        ("box", json!({"type": "cube", "interior": named("fog"), "bsdf": walls})),
        ("lamp", with(lamp_panel([0.0; 3], 0.3, 4.0), &[("to_world", lamp), ("bsdf", diffuse(0.5))])),
    ]);
    let reported = Sandbox::with_scene(&scene).pixel("5 3 --sample 59 --integrator pt");
    let value = reported["samples"][0]["value"].as_array().unwrap();
    assert!(value.iter().all(Value::is_number), "{value:?}");
}

/// Densities by hand (LW96 eq. 13): that of the direction, times transmittance, times extinction in the medium or the
/// cosine on a surface, over the square of the distance. Positions are those of the file.
#[test]
fn densities_are_those_of_the_walk() {
    let sandbox =
        Sandbox::with_scene(&foggy_room(Some(with(medium(0.7, 0.8, 0.3), &[("id", json!("mist"))])), "box"));
    let reported = sandbox.pixel("20 20 --samples 40");
    let (mut surfaces, mut media) = (0, 0);
    for sample in reported["samples"].as_array().unwrap() {
        let walk = &sample["eye_walks"][0];
        assert_eq!(numbers(&walk["start"]["position"]), [5.0, 0.0, 0.9], "the lens");
        let (mut before, mut leg) = (walk["start"]["position"].clone(), walk["start"]["onward"].clone());
        for vertex in walk["vertices"].as_array().unwrap() {
            let (from, to, direction) =
                (numbers(&before), numbers(&vertex["position"]), numbers(&leg["direction"]));
            let d2: f64 = from.iter().zip(&to).map(|(a, b)| (b - a).powi(2)).sum();
            let expected = leg["density"].as_f64().unwrap() * (-0.7 * d2.sqrt()).exp() / d2;
            let expected = if vertex["kind"] == "medium" {
                media += 1;
                assert_eq!((&vertex["measure"], &vertex["medium"]), (&json!("1/m^3"), &json!("mist")));
                expected * 0.7
            } else {
                surfaces += 1;
                let surface = &vertex["surface"];
                let (index, name) = (surface["shape"]["index"].as_u64().unwrap(), &surface["shape"]["name"]);
                assert_eq!(["room", "lamp"][index as usize - 1], name);
                assert_eq!(surface["emitter"] == "area", name == "lamp");
                let normal = numbers(&surface["normal"]);
                expected * normal.iter().zip(&direction).map(|(n, d)| n * d).sum::<f64>().abs()
            };
            let density = vertex["density"].as_f64().unwrap();
            assert!((density / expected - 1.0).abs() < 1e-3, "{density} {expected}: {vertex}");
            assert!(leg["dirac"] == false && leg["medium"] == "mist");
            (before, leg) = (vertex["position"].clone(), vertex["onward"].clone());
        }
        assert_eq!(walk["end"], "absorbed");
    }
    assert!(surfaces > 20 && media > 20, "{surfaces} {media}");
}

/// Weights that are told are those of paths: of one segment there are two strategies, and here one is left out.
#[test]
fn contributions_are_told_with_their_strategies() {
    let sandbox = Sandbox::with_scene(&foggy_room(Some(medium(0.3, 0.8, 0.3)), "box"));
    let reported = sandbox.pixel("20 20 --samples 100 --strategies hit,next-event,join");
    let samples = reported["samples"].as_array().unwrap();
    let all: Vec<&Value> = samples.iter().flat_map(|s| s["contributions"].as_array().unwrap()).collect();
    for one in &all {
        let (s, t) = (one["s"].as_u64().unwrap(), one["t"].as_u64().unwrap());
        assert_eq!(one["strategy"], ["hit", "next-event", "join"][s.min(2) as usize]);
        assert_eq!((&one["eye_walk"], &one["eye_vertex"]), (&json!(0), &json!(t - 1)));
        assert_eq!((one["light"].is_null(), one["emitter"].is_null()), (s < 2, s >= 2));
        if (s, t) == (0, 2) {
            assert_eq!(one["weight"], 1.0, "nothing else shows the lamp directly: {one}");
        }
        if one["reached"] == false {
            assert!(one["weight"].is_null() && floats(&one["value"]) == [0.0; 3]);
        }
    }
    assert!(all.iter().any(|one| one["s"] == 0) && all.iter().any(|one| one["s"] == 3));
    assert!(samples.iter().all(|sample| sample["splats"].as_array().unwrap().is_empty()));
    let names: Vec<&str> = all.iter().filter_map(|one| one["emitter"]["emitter"]["kind"].as_str()).collect();
    assert!(names.contains(&"area") && names.contains(&"point"));
}

#[test]
fn the_file_holds_what_is_printed_otherwise() {
    let sandbox = Sandbox::with_scene(&cloud_under_sky(json!(1.0)));
    let (code, out, err) = sandbox.run("pixel scene.json 3 5 -o told.json --threads 1").reported();
    assert_eq!((code, out.trim()), (Some(0), "told.json"), "{err}");
    let file: Value =
        serde_json::from_str(&std::fs::read_to_string(sandbox.path("told.json")).unwrap()).unwrap();
    assert_eq!(file, sandbox.pixel("3 5"));
    let ends: Vec<Value> = sandbox.pixel("3 5 --samples 20")["samples"]
        .as_array()
        .unwrap()
        .iter()
        .map(|sample| sample["eye_walks"][0]["end"].clone())
        .collect();
    assert!(ends.contains(&json!("left the scene")), "{ends:?}");
}

#[test]
fn what_is_not_there_is_refused() {
    let sandbox = Sandbox::with_scene(&foggy_room(None, "box"));
    for (words, hints) in [
        ("pixel scene.json 40 0", vec!["X", "0 to 39", "40"]),
        ("pixel scene.json 0 40", vec!["Y", "0 to 39", "40"]),
        ("pixel scene.json 4 4 --size 4x8", vec!["X", "0 to 3"]),
        ("pixel scene.json 4", vec!["<Y>"]),
        ("pixel scene.json -1 4", vec!["-1"]),
        ("pixel scene.json 4 4 --samples 0", vec!["--samples"]),
        ("pixel scene.json 4 4 --integrator fog", vec!["paths", "--integrator bdpt"]),
        ("pixel scene.json 4 4 -o nowhere/at.json", vec!["nowhere"]),
    ] {
        let (code, _, err) = sandbox.run(words).reported();
        assert_eq!(code, Some(2), "{words}: {err}");
        assert!(hints.iter().all(|hint| err.contains(hint)) && !err.contains("panicked"), "{words}: {err}");
    }
}
