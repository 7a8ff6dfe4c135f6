//! `tyndall strategies`: the parts that strategies bring make the image, each alone shows what all together do where it
//! can, and the program says so.

use crate::{
    common::{
        self, Stage,
        claims::{Claims, Sample},
        pieces::*,
    },
    sandbox::Sandbox,
};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use tyndall::{
    analysis::strategies::images::{StrategyCell, StrategyImages, StrategyTable},
    film::sharing::FilmSamples,
    math::Spectrum,
    render::instrument::Instrument,
    transport::{Strategies, strategy::StrategyKind},
};

fn foggy_room(fog: Value) -> Value {
    scene(&[
        ("sensor", camera([0.0, 0.0, 0.9], [0.0, 0.0, -1.0], 8)),
        ("fog", fog),
        ("room", room(0.6, Some(named("fog")))),
        ("lamp", lamp_ball([0.2, 0.3, -0.3], 0.3, rgb(2.0, 3.0, 1.0))),
    ])
}

/// With a filter whose shares go to many pixels, some of them negative.
fn through_filter(mut scene: Value, filter: &str) -> Value {
    scene["sensor"]["film"]["rfilter"] = json!({"type": filter});
    scene
}

fn glass_ball() -> Value {
    scene(&[
        ("sensor", camera([0.0, 0.0, 0.9], [0.0, 0.0, -1.0], 8)),
        ("room", room(0.5, None)),
        ("lamp", lamp_panel([0.0, 0.9, 0.0], 0.7, 2.0)),
        (
            "glass",
            json!({"type": "sphere", "center": [0, -0.2, -0.2], "radius": 0.6,
                   "bsdf": {"type": "dielectric", "int_ior": 1.5}}),
        ),
    ])
}

fn cloud_under_sky() -> Value {
    let chromatic = medium(rgb(0.3, 1.0, 2.0), 0.9, 0.3);
    scene(&[
        ("sensor", camera([0.0, 0.6, 3.2], [0.0, 0.2, 0.0], 8)),
        ("floor", floor(-0.6, 2.0, 0.5)),
        ("cloud", null_box([-0.8, -0.4, -0.8], [0.8, 0.8, 0.8], Some(chromatic))),
        ("sky", sky(0.5)),
        ("sun", sun([0.3, -1.0, -0.2], 1.0)),
    ])
}

fn scenes() -> Vec<(&'static str, Value)> {
    let glowing = with(medium(1.0, 0.8, 0.3), &[("radiance", json!(1))]);
    vec![
        ("fog", foggy_room(medium(1.0, 0.8, 0.3))),
        ("filtered fog", through_filter(foggy_room(medium(1.0, 0.8, 0.3)), "lanczos")),
        ("chromatic fog", foggy_room(medium(rgb(0.2, 1.0, 3.0), rgb(0.9, 0.7, 0.8), -0.2))),
        ("fire", foggy_room(glowing)),
        ("cloud", cloud_under_sky()),
        ("glass", glass_ball()),
    ]
}

fn parts(stage: &Stage, set: Strategies, cells: StrategyTable, passes: usize, seed: u64) -> StrategyImages {
    let settings = stage.settings(set, passes as u64, seed);
    let instrument = Instrument::new(&stage.setup.scene, &stage.setup.film, &settings);
    StrategyImages::render(&instrument, set, cells, passes, &mut |_| {})
}

fn sum<'a>(images: impl Iterator<Item = &'a Vec<Spectrum>>, pixels: usize) -> Vec<Spectrum> {
    images.fold(vec![Spectrum::ZERO; pixels], |sum, image| {
        sum.iter().zip(image).map(|(sum, value)| *sum + *value).collect()
    })
}

