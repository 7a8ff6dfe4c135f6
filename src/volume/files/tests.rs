//! Files against what the libraries that wrote them say (samples/golden.txt, made by samples/make.cpp with OpenVDB 10.0.1
//! and NanoVDB 32.4.2), and files that are cut off, damaged or of another kind.

use super::*;
use crate::volume::Samples;
use flate2::read::GzDecoder;
use std::{fs, io::Cursor};

fn folder() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src/volume/files/samples")
}

/// The bytes of a file of samples.
pub(in crate::volume) fn sample(name: &str) -> Vec<u8> {
    let file = File::open(folder().join(format!("{name}.gz"))).unwrap();
    let mut bytes = vec![];
    GzDecoder::new(file).read_to_end(&mut bytes).unwrap();
    bytes
}

fn get(bytes: &[u8], grid: Option<&str>) -> Result<Source> {
    Archive::new(Cursor::new(bytes))?.chosen(grid)?.no_surface()
}

fn names() -> impl Iterator<Item = String> {
    let files =
        fs::read_dir(folder()).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    files.filter_map(|name| name.strip_suffix(".gz").map(str::to_owned))
}

/// What golden.txt says about a grid.
struct Golden {
    file: String,
    name: String,
    channels: usize,
    map: [DVec3; 4],
    low: [i64; 3],
    high: [i64; 3],
    sum: Option<Vec<f64>>,
    at: Vec<([i64; 3], Vec<f64>)>,
}

fn goldens() -> Vec<Golden> {
    let text = fs::read_to_string(folder().join("golden.txt")).unwrap();
    text.split("grid ").skip(1).map(golden).collect()
}

fn golden(text: &str) -> Golden {
    let lines: Vec<Vec<&str>> = text.lines().map(|line| line.split_whitespace().collect()).collect();
    let all = |kind: &str| -> Vec<Vec<f64>> {
        let lines = lines.iter().skip(1).filter(|line| line[0] == kind);
        lines.map(|line| line[1..].iter().map(|number| number.parse().unwrap()).collect()).collect()
    };
    let index = |numbers: &[f64]| std::array::from_fn(|axis| numbers[axis] as i64);
    let (map, active) = (&all("map")[0], &all("box")[0]);
    let head = &lines[0];
    Golden {
        file: head[0].into(),
        name: head[1].into(),
        channels: head[2].parse().unwrap(),
        map: std::array::from_fn(|row| DVec3::from_slice(&map[3 * row..])),
        low: index(active),
        high: index(&active[3..]),
        sum: all("sum").pop(),
        at: all("at").iter().map(|numbers| (index(numbers), numbers[3..].to_vec())).collect(),
    }
}

impl Source {
    fn at(&self, index: [usize; 3]) -> Vec<f64> {
        match &self.samples {
            Field::Grey(samples) => vec![samples.at(index).into()],
            Field::Colour(samples) => samples.at(index).as_dvec3().to_array().into(),
        }
    }

    fn uniform(&self, low: [usize; 3], high: [usize; 3]) -> Option<Vec<f64>> {
        match &self.samples {
            Field::Grey(samples) => samples.uniform(low, high).map(|value| vec![value.into()]),
            Field::Colour(samples) => {
                samples.uniform(low, high).map(|value| value.as_dvec3().to_array().into())
            }
        }
    }

    fn sum(&self) -> Vec<f64> {
        let mut sum = vec![0.0; self.channels()];
        for index in indices([0; 3], self.size().map(|size| size - 1)) {
            for (sum, value) in sum.iter_mut().zip(self.at(index)) {
                *sum += value;
            }
        }
        sum
    }
}

fn indices(low: [usize; 3], high: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
    (low[0]..=high[0])
        .flat_map(move |x| (low[1]..=high[1]).flat_map(move |y| (low[2]..=high[2]).map(move |z| [x, y, z])))
}

#[test]
fn every_grid_holds_what_its_makers_say() {
    let goldens = goldens();
    assert!(goldens.len() > 30);
    for golden in goldens {
        let source = get(&sample(&golden.file), Some(&golden.name)).unwrap();
        let label = format!("{} of {}", golden.name, golden.file);
        assert_eq!(source.label.name, golden.name, "{label}");
        assert_eq!(source.channels(), golden.channels, "{label}");
        assert_eq!(source.low, golden.low.map(|i| i - 1), "{label}");
        let size = [0, 1, 2].map(|axis| (golden.high[axis] - golden.low[axis] + 3) as usize);
        assert_eq!(source.size(), size, "{label}");
        let points = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        for (point, expected) in points.into_iter().zip(golden.map) {
            let found = source.to_world.transform_point3(point);
            assert!(found.abs_diff_eq(expected, 1e-12), "{label}: {point} is at {found}, not {expected}");
        }
        for (index, expected) in &golden.at {
            let index = std::array::from_fn(|axis| (index[axis] - source.low[axis]) as usize);
            let expected: Vec<_> = expected.iter().map(|value| f64::from(*value as f32)).collect();
            assert_eq!(source.at(index), expected, "{label} at {index:?}");
        }
        if let Some(expected) = &golden.sum {
            for (found, expected) in source.sum().iter().zip(expected) {
                // Sums of doubles that are kept as floats.
                assert!(
                    (found - expected).abs() <= 1e-6 * expected.abs(),
                    "{label}: {found}, not {expected}"
                );
            }
        }
    }
}

