//! Files: what Mitsuba 3.9.1 makes of them, and what is wrong with them.

use super::*;
use crate::{
    description::{Library, TransformStep, Value},
    testing::object,
    volume::{self, Volume},
};
use std::fs;

/// 4 x 3 x 2 voxels.
const NUMBERS: [f32; 24] = [
    0.51, 0.95, 0.14, 0.95, 0.31, 0.42, 0.83, 0.41, 0.55, 0.03, 0.75, 0.54, 0.33, 0.79, 0.3, 0.45, 0.13, 0.4,
    0.2, 0.26, 0.75, 0.28, 0.49, 0.98,
];

/// 2 x 2 x 2 voxels of three channels.
const COLOURS: [f32; 24] = [
    0.96, 0.72, 0.54, 0.28, 0.16, 0.97, 0.52, 0.12, 0.62, 0.78, 0.61, 0.92, 0.04, 0.53, 0.46, 0.06, 0.64,
    0.85, 0.59, 0.26, 0.84, 0.51, 0.51, 0.75,
];

/// The bytes of a file.
fn vol(size: [i32; 4], bounds: [f32; 6], values: &[f32]) -> Vec<u8> {
    let mut bytes = b"VOL\x03".to_vec();
    bytes.extend([1].iter().chain(&size).flat_map(|n| n.to_le_bytes()));
    bytes.extend(bounds.iter().chain(values).flat_map(|x| x.to_le_bytes()));
    bytes
}

const UNIT: [f32; 6] = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0];

/// Builds the volume of a file with these bytes.
fn build(bytes: &[u8], properties: &[(&str, Value)]) -> Result<Volume> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("grid.vol");
    fs::write(&path, bytes).unwrap();
    let mut all = vec![("filename", Value::String(path.display().to_string()))];
    all.extend_from_slice(properties);
    let place = Place::new(DVec3::ZERO, 0.0);
    volume::build(&object("gridvolume", &all), &Library::default(), &place)
}

fn text(word: &str) -> Value {
    Value::String(word.into())
}

#[track_caller]
fn check(volume: &Volume, positions: &[[f32; 3]], values: &[[f32; 3]]) {
    for (position, value) in positions.iter().zip(values) {
        let found: Spectrum = volume.eval(Vec3::from_array(*position));
        let off = (found - Vec3::from_array(*value)).abs().max_element();
        assert!(off < 4e-6, "{position:?}: {found} for {value:?}");
    }
}

#[test]
fn filters_and_wrap_modes_are_those_of_mitsuba() {
    let positions = [
        [0.5, 0.5, 0.5],
        [0.3, 0.6, 0.4],
        [0.05, 0.02, 0.9],
        [1.2, 0.5, 0.5],
        [-0.1, 1.3, 2.6],
        [-3.3, -2.2, 7.7],
        [0.125, 1.0 / 6.0, 0.25],
        [1.0, 1.0, 1.0],
        [0.0, 0.0, 0.0],
    ];
    let rows = [
        ("clamp", "trilinear", [0.4625, 0.3335699, 0.33, 0.335, 0.75, 0.33, 0.51, 0.98, 0.51]),
        ("clamp", "nearest", [0.2, 0.42, 0.33, 0.26, 0.75, 0.33, 0.51, 0.98, 0.51]),
        (
            "repeat",
            "trilinear",
            [0.4625, 0.3335699, 0.575784, 0.277, 0.4642001, 0.60446, 0.51, 0.6325, 0.6325],
        ),
        ("repeat", "nearest", [0.2, 0.42, 0.33, 0.13, 0.45, 0.49, 0.51, 0.51, 0.51]),
        ("mirror", "trilinear", [0.4625, 0.3335699, 0.33, 0.389, 0.4876001, 0.4068202, 0.51, 0.98, 0.51]),
        ("mirror", "nearest", [0.2, 0.42, 0.33, 0.26, 0.75, 0.14, 0.51, 0.98, 0.51]),
    ];
    for (wrap, filter, values) in rows {
        let properties = [("wrap_mode", text(wrap)), ("filter_type", text(filter))];
        let volume = build(&vol([4, 3, 2, 1], UNIT, &NUMBERS), &properties).unwrap();
        assert!(volume.is_grey());
        check(&volume, &positions, &values.map(|x| [x; 3]));
    }
}