/// They differ by no more than the rounding of their sums.
fn assert_same(what: &str, image: &[Spectrum], expected: &[Spectrum]) {
    let brightest = expected.iter().map(|v| v.abs().max_element()).fold(0.0, f32::max);
    for (pixel, (a, b)) in image.iter().zip(expected).enumerate() {
        let error = (*a - *b).abs().max_element();
        assert!(error <= 1e-5 * (b.abs().max_element() + 0.1 * brightest), "{what}, pixel {pixel}: {a} {b}");
    }
    assert!(brightest > 0.0, "{what} is black");
}

#[test]
fn the_weighted_parts_make_the_image() {
    for (name, scene) in scenes() {
        let stage = Stage { film_samples: FilmSamples::Own, ..Stage::new(&scene) };
        for set in [Strategies::BDPT, Strategies::PT, Strategies::LT, common::strategies("hit+join")] {
            let name = format!("{name}, {}", common::name_of(set));
            let image = stage.render(set, 4, 7);
            for depth in [1, 4] {
                let parts = parts(&stage, set, StrategyTable { depth }, 4, 7);
                assert_same(&name, &parts.whole.mean(), &image);
                let weighted: Vec<_> = parts.images.iter().flatten().map(|i| i.weighted.mean()).collect();
                assert_same(&name, &sum(weighted.iter(), image.len()), &image);
            }
        }
    }
}

/// Every strategy that can make all paths of a length shows, unweighted, what all show together.
#[test]
fn every_strategy_alone_shows_the_same() {
    const DEPTH: u32 = 3;
    let mut claims = Claims::new();
    for (name, fog) in [
        ("grey", medium(0.3, 0.8, 0.3)),
        // Each hero can make what the others can.
        ("chromatic", medium(rgb(0.1, 0.3, 0.5), rgb(0.9, 0.7, 0.8), -0.2)),
    ] {
        let stage = Stage::new(&foggy_room(fog));
        let mut images: BTreeMap<String, Vec<Vec<Spectrum>>> = BTreeMap::new();
        for seed in 0..12 {
            let parts = parts(&stage, Strategies::BDPT, StrategyTable { depth: DEPTH }, 150, seed);
            let of = |cell: &StrategyCell, alone: bool| {
                let index = parts.table.all().position(|other| other == *cell).unwrap();
                let images = parts.images[index].as_ref().unwrap();
                if alone { images.alone.mean() } else { images.weighted.mean() }
            };
            for length in 1..=DEPTH {
                let runs = |cell: &StrategyCell| cell.length() == Some(length) && cell.runs(Strategies::BDPT);
                let cells: Vec<StrategyCell> = parts.table.all().filter(runs).collect();
                // Emitters in view are left to camera subpaths.
                assert_eq!(cells.len() as u32, if length == 1 { 1 } else { length + 1 });
                let weighted: Vec<_> = cells.iter().map(|cell| of(cell, false)).collect();
                let all = sum(weighted.iter(), weighted[0].len());
                images.entry(format!("all{length}")).or_default().push(all);
                for cell in cells {
                    images.entry(cell.name()).or_default().push(of(&cell, true));
                }
            }
        }
        let sample = |name: &str| Sample::of(&images[name], stage.width());
        for cell in (StrategyTable { depth: DEPTH }).all() {
            if let Some(length) = cell.length().filter(|_| cell.runs(Strategies::BDPT)) {
                let what = format!("{name}: {} alone against all", cell.name());
                claims.equal_in_pairs(&what, &sample(&cell.name()), &sample(&format!("all{length}")));
            }
        }
    }
    claims.settle();
}

fn of_kind(cells: &[Value], kind: &str) -> Vec<Value> {
    cells.iter().filter(|cell| cell["kind"] == kind).cloned().collect()
}

/// The sum of a number over cells.
fn shares(cells: &[Value], key: &str) -> f64 {
    cells.iter().map(|cell| cell[key].as_f64().unwrap()).sum()
}