#[test]
fn boxes_that_are_said_to_be_uniform_are() {
    for (file, grid) in [("tiles.vdb", "smoke"), ("tiles_half.vdb", "smoke"), ("tiles.nvdb", "smoke")] {
        let source = get(&sample(file), Some(grid)).unwrap();
        let last = source.size().map(|size| size - 1);
        let (mut uniform, mut varying) = (0, 0);
        for low in indices([0; 3], last.map(|i| i / 8)).map(|brick| brick.map(|i| 8 * i)) {
            let high = std::array::from_fn(|axis| (low[axis] + 8).min(last[axis]));
            match source.uniform(low, high) {
                Some(value) => {
                    uniform += 1;
                    assert!(indices(low, high).all(|index| source.at(index) == value), "{file} {low:?}");
                }
                None => varying += 1,
            }
        }
        assert!(uniform > 0 && varying > 0, "{file}: {uniform} and {varying}");
    }
    let far = get(&sample("far.vdb"), None).unwrap();
    let inside = [5000, 100_000 + 50, 4096 + 50];
    assert_eq!(far.low, [-4097, -100_001, 4]);
    assert_eq!(far.uniform([1000, 100_100, 4200], [1040, 100_120, 4210]), Some(vec![1.5]));
    assert_eq!(far.uniform(inside, inside.map(|i| i + 9)), Some(vec![0.0]));
    assert_eq!(far.uniform([0; 3], far.size().map(|size| size - 1)), None, "that would be to look at all");
}

#[test]
fn plain_nanovdb_files_are_the_unpacked_ones() {
    let [plain, packed] = ["none.nvdb", "zip.nvdb"].map(|name| get(&sample(name), None).unwrap());
    assert_eq!(plain.sum(), packed.sum());
}

#[test]
fn a_grid_without_active_voxels_is_empty_if_it_can_be() {
    let empty = get(&sample("empty.vdb"), None).unwrap();
    assert_eq!(empty.sum(), [0.0]);
    let problem = get(&sample("everywhere.vdb"), None).unwrap_err();
    assert_eq!(problem.expected, "a grid with active voxels");
}

#[track_caller]
fn refused(file: &str, grid: Option<&str>, found: &str, remedy: &str) {
    let problem = get(&sample(file), grid).unwrap_err();
    assert!(problem.found.contains(found), "{problem:?}");
    assert!(problem.remedy.contains(remedy), "{problem:?}");
    assert!(!problem.expected.is_empty(), "{problem:?}");
}

#[test]
fn the_density_or_the_only_grid_is_meant_if_none_is_named() {
    assert_eq!(get(&sample("zip.vdb"), None).unwrap().label.name, "density");
    assert_eq!(get(&sample("tiles.nvdb"), None).unwrap().label.name, "smoke");
    assert_eq!(get(&sample("several.vdb"), Some("flame")).unwrap().label.name, "flame[0]");
    let list = "\"Cd\" (Tree_vec3s_5_4_3), \"color\" (Tree_vec3s_5_4_3 as half)";
    refused("several.vdb", None, list, "\"grid\"");
    refused("several.nvdb", None, "\"Cd\" (Vec3f), \"ids\" (int32)", "\"grid\"");
    refused("several.vdb", Some("temperatur"), "\"temperatur\"", "did you mean \"temperature\"?");
}

#[test]
fn what_is_no_density_is_refused_with_a_way_out() {
    refused("several.vdb", Some("ids"), "\"ids\" of type Tree_int32_5_4_3", "convert this one to float");
    refused("several.vdb", Some("inside"), "\"inside\" of type Tree_bool_5_4_3", "convert this one");
    refused("several.nvdb", Some("ids"), "\"ids\" of type int32", "convert this one");
    refused("levelset.vdb", None, "a level set", "fog volume");
    refused("levelset.nvdb", None, "a level set", "fog volume");
    refused("frustum.vdb", None, "NonlinearFrustumMap", "resample");
    refused("stream.vdb", None, "a stream", "write it again as a file");
}

