//! The program as a user runs it: what it writes, what it says, and what it leaves behind when it fails.

use crate::{common::pieces::*, sandbox::Sandbox};
use serde_json::{Value, json};
use std::{
    fs,
    time::{Duration, Instant},
};

fn foggy_room() -> Value {
    scene(&[
        ("sensor", camera([0.0, 0.0, 0.9], [0.0, 0.0, -1.0], 8)),
        ("fog", medium(1.0, 0.8, 0.3)),
        ("room", room(0.6, Some(named("fog")))),
        ("lamp", lamp_ball([0.2, 0.3, -0.3], 0.3, 2.0)),
    ])
}

/// Width and height that an OpenEXR or PNG file states of itself.
fn size_of(png: &[u8]) -> (u32, u32) {
    let number = |at: usize| u32::from_be_bytes(png[at..at + 4].try_into().unwrap());
    (number(16), number(20))
}

#[test]
fn a_render_leaves_an_image_and_its_preview() {
    let sandbox = Sandbox::with_scene(&foggy_room());
    let run = sandbox.run("render scene.json").ends(0);
    assert_eq!(sandbox.files(), ["scene.exr", "scene.json", "scene.png"]);
    assert!(run.out().contains("4 samples/pixel") && run.out().contains("scene.exr"), "{}", run.out());
    assert_eq!(size_of(&sandbox.bytes("scene.png")), (8, 8));
}

#[test]
fn the_size_can_be_chosen() {
    let sandbox = Sandbox::with_scene(&foggy_room());
    sandbox.run("render scene.json -o small.exr --size 13x5 --spp 1").ends(0);
    assert_eq!(size_of(&sandbox.bytes("small.png")), (13, 5));
}

/// A cloud that drifts past the camera.
fn drifting() -> Value {
    let wave = json!({"type": "cosine", "w": {"type": "wave", "amplitude": 0.9, "vector": [3, 0, 0]}});
    let wind = json!({"type": "wind", "velocity": [1, 0, 0], "a": wave});
    let cloud = json!({"type": "heterogeneous", "sigma_t": wind, "albedo": 0.5});
    scene(&[
        ("sensor", camera([0.0, 0.0, 4.0], [0.0, 0.0, 0.0], 8)),
        ("cloud", null_box([-1.0; 3], [1.0; 3], Some(cloud))),
        ("sky", sky(1.0)),
    ])
}

#[test]
fn frames_are_numbered_files_and_the_same_alone() {
    let sandbox = Sandbox::with_scene(&drifting());
    let run =
        sandbox.run("render scene.json -o a.exr --frames 9..11 --fps 2 --report r.json --spp 1").ends(0);
    let names = ["a.0009.exr", "a.0009.png", "a.0010.exr", "a.0010.png", "a.0011.exr", "a.0011.png"];
    assert_eq!(sandbox.files(), [&names[..], &["r.json", "scene.json"]].concat());
    assert!(
        run.out().contains("frame 10 of 9..11") && !run.err().contains("warning"),
        "{}{}",
        run.out(),
        run.err()
    );
    let figures: Value = serde_json::from_slice(&sandbox.bytes("r.json")).unwrap();
    assert_eq!((&figures["frames"][1]["frame"], &figures["frames"][1]["time"]), (&json!(10), &json!(5.0)));
    let all = sandbox.channels("a.0010.exr");
    sandbox.run("render scene.json -o a.exr --frames 10 --fps 2 --spp 1").ends(0);
    assert_eq!(sandbox.channels("a.0010.exr"), all);
    sandbox.run("render scene.json -o a.exr --frames 10 --fps 4 --spp 1").ends(0);
    assert_ne!(sandbox.channels("a.0010.exr"), all);
    let still = Sandbox::with_scene(&foggy_room());
    let reported = still.run("render scene.json --frames 0..1 --spp 1").ends(0).err();
    assert!(reported.contains("warning") && reported.contains("wind"), "{reported}");
    assert_eq!(still.files().len(), 5);
    assert_ne!(still.channels("scene.0000.exr"), still.channels("scene.0001.exr"));
}

