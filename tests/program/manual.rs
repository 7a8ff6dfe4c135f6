//! The scenes of `scenes/manual/` are what the reader is told that they are.

use crate::sandbox::Sandbox;

/// What stands between fences of JSON on a page.
fn blocks(page: &str) -> Vec<String> {
    let text = std::fs::read_to_string(format!("scenes/manual/{page}")).unwrap();
    let blocks = text.split("```json\n").skip(1);
    blocks.map(|block| block.split("```").next().unwrap().to_owned()).collect()
}

/// The report of `info` on a scene, without warnings.
fn info(scene: &str) -> String {
    let run = Sandbox::with_files(&[("fog.json", scene)]).run("info fog.json").ends(0);
    assert_eq!(run.err(), "", "{scene}");
    run.out()
}

#[test]
fn the_first_fog_is_built_step_by_step() {
    let [clear, fog, camera] = &blocks("first-fog.md")[..] else { panic!("three blocks") };
    let report = info(clear);
    assert!(report.contains("camera      in vacuum"), "{report}");
    let body = clear.trim_end().trim_end_matches('}').trim_end();
    let foggy = format!("{body},\n{fog}}}").replacen(
        "\"type\": \"perspective\",",
        &format!("\"type\": \"perspective\",\n{camera}"),
        1,
    );
    let report = info(&foggy);
    for part in ["camera      in fog", "emitter     spot in fog", "bank touches room"] {
        assert!(report.contains(part), "no {part} in {report}");
    }
}

#[test]
fn the_smoke_of_ones_own_is_a_scene() {
    let [scene] = &blocks("smoke.md")[..] else { panic!("one block") };
    let sandbox = Sandbox::with_files(&[("scene.json", scene)]);
    std::fs::copy("scenes/gallery/assets/cumulus.vdb", sandbox.path("plume.vdb")).unwrap();
    let report = sandbox.run("info scene.json").ends(0).out();
    assert!(report.contains("density from \"density\""), "{report}");
}
