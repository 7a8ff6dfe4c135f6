//! What holds for every texture, and agreement with Mitsuba.

use super::*;
use crate::description::{Location, Table, TransformStep, table};
use crate::math::vec3;
use crate::testing::{nowhere, object};
use ::image::{Rgb, RgbImage};
use std::path::{Path, PathBuf};
use std::sync::Arc;

#[test]
fn no_texture_exceeds_its_bound_or_misses_its_mean() {
    for texture in examples() {
        let n = 128;
        let mut sum = Spectrum::ZERO;
        for i in 0..n * n {
            let uv = (vec2((i % n) as f32, (i / n) as f32) + Vec2::splat(0.5)) / n as f32;
            let color = texture.eval(uv);
            assert!(color.cmple(texture.max() + Vec2::splat(1e-6).extend(1e-6)).all(), "{texture:?} at {uv}");
            sum += color;
        }
        let mean = sum / (n * n) as f32;
        // A turned, clamped or mirrored image shows another part of itself in the unit square.
        let whole = !matches!(texture, Texture::Bitmap(_));
        assert!(!whole || mean.distance(texture.mean()) < 0.02, "{texture:?}: {mean}");
    }
}

#[test]
fn far_and_odd_positions_are_harmless() {
    for texture in examples() {
        for x in [0.0, -0.0, 1.0, -1e-9, 1e9, -3e12, 1e30, f32::MAX] {
            assert!(texture.eval(vec2(x, -x)).is_finite(), "{texture:?} at {x}");
        }
    }
}

/// The values of Mitsuba 3.9.1 at these positions for a 3 x 2 image of 0.1, 0.2, ... row by row.
const POSITIONS: [(f32, f32); 9] = [
    (1.0 / 6.0, 0.25),
    (0.5, 0.25),
    (5.0 / 6.0, 0.25),
    (1.0 / 6.0, 0.75),
    (0.3, 0.4),
    (1.1, 0.2),
    (-0.3, -0.3),
    (0.0, 0.0),
    (0.99, 0.99),
];

fn image_file(folder: &Path) -> PathBuf {
    let path = folder.join("steps.exr");
    let grey = |x, y| 0.1 * (1 + x + 3 * y) as f32;
    exr::prelude::write_rgb_file(&path, 3, 2, |x, y| (grey(x, y), grey(x, y), grey(x, y))).unwrap();
    path
}

fn check(texture: &Texture, values: &[f32]) {
    for ((u, v), value) in POSITIONS.iter().zip(values) {
        let found = texture.eval(vec2(*u, *v)).x;
        assert!((found - value).abs() < 3e-5, "{texture:?} at {u}, {v}: {found} for {value}");
    }
}

