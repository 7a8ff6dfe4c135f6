//! How a PNG shows an image: --exposure and --view of render, merge and convert, which change nothing else.

use crate::{common::pieces::*, sandbox::Sandbox};
use serde_json::Value;

/// A lamp so dim that its PNG is black.
fn dim() -> Sandbox {
    let lamp = lamp_ball([0.0, 0.0, 0.0], 1.0, 0.001);
    Sandbox::with_scene(&scene(&[("sensor", camera([0.0, 0.0, 3.0], [0.0; 3], 16)), ("lamp", lamp)]))
}

/// The brightest byte of a PNG.
fn brightest(sandbox: &Sandbox, name: &str) -> u8 {
    image::open(sandbox.path(name)).unwrap().to_rgb8().into_raw().into_iter().max().unwrap()
}

fn told(sandbox: &Sandbox, name: &str) -> Value {
    serde_json::from_str(&sandbox.run(&format!("info {name} --json")).ends(0).out()).unwrap()
}

#[test]
fn a_png_is_shown_as_asked_and_the_image_is_the_same() {
    let sandbox = dim();
    let render = |words: &str| sandbox.run(&format!("render scene.json --spp 4 {words}")).ends(0).out();
    render("-o plain.exr");
    assert!(brightest(&sandbox, "plain.png") < 5);
    render("-o bright.exr --exposure 10 --view linear");
    assert_eq!(brightest(&sandbox, "bright.png"), 255);
    assert!(sandbox.channels("plain.exr") == sandbox.channels("bright.exr"));
    let said = render("-o auto.exr --exposure auto --view agx");
    // 0.001 is to be 0.18 on average, and AgX shows that as 128; edges have less than the lamp.
    assert!((120..=160).contains(&brightest(&sandbox, "auto.png")), "{}", brightest(&sandbox, "auto.png"));
    let stops = said.trim().rsplit_once("--exposure ").unwrap().1.to_owned();
    let told = told(&sandbox, "auto.png");
    assert_eq!((&told["view"], told["exposure"].to_string()), (&"agx".into(), stops.clone()));
    render(&format!("-o again.exr --exposure {stops} --view agx"));
    let pixels = |name: &str| image::open(sandbox.path(name)).unwrap().to_rgb8().into_raw();
    assert_eq!(pixels("again.png"), pixels("auto.png"));
    // And of an image that there is.
    sandbox.run(&format!("convert plain.exr late.png --exposure {stops} --view agx")).ends(0);
    assert_eq!(pixels("late.png"), pixels("auto.png"));
    let said = sandbox.run("convert plain.exr late.png --exposure auto --view aces").ends(0).out();
    assert!(said.contains(&stops) && pixels("late.png") != pixels("auto.png"), "{said}");
}

#[test]
fn merge_shows_as_its_parts_or_as_told() {
    let sandbox = dim();
    sandbox.run("render scene.json --samples 0..4 --sums a.sums --exposure 12 --view linear").ends(0);
    sandbox.run("merge a.sums -o a.exr").ends(0);
    assert_eq!(brightest(&sandbox, "a.png"), 255);
    sandbox.run("merge a.sums -o a.exr --exposure 0").ends(0);
    assert!(brightest(&sandbox, "a.png") < 5);
}

#[test]
fn frames_are_all_shown_as_the_first() {
    let sandbox = dim();
    sandbox.run("render scene.json --spp 1 -o a.exr --frames 0..1 --exposure auto").ends(0);
    let stops = |name| told(&sandbox, name)["exposure"].clone();
    assert_eq!(stops("a.0000.png"), stops("a.0001.png"));
    assert!(stops("a.0000.png").as_f64().unwrap() > 6.0);
}

#[test]
fn what_cannot_be_shown_is_refused() {
    let sandbox = dim();
    for (words, hints) in [
        ("render scene.json --exposure bright", &["-60 to 60", "auto"][..]),
        ("render scene.json --exposure nan", &["-60 to 60"]),
        ("render scene.json --exposure 61", &["-60 to 60"]),
        ("render scene.json --view agz", &["standard, agx, aces, linear"]),
        ("convert scene.json a.xml --view agx", &["--view: expected a PNG to write", "a.xml"]),
        ("convert scene.json a.png -D x=1", &["-D: expected a scene file to write", "a.png"]),
        ("convert missing.exr a.png", &["missing.exr"]),
        ("convert scene.json a.png", &["scene.json"]),
    ] {
        sandbox.run(words).refuses(hints);
    }
    assert_eq!(sandbox.files(), ["scene.json"]);
}
