//! Scenes to start from: around volume files, and by name.

use crate::sandbox::Sandbox;
use serde_json::json;
use std::{fs, path::Path};

#[test]
fn a_volume_file_is_rendered_as_the_scene_that_new_writes() {
    let sandbox =
        Sandbox::with_files(&[("smoke/note.txt", "")]).with_sample("houdini.vdb", "smoke/plume.vdb");
    let run = sandbox.run("render smoke/plume.vdb --size 16x24 --spp 2 -o a.exr").ends(0);
    assert!(
        run.err().starts_with("smoke/plume.vdb: 1.250 x 2.000 x 1.250 (width, height, depth), up is y\n"),
        "{}",
        run.err()
    );
    assert!(run.err().contains("density_scale ") && run.err().contains("emission_scale "), "{}", run.err());
    let image = sandbox.channels("a.exr");
    // Names of files start at the folder of the new scene; on standard output, at the current one.
    let run = sandbox.run("new smoke/plume.vdb -o scenes/deep/plume.json").ends(0);
    assert_eq!(run.out(), "scenes/deep/plume.json: tyndall render scenes/deep/plume.json\n");
    assert_eq!(sandbox.json("scenes/deep/plume.json")["smoke"]["filename"], "../../smoke/plume.vdb");
    fs::write(sandbox.path("piped.json"), sandbox.run("new smoke/plume.vdb").ends(0).out()).unwrap();
    for scene in ["scenes/deep/plume.json", "piped.json"] {
        sandbox.run(&format!("render {scene} --size 16x24 --spp 2 -o b.exr")).ends(0);
        assert_eq!(sandbox.channels("b.exr"), image, "{scene}");
    }
    // Its numbers are parameters of both.
    sandbox
        .run("render smoke/plume.vdb -D density_scale=0 -D emission_scale=0 --size 16x24 --spp 2 -o c.exr")
        .ends(0);
    assert_ne!(sandbox.channels("c.exr"), image);
    let run = sandbox.run("info a.exr --json").ends(0).out();
    assert!(run.contains("\"scene\":") && !run.contains("\"plume.vdb\""), "{run}");
}

/// How much of an image of `file` differs from the same without smoke and fire, and whether its border does.
fn seen(sandbox: &Sandbox, file: &str) -> (f64, bool) {
    const SIZE: usize = 24;
    let render = |scene: &str, name: &str| {
        sandbox.run(&format!("render {scene} --size {SIZE}x{SIZE} --spp 4 -o {name}")).ends(0);
        sandbox.channels(name)["G"].clone()
    };
    let image = render(file, "with.exr");
    sandbox.run(&format!("new {file} -o {file}.json")).ends(0);
    let mut scene = sandbox.json(&format!("{file}.json"));
    scene.as_object_mut().unwrap().remove("smoke");
    scene.as_object_mut().unwrap().remove("$defaults");
    fs::write(sandbox.path("bare.json"), scene.to_string()).unwrap();
    let bare = render("bare.json", "bare.exr");
    let differs = |n: &usize| (image[*n] - bare[*n]).abs() > 0.15 * bare[*n];
    assert!(
        image.iter().all(|value| value.is_finite()) && image.iter().sum::<f32>() > 1.0,
        "{file} is black"
    );
    let different = (0..SIZE * SIZE).filter(differs).count();
    (different as f64 / (SIZE * SIZE) as f64, (0..SIZE).any(|n| differs(&n)))
}

#[test]
fn whatever_a_volume_file_holds_is_seen_and_whole() {
    let samples = [
        "houdini.vdb",
        "blender.vdb",
        "bifrost.vdb",
        "kelvin.vdb",
        "burning.vdb",
        "strange.vdb",
        "levelset.vdb",
        "upright.vdb",
        "zip.nvdb",
    ];
    for sample in samples {
        let sandbox = Sandbox::new().with_sample(sample, sample);
        let (part, reaches_above) = seen(&sandbox, sample);
        assert!(part > 0.03 && part < 0.9 && !reaches_above, "{sample}: {part} {reaches_above}");
    }
    let sandbox = Sandbox::new();
    let grid = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/crosscheck/assets/smoke_colours.vol");
    fs::copy(grid, sandbox.path("a.vol")).unwrap();
    assert!(seen(&sandbox, "a.vol").0 > 0.03);
}

#[test]
fn what_new_found_out_stands_in_the_scene() {
    let sandbox = Sandbox::new().with_sample("upright.vdb", "a.vdb").with_sample("strange.vdb", "b.vdb");
    let sandbox = sandbox.with_sample("levelset.vdb", "c.vdb").with_sample("empty.vdb", "d.vdb");
    for name in ["a", "b", "c"] {
        sandbox.run(&format!("new {name}.vdb -o {name}.json -q")).ends(0);
    }
    assert_eq!(sandbox.json("a.json")["smoke"]["up"], "z");
    assert_eq!(sandbox.json("b.json")["smoke"]["density_grid"], "soot");
    assert_eq!(sandbox.json("c.json")["smoke"]["level_set_to_fog"], true);
    sandbox.run("new d.vdb").refuses(&["d.vdb: expected a "]);
    sandbox.run("render d.vdb").refuses(&["d.vdb: expected a "]);
}

