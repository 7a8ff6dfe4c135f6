//! Keyframes: frames of an animation against the same scenes written by hand.

use crate::{common::pieces::*, sandbox::Sandbox};
use serde_json::{Value, json};

/// A value that changes in time.
fn keyed(keys: &[(f64, Value)]) -> Value {
    json!({"type": "keyframes", "value": keys})
}

/// A scene of BMA02's functions under a lamp, and what each `change` says of it in place of what it is at 2 s.
fn scene_with(change: impl Fn(&str, Value) -> Value) -> Value {
    let waves = json!({"type": "cosine", "constant": 1,
        "w": {"type": "wave", "amplitude": change("amplitude", json!(0.5)), "vector": change("vector", json!([3, 0.5, 0]))}});
    let steps =
        json!({"type": "polynomial", "half_width": 0.5, "x": change("x", json!("0.875, -0.25, 0, 0, 0.25"))});
    let puff = json!({"type": "equipotential", "center": change("center", json!([0.5, 0, 0])), "strength": change("strength", json!(2.5))});
    let blown =
        json!({"type": "wind", "velocity": change("velocity", json!([0.5, 0.25, 0])), "steps": steps});
    let fog = json!({"type": "sum", "waves": waves, "blown": blown, "puff": puff});
    let fog = json!({"type": "heterogeneous", "sigma_t": fog, "albedo": change("albedo", json!(0.75))});
    let ball = json!({"type": "sphere", "radius": 0.3, "bsdf": {"type": "ref", "id": "red"}});
    scene(&[
        ("sensor", camera([0.0, 0.0, 4.0], [0.0, 0.0, 0.0], 8)),
        ("red", json!({"type": "diffuse", "reflectance": {"type": "rgb", "value": [0.5, 0.1, 0.1]}})),
        ("cloud", null_box([-1.0; 3], [1.0; 3], Some(fog))),
        ("ball", ball),
        ("lamp", json!({"type": "spot", "to_world": change("to_world", place(1.0, 90.0))})),
        (
            "sky",
            json!({"type": "constant", "radiance": change("radiance", json!({"type": "rgb", "value": [0.5, 1.0, 1.5]}))}),
        ),
    ])
}

fn place(x: f64, angle: f64) -> Value {
    json!([{"type": "rotate", "axis": [0, 1, 0], "angle": angle}, {"type": "translate", "value": [x, 0, 3]}])
}

/// The values of `scene_with` at 1, 2 and 3 s; beyond, and in the middle, nothing else is known of them.
fn keys_of(name: &str, at_2: &Value) -> Value {
    let rgb = |rgb: [f64; 3]| json!({"type": "rgb", "value": rgb});
    let [first, last] = match name {
        "amplitude" => [json!(0.25), json!(0.75)],
        "vector" => [json!([1, 0.5, 0]), json!([5, 0.5, 0])],
        "x" => [json!("1 0 0 0 0"), json!("0.75, -0.5, 0, 0, 0.5")],
        "center" => [json!([0, 0, 0]), json!([1, 0, 0])],
        "strength" => [json!(1), json!(4)],
        // The mean until 2 s of what is (0, 0.25, 0) up to 1 s and grows by (2, 0, 0) until then.
        "velocity" => {
            return keyed(&[(1.0, json!([0, 0.25, 0])), (2.0, json!([2, 0.25, 0])), (3.0, json!([9, 9, 9]))]);
        }
        "albedo" => [json!(0.5), json!(1)],
        "to_world" => [place(0.0, 0.0), place(2.0, 180.0)],
        "radiance" => [rgb([0.0, 1.0, 2.0]), rgb([1.0; 3])],
        other => panic!("{other}"),
    };
    let middle = if name == "strength" { vec![(2.0, at_2.clone())] } else { vec![] };
    keyed(&[vec![(1.0, first)], middle, vec![(3.0, last)]].concat())
}

fn animated() -> Value {
    scene_with(|name, at_2| keys_of(name, &at_2))
}

#[test]
fn a_frame_is_the_same_alone_and_written_by_hand() {
    let sandbox = Sandbox::with_scene(&animated());
    // One key is enough for a scene to be built at the time of its frame.
    let by_hand = scene_with(|name, at_2| if name == "albedo" { keyed(&[(0.0, at_2)]) } else { at_2 });
    std::fs::write(sandbox.path("hand.json"), by_hand.to_string()).unwrap();
    let run = sandbox.run("render scene.json -o a.exr --frames 1..3 --fps 1 --spp 2").ends(0);
    assert!(!run.err().contains("warning"), "{}", run.err());
    let frames = ["a.0001.exr", "a.0002.exr", "a.0003.exr"].map(|name| sandbox.channels(name));
    assert!(frames[0] != frames[1] && frames[1] != frames[2]);
    for frame in 1..=3 {
        sandbox.run(&format!("render scene.json -o b.exr --frames {frame} --fps 1 --spp 2")).ends(0);
        assert_eq!(sandbox.channels(&format!("b.{frame:04}.exr")), frames[frame - 1], "frame {frame}");
    }
    sandbox.run("render hand.json -o c.exr --frames 2 --fps 1 --spp 2").ends(0);
    assert_eq!(sandbox.channels("c.0002.exr"), frames[1]);
    // The closed forms are used at every time.
    let info = sandbox.run("info scene.json").ends(0).out();
    assert!(info.contains("tracker closed_form"), "{info}");
}