#[test]
fn heuristics_can_be_chosen() {
    let lamp = lamp_ball([0.0, 0.0, 0.0], 0.3, 1.0);
    let sandbox =
        Sandbox::with_scene(&scene(&[("sensor", camera([0.0, 0.0, 3.0], [0.0; 3], 4)), ("lamp", lamp)]));
    for heuristic in ["balance", "power", "maximum", "cutoff:0.3 --max-depth 32", "uniform"] {
        sandbox.run(&format!("render scene.json --spp 1 --heuristic {heuristic}")).ends(0);
    }
    sandbox.run("render scene.json --heuristic cutoff").refuses(&["max_depth", "32", "no limit"]);
    sandbox.run("render scene.json --heuristic cutoff --max-depth 33").refuses(&["--max-depth", "32", "33"]);
    let reported = sandbox.run("render scene.json --integrator fog --heuristic power").ends(0).err();
    assert!(reported.contains("--heuristic has no effect"), "{reported}");
    let reported = sandbox.run("info scene.json").ends(0).out();
    assert!(reported.contains("weighted by the balance heuristic"), "{reported}");
}

/// Every batch is the image of its own seed, the image is their mean, and the error is that of the mean.
#[test]
fn batches_are_the_images_of_consecutive_seeds() {
    let sandbox = Sandbox::with_scene(&foggy_room());
    let single = "--spp 2 --size 5x4 --integrator lt";
    sandbox
        .run(&format!("render scene.json -o all.exr --batches 3 --seed 7 --report r.json {single}"))
        .ends(0);
    let layers = sandbox.channels("all.exr");
    let images = [7, 8, 9].map(|seed| {
        sandbox.run(&format!("render scene.json -o {seed}.exr --seed {seed} {single}")).ends(0);
        sandbox.channels(&format!("{seed}.exr"))
    });
    for colour in ["R", "G", "B"] {
        for (k, image) in images.iter().enumerate() {
            assert_eq!(layers[&format!("batch.{k}.{colour}")], image[colour], "{k} {colour}");
        }
        for i in 0..20 {
            let values = images.each_ref().map(|image| f64::from(image[colour][i]));
            let mean = values.iter().sum::<f64>() / 3.0;
            let error = (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / 6.0).sqrt();
            let found =
                [colour.to_owned(), format!("standard_error.{colour}")].map(|c| f64::from(layers[&c][i]));
            assert!(
                (found[0] - mean).abs() <= 2e-3 * mean && (found[1] - error).abs() <= 3e-3 * error,
                "{found:?}"
            );
        }
    }
    assert_eq!(
        (layers.len(), &sandbox.json("r.json")["batches"]),
        (3 + 3 + 9 + usize::from(layers.contains_key("A")), &json!(3))
    );
    sandbox.run("render scene.json -o all.pfm --batches 3").refuses(&[
        "all.pfm",
        "OpenEXR",
        "--batches",
        ".exr",
    ]);
    let frames =
        sandbox.run("render scene.json -o f.exr --spp 1 --size 2x2 --frames 1..2 --batches 2").ends(0);
    assert!(
        frames.out().contains("frame 2 of 1..2") && sandbox.channels("f.0002.exr").contains_key("batch.1.G")
    );
}

#[test]
fn trackers_can_be_forced() {
    let sandbox = Sandbox::with_scene(&drifting());
    let reported = |words: &str| sandbox.run(&format!("info scene.json {words}")).ends(0).out();
    assert!(reported("").contains("tracker closed_form, chosen by cost"), "{}", reported(""));
    let forced = reported("--tracker null_collision");
    assert!(forced.contains("tracker null_collision, forced by --tracker"), "{forced}");
    sandbox.run("render scene.json --tracker march --spp 1").ends(0);
    sandbox.run("render scene.json --tracker exact").refuses(&["gridvolume", "closed_form"]);
    let still = Sandbox::with_scene(&foggy_room());
    let reported = still.run("info scene.json --tracker march").ends(0).err();
    assert!(reported.contains("--tracker has no effect"), "{reported}");
}

