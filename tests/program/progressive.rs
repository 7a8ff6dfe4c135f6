//! Progressive pictures: --progressive and --fraction of render.

use crate::{common::pieces::*, sandbox::Sandbox};
use serde_json::{Value, json};

/// A room with a lamp in thin fog.
fn foggy() -> Sandbox {
    Sandbox::with_scene(&scene(&[
        ("sensor", camera([0.0, 0.0, 0.9], [0.0, 0.0, -1.0], 32)),
        ("room", room(0.6, Some(medium(0.3, 0.8, 0.3)))),
        ("lamp", lamp_ball([0.2, 0.3, -0.3], 0.3, rgb(2.0, 3.0, 1.0))),
        ("integrator", json!({"type": "bdpt"})),
    ]))
}

fn told(sandbox: &Sandbox, name: &str) -> Value {
    serde_json::from_str(&sandbox.run(&format!("info {name} --json")).ends(0).out()).unwrap()
}

/// The file, its PNG, the plan, the summary and the report say what it is; the file shows which pixels were shaded.
#[test]
fn a_preview_says_that_it_is_one() {
    let sandbox = foggy();
    for (method, fraction, pixels) in [("straight", "", 102), ("regions", "--fraction 0.2", 205)] {
        let words = format!("render scene.json --progressive {method} {fraction} --spp 2 --report r.json");
        let run = sandbox.run(&words).ends(0);
        let share = if pixels == 102 { "10.0 %" } else { "20 %" };
        let text = format!("{method}, {share} of pixels shaded: a biased preview");
        assert!(run.out().contains(&text), "{}", run.out());
        assert!(run.err().contains("a biased preview by") && !run.err().contains("lens"), "{}", run.err());
        for file in ["scene.exr", "scene.png"] {
            let said = told(&sandbox, file)["progressive"].to_string();
            assert!(said.contains(&text), "{file}: {said}");
        }
        assert!(told(&sandbox, "scene.exr")["progressive"].to_string().contains("without the strategy lens"));
        let strategies = told(&sandbox, "scene.exr")["settings"]["strategies"].to_string();
        assert!(!strategies.contains("lens"), "{strategies}");
        let report = sandbox.json("r.json");
        assert_eq!(report["progressive"]["pixels_shaded"], pixels);
        assert_eq!(report["progressive"]["pixels"], 1024);
        assert_eq!(report["progressive"]["is_biased"], true);
        let whole = report["render_seconds"].as_f64().unwrap();
        assert!(report["progressive"]["seconds_of_shading"].as_f64().unwrap() <= whole);
        let samples = &sandbox.channels("scene.exr")["samples.N"];
        assert_eq!(samples.iter().filter(|n| **n == 2.0).count(), pixels);
        assert_eq!(samples.iter().filter(|n| **n == 0.0).count(), 1024 - pixels);
    }
}

/// All pixels, by time, frame by frame, of the preview fog, with alpha and layers.
#[test]
fn previews_go_with_other_options() {
    let sandbox = foggy();
    let render = |words: &str| sandbox.run(&format!("render scene.json --spp 1 {words}")).ends(0);
    render("--integrator pt -o whole.exr");
    render("--integrator pt --progressive straight --fraction 1 -o all.exr");
    let [whole, all] = ["whole.exr", "all.exr"].map(|name| sandbox.channels(name)["G"].clone());
    assert!(whole.iter().zip(&all).all(|(a, b)| (a - b).abs() <= 1e-3 * a.abs()), "half floats aside");
    render("--progressive regions --time-limit 20s -o late.exr");
    assert!(sandbox.channels("late.exr")["samples.N"].iter().all(|n| *n == 1.0));
    render("--progressive straight --integrator fog -o fog.exr");
    render("--progressive straight --frames 0..1 -o a.exr");
    assert!(told(&sandbox, "a.0001.exr")["progressive"].is_string());
    render("--progressive straight -o a.pfm");
}

#[test]
fn what_cannot_be_shaded_pixel_by_pixel_is_refused() {
    let sandbox = foggy();
    for (words, hints) in [
        ("--progressive straight --integrator lt", ["--integrator", "lt", "bdpt or pt"]),
        ("--progressive straight --strategies hit,lens", ["--strategies", "lens", "leave out"]),
        ("--progressive curved", ["curved", "straight", "regions"]),
        ("--progressive straight --fraction 0", ["--fraction", "above 0", "such as 0.1"]),
        ("--progressive straight --fraction 1.5", ["--fraction", "at most 1", "such as 0.1"]),
        ("--fraction 0.5", ["--progressive", "required", "--fraction"]),
        ("--progressive straight --error 0.1", ["--error", "cannot be used", "--progressive"]),
        ("--progressive regions --groups", ["--groups", "cannot be used", "--progressive"]),
        ("--progressive regions --size 1x9", ["1 x 9", "2 x 2", "--size"]),
    ] {
        sandbox.run(&format!("render scene.json {words}")).refuses(&hints);
    }
    let mut moments = serde_json::from_str::<Value>(&sandbox.text("scene.json")).unwrap();
    moments["integrator"] = json!({"type": "moment", "inner": {"type": "bdpt"}});
    let sandbox = Sandbox::with_scene(&moments);
    sandbox.run("render scene.json --progressive straight").refuses(&[
        "moment",
        "--progressive",
        "leave out",
    ]);
}
