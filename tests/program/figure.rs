//! `tyndall report --figure`: what is handed to Python, and what is refused before.

use crate::common::studies::Study;
use crate::sandbox::Sandbox;
use serde_json::Value;
use std::fs;

/// Python that keeps what it is given; without matplotlib if $BROKEN is set.
const PYTHON: &str = "#!/bin/sh\n[ -z \"$BROKEN\" ] || { echo no matplotlib >&2; exit 2; }\n\
    [ \"$4\" = --check ] || { echo \"$1 $2 $3\" > words; cp \"$4\" figure.json; shift 4; echo \"$@\" >> words; \
    cp \"$(dirname \"$(grep -o '/[^\"]*reference.png' figure.json | head -1)\")\"/*.png .; }\n";

/// A study and such a Python.
fn desk() -> (Sandbox, Study) {
    let sandbox = Sandbox::with_files(&[("python", PYTHON)]);
    sandbox.shell("chmod +x python").ends(0);
    (sandbox, Study::new(&["room", "church"], &["bdpt", "pt", "volpath"], 3))
}

fn report(study: &Study, words: &str) -> String {
    format!("TYNDALL_PYTHON=./python $TYNDALL report '{}' {words}", study.folder.path().display())
}

#[cfg(unix)]
#[test]
fn a_figure_shows_all_unless_it_is_told_what() {
    let (sandbox, study) = desk();
    let run = sandbox.shell(&report(&study, "--figure a.pdf --figure b.PNG --view agx")).ends(0);
    assert!(run.out().ends_with("study.html\na.pdf\nb.PNG\n"), "{}", run.out());
    assert_eq!(sandbox.text("words"), "-m tyndall figure\na.pdf b.PNG\n");
    let rows = sandbox.json("figure.json")["rows"].clone();
    assert_eq!([&rows[0]["name"], &rows[1]["name"]], ["room", "church"]);
    let column = |row: usize, column: usize, what: &str| rows[row]["columns"][column][what].clone();
    let names: Vec<Value> = (0..3).map(|number| column(0, number, "name")).collect();
    assert_eq!(names, ["bdpt", "pt", "volpath"]);
    // As the study says of its last budget.
    assert_eq!((column(0, 1, "relmse"), column(0, 1, "seconds")), ("0.0500".into(), "2.00 s".into()));
    assert_eq!((column(1, 0, "lead"), column(1, 1, "lead")), ("1×".into(), "0.500×".into()));
    assert_eq!((column(1, 0, "is_best"), column(1, 1, "is_best")), (true.into(), false.into()));
    for crop in rows[0]["crops"].as_array().unwrap() {
        let [x, y, width, height] = [0, 1, 2, 3].map(|side| crop[side].as_u64().unwrap());
        assert!(x + width <= 12 && y + height <= 8 && width > 0, "{crop}");
    }
    // All images of a scene are shown by the curve of its reference: equal pixels are equal, whatever their neighbours are.
    let pixels = |name: &str| image::open(sandbox.path(name)).unwrap().into_rgb8();
    assert_eq!(pixels("0-reference.png").dimensions(), (12, 8));
    assert_eq!(pixels("0-reference.png").get_pixel(0, 0), pixels("0-0.png").get_pixel(0, 0));
}

#[cfg(unix)]
#[test]
fn scenes_contenders_and_crops_are_those_given_in_their_order() {
    let (sandbox, study) = desk();
    let words =
        "--figure a.pdf --scene church --contender pt --contender bdpt --crop 3x2+9+6 --crop 0,0,12,8";
    sandbox.shell(&report(&study, words)).ends(0);
    let rows = sandbox.json("figure.json")["rows"].clone();
    assert_eq!((rows.as_array().unwrap().len(), &rows[0]["name"]), (1, &"church".into()));
    let columns = &rows[0]["columns"];
    assert_eq!([&columns[0]["name"], &columns[1]["name"]], ["pt", "bdpt"]);
    // Over the first of them.
    assert_eq!([&columns[0]["lead"], &columns[1]["lead"]], ["1×", "2.00×"]);
    assert_eq!(rows[0]["crops"], serde_json::json!([[9, 6, 3, 2], [0, 0, 12, 8]]));
    let mut study = study;
    study.outcome.scenes[0].contenders[1].efficiency.mean = f64::NAN;
    study.rewrite();
    let run = sandbox.shell(&report(&study, "--figure new/a.pdf --exposure auto")).ends(0);
    assert_eq!(sandbox.json("figure.json")["rows"][0]["columns"][1]["lead"], "–");
    assert!(run.out().starts_with("room, shown with --exposure "), "{}", run.out());
    assert!(sandbox.path("new").is_dir());
}

#[cfg(unix)]
#[test]
fn figures_that_cannot_be_are_refused() {
    let (sandbox, study) = desk();
    for (words, hints) in [
        ("--figure a.svg", ["a.svg", "ends in .pdf or .png"]),
        (
            "--figure a.pdf --contender lt",
            ["--contender", "a name of the study: bdpt, pt, volpath, found \"lt\""],
        ),
        ("--figure a.pdf --scene hall", ["--scene", "a name of the study: room, church"]),
        ("--figure a.pdf --crop 4x4+9+0", ["the image of room, which is 12 x 8", "found 4x4+9+0"]),
        ("--figure a.pdf --crop 9,4294967290,3,2", ["the image of room", "found 3x2+9+4294967290"]),
        ("--figure a.pdf --crop 4x4", ["--crop", "320x240+640+0"]),
        ("--crop 4x4+0+0", ["--figure", ""]),
        ("--view agx", ["--figure", "no figure that would be shown so"]),
    ] {
        sandbox.shell(&report(&study, words)).refuses(&hints);
    }
    let broken = format!("BROKEN=1 {}", report(&study, "--figure a.pdf"));
    sandbox.shell(&broken).refuses(&[
        "Python with the packages tyndall and matplotlib",
        "no matplotlib",
        "'.[figure]'",
    ]);
    fs::remove_file(study.folder.path().join("study.json")).unwrap();
    sandbox.shell(&report(&study, "--figure a.pdf")).refuses(&["study.json", "the numbers of a study"]);
}
