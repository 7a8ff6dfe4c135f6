//! `render --integrator gather`: a preview that says so, and that can be kept, resumed and put together as other images are.

use crate::{common::pieces::*, sandbox::Sandbox};
use serde_json::{Value, json};

fn divided() -> Sandbox {
    Sandbox::with_scene(&scene(&[
        ("sensor", camera([0.0, 0.0, 0.9], [0.0, 0.0, -1.0], 16)),
        ("room", room(0.6, Some(medium(0.7, 0.8, 0.3)))),
        ("wall", floor(0.3, 0.5, 0.5)),
        ("lamp", lamp_ball([0.2, 0.7, -0.3], 0.15, rgb(2.0, 3.0, 1.0))),
    ]))
}

#[test]
fn images_say_that_they_are_previews_and_are_the_same_by_any_threads() {
    let sandbox = divided();
    let render = |words: &str| sandbox.run(&format!("render scene.json --integrator gather {words}")).ends(0);
    let said: Value = serde_json::from_str(&render("--spp 4 --threads 1 -o one.exr --json").out()).unwrap();
    assert_eq!(said["plan"]["integrator"], json!("gather"));
    let bytes = sandbox.bytes("one.exr");
    let note = b"\"preview\":\"gather\"";
    assert!(bytes.windows(note.len()).any(|text| text == note));
    render("--spp 4 --threads 2 -o two.exr");
    render("--samples 0..2 -o a.exr --sums a.sums");
    render("--samples 2..4 -o b.exr --sums b.sums");
    sandbox.run("merge a.sums b.sums -o merged.exr").ends(0);
    let one = sandbox.channels("one.exr");
    assert!(one["G"].iter().any(|value| *value > 0.0));
    for other in ["two.exr", "merged.exr"] {
        assert_eq!(sandbox.channels(other)["G"], one["G"], "{other}");
    }
    render("--spp 2 --progressive straight -o fast.exr");
    assert!(sandbox.channels("fast.exr")["G"].iter().any(|value| *value > 0.0));
}

/// A first pass is made whole, and says what that cost.
#[test]
fn a_time_limit_that_is_not_kept_is_told() {
    let render = "render scene.json --time-limit 0.0001s -o a.exr --integrator";
    let said = divided().run(&format!("{render} gather")).ends(0).err();
    assert!(said.contains("--time-limit 0.0001 s was not kept: the first pass of gather"), "{said}");
    assert!(!divided().run(&format!("{render} pt")).ends(0).err().contains("was not kept"));
}

/// It has no use for a second walk from each primary ray, and says so.
#[test]
fn no_interaction_is_forced() {
    let sandbox = divided();
    sandbox.run("render scene.json --integrator gather --spp 2 -o plain.exr").ends(0);
    let run = sandbox
        .run("render scene.json --integrator gather --spp 2 --forced-interaction -o forced.exr")
        .ends(0);
    assert!(run.err().contains("--forced-interaction has no effect"), "{}", run.err());
    assert_eq!(sandbox.channels("forced.exr")["G"], sandbox.channels("plain.exr")["G"]);
}

/// In the dark there is nothing to learn; directly lit, nothing to gather.
#[test]
fn scenes_with_little_to_show_are_shown() {
    let sandbox = Sandbox::with_scene(&scene(&[
        ("sensor", camera([0.0, 0.0, 0.9], [0.0, 0.0, -1.0], 8)),
        ("room", room(0.6, None)),
    ]));
    sandbox.run("render scene.json --integrator gather --spp 2 -o dark.exr").ends(0);
    assert!(sandbox.channels("dark.exr")["G"].iter().all(|value| *value == 0.0));
    let sandbox = divided();
    sandbox
        .run("render scene.json --integrator gather --guide never --max-depth 2 --spp 4 -o direct.exr")
        .ends(0);
    sandbox
        .run("render scene.json --integrator pt --strategies hit,next-event --max-depth 2 --spp 4 -o pt.exr")
        .ends(0);
    assert_eq!(sandbox.channels("direct.exr")["G"], sandbox.channels("pt.exr")["G"]);
}

/// Of what was learnt it is not known by which paths the light came.
#[test]
fn what_needs_whole_paths_is_refused() {
    let sandbox = divided();
    for (words, hints) in [
        ("render scene.json --integrator gather --groups", ["--groups", "gather"]),
        ("render scene.json --integrator gather --components", ["--components", "gather"]),
        ("render scene.json --integrator gather --error 0.1", ["--error", "gather"]),
        ("render scene.json --integrator gather --heuristic power", ["--integrator gather", "balance"]),
        (
            "render scene.json --integrator gather --strategies hit,next-event",
            ["--strategies", "--integrator pt"],
        ),
        ("strategies scene.json --integrator gather", ["paths", "--integrator bdpt"]),
        ("pixel scene.json 4 4 --integrator gather", ["paths", "--integrator bdpt"]),
        ("guide scene.json --integrator gather", ["--integrator", "bdpt, pt or lt"]),
    ] {
        sandbox.run(words).refuses(&hints);
    }
}