#[test]
fn integrators_that_do_less_say_so() {
    let with_integrator =
        |integrator: Value| Sandbox::with_scene(&with(drifting(), &[("integrator", integrator)]));
    let sandbox = with_integrator(json!({"type": "fog", "threshold": 50}));
    sandbox.run("render scene.json").ends(0);
    sandbox.run("render scene.json -o again.exr --integrator fog").ends(0);
    assert_eq!(sandbox.channels("scene.exr"), sandbox.channels("again.exr"));
    sandbox.run("convert scene.json spelt.xml").ends(0);
    sandbox.run("render spelt.xml -o spelt.exr").ends(0);
    assert_eq!(sandbox.channels("scene.exr"), sandbox.channels("spelt.exr"));
    sandbox.run("render scene.json -o full.exr --integrator pt").ends(0);
    assert_ne!(sandbox.channels("scene.exr"), sandbox.channels("full.exr"));
    assert!(sandbox.run("info scene.json").ends(0).out().contains("fog, a preview"));
    let reported = sandbox.run("render scene.json --max-depth 3").ends(0).err();
    assert!(reported.contains("--max-depth has no effect"), "{reported}");
    let reported = sandbox.run("render scene.json --min-depth 3").ends(0).err();
    assert!(reported.contains("--min-depth has no effect"), "{reported}");
    sandbox.run("render scene.json --strategies hit").refuses(&["--strategies"]);
    let sandbox = with_integrator(json!({"type": "single_scattering", "step": 0.05}));
    let reported = sandbox.run("info scene.json").ends(0).out();
    assert!(
        reported.contains("single scattering") && reported.contains("march by steps of at most 0.05 m"),
        "{reported}"
    );
    sandbox.run("render scene.json --max-depth 3").refuses(&["--max-depth", "single_scattering"]);
    sandbox.run("render scene.json --min-depth 3").refuses(&["--min-depth", "maximum of 2", "found 3"]);
    let sandbox = with_integrator(json!({"type": "non_scattering"}));
    let reported = sandbox.run("info scene.json").ends(0).out();
    assert!(
        reported.contains("absorb and emit only") && reported.contains("albedo at most 0 0 0"),
        "{reported}"
    );
}

/// What a scene says about marching and scattering, the command line can say: the images are the same, bit for bit.
#[test]
fn the_command_line_says_what_scenes_say_of_media() {
    let restricted =
        |integrator: Value| Sandbox::with_scene(&with(drifting(), &[("integrator", integrator)]));
    let plain = restricted(json!({"type": "path"}));
    let same = |scene: Value, words: &str| {
        let said = restricted(scene);
        said.run("render scene.json --integrator pt --spp 2").ends(0);
        plain.run(&format!("render scene.json --integrator pt --spp 2 {words}")).ends(0);
        assert_eq!(said.channels("scene.exr"), plain.channels("scene.exr"), "{words}");
        said.channels("scene.exr")
    };
    let marched = json!({"type": "single_scattering", "step": 0.3});
    let single = same(marched.clone(), "--scattering single --step 0.3");
    let fine = same(
        json!({"type": "single_scattering", "march_error": 1e-4}),
        "--scattering single --march-error 1e-4",
    );
    let none = same(json!({"type": "non_scattering"}), "--scattering none");
    let all = same(json!({"type": "path"}), "");
    assert!(single != fine && fine != none && none != all);
    let single = restricted(marched);
    single.run("render scene.json --integrator pt --spp 2 --scattering multiple").ends(0);
    assert_eq!(single.channels("scene.exr"), all);
    let step = plain.run("info scene.json --step 0.25").ends(0).out();
    assert!(step.contains("march by steps of at most 0.25 m, forced by the command line"), "{step}");
    let idle = plain.run("info scene.json --step 0.25 --tracker closed_form").ends(0).err();
    assert!(idle.contains("--step has no effect: --tracker closed_form does not march"), "{idle}");
    plain.run("render scene.json --scattering single --max-depth 3").refuses(&["--scattering multiple"]);
}

