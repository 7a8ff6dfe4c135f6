//! `render --groups` and `--components`: layers of what each group of emitters contributes, and as which component of
//! radiance, however a render is cut up.

use crate::sandbox::Sandbox;
use serde_json::{Value, json};

/// A room of fog that glows, with lamps of several groups, whose filter reaches across pixels.
fn lamps() -> Value {
    let fog = json!({"type": "homogeneous", "sigma_t": 1, "albedo": 0.8, "radiance": 0.1, "group": "glow"});
    json!({
        "type": "scene",
        "integrator": {"type": "bdpt", "max_depth": 8},
        "sensor": {"type": "perspective", "fov": 60, "medium": {"type": "ref", "id": "fog"},
            "to_world": [{"type": "lookat", "origin": [0, 0, 0.9], "target": [0, 0, -1], "up": [0, 1, 0]}],
            "film": {"type": "hdrfilm", "width": 48, "height": 40}},
        "fog": fog,
        "room": {"type": "cube", "flip_normals": true, "exterior": {"type": "ref", "id": "fog"}},
        "ball": {"type": "sphere", "center": [0.2, 0.3, -0.3], "radius": 0.2,
            "emitter": {"type": "area", "radiance": 2, "group": "a"}},
        "beam": {"type": "collimated", "radius": 0.2, "irradiance": 5, "group": "b.left", "to_world":
            [{"type": "lookat", "origin": [-0.8, 0.6, -0.6], "target": [0, 0, 0], "up": [0.1, 1, 0]}]},
        "point": {"type": "point", "position": [-0.5, -0.5, 0.2], "intensity": 0.3},
    })
}

/// So that samples are alike, however many they are to be.
const ALIKE: &str = "--strategies hit,next-event,join,lens";
const GROUPS: [&str; 4] = ["a", "b.left", "glow", "rest"];

/// The layers of the image `name` add up to it.
fn assert_whole(sandbox: &Sandbox, name: &str) {
    assert_whole_of(sandbox, name, &GROUPS.map(|group| format!("group.{group}")));
}

fn assert_whole_of(sandbox: &Sandbox, name: &str, layers: &[String]) {
    let channels = sandbox.channels(name);
    for end in ["R", "G", "B"] {
        let layers: Vec<_> = layers.iter().map(|layer| &channels[&format!("{layer}.{end}")]).collect();
        for (pixel, value) in channels[end].iter().enumerate() {
            let sum: f32 = layers.iter().map(|layer| layer[pixel]).sum();
            assert!((sum - value).abs() <= 1e-5 * value + 1e-6, "{name}, pixel {pixel}: {sum} not {value}");
        }
    }
}

/// Samples that are merged, and those that a render goes on with, make the image all.exr of six samples.
fn assert_same_in_parts(sandbox: &Sandbox, render: impl Fn(&str)) {
    let same = |name: &str| assert!(sandbox.channels("all.exr") == sandbox.channels(name), "{name}");
    render("--samples 0..2 --sums a.sums");
    render("--samples 2..6 --sums b.sums");
    sandbox.run("merge b.sums a.sums -o merged.exr").ends(0);
    same("merged.exr");
    render("--spp 2 -o resumed.exr --sums c.sums");
    render("--spp 6 -o resumed.exr --sums c.sums --resume");
    same("resumed.exr");
}

#[test]
fn groups_are_layers_whatever_a_render_is_cut_into() {
    let sandbox = Sandbox::with_scene(&lamps());
    let render = |words: &str| {
        sandbox.run(&format!("render scene.json --groups {ALIKE} {words}")).ends(0);
    };
    render("--spp 6 --threads 2 -o all.exr");
    assert_whole(&sandbox, "all.exr");
    render("--spp 6 --threads 1 -o single.exr");
    assert!(sandbox.channels("all.exr") == sandbox.channels("single.exr"));
    assert_same_in_parts(&sandbox, render);
    for (name, part) in [("left", "24x40+0+0"), ("right", "24x40+24+0")] {
        render(&format!("--spp 3 --crop {part} --sums {name}.sums"));
    }
    sandbox.run("merge left.sums right.sums -o side.exr").ends(0);
    assert_whole(&sandbox, "side.exr");
    render("--spp 2 --batches 2 -o batches.exr");
    assert_whole(&sandbox, "batches.exr");
}