#[test]
fn numbered_files_are_seen_as_the_last_fits() {
    let sandbox =
        Sandbox::new().with_sample("twins.vdb", "a_0007.vdb").with_sample("houdini.vdb", "a_0008.vdb");
    let run = sandbox.run("render a_####.vdb --size 8x8 --spp 1 --frames 0..1").ends(0);
    assert!(run.err().contains("all frames are seen as a_0008.vdb fits"), "{}", run.err());
    let files = sandbox.files();
    assert!(
        files.contains(&"a.0000.exr".to_owned()) && files.contains(&"a.0001.exr".to_owned()),
        "{files:?}"
    );
    sandbox.run("render b_####.vdb").refuses(&["b_####.vdb", "none for"]);
}

#[test]
fn templates_are_scenes_that_show_something() {
    for name in ["fog", "room", "cloud"] {
        let sandbox = Sandbox::new();
        sandbox.run(&format!("new {name} -o {name}.json")).ends(0);
        let run = sandbox.run(&format!("render {name}.json --size 12x8 --spp 1 -o a.exr --strict")).ends(0);
        assert!(!run.err().contains("warning"), "{}", run.err());
        assert!(sandbox.channels("a.exr")["G"].iter().sum::<f32>() > 1.0, "{name}");
    }
}

#[test]
fn new_refuses_what_it_cannot_start_from_or_write_to() {
    let sandbox = Sandbox::with_scene(&json!({"type": "scene"}));
    let run = sandbox.run("new fogg").ends(2);
    assert_eq!(
        run.err(),
        "error: tyndall new: expected the name of a template, or a volume file (.vdb, .nvdb, .vol), found \"fogg\"\n  remedy: did you mean \"fog\"? templates: fog, room, cloud\n"
    );
    sandbox.run("new none.vdb").refuses(&["none.vdb: expected a file to read", "check that the path exists"]);
    sandbox
        .run("new fog -o scene.json")
        .refuses(&["scene.json: expected a file that does not exist yet", "choose another name"]);
    assert_eq!(sandbox.text("scene.json"), r#"{"type":"scene"}"#);
    sandbox.run("new fog -o fog.xml").refuses(&["ends in .json"]);
    assert_eq!(sandbox.files(), ["scene.json"]);
    assert!(sandbox.run("new --help").ends(0).out().contains("  cloud  a cloud under a blue sky"));
}

#[test]
fn files_that_are_no_scenes_are_called_what_they_are() {
    let sandbox = Sandbox::new();
    for (file, hints) in [
        ("a.exr", ["found an image", "tyndall info"]),
        ("a.pbrt", ["found a scene of pbrt", "Mitsuba 3 XML"]),
        ("a.blend", ["found a scene of Blender", "mitsuba-blender"]),
        ("a.glb", ["Tyndall does not read", "Blender"]),
        ("a.PLY", ["found a mesh", "filename"]),
        ("a.sums", ["found a checkpoint", "--resume"]),
    ] {
        sandbox.run(&format!("render {file}")).refuses(&hints);
    }
}

#[test]
fn the_folder_of_an_image_is_made() {
    let sandbox = Sandbox::with_files(&[]);
    sandbox.run("new fog -o fog.json").ends(0);
    sandbox.run("render fog.json --size 4x4 --spp 1 -o anim/deep/x.exr").ends(0);
    assert!(sandbox.path("anim/deep/x.exr").is_file() && sandbox.path("anim/deep/x.png").is_file());
}

#[cfg(unix)]
#[test]
fn denoising_is_left_to_python_and_refused_before_the_render_without_it() {
    let python = "#!/bin/sh\necho \"$@\" >> words\n[ -z \"$BROKEN\" ] || { echo no pyoidn >&2; exit 2; }\n";
    let sandbox = Sandbox::with_files(&[("python", python)]);
    sandbox.run("new fog -o fog.json").ends(0);
    let render = "$TYNDALL render fog.json --size 4x4 --spp 1 --denoise --exposure 1.5";
    let run = sandbox.shell(&format!("TYNDALL_PYTHON=./none {render}"));
    run.refuses(&[
        "denoise: expected Python with the packages tyndall and pyoidn",
        "pip install '.[denoise]'",
    ]);
    let run = sandbox.shell(&format!("chmod +x python; BROKEN=1 TYNDALL_PYTHON=./python {render}"));
    run.refuses(&["found no pyoidn", "pip install"]);
    assert!(!sandbox.path("fog.exr").exists());
    let run = sandbox.shell(&format!("rm words; TYNDALL_PYTHON=./python {render}")).ends(0);
    assert!(run.out().ends_with("denoised: fog.denoised.exr\n"), "{}", run.out());
    let files = "fog.exr fog.denoised.exr fog.denoised.png --view=standard --exposure=1.5";
    assert_eq!(sandbox.text("words"), format!("-m tyndall denoise --check\n-m tyndall denoise {files}\n"));
    let layers = sandbox.channels("fog.exr");
    assert!(layers.contains_key("albedo.R") && layers.contains_key("normal.X"), "{:?}", layers.keys());
    // A layer of an image as a PNG.
    sandbox.run("convert fog.exr albedo.png --layer albedo").ends(0);
    sandbox.run("convert fog.exr b.png --layer albdo").refuses(&["albdo", "did you mean \"albedo\"?"]);
    sandbox.run("convert fog.json b.json --layer albedo").refuses(&["--layer", "a PNG to write"]);
}
