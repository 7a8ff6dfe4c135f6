//! What a scene or a command reads is never written: it is refused before the first ray.
#![cfg(unix)]

use crate::{common::pieces::*, sandbox::Sandbox};
use std::{fs, os::unix::fs::symlink};

/// Reads a file of each kind, with numbered files and such as others include. Its image would be its own sky.
const SCENE: &str = r#"<scene version="3.0.0">
    <sensor type="perspective"><film type="hdrfilm"><integer name="width" value="4"/><integer name="height" value="4"/></film></sensor>
    <include filename="parts/part.xml"/>
    <emitter type="envmap"><string name="filename" value="sky.exr"/></emitter>
    <shape type="smoke"><string name="filename" value="s_####.vdb"/></shape>
    <shape type="sphere"><bsdf type="diffuse"><texture type="bitmap" name="reflectance">
        <string name="filename" value="f.0001.png"/></texture></bsdf></shape>
    <shape type="sphere"><bsdf type="diffuse"><texture type="bitmap" name="reflectance">
        <string name="filename" value="t/weighted.png"/></texture></bsdf></shape></scene>"#;
const PART: &str = r#"<scene version="3.0.0">
    <shape type="obj"><string name="filename" value="m.exr.sums"/>
        <bsdf type="diffuse"><spectrum name="reflectance" filename="../d/images/grey.spd"/></bsdf></shape></scene>"#;
const MESH: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
const GREY: &str = "400 0.5\n700 0.5\n";

fn sandbox() -> Sandbox {
    let lamp =
        scene(&[("lamp", lamp_ball([0.0; 3], 0.3, 1.0)), ("sensor", camera([0.0, 0.0, 3.0], [0.0; 3], 4))]);
    let sandbox = Sandbox::with_files(&[
        ("sky.xml", SCENE),
        ("parts/part.xml", PART),
        ("parts/m.exr.sums", MESH),
        ("d/images/grey.spd", GREY),
        ("lamp.json", &lamp.to_string()),
    ]);
    let sandbox = sandbox.with_sample("twins.vdb", "s_0001.vdb").with_sample("twins.vdb", "s_0002.vdb");
    sandbox.run("render lamp.json --spp 1 -o sky.exr").ends(0);
    fs::create_dir(sandbox.path("t")).unwrap();
    fs::copy(sandbox.path("sky.png"), sandbox.path("t/weighted.png")).unwrap();
    fs::rename(sandbox.path("sky.png"), sandbox.path("f.0001.png")).unwrap();
    symlink("../sky.exr", sandbox.path("parts/link.exr")).unwrap();
    fs::hard_link(sandbox.path("sky.exr"), sandbox.path("hard.exr")).unwrap();
    sandbox
}

const INPUTS: [&str; 9] = [
    "sky.xml",
    "sky.exr",
    "parts/part.xml",
    "parts/m.exr.sums",
    "d/images/grey.spd",
    "s_0001.vdb",
    "s_0002.vdb",
    "f.0001.png",
    "t/weighted.png",
];

#[test]
fn what_is_read_is_never_written() {
    let sandbox = sandbox();
    sandbox.run("render sky.xml --spp 1 -o ok.exr --sums ok.sums").ends(0);
    let contents = || INPUTS.map(|name| sandbox.bytes(name));
    let (before, files) = (contents(), sandbox.files());
    let render = "render sky.xml --spp 1000000000";
    for (words, input) in [
        (render.to_owned(), "sky.exr"),
        (format!("{render} -o parts/../sky.exr"), "sky.exr"),
        (format!("{render} -o parts/link.exr --preview"), "sky.exr"),
        (format!("{render} -o hard.exr"), "sky.exr"),
        (format!("{render} -o f.0001.pfm"), "f.0001.png"),
        (format!("{render} -o f.exr --frames 0..1"), "f.0001.png"),
        (format!("{render} -o parts/m.exr"), "m.exr.sums"),
        (format!("{render} -o a.exr --sums d/images/grey.spd"), "grey.spd"),
        (format!("{render} -o a.exr --report s_0002.vdb"), "s_0002.vdb"),
        (format!("{render} -o a.exr --report parts/part.xml"), "part.xml"),
        (format!("{render} -o a.exr --report sky.xml"), "sky.xml"),
        ("pixel sky.xml 1 1 --samples 4000000000 -o sky.exr".into(), "sky.exr"),
        ("strategies sky.xml --spp 1000000000 -o t".into(), "weighted.png"),
        ("strategies sky.xml --spp 1000000000 -o a --report sky.exr".into(), "sky.exr"),
        ("guide sky.xml -o a --report sky.exr".into(), "sky.exr"),
        ("info sky.xml --report sky.exr".into(), "sky.exr"),
        ("study sky.xml --spp 1000000000 -o d".into(), "grey.spd"),
        ("study sky.xml --spp 1000000000 -o d --restart".into(), "grey.spd"),
        ("study sky.xml --spp 1000000000 -o a --report f.0001.png".into(), "f.0001.png"),
        ("convert sky.xml parts/part.xml".into(), "part.xml"),
        ("merge ok.sums --sums parts/m.exr.sums".into(), "m.exr.sums"),
        ("merge ok.sums -o f.0001.exr".into(), "f.0001.png"),
    ] {
        let hint = format!("{input}, which the scene reads");
        let hints = [hint.as_str(), "expected a file that is only written", "-o names an image"];
        sandbox.shell(&format!("timeout 60 $TYNDALL {words}")).refuses(&hints);
    }
    for words in [
        "convert f.0001.png f.0001.png",
        "diff sky.exr hard.exr --report sky.exr",
        "info s_0001.vdb --report s_0001.vdb",
        "merge ok.sums --sums ok.sums",
        "phase hg g=@sky.xml --report sky.xml",
    ] {
        sandbox.run(words).refuses(&[]);
    }
    assert!(contents() == before);
    assert_eq!(sandbox.files(), files);
    sandbox.run("render sky.xml --spp 1 -o b.exr").ends(0);
}
