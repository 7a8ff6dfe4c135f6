//! Parts of an image: rendered by themselves, and put side by side.

use crate::sandbox::Sandbox;
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// A room of fog, seen through a filter that reaches across the edges of parts, with alpha and layers.
fn foggy() -> Sandbox {
    let mut scene: Value = serde_json::from_str(include_str!("../../scenes/foggy_room.json")).unwrap();
    scene["integrator"] = json!({"type": "aov", "aovs": "n:sh_normal,p:position", "inner": {"type": "bdpt"}});
    scene["sensor"]["film"]["pixel_format"] = "rgba".into();
    Sandbox::with_files(&[("fog.json", &scene.to_string())])
}

const SIZE: [usize; 2] = [30, 20];
/// Width, height, column and row of parts that cover it.
const PARTS: [[usize; 4]; 4] = [[11, 20, 0, 0], [19, 9, 11, 0], [1, 11, 11, 9], [18, 11, 12, 9]];

fn spelled([width, height, x, y]: [usize; 4]) -> String {
    format!("{width}x{height}+{x}+{y}")
}

fn render(sandbox: &Sandbox, words: &str) {
    sandbox.run(&format!("render fog.json --size 30x20 --integrator bdpt {words}")).ends(0);
}

/// The part of an image, channel by channel.
fn cut(image: &BTreeMap<String, Vec<f32>>, [width, height, x, y]: [usize; 4]) -> BTreeMap<String, Vec<f32>> {
    let rows = |values: &[f32]| {
        let rows = (y..y + height).flat_map(|row| &values[row * SIZE[0] + x..row * SIZE[0] + x + width]);
        rows.copied().collect()
    };
    image.iter().map(|(name, values)| (name.clone(), rows(values))).collect()
}

/// Parts are what they are in the merged image, to the last bit, with alpha and all layers.
#[test]
fn parts_are_put_side_by_side() {
    for words in ["--spp 4", "--error 0.6 --spp 200"] {
        let sandbox = foggy();
        for (index, part) in PARTS.into_iter().enumerate() {
            let crop = spelled(part);
            render(&sandbox, &format!("{words} --crop {crop} --sums {index}.sums -o {index}.exr"));
        }
        sandbox.run("merge 2.sums 0.sums 3.sums 1.sums -o merged.exr").ends(0);
        let merged = sandbox.channels("merged.exr");
        assert!(["A", "n.X", "R"].iter().all(|name| merged[*name].len() == SIZE[0] * SIZE[1]));
        assert_eq!(merged.contains_key("samples.N"), words.contains("--error"));
        for (index, part) in PARTS.into_iter().enumerate() {
            assert!(cut(&merged, part) == sandbox.channels(&format!("{index}.exr")), "{words}: {part:?}");
        }
    }
}

/// Beside the edges of parts pixels look where those of the whole image do: a filter that is cut off there would look a
/// seventh of a pixel too far inwards.
#[test]
fn no_edge_shows() {
    let sandbox = foggy();
    for (index, part) in PARTS.into_iter().enumerate() {
        let crop = spelled(part);
        render(&sandbox, &format!("--spp 256 --crop {crop} --sums {index}.sums"));
    }
    sandbox.run("merge 0.sums 1.sums 2.sums 3.sums -o merged.exr").ends(0);
    render(&sandbox, "--spp 256 -o all.exr");
    let [merged, all] = ["merged.exr", "all.exr"].map(|name| sandbox.channels(name));
    let columns = [10, 11].map(|x| (0..SIZE[1]).map(|y| y * SIZE[0] + x).collect::<Vec<_>>());
    let rows = [8, 9].map(|y| (13..SIZE[0]).map(|x| y * SIZE[0] + x).collect::<Vec<_>>());
    for line in columns.iter().chain(&rows) {
        for name in ["p.X", "p.Y", "p.Z"] {
            let apart = |pixel: &usize| f64::from(merged[name][*pixel] - all[name][*pixel]);
            let z = deviations(&line.iter().map(apart).collect::<Vec<_>>());
            assert!(z.abs() < 5.0, "{name} at {line:?}: {z} standard errors");
        }
    }
}

/// How many standard errors the mean of `values` is off 0; of walls that are seen straight on, whose depth is known, 0.
fn deviations(values: &[f64]) -> f64 {
    let (n, mean) = (values.len() as f64, values.iter().sum::<f64>() / values.len() as f64);
    let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (n - 1.0);
    if variance < 1e-12 { 0.0 } else { mean / (variance / n).sqrt() }
}