#[test]
fn placed_colours_are_those_of_mitsuba() {
    let steps = vec![
        TransformStep::Scale([1.0, 2.0, -3.0]),
        TransformStep::Rotate { axis: [0.0, 1.0, 0.0], angle: 30.0 },
        TransformStep::Translate([1.0, 2.0, 3.0]),
    ];
    let positions = [[0.4, 0.3, 0.6], [0.5, 2.5, 2.0], [-7.0, 3.0, 9.0]];
    let rows = [
        ("clamp", [[0.0572154, 0.624685, 0.7957], [0.735504, 0.673637, 0.520479], [0.74, 0.42, 0.58]]),
        (
            "repeat",
            [[0.175564, 0.569432, 0.798888], [0.549129, 0.528505, 0.674297], [0.411636, 0.443797, 0.705432]],
        ),
        (
            "mirror",
            [[0.521138, 0.475192, 0.762531], [0.735504, 0.673637, 0.520479], [0.61359, 0.412564, 0.60082]],
        ),
    ];
    for (wrap, values) in rows {
        for raw in [false, true] {
            let properties = [
                ("wrap_mode", text(wrap)),
                ("raw", Value::Boolean(raw)),
                ("accel", Value::Boolean(false)),
                ("to_world", Value::Transform(steps.clone())),
            ];
            let volume = build(&vol([2, 2, 2, 3], UNIT, &COLOURS), &properties).unwrap();
            assert!(!volume.is_grey());
            check(&volume, &positions, &values);
            let [low, high] = volume.domain().unwrap();
            assert!(low.distance(vec3(-0.5, 2.0, -0.0980761)) < 1e-6, "{low}");
            assert!(high.distance(vec3(1.86603, 4.0, 3.0)) < 1e-5, "{high}");
        }
    }
}

#[test]
fn the_box_in_the_file_counts_where_asked_for() {
    let bytes = vol([4, 3, 2, 1], [-1.0, 0.0, 2.0, 3.0, 1.0, 8.0], &NUMBERS);
    let positions = [[0.1, 0.2, 0.3], [1.0, 0.5, 4.0], [2.0, 2.5, 12.0]];
    let steps = vec![TransformStep::Scale([2.0; 3]), TransformStep::Translate([1.0, 2.0, 3.0])];
    let rows = [
        (false, false, [0.472, 0.26, 0.98]),
        (true, false, [0.7342, 0.570833, 0.735]),
        (false, true, [0.51, 0.42, 0.48375]),
        (true, true, [0.532, 0.73, 0.775833]),
    ];
    for (uses_box, is_placed, values) in rows {
        let mut properties = vec![("use_grid_bbox", Value::Boolean(uses_box))];
        properties.extend(is_placed.then(|| ("to_world", Value::Transform(steps.clone()))));
        check(&build(&bytes, &properties).unwrap(), &positions, &values.map(|x| [x; 3]));
    }
}

/// In Mitsuba the box that counts is that around the turned cube (its medium's `intersect_aabb`), and a render through
/// it shows the transmittance of its chord, 0.2438 +- 0.001.
#[test]
fn the_box_around_a_turned_cube_counts_as_in_mitsuba() {
    let turn = TransformStep::Rotate { axis: [0.0, 0.0, 1.0], angle: 45.0 };
    let properties = [("to_world", Value::Transform(vec![turn]))];
    let volume = build(&vol([2, 2, 2, 1], UNIT, &[1.0; 8]), &properties).unwrap();
    let segment = RaySegment { origin: vec3(-2.0, 0.1, 0.5), direction: Vec3::X, length: 9.0 };
    let depth: f32 = volume.integral(&segment);
    assert!((depth - (2.707_106_6 - 1.292_893)).abs() < 1e-5, "{depth}");
    let reached = match &volume {
        Volume::Grid(grid) => grid.invert::<f32>(&segment, 1.0, 0, 0.5),
        _ => unreachable!(),
    };
    assert!(matches!(reached, Reached::Within { t, .. } if (t - 1.792_893).abs() < 1e-5), "{reached:?}");
    assert!(volume.contains(vec3(-0.7, 0.01, 0.5)) && volume.contains(vec3(0.7, 1.4, 0.5)));
    assert!(!volume.contains(vec3(-0.71, 0.1, 0.5)));
}