#[test]
fn a_camera_and_shapes_that_move_leave_nothing_behind() {
    let mut scene = animated();
    let look =
        |x: f64| json!([{"type": "lookat", "origin": [x, 0, 4], "target": [0, 0, 0], "up": [0, 1, 0]}]);
    scene["sensor"]["to_world"] = keyed(&[(0.0, look(0.0)), (2.0, look(0.0)), (3.0, look(2.0))]);
    scene["ball"]["radius"] = keyed(&[(1.0, json!(0.3)), (2.0, json!(0.6))]);
    scene["red"]["reflectance"] = keyed(&[(0.0, json!(0.0)), (4.0, json!(1.0))]);
    let sandbox = Sandbox::with_scene(&scene);
    sandbox.run("render scene.json -o a.exr --frames 0..3 --fps 1 --spp 2 --integrator fog").ends(0);
    for frame in 0..=3 {
        sandbox
            .run(&format!("render scene.json -o b.exr --frames {frame} --fps 1 --spp 2 --integrator fog"))
            .ends(0);
        let [all, alone] = ["a", "b"].map(|name| sandbox.channels(&format!("{name}.{frame:04}.exr")));
        assert_eq!(all, alone, "frame {frame}");
    }
}

#[test]
fn keyframes_are_the_same_in_either_format() {
    let mut scene = animated();
    scene["$defaults"] = json!({"when": 2.5, "bright": 3});
    scene["sky"]["radiance"] = json!({"type": "keyframes", "interpolation": "smooth",
        "value": [[0, 1], ["$when", "$bright"]]});
    let sandbox = Sandbox::with_scene(&scene);
    sandbox.run("convert scene.json scene.xml -D bright=7").ends(0);
    sandbox.run("convert scene.xml back.json").ends(0);
    let xml = String::from_utf8(sandbox.bytes("scene.xml")).unwrap();
    assert!(xml.contains(r#"<keyframes name="radiance" interpolation="smooth">"#), "{xml}");
    assert!(xml.contains(r#"<integer time="2.5" value="7"/>"#), "{xml}");
    let back: Value = serde_json::from_slice(&sandbox.bytes("back.json")).unwrap();
    assert_eq!(back["sky"]["radiance"]["value"], json!([[0, 1], [2.5, 7]]), "{back}");
    let image = |file: &str| {
        sandbox.run(&format!("render {file} -o a.exr --frames 2 --fps 1 --spp 1")).ends(0);
        sandbox.channels("a.0002.exr")
    };
    let [json, xml, back] = ["scene.json -D bright=7", "scene.xml", "back.json"].map(image);
    assert!(json == xml && json == back);
}

/// The sky is brighter than 0 in all frames but the second, or the last two.
#[test]
fn what_leaves_its_range_is_refused_before_the_first_frame() {
    for (keys, place) in [
        (json!([[0, 1], [0.4, -1], [1, 1]]), "frame 1, at 0.3"),
        (json!([[0, 1], [1, 0.1], [10, -100]]), "frame 4, at 1.3"),
    ] {
        let mut scene = animated();
        scene["sky"]["radiance"] = json!({"type": "keyframes", "value": keys});
        let sandbox = Sandbox::with_scene(&scene);
        let run = sandbox.run("render scene.json -o a.exr --frames 0..4 --fps 3 --spp 1");
        run.refuses(&[place, "radiance"]);
        assert!(!sandbox.path("a.0000.exr").exists());
    }
}

/// The animated scene, of which all passes see another moment.
fn blurred() -> Value {
    let mut scene = animated();
    scene["time"] = json!(1.0);
    scene["sensor"]["shutter_open"] = json!(-0.25);
    scene["sensor"]["shutter_close"] = json!(1.5);
    scene
}

#[test]
fn any_partition_of_the_samples_sees_the_same_moments() {
    let sandbox = Sandbox::with_scene(&blurred());
    let run = |words: &str| {
        sandbox.run(&format!("render scene.json --strategies hit,next-event,join {words}")).ends(0)
    };
    run("--spp 7 -o all.exr --threads 2");
    run("--samples 0..3 --sums a.sums --threads 1");
    run("--samples 3..7 --sums b.sums --threads 3");
    sandbox.run("merge b.sums a.sums -o merged.exr").ends(0);
    assert_eq!(sandbox.channels("all.exr"), sandbox.channels("merged.exr"));
    run("--spp 7 --resume --sums a.sums -o gone_on.exr");
    assert_eq!(sandbox.channels("all.exr"), sandbox.channels("gone_on.exr"));
    let info = sandbox.run("info scene.json").ends(0).out();
    assert!(info.contains("exposure    from -0.25 to 1.5 s"), "{info}");
}

#[test]
fn a_blurred_frame_is_the_same_alone() {
    let mut scene = blurred();
    scene["integrator"] = json!({"type": "aov", "aovs": "d:depth", "inner": {"type": "bdpt"}});
    let step = |x: f64| json!([{"type": "translate", "value": [x, 0, 0]}]);
    scene["ball"]["to_world"] = keyed(&[(0.0, step(0.0)), (3.0, step(1.5))]);
    let sandbox = Sandbox::with_scene(&scene);
    sandbox.run("render scene.json -o a.exr --frames 0..1 --fps 2 --spp 3").ends(0);
    sandbox.run("render scene.json -o b.exr --frames 1 --fps 2 --spp 3").ends(0);
    let [first, second, alone] =
        ["a.0000.exr", "a.0001.exr", "b.0001.exr"].map(|name| sandbox.channels(name));
    assert!(first != second && second == alone);
}

/// What stands still is not asked for another moment, and shows what it showed.
#[test]
fn an_open_shutter_changes_nothing_that_stands_still() {
    let mut scene = scene_with(|name, at_2| if name == "velocity" { json!([0, 0, 0]) } else { at_2 });
    let sandbox = Sandbox::with_scene(&scene);
    sandbox.run("render scene.json -o still.exr --spp 2").ends(0);
    scene["sensor"]["shutter_close"] = json!(2.0);
    std::fs::write(sandbox.path("scene.json"), scene.to_string()).unwrap();
    sandbox.run("render scene.json -o open.exr --spp 2").ends(0);
    assert_eq!(sandbox.channels("still.exr"), sandbox.channels("open.exr"));
}

#[test]
fn samples_of_a_pixel_are_those_of_the_image() {
    let mut scene = blurred();
    scene["integrator"] = json!({"type": "path"});
    scene["sensor"]["film"]["rfilter"] = json!({"type": "box"});
    let sandbox = Sandbox::with_scene(&scene);
    sandbox.run("render scene.json -o a.exr --spp 5 --strategies hit,next-event").ends(0);
    let paths = sandbox.run("pixel scene.json 3 4 --samples 5 --strategies hit,next-event").ends(0).out();
    let paths: Value = serde_json::from_str(&paths).unwrap();
    let red = |sample: &Value| sample["value"][0].as_f64().unwrap();
    let mean = paths["samples"].as_array().unwrap().iter().map(red).sum::<f64>() / 5.0;
    let found = f64::from(sandbox.channels("a.exr")["R"][4 * 8 + 3]);
    assert!(found > 0.0 && (mean / found - 1.0).abs() < 1e-5, "{mean} {found}");
}

/// What is not there halfway through the exposure is not left out by the pilot.
#[test]
fn fog_that_appears_late_is_lit() {
    let fog = |sigma_t: Value| {
        scene(&[
            ("sensor", with(camera([0.0, 0.0, 4.0], [0.0, 0.0, 0.0], 32), &[("shutter_close", json!(1.0))])),
            ("fog", null_box([-1.0; 3], [1.0; 3], Some(medium(sigma_t, 0.9, 0.0)))),
            ("sky", sky(0.2)),
            ("lamp", point([2.0, 2.0, 2.0], 5.0)),
        ])
    };
    let appears = fog(keyed(&[(0.0, json!(0.0)), (0.6, json!(0.0)), (1.0, json!(3.0))]));
    let sandbox = Sandbox::with_scene(&appears);
    let red = |name: &str| sandbox.channels(name)["R"].iter().map(|x| f64::from(*x)).sum::<f64>();
    let run = |words: &str| sandbox.run(&format!("render scene.json --spp 64 {words}")).ends(0);
    run("-o pilot.exr");
    run("--seed 1 -o named.exr --strategies hit,next-event");
    let ratio = red("pilot.exr") / red("named.exr");
    assert!((ratio - 1.0).abs() < 0.02, "{ratio}");
}

/// All tasks of such a pass are one, which is always done.
#[test]
fn a_moving_scene_of_one_block_ends_in_time() {
    let mut scene = animated();
    scene["sensor"]["shutter_close"] = json!(1);
    let sandbox = Sandbox::with_scene(&scene);
    let render = "$TYNDALL render scene.json --spp 100000000 -o a.exr";
    for words in ["--time-limit 0.3s", "--time-limit 0.3s --error 0.00001"] {
        sandbox.shell(&format!("timeout 60 {render} {words}")).ends(0);
    }
    std::fs::remove_file(sandbox.path("a.exr")).unwrap();
    // It is interrupted after a second, and killed if it goes on.
    sandbox.shell(&format!("timeout -s INT -k 60 1 {render}; test $? != 137")).ends(0);
    assert!(sandbox.path("a.exr").exists());
}
