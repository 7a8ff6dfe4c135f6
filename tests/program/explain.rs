//! `tyndall explain` as a user runs it.

use crate::sandbox::Sandbox;

#[test]
fn plugins_kinds_and_parameters_are_explained() {
    let sandbox = Sandbox::new();
    for (words, hints) in [
        (
            "explain spot",
            &[
                "spot (emitter)",
                "above 0, up to 180 [degrees]",
                "three quarters of cutoff_angle",
                "\"my_spot\"",
            ],
        ),
        ("explain gaussian", &["gaussian (rfilter)", "gaussian* (phase)"]),
        ("explain emitter", &["spot ", "envmap "]),
        ("explain cutoff_angle", &["spot (emitter)"]),
        ("explain shutter_open", &["perspective (sensor)", "When the shutter opens"]),
        ("explain keyframes", &["\"type\": \"keyframes\"", "<keyframes name=", "smooth", "--frames 0..47"]),
        ("explain progress", &["--progress json", "samples_per_pixel  samples so far", "\"image\": null}"]),
        (
            "explain rotate",
            &["The first step is applied first", "counter-clockwise", "\"type\": \"translate\""],
        ),
        ("explain fog", &["A medium in a boundary", "fog* (integrator)"]),
        ("explain scale", &["transform, translate", "scale, a parameter of"]),
        (
            "explain",
            &[
                "heterogeneous",
                "hdrfilm",
                "wave",
                "Phase functions",
                "Words: transform, ref",
                "keyframes: ",
                "progress: ",
            ],
        ),
    ] as [(&str, &[&str]); 11]
    {
        let text = sandbox.run(words).ends(0).out();
        for hint in hints {
            assert!(text.contains(hint), "{words}: no {hint} in {text}");
        }
        assert!(text.lines().all(|line| line.len() <= 120 || line.contains("\"my_")), "{words}: {text}");
    }
}

/// Each word of the language and of everyday life is found, and its example can be pasted into a scene.
#[test]
fn words_are_explained() {
    let sandbox = Sandbox::new();
    let words = "transform translate rotate scale lookat ref rgb include defaults fog sun sky window glass water \
                 cloud fire lamp mirror keyframes";
    let mut pasted = 0;
    for word in words.split_whitespace() {
        let text = sandbox.run(&format!("explain {word}")).ends(0).out();
        let Some((_, example)) = text.split_once("\nIn a scene:\n") else { continue };
        let example = example.split("\n\n").next().unwrap();
        let scene = format!(
            r#"{{"type": "scene", "lantern": {{"type": "point", "position": [0, 5, 5]}}, "eye": {{"type": "perspective",
            "to_world": [{{"type": "lookat", "origin": [0, 2, 12], "target": [0, 0, 0]}}]}}, {example}}}"#
        );
        std::fs::write(sandbox.path("scene.json"), scene).unwrap();
        let run = sandbox.run("info scene.json").ends(0);
        let warnings = run.err();
        assert!(
            warnings.is_empty() || word == "rgb" && warnings.contains("is not used"),
            "{word}: {warnings}"
        );
        pasted += 1;
    }
    assert!(pasted >= 14, "{pasted}");
}

#[test]
fn the_schema_is_json() {
    let text = Sandbox::new().run("explain --schema").ends(0).out();
    let schema: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(schema["definitions"]["emitter spot"]["properties"]["cutoff_angle"]["default"], 20.0);
}

#[test]
fn mistakes_are_explained() {
    let sandbox = Sandbox::new();
    sandbox.run("explain hetrogeneous").refuses(&["did you mean \"heterogeneous\"?"]);
    sandbox.run("explain keyframe").refuses(&["did you mean \"keyframes\"?"]);
    sandbox.run("explain cutof_angle").refuses(&["did you mean \"cutoff_angle\"?"]);
    sandbox.run("explain spot --schema").refuses(&["cannot be used with"]);
}
