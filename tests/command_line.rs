//! The program as a user runs it: what it writes, what it says, and what it leaves behind when it fails.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on stops loudly")]

mod common;

use common::pieces::*;
use serde_json::{Value, json};
use std::{
    fs,
    path::PathBuf,
    process::{Command, Output},
    time::{Duration, Instant},
};
use tempfile::TempDir;

/// A folder in which the program runs.
struct Desk {
    folder: TempDir,
}

impl Desk {
    /// With `scene.json` in it.
    fn new(scene: &Value) -> Self {
        let desk = Self { folder: TempDir::new().unwrap() };
        fs::write(desk.path("scene.json"), scene.to_string()).unwrap();
        desk
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Runs the program with `words` as its arguments.
    fn run(&self, words: &str) -> Run {
        let mut program = Command::new(env!("CARGO_BIN_EXE_tyndall"));
        let output = program.current_dir(self.folder.path()).args(words.split_whitespace()).output().unwrap();
        Run { words: words.to_owned(), output }
    }

    /// Names of all files, hidden ones too.
    fn files(&self) -> Vec<String> {
        let entries = fs::read_dir(self.folder.path()).unwrap();
        let mut names: Vec<_> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    fn bytes(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap()
    }
}

/// What came of it.
struct Run {
    words: String,
    output: Output,
}

impl Run {
    fn out(&self) -> String {
        String::from_utf8(self.output.stdout.clone()).unwrap()
    }

    fn err(&self) -> String {
        String::from_utf8(self.output.stderr.clone()).unwrap()
    }

    fn succeeds(self) -> Self {
        assert!(self.output.status.success(), "{}: {}", self.words, self.err());
        self
    }

    /// It ends with code 2, having said all of `hints`.
    fn is_refused(&self, hints: &[&str]) {
        let err = self.err();
        assert_eq!(self.output.status.code(), Some(2), "{}: {err}", self.words);
        for hint in hints {
            assert!(err.contains(hint), "{}: no \"{hint}\" in: {err}", self.words);
        }
        assert!(!err.contains("panicked"), "{}: {err}", self.words);
    }
}

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
    let desk = Desk::new(&foggy_room());
    let run = desk.run("render scene.json").succeeds();
    assert_eq!(desk.files(), ["scene.exr", "scene.json", "scene.png"]);
    assert!(run.out().contains("4 samples/pixel") && run.out().contains("scene.exr"), "{}", run.out());
    assert_eq!(size_of(&desk.bytes("scene.png")), (8, 8));
}

#[test]
fn the_size_can_be_chosen() {
    let desk = Desk::new(&foggy_room());
    desk.run("render scene.json -o small.exr --size 13x5 --spp 1").succeeds();
    assert_eq!(size_of(&desk.bytes("small.png")), (13, 5));
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
    let desk = Desk::new(&drifting());
    let run =
        desk.run("render scene.json -o a.exr --frames 9..11 --fps 2 --report r.json --spp 1").succeeds();
    let names = ["a.0009.exr", "a.0009.png", "a.0010.exr", "a.0010.png", "a.0011.exr", "a.0011.png"];
    assert_eq!(desk.files(), [&names[..], &["r.json", "scene.json"]].concat());
    assert!(run.out().contains("frame 10 of 9..11") && run.err().is_empty(), "{}{}", run.out(), run.err());
    let figures: Value = serde_json::from_slice(&desk.bytes("r.json")).unwrap();
    assert_eq!((&figures["frames"][1]["frame"], &figures["frames"][1]["time"]), (&json!(10), &json!(5.0)));
    let all = desk.bytes("a.0010.exr");
    desk.run("render scene.json -o a.exr --frames 10 --fps 2 --spp 1").succeeds();
    assert_eq!(desk.bytes("a.0010.exr"), all);
    desk.run("render scene.json -o a.exr --frames 10 --fps 4 --spp 1").succeeds();
    assert_ne!(desk.bytes("a.0010.exr"), all);
    let still = Desk::new(&foggy_room());
    let told = still.run("render scene.json --frames 0..1 --spp 1").succeeds().err();
    assert!(told.contains("warning") && told.contains("wind"), "{told}");
    assert_eq!(still.files().len(), 5);
    assert_ne!(still.bytes("scene.0000.exr"), still.bytes("scene.0001.exr"));
}

#[test]
fn heuristics_can_be_chosen() {
    let lamp = lamp_ball([0.0, 0.0, 0.0], 0.3, 1.0);
    let desk = Desk::new(&scene(&[("sensor", camera([0.0, 0.0, 3.0], [0.0; 3], 4)), ("lamp", lamp)]));
    for heuristic in ["balance", "power", "maximum", "cutoff:0.3 --max-depth 32", "uniform"] {
        desk.run(&format!("render scene.json --spp 1 --heuristic {heuristic}")).succeeds();
    }
    desk.run("render scene.json --heuristic cutoff").is_refused(&["max_depth", "32", "no limit"]);
    desk.run("render scene.json --heuristic cutoff --max-depth 33").is_refused(&["--max-depth", "32", "33"]);
    let told = desk.run("render scene.json --integrator fog --heuristic power").succeeds().err();
    assert!(told.contains("--heuristic has no effect"), "{told}");
    let told = desk.run("info scene.json").succeeds().out();
    assert!(told.contains("weighed by the balance heuristic"), "{told}");
}

#[test]
fn trackers_can_be_forced() {
    let desk = Desk::new(&drifting());
    let told = |words: &str| desk.run(&format!("info scene.json {words}")).succeeds().out();
    assert!(told("").contains("tracker closed_form, chosen by cost"), "{}", told(""));
    let forced = told("--tracker null_collision");
    assert!(forced.contains("tracker null_collision, forced by --tracker"), "{forced}");
    desk.run("render scene.json --tracker march --spp 1").succeeds();
    desk.run("render scene.json --tracker exact").is_refused(&["gridvolume", "closed_form"]);
    let still = Desk::new(&foggy_room());
    let told = still.run("info scene.json --tracker march").succeeds().err();
    assert!(told.contains("--tracker has no effect"), "{told}");
}

#[test]
fn integrators_that_do_less_say_so() {
    let with_integrator = |integrator: Value| Desk::new(&with(drifting(), &[("integrator", integrator)]));
    let desk = with_integrator(json!({"type": "fog", "threshold": 50}));
    desk.run("render scene.json").succeeds();
    desk.run("render scene.json -o again.exr --integrator fog").succeeds();
    assert_eq!(desk.bytes("scene.exr"), desk.bytes("again.exr"));
    desk.run("convert scene.json spelt.xml").succeeds();
    desk.run("render spelt.xml -o spelt.exr").succeeds();
    assert_eq!(desk.bytes("scene.exr"), desk.bytes("spelt.exr"));
    desk.run("render scene.json -o full.exr --integrator pt").succeeds();
    assert_ne!(desk.bytes("scene.exr"), desk.bytes("full.exr"));
    assert!(desk.run("info scene.json").succeeds().out().contains("fog, a preview"));
    let told = desk.run("render scene.json --max-depth 3").succeeds().err();
    assert!(told.contains("--max-depth has no effect"), "{told}");
    desk.run("render scene.json --strategies hit").is_refused(&["--strategies"]);
    let desk = with_integrator(json!({"type": "single_scattering", "step": 0.05}));
    let told = desk.run("info scene.json").succeeds().out();
    assert!(
        told.contains("single scattering") && told.contains("march by steps of at most 0.05 m"),
        "{told}"
    );
    desk.run("render scene.json --max-depth 3").is_refused(&["--max-depth", "single_scattering"]);
    let desk = with_integrator(json!({"type": "non_scattering"}));
    let told = desk.run("info scene.json").succeeds().out();
    assert!(told.contains("absorb and emit only") && told.contains("albedo at most 0 0 0"), "{told}");
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
    let desk = Desk::new(&filmed(&crop));
    desk.run("render scene.json --spp 1").succeeds();
    assert_eq!(size_of(&desk.bytes("scene.png")), (5, 3));
    desk.run("render scene.json --size 16x16").is_refused(&["--size", "crop window", "5 x 3"]);
    assert!(desk.run("info scene.json").succeeds().out().contains("the window at 2, 0 of 8 x 8"));
}

#[test]
fn the_film_or_the_name_decides_the_file() {
    let desk = Desk::new(&filmed(&[("file_format", json!("pfm")), ("pixel_format", json!("luminance"))]));
    desk.run("render scene.json --spp 1").succeeds();
    assert_eq!(desk.files(), ["scene.json", "scene.pfm", "scene.png"]);
    assert!(desk.bytes("scene.pfm").starts_with(b"Pf\n8 8\n"));
    let told = desk.run("render scene.json --spp 1 -o bright.hdr").succeeds().err();
    assert!(told.contains("warning") && told.contains("RGB is written"), "{told}");
    assert!(desk.bytes("bright.hdr").starts_with(b"#?RADIANCE"));
    desk.run("render scene.json --spp 1 -o exact.exr").succeeds();
    assert!(desk.path("exact.exr").exists());
    let desk = Desk::new(&filmed(&[("file_format", json!("rgbe")), ("pixel_format", json!("rgba"))]));
    let told = desk.run("render scene.json --spp 1").succeeds().err();
    assert!(told.contains("warning") && told.contains("RGB"), "{told}");
}

#[test]
fn layers_need_a_file_that_holds_them() {
    let integrator = json!({"type": "aov", "aovs": "n:sh_normal", "img": {"type": "path"}});
    let desk = Desk::new(&with(foggy_room(), &[("integrator", integrator)]));
    desk.run("render scene.json --spp 1").succeeds();
    let layers = desk.bytes("scene.exr");
    let holds = |name: &str| layers.windows(name.len()).any(|part| part == name.as_bytes());
    assert!(["n.X", "n.Y", "n.Z", "img.R", "img.A"].into_iter().all(holds));
    assert!(desk.run("info scene.json").succeeds().out().contains("img (RGBA), n (XYZ)"));
    desk.run("render scene.json -o a.pfm").is_refused(&["a.pfm", "OpenEXR", "file_format"]);
    assert!(!desk.path("a.pfm").exists());
}

#[test]
fn the_seed_decides_the_image() {
    let desk = Desk::new(&foggy_room());
    for (name, seed) in [("a", 1), ("again", 1), ("b", 2)] {
        desk.run(&format!("render scene.json -o {name}.exr --seed {seed}")).succeeds();
    }
    assert_eq!(desk.bytes("a.exr"), desk.bytes("again.exr"));
    assert_ne!(desk.bytes("a.exr"), desk.bytes("b.exr"));
}

#[test]
fn parameters_are_set_from_the_command_line() {
    let text = "<scene version=\"3.0.0\"><default name=\"width\" value=\"8\"/>
        <sensor type=\"perspective\"><float name=\"fov\" value=\"40\"/>
        <film type=\"hdrfilm\"><integer name=\"width\" value=\"$width\"/>
        <integer name=\"height\" value=\"4\"/></film></sensor>
        <emitter type=\"constant\"/></scene>";
    let desk = Desk::new(&foggy_room());
    fs::write(desk.path("sky.xml"), text).unwrap();
    desk.run("render sky.xml -o default.exr").succeeds();
    desk.run("render sky.xml -o wide.exr -D width=20").succeeds();
    assert_eq!(size_of(&desk.bytes("default.png")), (8, 4));
    assert_eq!(size_of(&desk.bytes("wide.png")), (20, 4));
    desk.run("render sky.xml -o bad.exr -D widht=20").is_refused(&["widht", "width", "expected", "remedy"]);
    assert!(!desk.path("bad.exr").exists());
}

#[test]
fn strategies_can_be_chosen_but_not_missed() {
    let desk = Desk::new(&foggy_room());
    for (name, list) in [("hit", "hit"), ("some", "hit,lens"), ("all", "hit,next-event,join,lens")] {
        desk.run(&format!("render scene.json -o {name}.exr --strategies {list}")).succeeds();
    }
    assert_ne!(desk.bytes("hit.exr"), desk.bytes("some.exr"));
    desk.run("render scene.json -o default.exr").succeeds();
    assert_eq!(desk.bytes("all.exr"), desk.bytes("default.exr"));
    let refused = desk.run("render scene.json -o no.exr --integrator pt --strategies join");
    refused.is_refused(&["--strategies", "expected", "found", "remedy"]);
    desk.run("render scene.json -o no.exr --strategies jion").is_refused(&["jion", "join"]);
    assert!(!desk.path("no.exr").exists());
}

#[test]
fn a_time_limit_is_kept() {
    let desk = Desk::new(&foggy_room());
    let started = Instant::now();
    let report = "render scene.json --time-limit 1s --report figures.json";
    desk.run(report).succeeds();
    let (limit, elapsed) = (Duration::from_secs(1), started.elapsed());
    assert!(elapsed >= limit.mul_f64(0.9) && elapsed < 4 * limit, "{elapsed:?}");
    let figures: Value = serde_json::from_slice(&desk.bytes("figures.json")).unwrap();
    assert!(figures["samples_per_pixel"].as_u64().unwrap() > 4, "{figures}");
    let seconds = figures["render_seconds"].as_f64().unwrap();
    assert!((0.9..1.5).contains(&seconds), "{figures}");
    // Samples end it first where they are fewer.
    desk.run("render scene.json --time-limit 1h --spp 2").succeeds();
}

#[test]
fn info_tells_how_a_scene_would_be_rendered() {
    let desk = Desk::new(&foggy_room());
    let told = desk.run("info scene.json").succeeds().out();
    for what in [
        "8 x 8",
        "bdpt",
        "profile     fog, leaving out",
        "fog: homogeneous",
        "closed-form tracker",
        "camera      in fog",
        "area in fog",
    ] {
        assert!(told.contains(what), "no \"{what}\" in:\n{told}");
    }
    assert_eq!(desk.files(), ["scene.json"]);
}

#[test]
fn a_scene_is_converted_there_and_back() {
    let desk = Desk::new(&foggy_room());
    let run = desk.run("convert scene.json scene.xml").succeeds();
    assert_eq!((run.out().trim(), run.err().as_str()), ("scene.xml", ""));
    desk.run("convert scene.xml again.json").succeeds();
    desk.run("render scene.json -o a.exr").succeeds();
    desk.run("render scene.xml -o b.exr").succeeds();
    desk.run("render again.json -o c.exr").succeeds();
    assert_eq!(desk.bytes("a.exr"), desk.bytes("b.exr"));
    assert_eq!(desk.bytes("a.exr"), desk.bytes("c.exr"));
}

#[test]
fn a_conversion_says_what_it_changed_and_writes_all_or_nothing() {
    let text = "<scene version=\"3.0.0\"><default name=\"up\" value=\"0 1 0\"/>
        <shape type=\"sphere\"><point name=\"center\" value=\"$up\"/></shape></scene>";
    let desk = Desk::new(&foggy_room());
    fs::write(desk.path("ball.xml"), text).unwrap();
    let run = desk.run("convert ball.xml ball.json").succeeds();
    assert!(run.err().contains("note: ball.xml:2:30: $up is written as its value"), "{}", run.err());
    let before = desk.bytes("ball.json");
    fs::write(desk.path("ball.xml"), text.replace("$up", "$u")).unwrap();
    desk.run("convert ball.xml ball.json").is_refused(&["$u", "did you mean", "expected", "found"]);
    assert_eq!(desk.bytes("ball.json"), before);
    desk.run("convert ball.xml missing/ball.json -D up=x").is_refused(&["ball.xml"]);
    desk.run("convert scene.json missing/scene.xml").is_refused(&["missing", "create the folder"]);
    desk.run("convert scene.json scene.txt").is_refused(&["scene.txt", ".xml or .json"]);
    desk.run("convert scene.json scene.json").is_refused(&["the same file", "another name"]);
    assert_eq!(desk.files(), ["ball.json", "ball.xml", "scene.json"]);
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
        let desk = Desk::new(&scene);
        let run = desk.run("render scene.json");
        run.is_refused(hints);
        run.is_refused(&["scene.json", "expected", "found", "remedy"]);
        assert_eq!(desk.files(), ["scene.json"]);
        desk.run("info scene.json").is_refused(hints);
    }
}