/// The bytes with those from `at` on replaced.
fn patched(at: usize, with: &[u8]) -> Vec<u8> {
    let mut bytes = vol([4, 3, 2, 1], UNIT, &NUMBERS);
    bytes[at..at + with.len()].copy_from_slice(with);
    bytes
}

#[test]
fn what_is_wrong_with_a_file_is_told() {
    let whole = vol([4, 3, 2, 1], UNIT, &NUMBERS);
    let longer: Vec<u8> = whole.iter().copied().chain([0; 4]).collect();
    let huge = |n: i32| patched(8, &[n.to_le_bytes(); 3].concat());
    let voxel = |x: f32| patched(48 + 4 * (2 + 4 * (1 + 3)), &x.to_le_bytes());
    let mut blue = COLOURS;
    blue[5 * 3 + 2] = f32::NEG_INFINITY;
    let rows: Vec<(Vec<u8>, &str, &str)> = vec![
        (whole[..140].to_vec(), "144 bytes, for 4 x 3 x 2 voxels of 1 channel", "140 bytes"),
        (longer, "144 bytes", "148 bytes"),
        (whole[..20].to_vec(), "a header of 48 bytes", "20 bytes"),
        (vec![], "a header of 48 bytes", "0 bytes"),
        (patched(0, b"V0L"), "\"VOL\" as the first three bytes", "\"V0L\""),
        (patched(0, b"\xff\x00\n"), "\"VOL\"", "\"\\xff\\x00\\n\""),
        (patched(3, &[2]), "version 3", "version 2"),
        (patched(4, &3i32.to_le_bytes()), "type 1", "type 3"),
        (patched(12, &0i32.to_le_bytes()), "at least one voxel", "4 x 0 x 2"),
        (patched(16, &(-2i32).to_le_bytes()), "at least one voxel", "4 x 3 x -2"),
        (vol([2, 1, 2, 6], UNIT, &NUMBERS), "1 or 3 channels", "6 channels"),
        (vol([3, 2, 2, 2], UNIT, &NUMBERS), "1 or 3 channels", "2 channels"),
        (huge(i32::MAX), "more than 2^64 bytes", "144 bytes"),
        (huge(1 << 10), "4294967344 bytes", "144 bytes"),
        (voxel(f32::NAN), "finite numbers >= 0", "NaN in channel 0 of the voxel (2, 1, 1)"),
        (voxel(-0.5), "finite numbers >= 0", "-0.5 in channel 0 of the voxel (2, 1, 1)"),
        (voxel(f32::INFINITY), "finite numbers >= 0", "inf in channel 0 of the voxel (2, 1, 1)"),
        (vol([2, 2, 2, 3], UNIT, &blue), "finite numbers >= 0", "-inf in channel 2 of the voxel (1, 0, 1)"),
    ];
    for (bytes, expected, found) in rows {
        let error = build(&bytes, &[]).unwrap_err();
        assert!(error.place.ends_with("grid.vol"), "{error}");
        assert!(error.expected.contains(expected) && error.found.contains(found), "{error}");
        assert!(!error.remedy.is_empty());
    }
}

#[test]
fn a_box_without_a_volume_is_an_error_only_where_it_counts() {
    for bounds in [[0.0, 0.0, 0.0, 1.0, 0.0, 1.0], [0.0, 0.0, 0.0, f32::NAN, 1.0, 1.0]] {
        let bytes = vol([4, 3, 2, 1], bounds, &NUMBERS);
        assert!(build(&bytes, &[]).is_ok());
        let error = build(&bytes, &[("use_grid_bbox", Value::Boolean(true))]).unwrap_err();
        assert!(error.expected.contains("bounding box") && error.remedy.contains("use_grid_bbox"), "{error}");
    }
}

#[test]
fn parameters_that_make_no_sense_are_errors() {
    let bytes = vol([4, 3, 2, 1], UNIT, &NUMBERS);
    let rows = [
        ("filter_type", text("cubic")),
        ("wrap_mode", text("zero")),
        ("raw", text("yes")),
        ("grid", text("x")),
        ("data", text("x")),
        ("bogus", Value::Float(1.0)),
        ("to_world", Value::Transform(vec![TransformStep::Scale([1.0, 0.0, 1.0])])),
    ];
    for row in rows {
        assert!(build(&bytes, std::slice::from_ref(&row)).is_err(), "{row:?}");
    }
    let place = Place::new(DVec3::ZERO, 0.0);
    let missing = object("gridvolume", &[("filename", text("/nowhere/grid.vol"))]);
    for lost in [missing, object("gridvolume", &[])] {
        assert!(volume::build(&lost, &Library::default(), &place).is_err());
    }
}