/// Sums of one step are not those of another.
#[test]
fn sums_know_the_step_that_was_marched_by() {
    let sandbox = Sandbox::with_scene(&drifting());
    sandbox.run("render scene.json --spp 1 --step 0.3 --sums a.sums").ends(0);
    sandbox.run("render scene.json --spp 2 --step 0.3 --sums a.sums --resume").ends(0);
    sandbox
        .run("render scene.json --spp 3 --step 0.2 --sums a.sums --resume")
        .refuses(&["overridden.step = 0.2"]);
    sandbox.run("render scene.json --spp 3 --sums a.sums --resume").refuses(&["trackers[0] = \"auto\""]);
    let all = "--strategies hit,next-event,join,lens --sums b.sums";
    sandbox.run(&format!("render scene.json --spp 1 {all}")).ends(0);
    let pairs = format!("render scene.json --spp 2 {all} --resume --connections all");
    sandbox.run(&pairs).refuses(&["connections = \"all\""]);
    // How noisy samples are does not matter.
    sandbox.run(&format!("render scene.json --spp 2 {all} --resume --guide always")).ends(0);
    sandbox.run("render scene.json --spp 2 --guide auto --heuristic power").refuses(&[
        "--guide",
        "power",
        "--guide never",
    ]);
    let guided = sandbox.run("render scene.json -v --spp 2 --guide always").ends(0).err();
    assert!(guided.contains("guided walks"), "{guided}");
    sandbox.run(&format!("render scene.json --spp 3 {all} --resume --starts learnt")).ends(0);
    let kept = "render scene.json --strategies hit,next-event,join,lens --spp 1 --guide always --sums c.sums";
    sandbox.run(kept).ends(0);
    sandbox.run(&format!("{kept} --resume --basis haar")).ends(0);
    for (words, flag) in [("--starts learnt --strategies hit", "--starts"), ("--basis bins", "--basis")] {
        let said = sandbox.run(&format!("render scene.json --spp 1 {words}")).ends(0).err();
        assert!(said.contains(&format!("{flag} has no effect")), "{said}");
    }
    let said = sandbox.run("render scene.json --spp 1 --integrator lt --sky hit").ends(0).err();
    assert_eq!(said.matches("--sky has no effect").count(), 1, "{said}");
    for (starts, is_learnt) in [("learnt", true), ("emitted", false)] {
        let said =
            sandbox.run(&format!("render scene.json -v --spp 1 --starts {starts} {all}2")).ends(0).err();
        assert_eq!(said.contains("learnt starts"), is_learnt, "{said}");
    }
}

#[test]
fn the_command_line_says_what_scenes_say_of_the_preview() {
    let fog = json!({"type": "fog", "threshold": 2.5, "fog_color": {"type": "rgb", "value": [0.5, 0.25, 1]}, "ambient": 0.125});
    let sandbox = Sandbox::with_scene(&with(drifting(), &[("integrator", fog)]));
    sandbox.run("render scene.json").ends(0);
    let plain = Sandbox::with_scene(&drifting());
    let words = "--integrator fog --threshold 2.5 --fog-color 0.5,0.25,1 --ambient 0.125";
    plain.run(&format!("render scene.json {words}")).ends(0);
    assert_eq!(sandbox.channels("scene.exr"), plain.channels("scene.exr"));
    plain.run("render scene.json --integrator fog -o own.exr").ends(0);
    assert_ne!(plain.channels("scene.exr"), plain.channels("own.exr"));
    let idle = plain.run("render scene.json --spp 1 --threshold 2").ends(0).err();
    assert!(idle.contains("--threshold has no effect"), "{idle}");
    for words in ["--fog-color 1,2", "--ambient -1", "--threshold 0"] {
        plain.run(&format!("render scene.json --integrator fog {words}")).refuses(&["such as"]);
    }
}

#[test]
fn emitters_are_hidden_or_shown_by_the_command_line() {
    let hidden = Sandbox::with_scene(&with(
        drifting(),
        &[("integrator", json!({"type": "path", "hide_emitters": true}))],
    ));
    let shown = Sandbox::with_scene(&drifting());
    let render = |sandbox: &Sandbox, words: &str| {
        sandbox.run(&format!("render scene.json --integrator pt --spp 2 {words}")).ends(0);
        sandbox.channels("scene.exr")
    };
    assert_eq!(render(&hidden, ""), render(&shown, "--hide-emitters"));
    assert_eq!(render(&shown, ""), render(&hidden, "--no-hide-emitters"));
    assert_ne!(render(&shown, ""), render(&hidden, ""));
}

/// A foggy room whose film has more to it.
fn filmed(more: &[(&str, Value)]) -> Value {
    let sensor = foggy_room()["sensor"].clone();
    let film = with(sensor["film"].clone(), more);
    with(foggy_room(), &[("sensor", with(sensor, &[("film", film)]))])
}