/// Samples of a part are added up before parts are put side by side.
#[test]
fn parts_of_parts_are_merged() {
    let sandbox = foggy();
    let alike = "--strategies hit,next-event,join,lens";
    for (index, part) in PARTS.into_iter().enumerate() {
        let crop = spelled(part);
        render(&sandbox, &format!("{alike} --samples 0..2 --crop {crop} --sums {index}a.sums"));
        render(&sandbox, &format!("{alike} --samples 2..5 --crop {crop} --sums {index}b.sums"));
        render(&sandbox, &format!("{alike} --spp 5 --crop {crop} --sums {index}.sums"));
    }
    sandbox.run("merge 0a.sums 1a.sums 2a.sums 3a.sums 3b.sums 2b.sums 1b.sums 0b.sums -o both.exr").ends(0);
    sandbox.run("merge 0.sums 1.sums 2.sums 3.sums -o merged.exr").ends(0);
    assert!(sandbox.channels("both.exr") == sandbox.channels("merged.exr"));
    let said = sandbox.run("merge 1b.sums 1a.sums -o one.exr").ends(0).out();
    assert!(said.contains("samples 0..5 of 19x9+11+0") && sandbox.channels("one.exr")["R"].len() == 19 * 9);
}

#[test]
fn what_does_not_make_one_image_is_refused() {
    let sandbox = foggy();
    for (index, part) in PARTS.into_iter().enumerate() {
        let crop = spelled(part);
        render(&sandbox, &format!("--spp 1 --crop {crop} --sums {index}.sums"));
    }
    render(&sandbox, "--spp 1 --crop 2x2+10+10 --sums over.sums");
    render(&sandbox, "--spp 1 --crop 18x11+12+9 --seed 1 --sums seed.sums");
    render(&sandbox, "--spp 1 --crop 18x11+12+9 --error 0.5 --sums error.sums");
    render(&sandbox, "--spp 1 --sums whole.sums");
    for (parts, hints) in [
        ("0.sums 1.sums 3.sums", &["30 x 20", "no part with 1x11+11+9", "--crop 1x11+11+9 --sums"][..]),
        ("1.sums 2.sums 3.sums", &["no part with 11x20+0+0"]),
        ("0.sums 1.sums 2.sums 3.sums over.sums", &["over.sums", "2x2+10+10", "0.sums"]),
        ("0.sums 0.sums", &["0.sums", "samples 0..1"]),
        ("0.sums 1.sums 2.sums seed.sums", &["seed.sums", "seed"]),
        ("0.sums 1.sums 2.sums error.sums", &["error.sums", "--error"]),
        ("0.sums whole.sums", &["whole.sums", "30x20+0+0", "0.sums"]),
        ("0.sums 1.sums 2.sums 3.sums --sums x.sums", &["--sums", "side by side"]),
    ] {
        sandbox.run(&format!("merge {parts} -o x.exr")).refuses(hints);
    }
    for crop in ["31x1+0+0", "1x1+0+20", "1x1+4294967295+0"] {
        sandbox
            .run(&format!("render fog.json --size 30x20 --crop {crop}"))
            .refuses(&["--crop", crop, "30 x 20"]);
    }
    assert!(!sandbox.path("x.exr").exists() && !sandbox.path("x.sums").exists());
}

/// A part of the window that the scene already has.
#[test]
fn windows_of_scenes_are_cut_too() {
    let mut scene: Value = serde_json::from_str(include_str!("../../scenes/foggy_room.json")).unwrap();
    scene["sensor"]["film"] = json!({"type": "hdrfilm", "width": 60, "height": 40, "crop_offset_x": 5,
        "crop_offset_y": 7, "crop_width": 20, "crop_height": 10});
    let sandbox = Sandbox::with_files(&[("fog.json", &scene.to_string())]);
    for (name, crop) in [("a", "20x4+0+0"), ("b", "20x6+0+4")] {
        sandbox
            .run(&format!("render fog.json --spp 2 --crop {crop} --sums {name}.sums -o {name}.exr"))
            .ends(0);
    }
    sandbox.run("merge a.sums b.sums -o merged.exr").ends(0);
    let [a, b, merged] =
        ["a", "b", "merged"].map(|name| sandbox.channels(&format!("{name}.exr"))["R"].clone());
    assert_eq!([a, b].concat(), merged);
}