#[test]
fn bitmaps_are_read_as_mitsuba_reads_them() {
    let folder = tempfile::tempdir().unwrap();
    let path = Value::String(image_file(folder.path()).display().to_string());
    let text = |s: &str| Value::String(s.into());
    let steps = |step| Value::Transform(vec![step]);
    let scale = steps(TransformStep::Scale([2.0, 3.0, 1.0]));
    let translate = steps(TransformStep::Translate([0.25, 0.1, 0.0]));
    let rotate = steps(TransformStep::Rotate { axis: [0.0, 0.0, 1.0], angle: 30.0 });
    let rows: [(&str, Value, [f32; 9]); 9] = [
        ("format", text("variant"), [0.1, 0.2, 0.3, 0.4, 0.23, 0.17, 0.53, 0.35, 0.362]),
        ("accel", Value::Boolean(true), [0.1, 0.2, 0.3, 0.4, 0.23, 0.17, 0.53, 0.35, 0.362]),
        ("raw", Value::Boolean(false), [0.1, 0.2, 0.3, 0.4, 0.23, 0.17, 0.53, 0.35, 0.362]),
        ("filter_type", text("nearest"), [0.1, 0.2, 0.3, 0.4, 0.1, 0.1, 0.6, 0.1, 0.6]),
        ("wrap_mode", text("clamp"), [0.1, 0.2, 0.3, 0.4, 0.23, 0.3, 0.1, 0.1, 0.6]),
        ("wrap_mode", text("mirror"), [0.1, 0.2, 0.3, 0.4, 0.23, 0.3, 0.17, 0.1, 0.6]),
        ("to_uv", scale, [0.45, 0.5, 0.55, 0.15, 0.26, 0.32, 0.26, 0.35, 0.38]),
        ("to_uv", translate, [0.235, 0.335, 0.21, 0.415, 0.365, 0.185, 0.5, 0.215, 0.218]),
        ("to_uv", rotate, [0.2183, 0.27231, 0.45891, 0.57051, 0.31196, 0.57235, 0.47, 0.35, 0.22013]),
    ];
    for (name, value, values) in rows {
        let object = object("bitmap", &[("filename", path.clone()), (name, value)]);
        check(&build(&object, &Library::default(), f32::INFINITY).unwrap(), &values);
    }
    for (name, value) in [("filter_type", text("cubic")), ("data", text("x")), ("foo", text("x"))] {
        let object = object("bitmap", &[("filename", path.clone()), (name, value)]);
        assert!(build(&object, &Library::default(), f32::INFINITY).is_err(), "{name}");
    }
}

/// Of the same image, not at the edges between pixels' centres, where a slope has no value. Mitsuba 3.9.1's.
#[test]
fn bitmaps_change_as_those_of_mitsuba() {
    let folder = tempfile::tempdir().unwrap();
    let path = Value::String(image_file(folder.path()).display().to_string());
    let scale = Value::Transform(vec![TransformStep::Scale([2.0, 3.0, 1.0])]);
    let positions = [(0.3, 0.4), (1.1, 0.2), (-0.3, -0.3), (0.99, 0.99)];
    let rows: [(&str, Value, [[f32; 2]; 4]); 4] = [
        ("raw", Value::Boolean(true), [[0.3, 0.6], [-0.6, -0.6], [0.3, 0.6], [-0.6, -0.6]]),
        ("to_uv", scale, [[0.6, -1.8], [0.6, 1.8], [0.6, -1.8], [-1.2, -1.8]]),
        ("wrap_mode", Value::String("clamp".into()), [[0.3, 0.6], [0.0, 0.0], [0.0, 0.0], [0.0, 0.0]]),
        ("filter_type", Value::String("nearest".into()), [[0.0; 2]; 4]),
    ];
    for (name, value, slopes) in rows {
        let object = object("bitmap", &[("filename", path.clone()), (name, value)]);
        let texture = build(&object, &Library::default(), f32::INFINITY).unwrap();
        for ((u, v), slope) in positions.into_iter().zip(slopes) {
            let found = texture.gradient(vec2(u, v).into());
            assert!(found.distance(slope.into()) < 1e-4, "{name} at {u}, {v}: {found} for {slope:?}");
        }
    }
}

#[test]
fn checkerboards_are_those_of_mitsuba() {
    let plain = [0.4, 0.4, 0.2, 0.2, 0.4, 0.4, 0.4, 0.4, 0.4];
    check(&build(&object("checkerboard", &[]), &Library::default(), f32::INFINITY).unwrap(), &plain);
    let shift = Value::Transform(vec![TransformStep::Translate([0.25, 0.1, 0.0])]);
    let shifted = [0.4, 0.2, 0.4, 0.2, 0.2, 0.4, 0.4, 0.4, 0.4];
    check(
        &build(&object("checkerboard", &[("to_uv", shift)]), &Library::default(), f32::INFINITY).unwrap(),
        &shifted,
    );
}

