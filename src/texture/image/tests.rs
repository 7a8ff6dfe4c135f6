//! Files written by Mitsuba 3.9.1 are read as Mitsuba reads them (its own values, with `format` `variant`).

use super::*;
use std::path::PathBuf;

fn sample(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src/texture/image/samples").join(name)
}

/// The pixels of a 2 x 2 image, channel by channel.
type Values = [[f32; 3]; 4];

const fn grey(values: [f32; 4]) -> Values {
    let [a, b, c, d] = values;
    [[a; 3], [b; 3], [c; 3], [d; 3]]
}

const LINEAR8: Values = [
    [0.003_035_27, 0.215_860_43, 0.577_580_75],
    [1.0, 0.0, 0.000_910_581],
    [0.001_517_635, 0.001_821_162, 0.002_124_689],
    [0.577_580_75, 0.644_479_93, 0.715_693_53],
];
const RAW8: Values = [
    [0.039_215_69, 0.501_960_8, 0.784_313_8],
    [1.0, 0.0, 0.011_764_707],
    [0.019_607_843, 0.023_529_414, 0.027_450_982],
    [0.784_313_8, 0.823_529_5, 0.862_745_17],
];
const FLOATS: Values = [[0.1, 1.28, 2.0], [2.55, 0.0, 0.03], [0.05, 0.06, 0.07], [2.0, 2.1, 2.2]];
const HALVES: Values = [
    [0.099_975_586, 1.280_273_4, 2.0],
    [2.550_781_3, 0.0, 0.029_998_78],
    [0.049_987_793, 0.059_997_56, 0.070_007_324],
    [2.0, 2.099_609_4, 2.199_218_8],
];

/// File, `raw`, pixels.
const FACTS: &[(&str, bool, Values)] = &[
    ("rgb8.png", false, LINEAR8),
    ("rgb8.png", true, RAW8),
    ("rgba8.png", false, LINEAR8),
    ("rgba8.png", true, RAW8),
    ("palette.png", false, LINEAR8),
    ("palette.png", true, RAW8),
    ("flat.jpg", false, [[0.003_035_27, 0.215_860_43, 0.577_580_75]; 4]),
    ("flat.jpg", true, [[0.039_215_69, 0.501_960_8, 0.784_313_8]; 4]),
    ("grey8.png", false, grey([0.003_035_27, 1.0, 0.001_517_635, 0.577_580_75])),
    ("grey16.png", false, grey([0.002_960_864_5, 0.939_388_04, 0.001_484_565_8, 0.543_095_2])),
    ("grey16.png", true, grey([0.038_254_37, 0.972_869_46, 0.019_180_59, 0.763_057_9])),
    (
        "rgb16.png",
        false,
        [
            [0.002_960_864_5, 0.203_456_91, 0.543_095_2],
            [0.939_388_04, 8.267_272e-6, 0.000_894_046_4],
            [0.001_484_565_8, 0.001_779_825_4, 0.002_075_085_2],
            [0.543_095_2, 0.605_872_63, 0.672_691_05],
        ],
    ),
    ("rgba_float.exr", false, FLOATS),
    ("rgba_float.exr", true, FLOATS),
    ("rgb_half.exr", false, HALVES),
    ("y_half.exr", false, grey([HALVES[0][0], HALVES[1][0], HALVES[2][0], HALVES[3][0]])),
    ("ya_float.exr", false, grey([0.1, 2.55, 0.05, 2.0])),
    ("y_uint.exr", false, grey([10.0, 255.0, 5.0, 200.0])),
    ("rgb_uint.exr", true, [[10.0, 128.0, 200.0], [255.0, 0.0, 3.0], [5.0, 6.0, 7.0], [200.0, 210.0, 220.0]]),
    (
        "xyz_float.exr",
        false,
        [
            [0.378_056_05, 0.562_759_9, 0.237_431_02],
            [0.200_660_53, 0.210_495_89, 0.232_608_33],
            [1.204_793_9, 0.948_291, 0.908_916_06],
            [0.623_169_1, 0.227_713_32, 0.063_995],
        ],
    ),
    (
        "rgb.hdr",
        false,
        [
            [0.093_75, 1.265_625, 2.0],
            [2.546_875, 0.0, 0.015_625],
            [0.049_804_688, 0.059_570_313, 0.069_824_22],
            [2.0, 2.093_75, 2.187_5],
        ],
    ),
];

