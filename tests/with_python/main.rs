//! Everything that needs Python 3: Tyndall against Mitsuba 3, against theory, and the package `validation/` itself. All of
//! it at full depth is `python3 -m validation full`.

#[path = "../common/mod.rs"]
mod common;

use common::studies::Study;
use std::process::Command;
use tyndall::analysis::study::page;

/// Runs `python3 -m validation` with these arguments; panics with its table unless everything in it holds.
fn must_hold(arguments: &[&str]) {
    let output = Command::new("python3")
        .args(["-m", "validation"])
        .args(arguments)
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .env("TYNDALL_BINARY", env!("CARGO_BIN_EXE_tyndall"))
        .output()
        .expect("python3 must be installed and on the PATH");
    let (table, messages) =
        (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "python3 -m validation {}\n{table}\n{messages}", arguments.join(" "));
}

/// Every scene of `scenes/crosscheck/` and a sample of generated ones through both renderers, pixel by pixel, and no
/// plugin that both have without a scene.
#[test]
fn agrees_with_mitsuba_on_every_crosscheck_scene() {
    must_hold(&["matrix", "--quick"]);
}

/// Furnaces, slabs by adding-doubling, single scattering by quadrature.
#[test]
fn agrees_with_closed_forms() {
    must_hold(&["closed-forms", "--quick"]);
}

/// Lines of the stability table: one group of each kind, and all that the renderer was once wrong about.
const LINES: &str = "glowing slab, b|albedo 0.9, b 100000|albedo 0.9, b 1e|white ball under the sky, b 1000|\
    ball under the sky, b 15000|camera on a boundary|touching|radiance 1e|a sphere in absorber";

/// Extremes of every number that a scene gives, against theory.
#[test]
fn extremes_are_as_theory_says() {
    must_hold(&["stability", "--quick", "--only", LINES]);
}

/// Its statistics, its way around this program, its pages and its type hints.
#[test]
fn the_python_package_passes_its_own_tests() {
    must_hold(&["test"]);
}

/// The page of `tyndall view` in a Chromium, where there is one.
#[test]
fn a_scene_is_viewed_in_a_browser() {
    must_hold(&["view", "--if-possible"]);
}

/// A study's page in a Chromium, where there is one.
#[test]
fn a_studys_page_works_in_a_browser() {
    let mut study = Study::new(&["a room", "<b>&é漢"], &["bdpt", "</script>", "volpath"], 4);
    study.outcome.scenes[1].contenders.truncate(1);
    study.outcome.scenes[1].contenders[0].points.truncate(1);
    study.rewrite();
    let path = page::write(study.folder.path()).expect("the page can be written");
    must_hold(&["page", path.to_str().expect("a plain path"), "--if-possible"]);
}
