//! What is written where: links, devices and pipes; what is known to fail is said before the first ray; and what is left
//! behind when writing fails all the same.
#![cfg(unix)]

use crate::{common::pieces::*, sandbox::Sandbox};
use std::{
    fs::{self, File},
    os::unix::fs::{FileTypeExt, symlink},
};

fn lamp() -> Sandbox {
    let lamp = lamp_ball([0.0, 0.0, 0.0], 0.3, 1.0);
    Sandbox::with_scene(&scene(&[("sensor", camera([0.0, 0.0, 3.0], [0.0; 3], 32)), ("lamp", lamp)]))
}

/// Where no one would wait for a render to end.
const LONG: &str = "--spp 1000000000";

/// The first bytes of every OpenEXR file.
const EXR: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

#[test]
fn a_link_stays_a_link() {
    let sandbox = lamp();
    fs::create_dir(sandbox.path("deep")).unwrap();
    symlink("deep/real.exr", sandbox.path("a.exr")).unwrap();
    for _ in 0..2 {
        sandbox.run("render scene.json -o a.exr --spp 1").ends(0);
        assert!(sandbox.path("a.exr").symlink_metadata().unwrap().is_symlink());
        assert_eq!(sandbox.bytes("deep/real.exr")[..4], EXR);
        assert_eq!(sandbox.files(), ["a.exr", "a.png", "deep", "scene.json"]);
    }
    symlink("b", sandbox.path("c")).unwrap();
    symlink("c", sandbox.path("b")).unwrap();
    sandbox.run(&format!("render scene.json --report b {LONG}")).refuses(&["b: expected", "without end"]);
}

#[test]
fn standard_output_takes_a_file_and_nothing_else() {
    let sandbox = lamp();
    let render = "$TYNDALL render scene.json --spp 1 -o a.exr --report /dev/stdout";
    let (piped, kept) =
        (sandbox.shell(render).ends(0), sandbox.shell(&format!("{render} > out.txt")).ends(0));
    for (report, said) in [(piped.out(), piped.err()), (sandbox.text("out.txt"), kept.err())] {
        let report: serde_json::Value = serde_json::from_str(&report).unwrap();
        assert_eq!(report["samples_per_pixel"], 1);
        assert!(said.contains("1 samples/pixel"), "{said}");
    }
    sandbox.shell("$TYNDALL render scene.json --spp 1 -o /dev/stdout | cat > got.exr").ends(0);
    assert_eq!(sandbox.channels("got.exr").len(), 3);
}

#[test]
fn a_pipe_takes_an_image_and_stays_a_pipe() {
    let sandbox = lamp();
    let script =
        "mkfifo p; timeout 60 cat p > got & timeout 60 $TYNDALL render scene.json --spp 1 -o p; wait";
    sandbox.shell(script).ends(0);
    assert!(sandbox.path("p").metadata().unwrap().file_type().is_fifo());
    assert_eq!(sandbox.bytes("got")[..4], EXR);
    assert_eq!(sandbox.files(), ["got", "p", "scene.json"]);
    sandbox.run("render scene.json --spp 1 -o /dev/null").ends(0);
}

#[test]
fn what_cannot_be_written_is_said_before_the_first_ray() {
    let sandbox = lamp();
    sandbox.run("render scene.json --spp 1").ends(0);
    for folder in ["folder", "x.png", "s/study.csv", "t/weighted.exr", "hg.ply", "f.0007.png"] {
        fs::create_dir_all(sandbox.path(folder)).unwrap();
    }
    let before = sandbox.files();
    let missing: &[&str] = &["missing/", "create the folder missing first"];
    let folder: &[&str] = &["expected a file to write, found a folder"];
    let same: &[&str] = &["a file of its own", "choose another name"];
    let read: &[&str] = &["scene.json, which the scene reads"];
    let flights = "flights --sigma-a 1 --sigma-s 1 --photons 1000000000000";
    for (words, hints) in [
        (format!("render scene.json {LONG} --report missing/r.json"), missing),
        (format!("render scene.json {LONG} -o x.exr"), folder),
        (format!("render scene.json {LONG} -o f.exr --frames 0..9"), folder),
        (format!("render scene.json {LONG} -o a.exr --report a.exr"), same),
        (format!("render scene.json {LONG} -o a.exr --report ./a.png"), same),
        (format!("render scene.json {LONG} --report scene.json"), read),
        ("pixel scene.json 1 1 --samples 4000000000 -o missing/p".into(), missing),
        (format!("study scene.json {LONG} -o s"), folder),
        (format!("study scene.json {LONG} -o scene.json"), &["scene.json", "choose another place"]),
        (format!("strategies scene.json {LONG} -o t"), folder),
        (format!("{flights} --report missing/f.json"), missing),
        (format!("{flights} --svg f --report f"), same),
        ("phase hg --samples 1000000000000 -o .".into(), folder),
        (
            "phase isotropic --samples 1000000000000 -o scene.json/drawn".into(),
            &["scene.json/drawn", "a folder to write to"],
        ),
        ("diff scene.exr scene.png --report missing/d.json".into(), missing),
        (
            "diff scene.exr scene.exr --map scene.png --report scene.exr".into(),
            &["scene.exr, which this command reads"],
        ),
        ("convert scene.json missing/a.xml".into(), missing),
    ] {
        sandbox.shell(&format!("timeout 60 $TYNDALL {words}")).refuses(hints);
    }
    assert_eq!(sandbox.files(), before);
}

/// Nobody may make a file in /sys, not even who may do everything.
#[test]
fn a_folder_that_takes_no_file_is_said_before_the_first_ray() {
    if fs::metadata("/sys/kernel").is_ok() {
        let words = format!("render scene.json {LONG} --report /sys/kernel/r.json");
        lamp().run(&words).refuses(&["/sys/kernel/r.json", "choose another place"]);
    }
}

