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
        ("explain", &["heterogeneous", "hdrfilm", "wave", "Phase functions", "keyframes: ", "progress: "]),
    ] as [(&str, &[&str]); 8]
    {
        let text = sandbox.run(words).ends(0).out();
        for hint in hints {
            assert!(text.contains(hint), "{words}: no {hint} in {text}");
        }
        assert!(text.lines().all(|line| line.len() <= 120 || line.contains("\"my_")), "{words}: {text}");
    }
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