#[test]
fn numbers_become_the_light_of_their_temperature() {
    let ramp = [("temperature_scale", Value::Float(1000.0)), ("temperature_offset", Value::Float(500.0))];
    let mut properties = vec![("convert", text("blackbody")), ("filter_type", text("nearest"))];
    properties.extend(ramp);
    let mut numbers = NUMBERS;
    // Nothing, less than nothing, and what is left of nothing: no fire, whatever the offset.
    numbers[..3].copy_from_slice(&[0.0, -0.2, 0.009]);
    let volume = build(&vol([4, 3, 2, 1], UNIT, &numbers), &properties).unwrap();
    for (index, number) in numbers.iter().enumerate() {
        let at = [index % 4, index / 4 % 3, index / 12];
        let position = Vec3::from_array([0, 1, 2].map(|i| (at[i] as f32 + 0.5) / [4.0, 3.0, 2.0][i]));
        let expected = match index {
            0..3 => Spectrum::ZERO,
            _ => crate::math::black_body::radiance(500.0 + 1000.0 * number),
        };
        let found: Spectrum = volume.eval(position);
        assert!(
            (found - expected).abs().max_element() <= 1e-5 * expected.max_element(),
            "{number}: {found} {expected}"
        );
    }
    numbers[5] = f32::NAN;
    let error = build(&vol([4, 3, 2, 1], UNIT, &numbers), &properties).unwrap_err();
    assert!(error.found.contains("NaN"), "{error}");
}

#[test]
fn what_cannot_be_converted_is_told() {
    let convert = |word| [("convert", text(word))];
    let colours = build(&vol([2, 2, 2, 3], UNIT, &COLOURS), &convert("blackbody")).unwrap_err();
    assert!(colours.expected.contains("one number per voxel"), "{colours}");
    let plain = build(&vol([4, 3, 2, 1], UNIT, &NUMBERS), &convert("fog")).unwrap_err();
    assert!(plain.expected.contains("a level set"), "{plain}");
    let unknown = build(&vol([4, 3, 2, 1], UNIT, &NUMBERS), &convert("fogg")).unwrap_err();
    assert!(unknown.remedy.contains("did you mean \"fog\""), "{unknown}");
}

/// The volume of a file of 10 x 10 x 10 numbers, the first as given and the others 0.5, and what is said of it.
fn almost(first: &[f32], most: f32, is_strict: bool) -> (Result<Volume>, Vec<String>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("grid.vol");
    let mut numbers = [0.5; 1000];
    numbers[..first.len()].copy_from_slice(first);
    fs::write(&path, vol([10, 10, 10, 1], UNIT, &numbers)).unwrap();
    let mut library = Library::default();
    library.is_strict = is_strict;
    let place = Place::new(DVec3::ZERO, 0.0).up_to(most);
    let grid = object("gridvolume", &[("filename", Value::String(path.display().to_string()))]);
    (volume::build(&grid, &library, &place), library.take_warnings())
}

#[test]
fn voxels_a_hair_out_of_range_are_brought_into_it_with_one_warning() {
    let corner = Vec3::splat(0.05);
    for (first, most, expected) in
        [(-8e-24, f32::INFINITY, 0.0), (f32::INFINITY, f32::INFINITY, 0.5), (1.2, 1.0, 1.0)]
    {
        let (volume, warnings) = almost(&[first], most, false);
        assert!((volume.unwrap().eval::<Spectrum>(corner).x - expected).abs() < 1e-6);
        let said = format!("1 value is out of range and changed: the worst, {first:?}, becomes {expected:?}");
        assert!(warnings.len() == 1 && warnings[0].ends_with(&said), "{warnings:?}");
        let (strict, _) = almost(&[first], most, true);
        assert!(strict.unwrap_err().found.contains("channel 0 of the voxel (0, 0, 0)"));
    }
    assert!(almost(&[1.2], f32::INFINITY, true).0.is_ok(), "no share of anything");
    let error = almost(&[-0.5; 20], f32::INFINITY, false).0.unwrap_err();
    assert!(error.found.ends_with("and 19 other values out of range"), "{error}");
}