#[test]
fn groups_stop_with_their_pixels() {
    let sandbox = Sandbox::with_scene(&lamps());
    let render = |words: &str| {
        sandbox.run(&format!("render scene.json --size 12x10 --error 0.5 {ALIKE} {words}")).ends(0);
    };
    render("--groups --spp 400 -o all.exr");
    assert_whole(&sandbox, "all.exr");
    render("--groups --spp 40 --sums a.sums -o a.exr");
    render("--groups --spp 400 --sums a.sums --resume -o a.exr");
    assert!(sandbox.channels("all.exr") == sandbox.channels("a.exr"));
    render("--spp 400 -o plain.exr");
    let all = sandbox.channels("all.exr");
    assert!(sandbox.channels("plain.exr").iter().all(|(name, values)| all[name] == *values));
}

#[test]
fn info_names_the_groups() {
    let sandbox = Sandbox::with_scene(&lamps());
    let said = sandbox.run("info scene.json").ends(0).out();
    for group in ["area in fog, group a", "collimated in fog, group b.left", ", group glow", "point in fog\n"]
    {
        assert!(said.contains(group), "{group}: {said}");
    }
    let told: Value = serde_json::from_str(&sandbox.run("info scene.json --json").ends(0).out()).unwrap();
    let groups: Vec<&str> =
        told["emitters"].as_array().unwrap().iter().map(|light| light["group"].as_str().unwrap()).collect();
    assert!(GROUPS.iter().all(|group| groups.contains(group)), "{groups:?}");
}

/// What a pilot chooses does not depend on them, and so the image does not.
#[test]
fn groups_leave_the_image_as_it_is() {
    let sandbox = Sandbox::with_scene(&lamps());
    for (name, words) in [("plain", ""), ("grouped", "--groups")] {
        sandbox.run(&format!("render scene.json --spp 3 {words} -o {name}.exr --report {name}.json")).ends(0);
    }
    let [plain, grouped] = ["plain.exr", "grouped.exr"].map(|name| sandbox.channels(name));
    assert_eq!((plain.len(), grouped.len()), (3, 15));
    assert!(plain.iter().all(|(name, values)| grouped[name] == *values));
    let [plain, grouped] = ["plain.json", "grouped.json"].map(|name| sandbox.json(name));
    assert_eq!(plain["plan"], grouped["plan"]);
}

#[test]
fn components_are_layers_whatever_a_render_is_cut_into() {
    let sandbox = Sandbox::with_scene(&lamps());
    let render = |words: &str| {
        sandbox.run(&format!("render scene.json --size 24x20 --components {ALIKE} {words}")).ends(0);
    };
    let components = ["unscattered", "emitted", "scattered.single", "scattered.multiple"].map(str::to_owned);
    render("--spp 6 -o all.exr");
    assert_whole_of(&sandbox, "all.exr", &components);
    assert_eq!(sandbox.channels("all.exr").len(), 15);
    assert_same_in_parts(&sandbox, render);
    render("--error 0.5 --spp 60 -o error.exr");
    assert_whole_of(&sandbox, "error.exr", &components);
    render("--groups --spp 2 -o both.exr");
    let of = |group: &str| components.each_ref().map(|component| format!("group.{group}.{component}"));
    assert_whole_of(&sandbox, "both.exr", &GROUPS.map(of).concat());
    assert_eq!(sandbox.channels("both.exr").len(), 3 + 3 * 16);
}

#[test]
fn groups_that_cannot_be_are_refused() {
    let sandbox = Sandbox::with_scene(&lamps());
    sandbox.run("render scene.json --groups -o a.pfm").refuses(&["a.pfm", "--groups", ".exr"]);
    sandbox.run("render scene.json --groups --integrator fog -o a.exr").refuses(&["--groups", "fog"]);
    sandbox.run("render scene.json --components -o a.pfm").refuses(&["a.pfm", "--components", ".exr"]);
    sandbox.run("render scene.json --components --integrator fog -o a.exr").refuses(&["--components", "fog"]);
    sandbox.run("render scene.json --spp 1 --groups --sums a.sums -o a.exr").ends(0);
    sandbox.run("render scene.json --spp 2 --sums a.sums --resume -o a.exr").refuses(&["layers", "group.a"]);
}