#[test]
fn a_crop_window_is_an_image_of_its_own() {
    let crop = [("crop_offset_x", json!(2)), ("crop_width", json!(5)), ("crop_height", json!(3))];
    let sandbox = Sandbox::with_scene(&filmed(&crop));
    sandbox.run("render scene.json --spp 1").ends(0);
    assert_eq!(size_of(&sandbox.bytes("scene.png")), (5, 3));
    sandbox.run("render scene.json --size 16x16").refuses(&["--size", "crop window", "5 x 3"]);
    assert!(sandbox.run("info scene.json").ends(0).out().contains("the window at 2, 0 of 8 x 8"));
}

#[test]
fn the_film_or_the_name_decides_the_file() {
    let sandbox =
        Sandbox::with_scene(&filmed(&[("file_format", json!("pfm")), ("pixel_format", json!("luminance"))]));
    sandbox.run("render scene.json --spp 1").ends(0);
    assert_eq!(sandbox.files(), ["scene.json", "scene.pfm", "scene.png"]);
    assert!(sandbox.bytes("scene.pfm").starts_with(b"Pf\n8 8\n"));
    let reported = sandbox.run("render scene.json --spp 1 -o bright.hdr").ends(0).err();
    assert!(reported.contains("warning") && reported.contains("RGB is written"), "{reported}");
    assert!(sandbox.bytes("bright.hdr").starts_with(b"#?RADIANCE"));
    sandbox.run("render scene.json --spp 1 -o exact.exr").ends(0);
    assert!(sandbox.path("exact.exr").exists());
    let sandbox =
        Sandbox::with_scene(&filmed(&[("file_format", json!("rgbe")), ("pixel_format", json!("rgba"))]));
    let reported = sandbox.run("render scene.json --spp 1").ends(0).err();
    assert!(reported.contains("warning") && reported.contains("RGB"), "{reported}");
}

#[test]
fn layers_need_a_file_that_holds_them() {
    let integrator = json!({"type": "aov", "aovs": "n:sh_normal", "img": {"type": "path"}});
    let sandbox = Sandbox::with_scene(&with(foggy_room(), &[("integrator", integrator)]));
    sandbox.run("render scene.json --spp 1").ends(0);
    let layers = sandbox.bytes("scene.exr");
    let holds = |name: &str| layers.windows(name.len()).any(|part| part == name.as_bytes());
    assert!(["n.X", "n.Y", "n.Z", "img.R", "img.A"].into_iter().all(holds));
    assert!(sandbox.run("info scene.json").ends(0).out().contains("img (RGBA), n (XYZ)"));
    sandbox.run("render scene.json -o a.pfm").refuses(&["a.pfm", "OpenEXR", "file_format"]);
    assert!(!sandbox.path("a.pfm").exists());
}

#[test]
fn the_seed_decides_the_image() {
    let sandbox = Sandbox::with_scene(&foggy_room());
    for (name, seed) in [("a", 1), ("again", 1), ("b", 2)] {
        sandbox.run(&format!("render scene.json -o {name}.exr --seed {seed}")).ends(0);
    }
    assert_eq!(sandbox.channels("a.exr"), sandbox.channels("again.exr"));
    assert_ne!(sandbox.channels("a.exr"), sandbox.channels("b.exr"));
}

#[test]
fn parameters_are_set_from_the_command_line() {
    let text = "<scene version=\"3.0.0\"><default name=\"width\" value=\"8\"/>
        <sensor type=\"perspective\"><float name=\"fov\" value=\"40\"/>
        <film type=\"hdrfilm\"><integer name=\"width\" value=\"$width\"/>
        <integer name=\"height\" value=\"4\"/></film></sensor>
        <emitter type=\"constant\"/></scene>";
    let sandbox = Sandbox::with_scene(&foggy_room());
    fs::write(sandbox.path("sky.xml"), text).unwrap();
    sandbox.run("render sky.xml -o default.exr").ends(0);
    sandbox.run("render sky.xml -o wide.exr -D width=20").ends(0);
    assert_eq!(size_of(&sandbox.bytes("default.png")), (8, 4));
    assert_eq!(size_of(&sandbox.bytes("wide.png")), (20, 4));
    sandbox.run("render sky.xml -o bad.exr -D widht=20").refuses(&["widht", "width", "expected", "remedy"]);
    assert!(!sandbox.path("bad.exr").exists());
}