#[test]
fn images_are_read_as_mitsuba_reads_them() {
    for (name, raw, values) in FACTS {
        let image = read(&sample(name), *raw, f32::INFINITY, &Library::default()).unwrap();
        let size = if *name == "flat.jpg" { 8 } else { 2 };
        assert_eq!((image.width, image.height), (size, size), "{name}");
        for (pixel, value) in image.pixels.iter().zip(values) {
            let value = Spectrum::from(*value);
            assert!(pixel.distance(value) <= 1e-6 * value.length(), "{name}, raw {raw}: {pixel} for {value}");
        }
    }
}

fn refused(path: &Path) -> Error {
    let error = read(path, false, f32::INFINITY, &Library::default()).unwrap_err();
    assert_eq!(error.place, path.display().to_string(), "{error}");
    error
}

#[test]
fn channels_without_a_meaning_are_refused() {
    assert!(refused(&sample("many_float.exr")).found.contains("channels"));
}

/// `name` with the bytes at the place of `mark` (plus `offset`) replaced.
fn forged(folder: &Path, name: &str, mark: &[u8], offset: usize, bytes: &[u8]) -> PathBuf {
    let mut data = std::fs::read(sample(name)).unwrap();
    let at = data.windows(mark.len()).position(|window| window == mark).unwrap() + mark.len() + offset;
    data[at..at + bytes.len()].copy_from_slice(bytes);
    let path = folder.join(name);
    std::fs::write(&path, data).unwrap();
    path
}

#[test]
fn headers_that_promise_too_much_are_refused_before_memory_is_taken() {
    let folder = tempfile::tempdir().unwrap();
    let huge = [0x00, 0x7f, 0xff, 0xff].repeat(2);
    let png = forged(folder.path(), "rgb8.png", b"IHDR", 0, &huge);
    assert!(refused(&png).expected.contains("at most"));
    // Right: the last column and row of the data window, far out.
    let window = [i32::MAX / 2, i32::MAX / 2].map(i32::to_le_bytes).concat();
    let exr = forged(folder.path(), "rgb_half.exr", b"dataWindow\0box2i\0", 12, &window);
    assert!(refused(&exr).expected.contains("at most"));
    let side = [60_000, 60_000].map(i32::to_le_bytes).concat();
    let exr = forged(folder.path(), "rgb_half.exr", b"dataWindow\0box2i\0", 12, &side);
    assert!(refused(&exr).expected.contains("at most"));
    let hdr = folder.path().join("huge.hdr");
    std::fs::write(&hdr, "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 60000 +X 60000\n").unwrap();
    assert!(refused(&hdr).expected.contains("at most"));
    let jpeg = forged(folder.path(), "flat.jpg", &[0xff, 0xc0], 3, &[0xff; 4]);
    refused(&jpeg);
}

#[test]
fn cut_files_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["rgb8.png", "rgb_half.exr", "rgb.hdr", "palette.png", "y_uint.exr"] {
        let data = std::fs::read(sample(name)).unwrap();
        let path = folder.path().join(name);
        for length in [0, 5, data.len() / 2, data.len() - 10] {
            std::fs::write(&path, &data[..length]).unwrap();
            refused(&path);
        }
    }
}

#[test]
fn pixels_that_are_no_colours_are_refused_with_their_place() {
    let folder = tempfile::tempdir().unwrap();
    for bad in [-0.5, f32::NAN, f32::INFINITY] {
        let path = folder.path().join("bad.exr");
        let pixel = |x, y| (if (x, y) == (2, 1) { bad } else { 0.5 }, 0.5f32, 0.5f32);
        ::exr::prelude::write_rgb_file(&path, 3, 2, pixel).unwrap();
        assert!(refused(&path).found.contains("column 2, row 1"));
    }
}