#[test]
fn a_disk_without_room_is_said_before_the_first_ray() {
    let sandbox = lamp();
    let mounted = sandbox.shell("mkdir small && mount -t tmpfs -o size=64k tmpfs small").code() == Some(0);
    if !mounted {
        return;
    }
    let large = sandbox.run(&format!("render scene.json {LONG} --size 200x200 -o small/a.exr"));
    // It fits, but something else takes the room meanwhile.
    sandbox.run("render scene.json --spp 1 -o small/b.exr").ends(0);
    let old = sandbox.bytes("small/b.exr");
    let full = sandbox.shell("head -c 65536 /dev/zero > small/rest; $TYNDALL convert scene.json small/b.exr");
    let (after, files) = (sandbox.bytes("small/b.exr"), fs::read_dir(sandbox.path("small")).unwrap().count());
    sandbox.shell("umount small").ends(0);
    large.refuses(&[
        "small: expected a disk with room for 0.6 MiB",
        "MiB free",
        "choose a folder on another disk",
    ]);
    assert_ne!(full.code(), Some(0));
    assert_eq!((after, files), (old, 3));
}

/// A limit on the size of files stands for any write that fails; its signal, for any moment of death.
#[test]
fn the_old_file_survives_a_failed_write_and_a_killed_process() {
    let sandbox = lamp();
    let render = "$TYNDALL render scene.json -o a.exr --spp";
    sandbox.shell(&format!("{render} 1")).ends(0);
    let (old, files) = (sandbox.bytes("a.exr"), sandbox.files());
    let failed = sandbox.shell(&format!("trap '' XFSZ; ulimit -f 1; {render} 2"));
    failed.refuses(&["a.exr: expected to write the file", "File too large", "raise the limit"]);
    assert_eq!((sandbox.bytes("a.exr"), sandbox.files()), (old.clone(), files.clone()));
    let killed = sandbox.shell(&format!("ulimit -c 0; ulimit -f 1; exec {render} 2"));
    assert_eq!(killed.code(), None);
    let left = sandbox.files().into_iter().find(|name| name.ends_with(".partial")).unwrap();
    assert!(left.starts_with(".a.exr.") && sandbox.bytes("a.exr") == old, "{left}");
    sandbox.shell(&format!("{render} 2")).ends(0);
    assert_eq!(sandbox.files(), files);
}

#[test]
fn a_full_device_is_an_error_wherever_it_is() {
    let sandbox = lamp();
    if File::open("/dev/full").is_err() {
        return;
    }
    sandbox.run("render scene.json --spp 1 --report /dev/full").refuses(&["/dev/full", "make room"]);
    let said = &["standard output: expected", "No space left"];
    for words in ["info scene.json", "--help", "--version", "render scene.json --spp 1 -o a.exr"] {
        sandbox.shell(&format!("$TYNDALL {words} > /dev/full")).refuses(said);
    }
    assert_eq!(sandbox.bytes("a.exr")[..4], EXR);
}

/// Who closes a pipe has read enough; the command does its work, and its exit code says how that went.
#[test]
fn a_closed_pipe_changes_nothing() {
    let sandbox = lamp();
    let run = |words: &str| {
        let script = format!("{{ sleep 0.3; $TYNDALL {words}; }} | true; exit ${{PIPESTATUS[0]}}");
        sandbox.shell(&script)
    };
    for (words, code) in [
        ("info scene.json", 0),
        ("--help", 0),
        ("render scene.json --spp 1 -q", 0),
        ("render scene.json --spp 1 -q --json", 0),
        ("diff scene.exr scene.exr", 0),
        ("info missing.json", 2),
    ] {
        let run = run(words).ends(code);
        assert_eq!(run.err().is_empty(), code == 0, "{words}: {}", run.err());
    }
    assert!(sandbox.path("scene.exr").is_file());
}

#[test]
fn too_little_memory_is_an_error_and_no_abort() {
    let sandbox = lamp();
    let film = &["the film: expected a render within", "which may need", "choose a smaller --size"];
    for size in [4096, 6144] {
        let script = format!("ulimit -v 2000000; $TYNDALL render scene.json --spp 1 --size {size}x{size}");
        sandbox.shell(&script).refuses(film);
    }
    let strategies = "strategies scene.json --spp 1 --size 16384x16384 -o s";
    sandbox.run(strategies).refuses(&["images within", "smaller --size"]);
    sandbox.shell("ulimit -v 2000000; $TYNDALL study scene.json --spp 1 --size 6144x6144 -o s").refuses(film);
    let layers: Vec<String> = (0..300).map(|layer| format!("l{layer}:position")).collect();
    let aov = serde_json::json!({"type": "aov", "aovs": layers.join(","), "image": {"type": "path"}});
    let layered = scene(&[("integrator", aov), ("sensor", camera([0.0, 0.0, 3.0], [0.0; 3], 4))]);
    Sandbox::with_scene(&layered).run("render scene.json --spp 1 --size 16384x16384").refuses(film);
}

#[test]
fn a_mesh_beyond_all_memory_is_an_error() {
    let huge = scene(&[
        ("sensor", camera([0.0, 0.0, 3.0], [0.0; 3], 4)),
        ("mesh", serde_json::json!({"type": "obj", "filename": "huge.obj"})),
    ]);
    let sandbox = Sandbox::with_scene(&huge);
    File::create(sandbox.path("huge.obj")).unwrap().set_len(1 << 40).unwrap();
    sandbox.run("info scene.json").refuses(&["huge.obj: expected a mesh within", "fewer triangles"]);
}