#[test]
fn strategies_can_be_chosen_but_not_missed() {
    let sandbox = Sandbox::with_scene(&foggy_room());
    for (name, list) in [("hit", "hit"), ("some", "hit,lens"), ("all", "hit,next-event,join,lens")] {
        sandbox.run(&format!("render scene.json -o {name}.exr --strategies {list}")).ends(0);
    }
    assert_ne!(sandbox.channels("hit.exr"), sandbox.channels("some.exr"));
    let words = "render scene.json -o again.exr --integrator bdpt --strategies lens,join,next-event,hit";
    sandbox.run(words).ends(0);
    assert_eq!(sandbox.channels("all.exr"), sandbox.channels("again.exr"));
    let refused = sandbox.run("render scene.json -o no.exr --integrator pt --strategies join");
    refused.refuses(&["--strategies", "expected", "found", "remedy"]);
    sandbox.run("render scene.json -o no.exr --strategies jion").refuses(&["jion", "join"]);
    assert!(!sandbox.path("no.exr").exists());
}

#[test]
fn a_time_limit_is_kept() {
    let sandbox = Sandbox::with_scene(&foggy_room());
    let started = Instant::now();
    let report = "render scene.json --time-limit 1s --report figures.json";
    sandbox.run(report).ends(0);
    let (limit, elapsed) = (Duration::from_secs(1), started.elapsed());
    assert!(elapsed >= limit.mul_f64(0.9) && elapsed < 4 * limit, "{elapsed:?}");
    let figures: Value = serde_json::from_slice(&sandbox.bytes("figures.json")).unwrap();
    assert!(figures["samples_per_pixel"].as_u64().unwrap() > 4, "{figures}");
    let seconds = figures["render_seconds"].as_f64().unwrap();
    assert!((0.9..1.5).contains(&seconds), "{figures}");
    let cpu = figures["cpu_seconds"].as_f64().unwrap();
    assert!(cpu > 0.05, "{figures}");
    // Samples end it first where they are fewer.
    sandbox.run("render scene.json --time-limit 1h --spp 2").ends(0);
}

#[test]
fn info_tells_how_a_scene_would_be_rendered() {
    let sandbox = Sandbox::with_scene(&foggy_room());
    let reported = sandbox.run("info scene.json").ends(0).out();
    for what in [
        "size        2 x 2 x 2 m, from [-1, -1, -1] to [1, 1, 1]\ncamera      in fog, at [0, 0, 0.9]\nfree path   fog: 1 m\nthickness   1.",
        "8 x 8",
        "bdpt",
        "profile     fog: ",
        "fog: homogeneous",
        "closed-form tracker",
        "camera      in fog",
        "area in fog",
    ] {
        assert!(reported.contains(what), "no \"{what}\" in:\n{reported}");
    }
    assert_eq!(sandbox.files(), ["scene.json"]);
}

#[test]
fn a_scene_is_converted_there_and_back() {
    let sandbox = Sandbox::with_scene(&foggy_room());
    let run = sandbox.run("convert scene.json scene.xml").ends(0);
    assert_eq!((run.out().trim(), run.err().as_str()), ("scene.xml", ""));
    sandbox.run("convert scene.xml again.json").ends(0);
    sandbox.run("render scene.json -o a.exr").ends(0);
    sandbox.run("render scene.xml -o b.exr").ends(0);
    sandbox.run("render again.json -o c.exr").ends(0);
    assert_eq!(sandbox.channels("a.exr"), sandbox.channels("b.exr"));
    assert_eq!(sandbox.channels("a.exr"), sandbox.channels("c.exr"));
}

#[test]
fn a_conversion_says_what_it_changed_and_writes_all_or_nothing() {
    let text = "<scene version=\"3.0.0\"><default name=\"up\" value=\"0 1 0\"/>
        <shape type=\"sphere\"><point name=\"center\" value=\"$up\"/></shape></scene>";
    let sandbox = Sandbox::with_scene(&foggy_room());
    fs::write(sandbox.path("ball.xml"), text).unwrap();
    let run = sandbox.run("convert ball.xml ball.json").ends(0);
    assert_eq!(run.err(), "note: ball.xml: parameters are not kept, only their values: $up = 0 1 0\n");
    let before = sandbox.bytes("ball.json");
    fs::write(sandbox.path("ball.xml"), text.replace("$up", "$u")).unwrap();
    sandbox.run("convert ball.xml ball.json").refuses(&["$u", "did you mean", "expected", "found"]);
    assert_eq!(sandbox.bytes("ball.json"), before);
    sandbox.run("convert ball.xml missing/ball.json -D up=x").refuses(&["ball.xml"]);
    sandbox.run("convert scene.json missing/scene.xml").refuses(&["missing", "create the folder"]);
    sandbox.run("convert scene.json scene.txt").refuses(&["scene.txt", ".xml or .json"]);
    sandbox
        .run("convert scene.json scene.json")
        .refuses(&["scene.json, which this command reads", "another name"]);
    assert_eq!(sandbox.files(), ["ball.json", "ball.xml", "scene.json"]);
}