#[test]
fn other_files_and_versions_are_told_apart() {
    for bytes in [&b""[..], b"VDB", b"\x89PNG\r\n\x1a\n and more"] {
        assert!(get(bytes, None).is_err());
    }
    let mut old = sample("empty.vdb");
    old[8] = 221;
    assert_eq!(get(&old, None).unwrap_err().expected, "OpenVDB file version 222 to 224");
    let mut young = sample("far.nvdb");
    young[8..12].copy_from_slice(&(33_u32 << 21).to_le_bytes());
    assert_eq!(get(&young, None).unwrap_err().found, "33.0");
    let mut dump = sample("far.nvdb");
    dump[7] = b'1';
    assert_eq!(get(&dump, None).unwrap_err().found, "a memory dump of a NanoVDB grid");
    // Version 32.6 changed but the first word.
    let mut segment = sample("far.nvdb");
    segment[7] = b'2';
    assert!(get(&segment, None).is_ok());
    assert!(open(&folder().join("none such.vdb"), None).is_err());
}

#[test]
fn a_file_that_is_cut_off_anywhere_is_refused() {
    for file in ["far.vdb", "tiles_half.vdb", "far.nvdb", "fpn.nvdb", "empty.vdb", "dense.vdb"] {
        let whole = sample(file);
        for length in 0..whole.len() {
            assert!(get(&whole[..length], None).is_err(), "{file} of {length} bytes");
        }
    }
}

/// Wrong bytes may mean something else; they must not end in a panic, nor take for ever.
#[test]
fn damaged_files_end_in_a_value_or_a_problem() {
    for file in names() {
        let whole = sample(&file);
        let mut state = 1_u64;
        for _ in 0..60 {
            let mut bytes = whole.clone();
            for _ in 0..4 {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                // Headers are damaged as often as all the rest.
                let reach = if state & 1 == 0 { bytes.len() } else { bytes.len().min(900) };
                bytes[(state >> 33) as usize % reach] = (state >> 25) as u8;
            }
            for grid in [None, Some("density"), Some("smoke"), Some("Cd")] {
                drop(get(&bytes, grid));
            }
        }
    }
}

#[test]
fn a_tree_whose_nodes_are_shared_without_end_is_refused() {
    // Every child of the first node below the root is made the same one.
    let mut bytes = vec![];
    let packed = sample("zip.nvdb");
    let name = packed.iter().skip(16 + 176).position(|byte| *byte == 0).unwrap();
    let start = 16 + 176 + name + 1;
    inflate::unpack(&packed[start + 8..], u64::from_le_bytes(value::array(&packed, 16)), &mut bytes).unwrap();
    let upper = 672 + 64 + 64 + 2 * 32;
    let table = upper + 8256;
    let masks = upper + 32 + 4096;
    let first = (0..32768).find(|n| sparse::is_set(&bytes[masks..], *n)).unwrap();
    let child: [u8; 8] = value::array(&bytes, table + 8 * first);
    bytes[masks..masks + 4096].fill(255);
    bytes[table..table + 8 * 32768].as_chunks_mut().0.fill(child);
    let mut file = packed[..start].to_vec();
    file[14] = 0;
    file[16 + 8..16 + 16].copy_from_slice(&(bytes.len() as u64).to_le_bytes());
    file.extend(&bytes);
    let problem = get(&file, None).unwrap_err();
    assert_eq!(problem.found, "more than fit");
}

/// A frame of Blosc: its flags, how many bytes it holds, and what follows the header.
fn frame(flags: u8, count: u32, rest: &[u8]) -> Vec<u8> {
    let mut bytes = vec![2, 1, flags, 4];
    for number in [count, count, 16 + rest.len() as u32] {
        bytes.extend(number.to_le_bytes());
    }
    bytes.extend(rest);
    bytes
}

#[test]
fn blosc_frames_hold_what_they_say_or_are_refused() {
    let mut out = vec![];
    let stored = frame(0b10, 6, b"clouds");
    blosc::unpack(&stored, 6, &mut out).unwrap();
    assert_eq!(out, b"clouds");
    // A block at byte 20 in one piece of 8 bytes, whose bytes are put together by significance; the last two remain.
    let shuffled = frame(0b11_0001, 10, b"\x14\0\0\0\x0a\0\0\0aAbBcCdDxy");
    blosc::unpack(&shuffled, 10, &mut out).unwrap();
    assert_eq!(out, b"abcdABCDxy");
    assert!(blosc::unpack(&stored, 7, &mut out).is_err());
    assert!(blosc::unpack(&stored[..20], 6, &mut out).is_err());
    assert!(blosc::unpack(&shuffled[..33], 10, &mut out).is_err());
    let zstandard = blosc::unpack(&frame(4 << 5, 6, b"clouds"), 6, &mut out).unwrap_err();
    assert_eq!(zstandard.found, "Zstandard");
    let bits = blosc::unpack(&frame(0b10_0100, 6, b"clouds"), 6, &mut out).unwrap_err();
    assert_eq!(bits.found, "LZ4 with shuffled bits");
}
