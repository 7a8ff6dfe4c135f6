//! `tyndall phase` as a user runs it.

use crate::sandbox::Sandbox;

#[test]
fn a_phase_function_is_judged_and_drawn() {
    let sandbox = Sandbox::new();
    let run = sandbox.run("phase hg g=0.6 --samples 200000 --seed 3 -o .").ends(0);
    for hint in [
        "normalisation      1.000000",
        "mean cosine        0.6000",
        "degrees of freedom",
        "according to the pdf",
    ] {
        assert!(run.out().contains(hint), "no {hint} in {}", run.out());
    }
    assert_eq!(sandbox.files(), ["hg.ply", "hg.svg", "hg_samples.ply"]);
    assert!(sandbox.text("hg.svg").contains("hg g=0.6") && sandbox.text("hg.svg").contains("<polyline"));
    let ply = sandbox.text("hg.ply");
    assert!(ply.starts_with("ply\nformat ascii") && ply.contains("element vertex 2018"), "{}", &ply[..300]);
    let again = sandbox.run("phase hg g=0.6 --samples 200000 --seed 3 -o .").ends(0);
    assert_eq!(run.out(), again.out());
    sandbox.run("phase hg --samples 20000 -o drawn/hg").ends(0);
    assert!(sandbox.path("drawn/hg/hg.svg").is_file());
}

/// The mesh is a shape that the renderer itself can read: the lobe of the isotropic function is a ball.
#[test]
fn the_mesh_is_a_shape() {
    let sandbox = Sandbox::new();
    sandbox.run("phase isotropic --samples 1000 -o .").ends(0);
    let scene = serde_json::json!({
        "type": "scene",
        "sensor": {"type": "perspective", "film": {"type": "hdrfilm", "width": 4, "height": 4},
                   "sampler": {"type": "independent", "sample_count": 1}},
        "light": {"type": "constant"},
        "lobe": {"type": "ply", "filename": "isotropic.ply"},
    });
    std::fs::write(sandbox.path("scene.json"), scene.to_string()).unwrap();
    assert!(sandbox.run("info scene.json").ends(0).out().contains("4032 primitives"));
}

#[test]
fn nested_functions_tables_and_files_are_understood() {
    let sandbox = Sandbox::new();
    std::fs::write(sandbox.path("table.txt"), "0.5 1\n2\n").unwrap();
    for words in [
        "phase blendphase weight=0.3 a=hg a.g=0.9 b=two_term_hg b.r=0.5 b.g1=0.2 b.g2=-0.4 --samples 50000",
        "phase tabphase values=@table.txt --samples 50000",
        "phase tabphase values=1,2,0.5 --samples 50000 --parallels 9 --meridians 4",
        "phase mie_murky form=blasi --samples 50000",
    ] {
        sandbox.run(words).ends(0);
    }
}

/// Without -o nothing is written; the list names every function, its formula and where it is from.
#[test]
fn nothing_is_written_unasked() {
    let sandbox = Sandbox::new();
    sandbox.run("phase hg --samples 1000").ends(0);
    let list = sandbox.run("phase --list").ends(0);
    for hint in [
        "mie_hazy*",
        "mie_murky*",
        "mie_reflecting*",
        "cos^n(theta/2)",
        "Nishita et al. 1987",
        "P03T eq. 2.16",
    ] {
        assert!(list.out().contains(hint), "no {hint} in {}", list.out());
    }
    assert_eq!(sandbox.files(), [""; 0]);
}

#[test]
fn mistakes_are_explained() {
    let sandbox = Sandbox::new();
    sandbox.run("phase henyey").refuses(&["phase function", "isotropic", "tabphase"]);
    sandbox.run("phase hg k=1").refuses(&["\"k\"", "known here: g"]);
    sandbox.run("phase hg g=1").refuses(&["phase g=1", "between -1 and 1", "remedy"]);
    sandbox.run("phase").refuses(&["<NAME"]);
    sandbox.run("phase hg --list").refuses(&["--list"]);
    sandbox.run("phase hg --parallels 2").refuses(&["3..=1025"]);
    sandbox.run("phase hg --significance 1").refuses(&["between 0 and 1"]);
    assert_eq!(sandbox.files(), [""; 0]);
}
