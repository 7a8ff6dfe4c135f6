//! What the program says of a render before it begins, and what it says to scripts.

use crate::{
    common::pieces::*,
    sandbox::{Run, Sandbox},
};
use serde_json::{Value, json};

fn foggy_room() -> Value {
    scene(&[
        ("sensor", with(camera([0.0, 0.0, 0.9], [0.0, 0.0, -1.0], 8), &[("medium", named("fog"))])),
        ("fog", medium(1.0, 0.8, 0.3)),
        ("room", room(0.6, Some(named("fog")))),
        ("lamp", lamp_ball([0.2, 0.3, -0.3], 0.3, 2.0)),
    ])
}

/// A glass ball in a room lit by a point.
fn glass_ball() -> Value {
    scene(&[
        ("sensor", camera([0.0, 0.0, 0.9], [0.0, 0.0, -1.0], 8)),
        ("room", room(0.6, None)),
        ("ball", json!({"type": "sphere", "radius": 0.3, "bsdf": {"type": "dielectric"}})),
        ("lamp", point([0.0, 0.8, 0.0], 1.0)),
    ])
}

fn parsed(run: &Run) -> Value {
    serde_json::from_str(&run.out()).unwrap_or_else(|error| panic!("{error}: {}", run.out()))
}

#[test]
fn a_render_says_in_a_line_what_it_will_do_and_in_another_how() {
    let sandbox = Sandbox::with_scene(&foggy_room());
    for (words, plain, details) in [
        (
            "--strategies hit,next-event,join,lens",
            "8 x 8, 4 samples per pixel, bdpt\n",
            "bdpt (hit, next-event, join, lens), sobol samples, closed-form flights, 8x8, 4 samples per pixel, profile fog\n",
        ),
        (
            "--strategies hit,next-event --sampler sobol --time-limit 0.1s",
            "8 x 8, 0.1 s, bdpt\n",
            "bdpt (hit, next-event), sobol samples, closed-form flights, 8x8, 0.1 s, profile fog\n",
        ),
        (
            "--strategies hit,join --spp 2 --error 0.5 --profile everything",
            "8 x 8, 2 samples per pixel or error 0.5, bdpt\n",
            "bdpt (hit, join), sobol samples, closed-form flights, 8x8, 2 samples per pixel or error 0.5, profile everything\n",
        ),
        (
            "--integrator fog --size 5x3",
            "5 x 3, 4 samples per pixel, fog\n",
            "fog, a preview of first surfaces, sobol samples, 5x3, 4 samples per pixel, profile fog\n",
        ),
    ] {
        let said = |more: &str| sandbox.run(&format!("render scene.json {words} {more}")).ends(0).err();
        assert_eq!(said(""), format!("scene.json: {plain}"), "{words}");
        assert_eq!(said("-v"), format!("scene.json: {plain}{details}"), "{words}");
    }
}

/// Whatever the command renders by, its report, its picture and `info` say it too.
#[test]
fn what_a_pilot_chooses_is_said() {
    let mut sensor = camera([0.0, 1.0, 3.0], [0.0; 3], 8);
    // Fewer are not worth a pilot.
    sensor["sampler"] = json!({"type": "independent", "sample_count": 4096});
    let sky = scene(&[
        ("sensor", sensor),
        ("floor", floor(-0.6, 4.0, 0.5)),
        ("sky", sky(1.0)),
        ("integrator", json!({"type": "volpath"})),
    ]);
    let sandbox = Sandbox::with_scene(&sky);
    let said = sandbox.run("render scene.json --verbose --report r.json").ends(0).err();
    // Walks from an open floor find an even sky without noise.
    let told =
        ["bdpt (hit; without next-event, join and lens: ", " times as efficient as all strategies equally)"];
    told.iter().for_each(|part| assert!(said.contains(part), "{said}"));
    assert!(sandbox.run("info scene.json").ends(0).out().contains("without next-event, join and lens"));
    let short = sandbox.run("info scene.json --pilot --spp 16").ends(0).out();
    assert!(short.contains("too few samples are to come"), "{short}");
    let plan = &sandbox.json("r.json")["plan"];
    let found: Value =
        serde_json::from_str(&sandbox.run("info scene.json --pilot --json").ends(0).out()).unwrap();
    let [best, next] = [0, 1].map(|index| &found["pilot"]["candidates"][index]);
    assert_eq!((&best["strategies"], &best["survival"]), (&plan["strategies"], &plan["survival"]));
    assert!(best["judgement"].as_f64() <= next["judgement"].as_f64(), "{best} {next}");
    assert_eq!((&plan["strategies"], &plan["survival"]), (&json!(["hit"]), &json!("albedo")));
    assert!(plan["time_of_all_strategies"].as_f64().unwrap() > 1.1, "{plan}");
    let picture = sandbox.run("info scene.exr").ends(0).out();
    assert!(picture.contains("\"survival\":\"albedo\""), "{picture}");
}

