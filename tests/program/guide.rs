//! `tyndall guide`: what is learnt is shown, whatever the scene, and the same by any number of threads.

use crate::{common::pieces::*, sandbox::Sandbox};
use serde_json::{Value, json};

/// Light comes round a wall, in fog; `size` over a metre.
fn divided(size: f64) -> Value {
    let place = |at: [f64; 3]| at.map(|x| size * x);
    let mut fog = medium(0.7 / size, 0.8, 0.3);
    fog["id"] = json!("fog");
    let sphere =
        |at: [f64; 3], radius: f64| json!({"type": "sphere", "center": place(at), "radius": size * radius});
    let mut room = sphere([0.0; 3], 1.0);
    room["flip_normals"] = json!(true);
    room["bsdf"] = json!({"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.6}});
    room["exterior"] = json!({"type": "ref", "id": "fog"});
    let mut lamp = sphere([0.2, 0.7, -0.3], 0.15);
    lamp["emitter"] = json!({"type": "area", "radiance": {"type": "rgb", "value": [2, 3, 1]}});
    lamp["exterior"] = json!({"type": "ref", "id": "fog"});
    let mut sensor = camera(place([0.0, 0.0, 0.9]), place([0.0, 0.0, -1.0]), 32);
    sensor["far_clip"] = json!(10.0 * size);
    sensor["medium"] = json!({"type": "ref", "id": "fog"});
    let wall = json!({"type": "cube", "exterior": {"type": "ref", "id": "fog"}, "to_world": [
        {"type": "scale", "value": place([0.5, 0.02, 0.5])}, {"type": "translate", "value": place([0.0, 0.3, 0.0])}]});
    scene(&[("fog", fog), ("sensor", sensor), ("room", room), ("lamp", lamp), ("wall", wall)])
}

/// The numbers, but how long it took.
fn numbers(sandbox: &Sandbox, file: &str) -> Value {
    let mut numbers = sandbox.json(file);
    assert!(numbers["seconds"].as_f64().unwrap() > 0.0);
    numbers["seconds"] = Value::Null;
    numbers
}

#[test]
fn what_is_learnt_is_shown_alike_by_any_threads() {
    let sandbox = Sandbox::with_scene(&divided(1.0));
    let run = sandbox.run("guide scene.json --threads 1").ends(0);
    assert!(run.out().contains("surfaces") && run.out().contains("MiB"), "{}", run.out());
    let first = numbers(&sandbox, "scene-guide/guide.json");
    for kind in ["surfaces", "media"] {
        assert!(first[kind]["cells"].as_u64().unwrap() > 4, "{first}");
    }
    let seen: f64 =
        first["seen"].as_array().unwrap().iter().map(|cell| cell["pixels"].as_f64().unwrap()).sum();
    assert!(seen > 0.0 && seen <= 1.0, "{first}");
    // One emitter has all starts, learnt or not.
    assert_eq!(first["starts"], json!([{"emitter": 0, "unlearnt": 1.0, "learnt": 1.0, "portals": []}]));
    for (guide, learns) in [("always", true), ("never", false)] {
        let run = sandbox.run(&format!("info scene.json --guide {guide} --json")).ends(0);
        let bytes = serde_json::from_str::<Value>(&run.out()).unwrap()["learnt_bytes"].as_u64().unwrap();
        assert_eq!((bytes > 1000, bytes < 1), (learns, !learns), "{guide}: {bytes}");
    }
    for threads in [2, 7] {
        sandbox.run(&format!("guide scene.json --threads {threads} -o other")).ends(0);
        assert_eq!(numbers(&sandbox, "other/guide.json"), first, "{threads} threads");
        for picture in ["cells.png", "directions.png"] {
            let [a, b] = ["scene-guide", "other"].map(|folder| sandbox.bytes(&format!("{folder}/{picture}")));
            assert!(a.starts_with(b"\x89PNG") && a == b, "{picture}, {threads} threads");
        }
    }
}

/// As large as a hand and as large as a planet; memory stays small.
#[test]
fn scenes_of_any_size_are_learnt() {
    for size in [1e-3, 1e6] {
        let sandbox = Sandbox::with_scene(&divided(size));
        let run = sandbox.run("guide scene.json --json").ends(0);
        let numbers: Value = serde_json::from_str(&run.out()).unwrap();
        for kind in ["surfaces", "media"] {
            assert!(numbers[kind]["cells"].as_u64().unwrap() > 4, "{size}: {numbers}");
        }
        assert!(numbers["bytes"].as_u64().unwrap() < 64 << 20, "{size}: {numbers}");
    }
}

/// Memory stays as small, and all light subpaths start somewhere.
#[test]
fn a_hundred_thousand_emitters_are_learnt() {
    let lamp = |index: u32| {
        let [x, z] = [index % 400, index / 400].map(|step| f64::from(step) * 2e-3 - 0.4);
        let lamp =
            json!({"type": "point", "position": [x, 0.5, z], "intensity": {"type": "rgb", "value": 1e-5}});
        (format!("lamp {index}"), lamp)
    };
    let mut lit = divided(1.0);
    lit.as_object_mut().unwrap().extend((0..100_000).map(lamp));
    let sandbox = Sandbox::with_scene(&lit);
    for integrator in ["bdpt", "pt"] {
        let run = sandbox.run(&format!("guide scene.json --integrator {integrator} --json")).ends(0);
        let numbers: Value = serde_json::from_str(&run.out()).unwrap();
        assert!(numbers["surfaces"]["cells"].as_u64().unwrap() > 4, "{numbers}");
        assert!(numbers["bytes"].as_u64().unwrap() < 64 << 20, "{numbers}");
    }
    sandbox.run("render scene.json --guide always --strategies hit,next-event,join,lens --spp 1").ends(0);
}

/// Whatever keeps them, directions are learnt that lower the variance, and in bins alone they are as coarse everywhere.
#[test]
fn directions_are_kept_in_any_basis() {
    let sandbox = Sandbox::with_scene(&divided(1.0));
    let numbers = ["quadtree", "bins", "haar"].map(|basis| {
        let run = sandbox.run(&format!("guide scene.json --integrator pt --basis {basis} --json")).ends(0);
        serde_json::from_str::<Value>(&run.out()).unwrap()
    });
    for numbers in &numbers {
        let left = numbers["second_moment"].as_f64().unwrap();
        assert!(left > 0.0 && left < 1.0, "{numbers}");
    }
    assert!(numbers[0]["bytes"] != numbers[1]["bytes"] && numbers[1]["bytes"] != numbers[2]["bytes"]);
    assert_ne!(numbers[0]["second_moment"], numbers[2]["second_moment"]);
}

/// Primary rays that are followed twice teach no more than others.
#[test]
fn forced_interactions_change_nothing_of_what_is_learnt() {
    let sandbox = Sandbox::with_scene(&divided(1.0));
    sandbox.run("guide scene.json --forced-interaction -o forced").ends(0);
    sandbox.run("guide scene.json -o plain").ends(0);
    let [forced, plain] =
        ["forced", "plain"].map(|folder| numbers(&sandbox, &format!("{folder}/guide.json")));
    assert_eq!(forced, plain);
}

/// Nothing to learn is no error, and no picture.
#[test]
fn of_a_black_scene_nothing_is_learnt() {
    let mut dark = divided(1.0);
    dark.as_object_mut().unwrap().remove("lamp");
    let sandbox = Sandbox::with_scene(&dark);
    let run = sandbox.run("guide scene.json").ends(0);
    assert!(run.out().contains("nothing"), "{}", run.out());
    assert!(sandbox.path("scene-guide/guide.json").is_file());
    assert!(!sandbox.path("scene-guide/cells.png").exists());
    sandbox.run("render scene.json --guide always --spp 1").ends(0);
}

#[test]
fn what_cannot_be_guided_is_refused() {
    let sandbox = Sandbox::with_scene(&divided(1.0));
    sandbox.run("guide scene.json --integrator fog").refuses(&["--integrator", "bdpt, pt or lt"]);
    sandbox.run("guide scene.json --heuristic power").refuses(&["--guide", "balance"]);
    sandbox.run("guide missing.json").refuses(&["missing.json"]);
}

/// A keyhole is found, by the camera's walks and by light's.
#[test]
fn portals_are_shown() {
    let sandbox = Sandbox::new();
    let keyhole = format!("{}/scenes/efficiency/keyhole.xml", env!("CARGO_MANIFEST_DIR"));
    for integrator in ["bdpt", "pt"] {
        let words = format!("guide {keyhole} --integrator {integrator} -o found");
        let run = sandbox.run(&words).ends(0);
        assert!(run.out().contains("portal "), "{}", run.out());
        let numbers = sandbox.json("found/guide.json");
        let centre: Vec<f64> = serde_json::from_value(numbers["portals"][0]["centre"].clone()).unwrap();
        let away = centre.iter().zip([0.0, 1.05, -0.3]).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt();
        let radius = numbers["portals"][0]["radius"].as_f64().unwrap();
        assert!(away < 0.06 && radius > 0.02 && radius < 0.12, "{integrator}: {numbers}");
    }
}

/// A guide is learnt anew from the scene by every part of an image, and is the same each time.
#[test]
fn parts_of_a_guided_image_make_the_whole() {
    let sandbox = Sandbox::with_scene(&divided(1.0));
    for strategies in ["hit,next-event", "hit,next-event,join,lens"] {
        let render = |words: &str| {
            sandbox
                .run(&format!("render scene.json --guide always --strategies {strategies} {words}"))
                .ends(0)
        };
        render("--spp 4 -o whole.exr");
        render("--samples 0..2 -o a.exr --sums a.sums");
        render("--samples 2..4 -o b.exr --sums b.sums");
        sandbox.run("merge a.sums b.sums -o merged.exr").ends(0);
        let [whole, merged] = ["whole.exr", "merged.exr"].map(|name| sandbox.channels(name));
        assert_eq!(whole["G"], merged["G"], "{strategies}");
        sandbox
            .run(&format!("render scene.json --guide never --strategies {strategies} --spp 4 -o plain.exr"))
            .ends(0);
        assert_ne!(whole["G"], sandbox.channels("plain.exr")["G"], "{strategies}");
    }
}

/// From some 25 million subpaths on, they follow what seven rounds learn; samples on both sides, by whatever threads and in
/// whatever parts, are those of the whole.
#[test]
fn later_samples_follow_what_is_learnt_by_then() {
    let sandbox = Sandbox::with_scene(&divided(1.0));
    let run = |words: &str| sandbox.run(&format!("{words} scene.json --size 64x64 --integrator pt")).ends(0);
    let learnt = |sample: u32| {
        run(&format!("guide --sample {sample} -o found"));
        numbers(&sandbox, "found/guide.json")
    };
    let [before, after] = [6143, 6144].map(learnt);
    let cells = |numbers: &Value| numbers["surfaces"]["cells"].as_u64().unwrap();
    assert!(cells(&before) < cells(&after), "{before} {after}");
    let render = |words: &str| run(&format!("render --guide always {words}"));
    render("--samples 6143..6146 --threads 2 --sums whole.sums -o whole.exr");
    render("--samples 6143..6145 --threads 1 --sums a.sums -o a.exr");
    render("--samples 6145..6146 --threads 3 --sums b.sums -o b.exr");
    sandbox.run("merge a.sums b.sums -o merged.exr").ends(0);
    let [whole, merged] = ["whole.exr", "merged.exr"].map(|name| sandbox.channels(name));
    assert_eq!(whole["G"], merged["G"]);
}

/// Learning as much as a small error is worth does not come before the first samples.
#[test]
fn a_small_error_in_no_time_has_samples() {
    let sandbox = Sandbox::with_scene(&divided(1.0));
    sandbox.run("render scene.json --guide always --error 0.01 --time-limit 0.001s -o a.exr").ends(0);
    let image = sandbox.channels("a.exr");
    assert!(image["G"].iter().sum::<f32>() > 0.0);
}

/// Whether it pays is decided for each part by itself.
#[test]
fn parts_with_a_guide_and_without_are_put_together() {
    let sandbox = Sandbox::with_scene(&divided(1.0));
    for (guide, crop, part) in [("always", "32x16+0+0", "a"), ("never", "32x16+0+16", "b")] {
        let words =
            format!("--integrator pt --guide {guide} --crop {crop} --spp 2 -o {part}.exr --sums {part}.sums");
        sandbox.run(&format!("render scene.json {words}")).ends(0);
    }
    sandbox.run("merge a.sums b.sums -o merged.exr").ends(0);
    let [a, b, merged] = ["a.exr", "b.exr", "merged.exr"].map(|name| sandbox.channels(name));
    assert_eq!([&a["G"][..], &b["G"][..]].concat(), merged["G"]);
}
