//! `tyndall diff` as a user runs it.

use crate::sandbox::Sandbox;
use tyndall::{
    film::{self, Channel, format::Format},
    math::{Spectrum, vec3},
};

/// 8 x 8 pixels, grey from 0.1 to 6.4, and `spoilt` with one of them changed.
fn pixels(spoilt: Option<f32>) -> Vec<Spectrum> {
    let mut pixels: Vec<_> = (1..=64).map(|i| Spectrum::splat(0.1 * i as f32)).collect();
    if let Some(value) = spoilt {
        pixels[19] = vec3(pixels[19].x, value, pixels[19].z);
    }
    pixels
}

fn exr(sandbox: &Sandbox, name: &str, pixels: &[Spectrum]) {
    film::exr::write(&sandbox.path(name), 8, 8, Format::default().channels(pixels, &[]), Format::default())
        .unwrap();
}

/// One value of 192, 2, is 5: MSE 9/192; relative to its square and 1 % of that of the mean luminance.
#[test]
fn figures_are_printed_and_written() {
    let sandbox = Sandbox::new();
    exr(&sandbox, "a.exr", &pixels(Some(5.0)));
    exr(&sandbox, "b.exr", &pixels(None));
    let run = sandbox.run("diff a.exr b.exr --report d.json --map d.png --tolerance 0.5").ends(0);
    for hint in [
        "b.exr (reference)",
        "3, 2, 1",
        "1.562 % of pixels",
        "0.0469",
        "d.png: relative squared error, black",
    ] {
        assert!(run.out().contains(hint), "no {hint} in {}", run.out());
    }
    let figures = sandbox.json("d.json");
    let number = |at: &str| figures.pointer(at).unwrap().as_f64().unwrap();
    assert!((number("/radiance/mse") - 9.0 / 192.0).abs() < 1e-6);
    let luminance = 0.1 * 32.5;
    let relmse = 9.0 / (4.0 + 0.01 * luminance * luminance) / 192.0;
    assert!((number("/radiance/relmse") - relmse).abs() < 1e-6);
    assert!((number("/radiance/ratio/1") - 211.0 / 208.0).abs() < 1e-6);
    assert!(number("/display/mse") > 0.0 && number("/display/mse") < 1e-3);
    assert!(number("/flip") > 0.0 && number("/flip") < 0.2);
    let map = image::open(sandbox.path("d.png")).unwrap().to_rgb8();
    let brightness = |x, y| map.get_pixel(x, y).0.iter().map(|c| u32::from(*c)).sum::<u32>();
    assert!(map.dimensions() == (8, 8) && brightness(3, 2) > 500 && brightness(4, 2) < 20);
}

#[test]
fn limits_set_the_exit_code() {
    let sandbox = Sandbox::new();
    exr(&sandbox, "a.exr", &pixels(Some(5.0)));
    exr(&sandbox, "b.exr", &pixels(None));
    sandbox.run("diff a.exr b.exr --fail-above mse=0.05 --fail-above largest=3.01").ends(0);
    let run = sandbox.run("diff a.exr b.exr --fail-above mse=0.05 --fail-above largest=2.9").ends(1);
    assert!(run.err().contains("largest is 3.0") && !run.err().contains("mse is"), "{}", run.err());
    sandbox.run("diff a.exr b.exr --fail-above display.mse=0").ends(1);
    sandbox
        .run("diff b.exr b.exr --fail-above mse=0 --fail-above difference=0 --fail-above beyond=0")
        .ends(0);
    sandbox.run("diff a.exr b.exr --fail-above mse=-1").refuses(&[">= 0"]);
    sandbox.run("diff a.exr b.exr --fail-above mze=1").refuses(&["mse, rmse"]);
}

/// A float map, a Radiance file and an OpenEXR file of the same pixels; a PNG of those that it can hold.
#[test]
fn every_format_is_read() {
    let sandbox = Sandbox::new();
    let pixels: Vec<Spectrum> = (0..64).map(|i| Spectrum::splat(i as f32 / 64.3)).collect();
    let channels = Format::default().channels(&pixels, &[]);
    exr(&sandbox, "a.exr", &pixels);
    film::raster::write_pfm(&sandbox.path("a.pfm"), 8, 8, &channels).unwrap();
    film::raster::write_rgbe(&sandbox.path("a.hdr"), 8, 8, &pixels).unwrap();
    film::png::write(&sandbox.path("a.png"), 8, 8, &pixels).unwrap();
    sandbox.run("diff a.pfm a.exr --fail-above mse=0").ends(0);
    for (name, most) in [("a.hdr", 0.01), ("a.png", 0.005)] {
        sandbox.run(&format!("diff {name} a.exr --fail-above largest={most}")).ends(0);
        sandbox.run(&format!("diff {name} a.exr --fail-above largest=0")).ends(1);
    }
}

#[test]
fn layers_are_compared_by_name_or_explained() {
    let sandbox = Sandbox::new();
    for (name, depth) in [("a.exr", 3.0), ("b.exr", 2.0)] {
        let mut channels = Format::default().channels(&pixels(None), &[]);
        channels.push(Channel { name: "dd.T".into(), values: vec![depth; 64] });
        film::exr::write(&sandbox.path(name), 8, 8, channels, Format::default()).unwrap();
    }
    sandbox.run("diff a.exr b.exr --fail-above mse=0").ends(0);
    let run =
        sandbox.run("diff a.exr b.exr --layer dd --fail-above mse=1.001 --fail-above largest=0.99").ends(1);
    assert!(
        run.err().contains("largest is 1.0") && run.out().contains("does not contain colours"),
        "{}",
        run.out()
    );
    sandbox.run("diff a.exr b.exr --layer depth").refuses(&["a.exr", "dd (T)", "R"]);
    sandbox
        .run("diff a.exr b.exr --layer dd --fail-above flip=1")
        .refuses(&["--fail-above", "does not contain colours"]);
    sandbox.run("diff a.exr b.exr --layer dd --map m.png --map-of flip").refuses(&["--map-of"]);
}

#[test]
fn what_cannot_be_compared_is_explained() {
    let sandbox = Sandbox::new();
    exr(&sandbox, "b.exr", &pixels(None));
    exr(&sandbox, "nan.exr", &pixels(Some(f32::NAN)));
    let small = Format::default().channels(&pixels(None)[..16], &[]);
    film::exr::write(&sandbox.path("small.exr"), 4, 4, small, Format::default()).unwrap();
    sandbox.run("diff small.exr b.exr").refuses(&["small.exr", "8 x 8", "4 x 4", "--size"]);
    sandbox.run("diff nan.exr b.exr").refuses(&["nan.exr", "finite", "column 3, row 2", "remedy"]);
    sandbox.run("diff missing.exr b.exr").refuses(&["missing.exr", "remedy"]);
    std::fs::write(sandbox.path("text.exr"), "no image").unwrap();
    sandbox.run("diff text.exr b.exr").refuses(&["text.exr", "remedy"]);
    sandbox.run("diff b.exr").refuses(&["REFERENCE"]);
    sandbox.run("diff b.exr b.exr --map m.jpg").refuses(&[".png"]);
    sandbox.run("diff b.exr b.exr --tolerance -1").refuses(&[">= 0"]);
    assert!(sandbox.run("diff --help").ends(0).out().contains("relative measures are relative to it"));
}