/// Every mistake is refused with code 2 and a message that says what to mend, and leaves no file behind.
#[test]
fn mistakes_are_refused_and_leave_nothing_behind() {
    let room = foggy_room();
    let lamp = |plugin: &str| with(room.clone(), &[("lamp", json!({"type": plugin}))]);
    let wrong_lamp =
        with(room.clone(), &[("lamp", with(lamp_ball([0.0; 3], 0.3, 1.0), &[("raduis", json!(2))]))]);
    let wrong_fog = with(room.clone(), &[("fog", medium("thick", 0.5, 0.0))]);
    let dangling = with(room.clone(), &[("room", self::room(0.5, Some(named("smog"))))]);
    let cases = [
        (lamp("shpere"), &["scene.json", "shpere", "sphere"][..]),
        (wrong_lamp, &["raduis", "radius"]),
        (wrong_fog, &["fog", "sigma_t", "thick"]),
        (dangling, &["smog", "fog"]),
        (with(room.clone(), &[("fog", medium(-1.0, 0.5, 0.0))]), &["sigma_t", "-1"]),
        (with(room.clone(), &[("fog", medium(1.0, 1.5, 0.0))]), &["albedo", "1.5"]),
        (scene(&[("room", self::room(0.5, None))]), &["sensor"]),
    ];
    for (scene, hints) in cases {
        let sandbox = Sandbox::with_scene(&scene);
        let run = sandbox.run("render scene.json");
        run.refuses(&[hints, &["scene.json", "expected", "found", "remedy"]].concat());
        assert_eq!(sandbox.files(), ["scene.json"]);
        sandbox.run("info scene.json").refuses(hints);
    }
}

#[test]
fn files_that_are_no_scenes_are_refused() {
    let sandbox = Sandbox::with_scene(&foggy_room());
    fs::write(sandbox.path("half.json"), "{\"type\": \"scene\", ").unwrap();
    fs::write(sandbox.path("half.xml"), "<scene version=\"3.0.0\"><sensor").unwrap();
    fs::write(sandbox.path("scene.blend"), "").unwrap();
    let before = sandbox.files();
    for name in ["missing.json", "half.json", "half.xml", "scene.blend"] {
        sandbox.run(&format!("render {name}")).refuses(&[name, "expected", "found", "remedy"]);
    }
    assert_eq!(sandbox.files(), before);
}

#[test]
fn an_image_that_cannot_be_written_is_told() {
    let sandbox = Sandbox::with_scene(&foggy_room());
    let run = sandbox.run("render scene.json --spp 1 -o scene.json/image.exr");
    run.refuses(&["scene.json", "expected", "found"]);
    assert_eq!(sandbox.files(), ["scene.json"]);
    sandbox.run("render scene.json -o image.jpg").refuses(&["image.jpg", ".exr"]);
    sandbox.run("render scene.json --spp 0").refuses(&["--spp", "at least 1"]);
    sandbox.run("render scene.json --size 0x8").refuses(&["--size", "640x480"]);
    assert_eq!(sandbox.files(), ["scene.json"]);
}

#[test]
fn warnings_are_told_and_do_not_stop_the_render() {
    let seeded = with(
        camera([0.0, 0.0, 0.9], [0.0, 0.0, -1.0], 8),
        &[("sampler", json!({"type": "independent", "sample_count": 1, "seed": 3}))],
    );
    let sandbox = Sandbox::with_scene(&with(foggy_room(), &[("sensor", seeded)]));
    let run = sandbox.run("render scene.json").ends(0);
    assert!(run.err().contains("warning") && run.err().contains("seed"), "{}", run.err());
}