/// An image of 10 x 10 grey pixels of 0.5, but for the first.
fn grey_but_for(first: f32) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("almost.exr");
    let pixel = |x, y| if (x, y) == (0, 0) { (first, first, 0.5) } else { (0.5, 0.5, 0.5f32) };
    ::exr::prelude::write_rgb_file(&path, 10, 10, pixel).unwrap();
    (folder, path)
}

#[test]
fn pixels_a_hair_out_of_range_are_brought_into_it_with_one_warning() {
    for (first, most, expected) in
        [(-1e-4, f32::INFINITY, 0.0), (f32::INFINITY, f32::INFINITY, 0.5), (1.1, 1.0, 1.0)]
    {
        let (_folder, path) = grey_but_for(first);
        let mut library = Library::default();
        let image = read(&path, false, most, &library).unwrap();
        assert_eq!(image.pixels[..2], [vec3(expected, expected, 0.5), Spectrum::splat(0.5)]);
        let warnings = library.take_warnings();
        let said =
            format!("2 values are out of range and changed: the worst, {first:?}, becomes {expected:?}");
        assert!(warnings.len() == 1 && warnings[0].ends_with(&said), "{warnings:?}");
        library.is_strict = true;
        assert!(read(&path, false, most, &library).unwrap_err().found.contains("column 0, row 0"));
    }
    let (_folder, path) = grey_but_for(1.1);
    assert_eq!(read(&path, false, f32::INFINITY, &Library::default()).unwrap().pixels[0].x, 1.1);
}

/// A grey image of 3 x 2 pixels from `first` on, the number of each 1 more, whose picture is `shown`: a corner and a size.
fn windows(path: &Path, first: [i32; 2], (corner, size): ([i32; 2], [usize; 2])) {
    use ::exr::{
        image::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, write::WritableImage as _},
        math::Vec2,
        meta::{
            attribute::IntegerBounds,
            header::{ImageAttributes, LayerAttributes},
        },
    };
    let values = FlatSamples::F32((1..=6).map(|i| i as f32).collect());
    let channels = AnyChannels::sort([AnyChannel::new("Y", values)].into_iter().collect());
    let attributes =
        LayerAttributes { layer_position: Vec2(first[0], first[1]), ..LayerAttributes::default() };
    let layer = Layer::new((3, 2), attributes, Encoding::UNCOMPRESSED, channels);
    let shown = IntegerBounds::new(Vec2(corner[0], corner[1]), Vec2(size[0], size[1]));
    Image::new(ImageAttributes::new(shown), layer).write().to_file(path).unwrap();
}

#[test]
fn the_display_window_is_the_picture() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("windows.exr");
    let cases: [([i32; 2], _, &[f32]); 4] = [
        ([0, 0], ([0, 0], [3, 2]), &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]),
        ([-1, -1], ([0, 0], [2, 1]), &[5.0, 6.0]),
        ([6, 8], ([5, 8], [3, 3]), &[0.0, 1.0, 2.0, 0.0, 4.0, 5.0, 0.0, 0.0, 0.0]),
        ([100, 0], ([0, 0], [1, 2]), &[0.0, 0.0]),
    ];
    for (first, shown, expected) in cases {
        windows(&path, first, shown);
        let image = read(&path, false, f32::INFINITY, &Library::default()).unwrap();
        assert_eq!([image.width, image.height], shown.1);
        assert_eq!(image.pixels, expected.iter().map(|x| Spectrum::splat(*x)).collect::<Vec<_>>());
        let picture = crate::analysis::picture::read(&path).unwrap();
        assert_eq!(
            (picture.width, picture.height, picture.pixels),
            (image.width, image.height, image.pixels)
        );
    }
}