#[test]
fn files_that_are_no_scenes_are_refused() {
    let desk = Desk::new(&foggy_room());
    fs::write(desk.path("half.json"), "{\"type\": \"scene\", ").unwrap();
    fs::write(desk.path("half.xml"), "<scene version=\"3.0.0\"><sensor").unwrap();
    fs::write(desk.path("scene.blend"), "").unwrap();
    let before = desk.files();
    for name in ["missing.json", "half.json", "half.xml", "scene.blend"] {
        desk.run(&format!("render {name}")).is_refused(&[name, "expected", "found", "remedy"]);
    }
    assert_eq!(desk.files(), before);
}

#[test]
fn an_image_that_cannot_be_written_is_told() {
    let desk = Desk::new(&foggy_room());
    let run = desk.run("render scene.json --spp 1 -o missing/image.exr");
    run.is_refused(&["missing", "expected", "found", "create the folder"]);
    assert_eq!(desk.files(), ["scene.json"]);
    desk.run("render scene.json -o image.jpg").is_refused(&["image.jpg", ".exr"]);
    desk.run("render scene.json --spp 0").is_refused(&["--spp", "at least 1"]);
    desk.run("render scene.json --size 0x8").is_refused(&["--size", "640x480"]);
    assert_eq!(desk.files(), ["scene.json"]);
}

#[test]
fn warnings_are_told_and_do_not_stop_the_render() {
    let seeded = with(
        camera([0.0, 0.0, 0.9], [0.0, 0.0, -1.0], 8),
        &[("sampler", json!({"type": "independent", "sample_count": 1, "seed": 3}))],
    );
    let desk = Desk::new(&with(foggy_room(), &[("sensor", seeded)]));
    let run = desk.run("render scene.json").succeeds();
    assert!(run.err().contains("warning") && run.err().contains("seed"), "{}", run.err());
}
