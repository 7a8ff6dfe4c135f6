//! What is said of an image that came out black.

use crate::{common::pieces::*, sandbox::Sandbox};
use serde_json::{Value, json};

/// What a render of `parts`, seen from `eye`, says after the image.
fn said(eye: [f64; 3], parts: &[(&str, Value)], words: &str) -> String {
    let sensor = [("sensor", camera(eye, [0.0; 3], 8))];
    let sandbox = Sandbox::with_scene(&scene(&[&sensor, parts].concat()));
    let run = sandbox.run(&format!("render scene.json --spp 4 {words}")).ends(0);
    run.err() + &run.out()
}

const BEFORE: [f64; 3] = [0.0, 0.0, 4.0];

fn wall() -> (&'static str, Value) {
    ("wall", json!({"type": "rectangle", "to_world": [{"type": "scale", "value": 9}]}))
}

#[test]
fn a_black_image_says_why() {
    let lamp = |at| ("lamp", point(at, 1.0));
    let sun = |z: f64| ("sun", sun([0.0, 0.0, z], 1.0));
    let turned = json!({"type": "rectangle", "emitter": {"type": "area"},
        "to_world": [{"type": "translate", "value": [0, 0, 6]}]});
    let fog = null_box([-1000.0; 3], [1000.0; 3], Some(medium(2.0, 0.5, 0.0)));
    let roof = json!({"type": "sphere", "radius": 20, "center": [0, 0, 50]});
    for (eye, parts, hint) in [
        (
            BEFORE,
            vec![("wall", json!({"type": "rectangle"})), sun(1.0)],
            "all light falls on the back of \"wall\"",
        ),
        (BEFORE, vec![wall(), sun(1.0)], "all light falls on the back of \"wall\""),
        ([0.0, 0.0, -4.0], vec![wall(), sun(1.0)], "the camera sees the back of \"wall\""),
        (BEFORE, vec![wall(), ("lamp", turned)], "all lamps face away"),
        (
            BEFORE,
            vec![wall(), ("roof", roof), lamp([0.0, 0.0, 99.0])],
            "\"roof\" hides all light from \"wall\"",
        ),
        (
            BEFORE,
            vec![("ball", lamp_ball([0.0, 0.0, 50.0], 1.0, 1.0))],
            "no surface, medium or sky is in view",
        ),
        (
            [0.0, 0.0, 900.0],
            vec![("fog", fog), wall(), lamp([0.0, 300.0, 0.0])],
            " m: nothing gets through more than 50",
        ),
    ] {
        let said = said(eye, &parts, "");
        assert!(said.contains("no light was seen") && !said.contains("noise"), "{said}");
        assert!(said.contains("warning: the image is black: ") && said.contains(hint), "no {hint}: {said}");
    }
}

#[test]
fn light_that_strategies_do_not_reach_is_named() {
    let glass = json!({"type": "sphere", "radius": 0.5, "center": [0, 0, 1], "bsdf": {"type": "dielectric"}});
    let parts = [wall(), ("glass", glass), ("lamp", point([0.0, 0.0, 1.0], 1.0))];
    let found = said([0.0, 3.0, 4.0], &parts, "--integrator pt");
    for hint in ["the image is black: these strategies do not reach", "smooth glass", "bdpt does"] {
        assert!(found.contains(hint), "no {hint}: {found}");
    }
}

#[test]
fn paths_that_are_too_short_are_named() {
    let parts = [wall(), ("sun", sun([0.0, 0.0, -1.0], 1.0))];
    for (most, hint) in [(0, "max_depth 0 leaves out all light"), (1, "max_depth 1 shows emitters alone")] {
        let found = said(BEFORE, &parts, &format!("--max-depth {most}"));
        assert!(found.contains(&format!("the image is black: {hint}")), "no {hint}: {found}");
    }
    let shut = json!({"type": "cube", "bsdf": {"type": "diffuse", "reflectance": 0}});
    let lamp = ("lamp", lamp_ball([0.0, 0.0, 0.0], 0.5, 1.0));
    let found = said(BEFORE, &[("box", shut), lamp], "--max-depth 5");
    assert!(found.contains("longer paths than max_depth (5) allows"), "{found}");
}

/// Light straight from a lamp without a size does not count, so that where to look is no remedy.
#[test]
fn a_black_meter_is_told_what_counts() {
    let lamp = ("lamp", point([0.0, 0.0, 3.0], 1.0));
    let screen = json!({"type": "rectangle", "meter": {"type": "irradiancemeter"}});
    let sandbox = Sandbox::with_scene(&scene(&[("screen", screen), lamp]));
    let said = sandbox.run("render scene.json --spp 4").ends(0).err();
    assert!(said.contains("in view of the irradiancemeter") && said.contains("does not count"), "{said}");
}

#[test]
fn a_lit_image_says_nothing() {
    for parts in [[wall(), ("sun", sun([0.0, 0.0, -1.0], 1.0))], [wall(), ("sky", sky(1e-20))]] {
        let said = said(BEFORE, &parts, "");
        assert!(said.contains("noise") && !said.contains("the image is"), "{said}");
    }
}
