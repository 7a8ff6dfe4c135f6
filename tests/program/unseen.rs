//! Warnings of images that come out black, and of media that no image shows.

use crate::{common::pieces::*, sandbox::Sandbox};
use serde_json::{Value, json};
use std::slice;

/// All warnings of a scene of `parts` around a camera at `eye`, but that it states no medium.
fn warnings(eye: [f64; 3], parts: &[(&str, Value)]) -> Vec<String> {
    let sensor = [("sensor", camera(eye, [0.0, 0.1, -9.0], 4))];
    let sandbox = Sandbox::with_scene(&scene(&[&sensor, parts].concat()));
    let run = sandbox.run("info scene.json").ends(0);
    let said = run.err();
    let warnings = said.lines().filter_map(|line| line.strip_prefix("warning: "));
    warnings.filter(|line| !line.contains("the camera states no medium")).map(str::to_owned).collect()
}

/// The one warning holds all of `hints`; without hints there is none.
fn warned(eye: [f64; 3], parts: &[(&str, Value)], hints: &[&str]) {
    let found = warnings(eye, parts);
    assert_eq!(found.len(), usize::from(!hints.is_empty()), "{parts:?}: {found:?}");
    hints.iter().for_each(|hint| assert!(found[0].contains(hint), "no {hint} in {found:?}"));
}

const INSIDE: [f64; 3] = [0.0, 0.0, 0.5];
const OUTSIDE: [f64; 3] = [0.0, 0.0, 5.0];

#[test]
fn a_scene_without_light_is_told() {
    let floor = ("floor", floor(-1.0, 2.0, 0.5));
    let dark = ["scene.json", "no emitter is in this scene", "\"constant\""];
    warned(OUTSIDE, slice::from_ref(&floor), &dark);
    warned(OUTSIDE, &[floor.clone(), ("lamp", point([0.0; 3], 0.0))], &["no emitter with power above 0"]);
    warned(OUTSIDE, &[floor.clone(), ("lamp", point([0.0; 3], 1.0))], &[]);
    warned(OUTSIDE, &[floor.clone(), ("integrator", json!({"type": "fog"}))], &[]);
    warned(OUTSIDE, &[floor, ("integrator", json!({"type": "aov", "aovs": "d:depth"}))], &[]);
}

#[test]
fn a_camera_shut_in_without_light_is_told() {
    let shut_in = ["$.sensor", "inside the closed opaque shape \"room\"", "will be black"];
    let ball = |more: &[(&str, Value)]| with(json!({"type": "sphere"}), more);
    let lamp = |at: [f64; 3]| ("lamp", lamp_ball(at, 0.1, 1.0));
    warned(INSIDE, &[("room", room(0.5, None)), ("sky", sky(1.0))], &shut_in);
    warned(INSIDE, &[("room", room(0.5, None)), lamp([0.0, 0.0, 3.0])], &shut_in);
    warned(INSIDE, &[("room", ball(&[])), ("lamp", point([0.0, 2.0, 0.0], 1.0))], &shut_in);
    warned(INSIDE, &[("room", ball(&[])), ("lamp", point([0.0, 0.2, 0.0], 1.0))], &[]);
    warned(INSIDE, &[("room", room(0.5, None)), lamp([0.0; 3])], &[]);
    warned(INSIDE, &[("room", ball(&[("bsdf", json!({"type": "dielectric"}))])), ("sky", sky(1.0))], &[]);
    warned(INSIDE, &[("room", ball(&[("emitter", json!({"type": "area"}))]))], &[]);
    warned(OUTSIDE, &[("room", ball(&[])), ("sky", sky(1.0))], &[]);
}

/// A cube of triangles; its last face may be missing.
fn cube(faces: usize) -> String {
    let corner = |i: usize| format!("v {} {} {}\n", i & 1, i >> 1 & 1, i >> 2);
    let corners: String = (0..8).map(corner).collect();
    let sides = ["1 3 4 2", "5 6 8 7", "1 2 6 5", "3 7 8 4", "1 5 7 3", "2 4 8 6"];
    corners + &sides[..faces].iter().map(|side| format!("f {side}\n")).collect::<String>()
}

#[test]
fn meshes_shut_in_only_where_they_are_closed() {
    for (faces, is_told) in [(6, true), (5, false)] {
        let parts = scene(&[
            ("sensor", camera([0.5; 3], [0.5, 0.5, 9.0], 4)),
            ("room", json!({"type": "obj", "filename": "room.obj"})),
            ("sky", sky(1.0)),
        ]);
        let sandbox = Sandbox::with_files(&[("scene.json", &parts.to_string()), ("room.obj", &cube(faces))]);
        let said = sandbox.run("info scene.json").ends(0).err();
        assert_eq!(said.contains("inside the closed opaque shape \"room\""), is_told, "{said}");
    }
}

#[test]
fn a_medium_behind_an_opaque_boundary_is_told() {
    let fog = ("interior", medium(1.0, 0.5, 0.0));
    let ball = |more: &[(&str, Value)]| {
        with(with(json!({"type": "sphere", "id": "ball"}), slice::from_ref(&fog)), more)
    };
    let hints = ["$.ball", "the medium \"homogeneous\" inside this closed shape is never seen", "\"null\""];
    warned(OUTSIDE, &[("ball", ball(&[])), ("sky", sky(1.0))], &hints);
    let flipped = json!({"type": "cube", "flip_normals": true, "exterior": medium(1.0, 0.5, 0.0)});
    warned(OUTSIDE, &[("ball", flipped), ("sky", sky(1.0))], &hints);
    warned(OUTSIDE, &[("ball", ball(&[("bsdf", json!({"type": "null"}))])), ("sky", sky(1.0))], &[]);
    let around = json!({"type": "sphere", "exterior": medium(1.0, 0.5, 0.0)});
    warned(OUTSIDE, &[("ball", around), ("lamp", point([0.0, 3.0, 0.0], 1.0))], &[]);
    let lamp = ball(&[("emitter", json!({"type": "area"}))]);
    warned(OUTSIDE, &[("lamp", lamp)], &[]);
}

#[test]
fn a_medium_in_an_open_boundary_is_told() {
    let tube = json!({"type": "cylinder", "bsdf": {"type": "null"}, "interior": medium(1.0, 0.5, 0.0)});
    let found = warnings([5.0, 0.0, 0.5], &[("tube", tube), ("sky", sky(1.0))]);
    assert!(found.iter().any(|said| said.contains("closed by flat lids")), "{found:?}");
    let water = json!({"type": "rectangle", "bsdf": {"type": "null"}, "interior": medium(1.0, 0.5, 0.0)});
    let found = warnings(OUTSIDE, &[("water", water), ("sky", sky(1.0))]);
    assert!(
        !found.iter().any(|said| said.contains("lids") || said.contains("cannot be correct")),
        "{found:?}"
    );
}

#[test]
fn a_medium_that_nothing_refers_to_is_told() {
    let fog = ("fog", medium(1.0, 0.5, 0.0));
    warned(
        OUTSIDE,
        &[fog, ("sky", sky(1.0))],
        &["$.fog", "never referred to", "\"interior\"", "or remove it"],
    );
}

#[test]
fn what_most_scenes_of_mitsuba_state_is_no_warning() {
    for plugin in ["path", "volpath", "bdpt", "ptracer", "fog"] {
        let integrator = json!({"type": plugin, "rr_depth": 5});
        warned(OUTSIDE, &[("integrator", integrator), ("sky", sky(1.0))], &[]);
    }
}