/// A cloud and two balls of fog before a sky, one of them red.
fn balls_before_a_sky(extinction: Value) -> Value {
    let ramp = json!({"type": "exponential", "value": 1.0});
    scene(&[
        ("sensor", camera([0.0, 0.0, 4.0], [0.0, 0.0, 0.0], 4)),
        ("cloud", json!({"type": "heterogeneous", "sigma_t": ramp, "albedo": 0.5})),
        ("fog", with(medium(1.0, 0.8, 0.3), &[("sigma_t", extinction)])),
        ("box", null_box([-1.0; 3], [1.0; 3], Some(named("cloud")))),
        ("left", null_ball([-3.0, 0.0, 0.0], 0.5, named("fog"))),
        ("right", null_ball([3.0, 0.0, 0.0], 0.5, named("fog"))),
        ("sky", sky(1.0)),
    ])
}

#[test]
fn info_says_why_a_profile_is_taken() {
    let told = |scene: &Value, words: &str| {
        let said = Sandbox::with_scene(scene).run(&format!("info scene.json {words}")).ends(0).out();
        said.lines().find_map(|line| line.strip_prefix("profile     ")).map(str::to_owned).unwrap()
    };
    let fog = "the medium \"fog\" has extinction";
    let open =
        "the shape \"box\" and 2 more let rays pass undeflected, the emitter \"constant\" has parallel rays";
    let grey = balls_before_a_sky(json!(1.0));
    let red = balls_before_a_sky(json!({"type": "rgb", "value": [1.0, 0.5, 0.5]}));
    for (scene, words, expected) in [
        (
            &foggy_room(),
            "",
            format!(
                "fog: {fog}; leaves out varying media, chromatic extinction, index-matched boundaries, infinite emitters, emissive media, microflakes"
            ),
        ),
        (
            &foggy_room(),
            "--hide-emitters",
            format!(
                "bounded: {fog}, the hidden emitter \"lamp\" lets rays pass undeflected; leaves out varying media, chromatic extinction, emissive media, microflakes"
            ),
        ),
        (
            &foggy_room(),
            "--profile everything",
            format!("everything, forced by --profile; fitted would be fog: {fog}; leaves out nothing"),
        ),
        (
            &foggy_room(),
            "--heuristic power",
            format!("everything, for the power heuristic; fitted would be fog: {fog}; leaves out nothing"),
        ),
        (
            &grey,
            "",
            format!(
                "smoke: the medium \"cloud\" varies in space, {open}; leaves out chromatic extinction, emissive media, microflakes"
            ),
        ),
        (
            &red,
            "--heuristic power",
            format!(
                "everything: the medium \"cloud\" varies in space, the medium \"fog\" has chromatic extinction, {open}; leaves out nothing"
            ),
        ),
    ] {
        assert_eq!(told(scene, words), expected, "{words}");
    }
    let lamp =
        scene(&[("sensor", camera([0.0, 0.0, 0.9], [0.0, 0.0, -1.0], 8)), ("lamp", point([0.0; 3], 1.0))]);
    assert!(told(&lamp, "").starts_with("vacuum; leaves out media, varying media, "));
    let figures =
        parsed(&Sandbox::with_scene(&grey).run("info scene.json --json --profile everything").ends(0));
    let need = |need, first, count: u32| json!({"need": need, "first": first, "count": count});
    let needs = [
        need("media", "the medium \"cloud\"", 2),
        need("varying media", "the medium \"cloud\"", 1),
        need("index-matched boundaries", "the shape \"box\"", 3),
        need("infinite emitters", "the emitter \"constant\"", 1),
    ];
    let expected = json!({"name": "everything", "forced": "forced by --profile", "fitted": "smoke", "needs": needs, "leaves_out": []});
    assert_eq!(figures["profile"], expected);
}