#[test]
fn integer_images_are_made_linear_unless_raw() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("one.png");
    RgbImage::from_pixel(1, 1, Rgb([10, 128, 200])).save(&path).unwrap();
    let read = |raw| {
        let file = Value::String(path.display().to_string());
        let object = object("bitmap", &[("filename", file), ("raw", Value::Boolean(raw))]);
        build(&object, &Library::default(), f32::INFINITY).unwrap().eval(Vec2::splat(0.5))
    };
    // Mitsuba 3.9.1's values.
    assert!(read(false).distance(vec3(0.003_035_27, 0.215_86, 0.577_581)) < 1e-5);
    assert!(read(true).distance(vec3(10.0, 128.0, 200.0) / 255.0) < 1e-6);
}

const TABLE: Table = table! {
    "Any plugin.";
    texture("reflectance", 1.0, Is(0.5), ""),
    light_texture("radiance", "", Optional, ""),
};

#[test]
fn a_parameter_is_a_number_a_colour_or_a_texture() {
    let library = Library::default();
    let read = |value: Value| {
        let object = object("diffuse", &[("reflectance", value)]);
        parameter(&Params::new(&object, &library, &TABLE), "reflectance").map(|texture| texture.max())
    };
    assert_eq!(read(Value::Float(0.25)), Ok(Spectrum::splat(0.25)));
    assert_eq!(read(Value::Rgb([1.0, 0.5, 0.0])), Ok(vec3(1.0, 0.5, 0.0)));
    assert_eq!(read(Value::Object(object("checkerboard", &[]))), Ok(Spectrum::splat(0.4)));
    assert!(read(Value::Object(object("chequers", &[]))).is_err());
    assert!(read(Value::Float(-1.0)).is_err());
    let nothing = object("diffuse", &[]);
    let default = parameter(&Params::new(&nothing, &library, &TABLE), "reflectance").unwrap();
    assert_eq!(default.max(), Spectrum::splat(0.5));
}

#[test]
fn light_and_matter_read_spectra_differently_and_textures_hold_matter() {
    let library = Library::default();
    let ramp = || Value::Spectrum(vec![(400.0, 0.1), (700.0, 0.4)]);
    let board = || object("checkerboard", &[("color0", ramp()), ("color1", ramp())]);
    let in_d65 = object("d65", &[("", Value::Object(board()))]);
    let (matter, light) = (vec3(0.340_779, 0.242_912, 0.140_304), vec3(0.402_061, 0.231_368, 0.124_453));
    // Values of Mitsuba 3.9.1, the checkerboard's from a picture of an area light.
    let rows = [
        (ramp(), matter, light),
        (Value::Object(board()), matter, matter),
        (Value::Object(in_d65), matter, matter),
        (Value::Object(object("d65", &[])), Spectrum::ONE, Spectrum::ONE),
    ];
    for (value, as_matter, as_light) in rows {
        let texture = |name| {
            let object = object("any", &[(name, value.clone())]);
            parameter(&Params::new(&object, &library, &TABLE), name).unwrap().eval(Vec2::splat(0.2))
        };
        assert!(texture("reflectance").distance(as_matter) < 2e-6, "{value:?}");
        assert!(texture("radiance").distance(as_light) < 2e-6, "{value:?}");
    }
    let both = object("d65", &[("", Value::Object(board())), ("color", Value::Rgb([0.5; 3]))]);
    assert!(build(&both, &library, 1.0).is_err());
    let black = object("blackbody", &[("temperature", Value::Float(3000.0))]);
    assert!(build(&black, &library, 1.0).is_ok());
}

#[test]
fn files_that_are_no_images_are_errors_that_name_them() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("text.png");
    std::fs::write(&path, "no image").unwrap();
    let location = Location { file: Arc::new(folder.path().join("scene.json")), ..nowhere() };
    let mut object = object("bitmap", &[("filename", Value::String("text.png".into()))]);
    object.properties[0].location = location;
    let error = build(&object, &Library::default(), f32::INFINITY).unwrap_err();
    assert!(error.place.ends_with("text.png"), "{error}");
    object.properties[0].value = Value::String("absent.png".into());
    assert!(build(&object, &Library::default(), f32::INFINITY).is_err());
}