#[test]
fn the_program_writes_tables_layers_and_sheets() {
    let sandbox = Sandbox::with_scene(&foggy_room(medium(1.0, 0.8, 0.3)));
    let (code, out, err) =
        sandbox.run("strategies scene.json -o deep/er --spp 6 --pilots 20 --depth 3 --seed 4").reported();
    assert_eq!(code, Some(0), "{err}");
    for word in
        ["next-event", "eye walks", "light walks", "covariances", "advice:", "without join,lens", "exposure"]
    {
        assert!(out.contains(word), "no \"{word}\" in {out}");
    }
    let report = sandbox.json("deep/er/strategies.json");
    let cells = report["cells"].as_array().unwrap();
    assert_eq!(cells.len(), 1 + 3 + 4 + 4);
    assert!((shares(cells, "energy") - 1.0).abs() < 1e-5);
    let walks = report["eye_walks"].as_f64().unwrap() + report["light_walks"].as_f64().unwrap();
    assert!((shares(cells, "time") + walks - 1.0).abs() < 1e-9 && walks > 0.0);
    let rest = report["covariances"].as_f64().unwrap();
    assert!((shares(cells, "variance") + rest - 1.0).abs() < 1e-9);
    // Next-event estimation is tried once at every vertex that is no black lamp; lamps in view are left to camera subpaths.
    let tries = |name: &str| cells.iter().find(|c| c["name"] == name).unwrap()["tries"].as_f64().unwrap();
    assert!(tries("s1t2") > 0.5 && tries("s1t2") <= 1.0 && tries("s2t2") <= tries("s1t2"));
    // Every light vertex tries the lens; camera vertices on the lamp, which is black, sample no lamp.
    let all_tries = |kind: &str| shares(&of_kind(cells, kind), "tries");
    let vertices = |name: &str| report[name].as_f64().unwrap();
    assert!((all_tries("lens") - vertices("light_vertices")).abs() < 1e-9);
    let next_event = all_tries("next-event");
    assert!(next_event > 0.0 && next_event <= vertices("eye_vertices"), "{next_event}");
    let csv = std::fs::read_to_string(sandbox.path("deep/er/strategies.csv")).unwrap();
    assert_eq!(csv.lines().count(), 1 + cells.len());
    assert!(csv.lines().all(|line| line.split(',').count() == 11), "{csv}");
    let layers = sandbox.channels("deep/er/weighted.exr");
    assert_eq!(layers.len(), 3 * (1 + cells.len()));
    let greens: Vec<&Vec<f32>> =
        cells.iter().map(|c| &layers[&format!("{}.G", c["name"].as_str().unwrap())]).collect();
    for (pixel, whole) in layers["G"].iter().enumerate() {
        let parts: f32 = greens.iter().map(|green| green[pixel]).sum();
        assert!((parts - whole).abs() <= 1e-5 * whole);
    }
    assert_eq!(sandbox.channels("deep/er/unweighted.exr").len(), layers.len());
    for sheet in ["weighted.png", "unweighted.png"] {
        let size = image::image_dimensions(sandbox.path("deep/er").join(sheet)).unwrap();
        // Captions are wider than images of 8 x 8 pixels: "> 3 segments" beside four rows, "next-event" above a cell.
        assert_eq!(
            size,
            (96 + 8 + 4 * (80 + 4) + 4, 4 * (8 + 8 + 8) + 4),
            "four rows, four cells in the longest"
        );
    }
    let subsets = report["subsets"].as_array().unwrap();
    assert_eq!(subsets.len(), 6);
    // Whatever is without hit and lens does not see the lamp; nothing here is smooth.
    assert!(subsets.iter().all(|set| set["lacks"].is_null() && set["gain"]["low"].as_f64().unwrap() > 0.0));
}