#[test]
fn free_flights_are_named_by_their_methods() {
    let ramp = json!({"type": "exponential", "value": 1.0});
    let cloud = json!({"type": "heterogeneous", "sigma_t": ramp, "albedo": 0.5, "tracker": "null_collision"});
    let parts = [
        ("sensor", camera([0.0, 0.0, 4.0], [0.0, 0.0, 0.0], 4)),
        ("cloud", null_box([-1.0; 3], [1.0; 3], Some(cloud))),
        ("fog", null_ball([3.0, 0.0, 0.0], 0.5, medium(1.0, 0.8, 0.3))),
        ("sky", sky(1.0)),
    ];
    let sandbox = Sandbox::with_scene(&scene(&parts));
    let said = |words: &str| sandbox.run(&format!("render scene.json -v --spp 1 {words}")).ends(0).err();
    assert!(said("").contains(", delta tracking and closed-form flights, 4x4"), "{}", said(""));
    assert!(said("--tracker march").contains(", ray marching and closed-form flights, "));
}

#[test]
fn light_that_is_not_reached_is_told_with_who_reaches_it() {
    let sandbox = Sandbox::with_scene(&glass_ball());
    let caustics = "light of point emitters by way of smooth glass (caustics)";
    let of_pt = sandbox.run("render scene.json --spp 1 --integrator pt").ends(0).err();
    for line in [
        format!("not reached by pt: {caustics}; bdpt reaches it\n"),
        format!("not reached by pt: {caustics}, seen by way of smooth glass; bdpt reaches a part of it\n"),
        "not reached by pt: light of point emitters that comes to the camera by way of smooth glass alone; no integrator does (--soften 0.01 does by dielectric and conductor, with a bias)\n".to_owned(),
    ] {
        assert!(of_pt.contains(&line), "no {line} in {of_pt}");
    }
    let of_some = sandbox.run("info scene.json --strategies next-event,join").ends(0).out();
    assert!(
        of_some.contains(&format!("not reached by these strategies: {caustics}; bdpt reaches it")),
        "{of_some}"
    );
    let of_bdpt = sandbox.run("render scene.json --spp 1").ends(0).err();
    assert!(!of_bdpt.contains("bdpt reaches it") && of_bdpt.contains("no integrator does"), "{of_bdpt}");
    assert!(of_bdpt.contains("sphere or cylinder sends on by itself"), "{of_bdpt}");
    let room = Sandbox::with_scene(&foggy_room());
    assert!(!room.run("render scene.json --spp 1 --integrator pt").ends(0).err().contains("not reached"));
}

#[test]
fn info_shows_the_plan_of_any_integrator() {
    let sandbox = Sandbox::with_scene(&glass_ball());
    let run = sandbox.run("info scene.json --integrator lt --max-depth 3").ends(0);
    assert!(run.out().contains("integrator  lt, paths of at most 3 segments"), "{}", run.out());
    assert!(run.out().contains("plan        lt (lens"), "{}", run.out());
    for (words, length) in [
        ("--min-depth 1", "any length"),
        ("--min-depth 3", "3 segments or more"),
        ("--min-depth 2 --max-depth 3", "2 to 3 segments"),
        ("--min-depth 3 --max-depth 3", "3 segments"),
    ] {
        let out = sandbox.run(&format!("info scene.json --integrator pt {words}")).ends(0).out();
        assert!(out.contains(&format!("integrator  pt, paths of {length}, weighted")), "{words}: {out}");
    }
    sandbox.run("info scene.json --integrator pt --strategies lens").refuses(&["--strategies"]);
}