#[test]
fn what_a_scene_needs_is_not_left_out() {
    let sandbox = Sandbox::with_scene(&glass_ball());
    let (code, out, err) =
        sandbox.run("strategies scene.json --spp 2 --pilots 1 --depth 2 --size 4x4").reported();
    assert_eq!(code, Some(0), "{err}");
    assert!(out.contains("cannot make: light of area emitters that comes"), "{out}");
    let subsets = sandbox.json("scene-strategies/strategies.json")["subsets"].clone();
    for set in subsets.as_array().unwrap() {
        let without_hit = set["without"].as_str().unwrap().contains("hit");
        assert_eq!(set["lacks"].is_string(), without_hit, "{set}");
        assert_eq!(set["gain"].is_null(), without_hit, "{set}");
    }
    let (code, out, err) =
        sandbox.run("strategies scene.json --spp 1 --pilots 0 --integrator pt --size 4x4").reported();
    assert_eq!(code, Some(0), "{err}");
    assert!(!out.contains("advice") && !out.contains("  join ") && out.contains("next-event"), "{out}");
    assert!(sandbox.json("scene-strategies/strategies.json")["variance"].is_null(), "one pass has none");
}

#[test]
fn what_cannot_be_done_is_refused() {
    let sandbox = Sandbox::with_scene(&foggy_room(medium(1.0, 0.8, 0.3)));
    for (words, hints) in [
        ("strategies scene.json --depth 0", vec!["--depth", "1"]),
        ("strategies scene.json --integrator fog", vec!["paths", "--integrator bdpt"]),
        ("strategies scene.json -o scene.json/x", vec!["a folder to write to"]),
        ("strategies scene.json --size 12000x12000", vec!["GiB", "--size", "--depth"]),
        ("strategies none.json", vec!["none.json"]),
    ] {
        let (code, _, err) = sandbox.run(words).reported();
        assert_eq!(code, Some(2), "{words}: {err}");
        assert!(hints.iter().all(|hint| err.contains(hint)) && !err.contains("panicked"), "{words}: {err}");
    }
}

/// What a strategy is called is how it is typed.
#[test]
fn kinds_are_called_as_they_are_typed() {
    let sandbox = Sandbox::with_scene(&foggy_room(medium(1.0, 0.8, 0.3)));
    for kind in StrategyKind::ALL {
        let words = format!("render scene.json --spp 1 --size 2x2 --strategies {}", kind.name());
        let (code, _, err) = sandbox.run(&words).reported();
        assert_eq!(code, Some(0), "{err}");
    }
}

/// What is too short to count is in no share of it, and what is seen first is as it was.
#[test]
fn paths_that_do_not_count_have_no_share() {
    let mut scene = foggy_room(medium(1.0, 0.8, 0.3));
    scene["integrator"] =
        json!({"type": "aov", "aovs": "n:sh_normal d:depth", "inner": {"type": "bdpt", "min_depth": 3}});
    let sandbox = Sandbox::with_scene(&scene);
    sandbox.run("strategies scene.json --spp 4 --pilots 0 -o out").ends(0);
    let found = sandbox.json("out/strategies.json");
    for cell in found["cells"].as_array().unwrap() {
        let counts = cell["length"].as_u64().is_none_or(|length| length >= 3);
        let tries = cell["tries"].as_f64().unwrap();
        assert!(counts || tries == 0.0 && cell["energy"] == 0.0, "{cell}");
    }
    let lengths: f64 = found["cells"].as_array().unwrap().iter().map(|c| c["energy"].as_f64().unwrap()).sum();
    assert!((lengths - 1.0).abs() < 1e-3, "{lengths}");
    sandbox.run("render scene.json --spp 4 -o long.exr").ends(0);
    sandbox.run("render scene.json --spp 4 --min-depth 0 -o all.exr").ends(0);
    let [long, all] = ["long.exr", "all.exr"].map(|name| sandbox.channels(name));
    let mean = |values: &[f32]| values.iter().sum::<f32>();
    assert!(mean(&long["R"]) < 0.8 * mean(&all["R"]) && long["inner.A"] == all["inner.A"]);
    let first: Vec<&String> =
        all.keys().filter(|name| name.starts_with("n.") || name.starts_with("d.")).collect();
    assert_eq!(first.len(), 4, "{:?}", all.keys());
    assert!(first.iter().all(|name| long[*name] == all[*name]));
}