/// Each a JSON document, the last one of the whole; nothing else is said.
#[test]
fn progress_can_be_lines_of_json() {
    let sandbox = Sandbox::with_scene(&foggy_room());
    let run = sandbox.run("-q render scene.json --spp 300 --progress json").ends(0);
    let lines: Vec<Value> = run.err().lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let done = |line: &Value| line["done"].as_f64().unwrap();
    assert!(lines.windows(2).all(|pair| done(&pair[0]) <= done(&pair[1])), "{lines:?}");
    let last = lines.last().unwrap();
    assert!(done(last) == 1.0 && last["samples_per_pixel"] == 300 && last["seconds"].is_number(), "{last}");
    assert!((0.0..1.0).contains(&last["noise"].as_f64().unwrap()) && last["within"].is_null(), "{last}");
    let run = sandbox.run("-q render scene.json --spp 1 --batches 2 --progress json").ends(0);
    assert!(run.err().contains(r#""image":"batch 2 of 2""#), "{}", run.err());
    assert_eq!(
        sandbox.run("-q strategies scene.json --spp 1 --progress json").ends(0).err().lines().last(),
        Some(r#"{"done":1.0}"#)
    );
}

#[test]
fn quiet_leaves_warnings_and_what_is_missing() {
    let scene = with(glass_ball(), &[("idle", diffuse(0.5))]);
    let sandbox = Sandbox::with_scene(&scene);
    for words in ["-q render scene.json --integrator pt", "render scene.json --integrator pt --quiet"] {
        let run = sandbox.run(words).ends(0);
        assert_eq!(run.out(), "");
        let mut lines = run.err().lines().map(str::to_owned).collect::<Vec<_>>();
        assert!(lines.remove(0).starts_with("warning: "), "{}", run.err());
        assert!(
            !lines.is_empty() && lines.iter().all(|line| line.starts_with("not reached by pt: ")),
            "{}",
            run.err()
        );
    }
    assert_eq!(sandbox.run("info -q scene.json").ends(0).out(), "");
    let run = sandbox.run("diff -q scene.exr scene.exr").ends(0);
    assert_eq!((run.out(), run.err()), (String::new(), String::new()));
    assert!(parsed(&sandbox.run("pixel -q scene.json 1 1").ends(0)).is_object());
    sandbox.run("-q render missing.json").refuses(&["missing.json"]);
}

#[test]
fn every_report_can_be_json() {
    let sandbox = Sandbox::with_scene(&glass_ball());
    let render = parsed(&sandbox.run("render scene.json --integrator pt --json --report r.json").ends(0));
    assert_eq!(render, sandbox.json("r.json"));
    assert_eq!((&render["samples_per_pixel"], &render["image"]), (&json!(4), &json!("scene.exr")));
    let plan = &render["plan"];
    assert_eq!(plan["strategies"], json!(["hit", "next-event"]));
    assert_eq!(
        (&plan["width"], &plan["sampler"], &plan["integrator"]),
        (&json!(8), &json!("sobol"), &json!("pt"))
    );
    assert!(
        plan["unreached"].as_array().unwrap().iter().any(|light| light["reached_by_bdpt"] == "all"),
        "{plan}"
    );
    let info = parsed(&sandbox.run("info scene.json --json").ends(0));
    assert_eq!((&info["shapes"], &info["emitters"][0]["type"]), (&json!(2), &json!("point")));
    assert!(info["plan"]["unreached"].is_array() && info["warnings"] == json!([]), "{info}");
    for (words, key) in [
        ("diff scene.exr scene.exr", "/radiance/mse"),
        ("phase hg g=0.5 --samples 1000", "/chi_square/p_value"),
        ("flights --sigma-a 0 --sigma-s 3 --photons 1000", "/methods/0/method"),
        ("strategies scene.json --spp 2 --pilots 0 --size 4x4", "/cells/0/name"),
        ("render scene.json --frames 0..1 --spp 1", "/frames/1/samples_per_pixel"),
    ] {
        let run = sandbox.run(&format!("{words} --json"));
        assert!(parsed(&run).pointer(key).is_some_and(|value| !value.is_null()), "{words}: {}", run.out());
    }
}

#[test]
fn a_scene_can_come_from_standard_input() {
    let sandbox = Sandbox::with_scene(&foggy_room());
    sandbox.run("convert scene.json scene.xml").ends(0);
    sandbox.run("render scene.json").ends(0);
    for name in ["scene.json", "scene.xml"] {
        let text = format!("\n  {}", sandbox.text(name));
        sandbox.run_with("render -", &text).ends(0);
        assert_eq!(sandbox.channels("stdin.exr"), sandbox.channels("scene.exr"), "{name}");
        std::fs::remove_file(sandbox.path("stdin.exr")).unwrap();
    }
    let text = sandbox.text("scene.json");
    assert_eq!(sandbox.run_with("info -", &text).ends(0).out(), sandbox.run("info scene.json").out());
    sandbox.run_with("convert - again.xml", &text).ends(0);
    assert_eq!(sandbox.text("again.xml"), sandbox.text("scene.xml"));
    sandbox.run_with("strategies - --spp 2 --pilots 0 --size 4x4", &text).ends(0);
    assert!(sandbox.path("stdin-strategies").is_dir());
    assert!(parsed(&sandbox.run_with("pixel - 1 1", &text).ends(0)).is_object());
}

#[test]
fn files_of_a_scene_on_standard_input_start_at_the_current_folder() {
    let sky = json!({"type": "envmap", "filename": "maps/sky.ppm"});
    let scene = with(glass_ball(), &[("sky", sky)]).to_string();
    let sandbox =
        Sandbox::with_files(&[("maps/sky.ppm", "P3 2 3 1  1 1 1  1 1 1  1 1 1  1 1 1  1 1 1  1 1 1\n")]);
    sandbox.run_with("info -", &scene).ends(0);
    sandbox.run_with("info -", &scene.replace("maps/", "")).refuses(&["<stdin>", "sky.ppm"]);
}

#[test]
fn what_is_no_scene_on_standard_input_is_refused() {
    let sandbox = Sandbox::with_scene(&foggy_room());
    sandbox.run_with("render -", "").refuses(&["<stdin>", "< (Mitsuba XML) or { (JSON)", "nothing"]);
    sandbox.run_with("render -", " x").refuses(&["<stdin>", "\"x\""]);
    sandbox.run_with("render -", "{\n  \"type\": ").refuses(&["<stdin>:2:"]);
    sandbox.run_with("study - -o out", "{}").refuses(&["standard input", "save the scene to a file"]);
    assert_eq!(sandbox.files(), ["scene.json"]);
}

#[test]
fn shells_and_man_learn_the_arguments() {
    let sandbox = Sandbox::new();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = sandbox.run(&format!("completions {shell}")).ends(0).out();
        assert!(["strategies", "time-limit", "quiet"].iter().all(|word| script.contains(word)), "{shell}");
    }
    sandbox.run("completions tcsh").refuses(&["bash", "zsh"]);
    let page = sandbox.run("man").ends(0).out();
    assert!(page.contains(".TH") && page.contains("SIGTERM"), "{page}");
    sandbox.run("man pages/1").ends(0);
    let page = sandbox.text("pages/1/tyndall-render.1");
    assert!(page.contains("time\\-limit") && page.contains("\\-\\-quiet"), "{page}");
    assert!(sandbox.path("pages/1/tyndall.1").is_file() && !sandbox.path("pages/1/tyndall-help.1").exists());
    std::fs::write(sandbox.path("file"), "").unwrap();
    sandbox.run("man file").refuses(&["file", "a folder"]);
}

#[test]
fn help_tells_the_exit_codes() {
    let help = Sandbox::new().run("--help").ends(0).out();
    for code in ["0    success", "1    done", "2    a mistake", "129", "130", "143"] {
        assert!(help.contains(code), "no {code} in {help}");
    }
}

/// What is biased says so: in words, in the name of the image, and in its metadata.
#[test]
fn softened_glass_is_told() {
    let sandbox = Sandbox::with_scene(&glass_ball());
    let said = sandbox.run("render scene.json -v --spp 1 --soften 0.02").ends(0).err();
    assert!(said.contains("softened (biased, alpha 0.02)") && !said.contains("not reached"), "{said}");
    assert!(sandbox.path("scene-softened.exr").is_file());
    let metadata = sandbox.run("info scene-softened.exr").ends(0).out();
    assert!(metadata.contains("soften") && metadata.contains("0.02"), "{metadata}");
    let refused = sandbox.run("render scene.json --soften 2").ends(2).err();
    assert!(refused.contains("expected a roughness from 0.0001 to 0.5"), "{refused}");
}
