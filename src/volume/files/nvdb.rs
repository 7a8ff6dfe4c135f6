//! NanoVDB's files: segments of grids, each an image of memory that may be packed. The layout is that of NanoVDB 32
//! (nanovdb/NanoVDB.h and nanovdb/util/IO.h), in which 32 refers to the layout itself.

mod image;
mod leaf;
mod tree;

use super::{
    Problem, Result, Source, blosc,
    choice::{LEVEL_SET, Label, shown},
    inflate,
    input::Input,
    value::{Value, array},
};
use crate::math::{DAffine3, DMat3, DVec3, Vec3};
use image::Image;
use leaf::Leaf;
use std::io::{Read, Seek};

/// First bytes of every segment: until version 32.5, of a memory dump since, and of a segment since.
pub(super) const MAGICS: [[u8; 8]; 3] = [*b"NanoVDB0", DUMP, *b"NanoVDB2"];

const DUMP: [u8; 8] = *b"NanoVDB1";

/// The layout that is read.
const LAYOUT: u32 = 32;

/// Length of what a segment says of a grid before its name (bytes).
const NOTES: usize = 176;

/// Grids are packed by pieces of this length before that (bytes).
const PIECE: u64 = 1 << 30;

/// Places within a grid's image (bytes): its map and the type of its values.
const MAP_MATRIX: usize = 296 + 88;
const MAP_SHIFT: usize = MAP_MATRIX + 2 * 72;
const CLASS: usize = 632;
const KIND: usize = 636;

/// Names of the first classes of grids, by number.
const CLASSES: [&str; 4] = ["", LEVEL_SET, "fog volume", "staggered"];

/// Names of the types of grids, by number.
const KINDS: [&str; 27] = [
    "unknown",
    "float",
    "double",
    "int16",
    "int32",
    "int64",
    "Vec3f",
    "Vec3d",
    "mask",
    "half",
    "uint32",
    "bool",
    "RGBA8",
    "Fp4",
    "Fp8",
    "Fp16",
    "FpN",
    "Vec4f",
    "Vec4d",
    "index",
    "on-index",
    "index mask",
    "on-index mask",
    "point index",
    "Vec3u8",
    "Vec3u16",
    "uint8",
];

/// A grid of the file.
pub(super) struct Entry {
    /// What is said of it.
    pub label: Label,
    codec: u16,
    /// Where it is.
    start: u64,
    /// Its length in the file, and that of its image (bytes).
    lengths: [u64; 2],
}

/// All grids; the input is positioned after the first magic bytes.
pub(super) fn entries<R: Read + Seek>(input: &mut Input<R>) -> Result<Vec<Entry>> {
    input.seek(0)?;
    let mut entries = vec![];
    while input.left() > 0 {
        segment(input, &mut entries)?;
    }
    Ok(entries)
}

/// Reads the grid of `entry`.
pub(super) fn source<R: Read + Seek>(input: &mut Input<R>, entry: &Entry) -> Result<Source> {
    input.seek(entry.start)?;
    grid(&entry.label, &Image::new(load(input, entry.codec, entry.lengths)?)?)
}

fn segment<R: Read + Seek>(input: &mut Input<R>, entries: &mut Vec<Entry>) -> Result<()> {
    let magic = input.array()?;
    if magic == DUMP {
        let remedy = "write the grid with nanovdb::io::writeGrid";
        return Err(Problem::new("a NanoVDB file", "a memory dump of a NanoVDB grid", remedy));
    }
    if !MAGICS.contains(&magic) {
        return Err(Problem::damage("a segment of NanoVDB", format!("\"{}\"", magic.escape_ascii())));
    }
    let version = input.u32()?;
    let [major, minor] = [version >> 21, version >> 10 & 0x7ff];
    if major != LAYOUT {
        let remedy = "convert the volume again with a NanoVDB of version 32, or give the .vdb file";
        let expected = format!("a NanoVDB file of version {LAYOUT}");
        return Err(Problem::new(expected, format!("{major}.{minor}"), remedy));
    }
    let [count, codec] = [input.array()?, input.array()?].map(u16::from_le_bytes);
    let first = entries.len();
    for _ in 0..count {
        entries.push(entry(input, codec)?);
    }
    for entry in &mut entries[first..] {
        entry.start = input.position();
        input.skip(entry.lengths[0])?;
    }
    Ok(())
}

fn entry<R: Read + Seek>(input: &mut Input<R>, codec: u16) -> Result<Entry> {
    let notes: [u8; NOTES] = input.array()?;
    let [whole, packed] = [0, 8].map(|at| u64::from_le_bytes(array(&notes, at)));
    let [kind, class, length] = [32, 36, 136].map(|at| u32::from_le_bytes(array(&notes, at)));
    let mut name = vec![];
    input.load(&mut name, length.into())?;
    let name = String::from_utf8_lossy(&name).trim_end_matches('\0').to_owned();
    let class = class_name(class).into();
    let (kind, channels) = (kind_name(kind).into(), channels(kind));
    let label = Label { name, kind, class, channels, ..Label::default() };
    Ok(Entry { label, codec, start: 0, lengths: [packed, whole] })
}

fn kind_name(kind: u32) -> &'static str {
    KINDS.get(kind as usize).unwrap_or(&KINDS[0])
}

fn class_name(class: u32) -> &'static str {
    CLASSES.get(class as usize).unwrap_or(&CLASSES[0])
}

/// Numbers to a value of a type that is read.
fn channels(kind: u32) -> Option<usize> {
    match kind {
        1 | 13..=16 => Some(f32::CHANNELS),
        6 => Some(Vec3::CHANNELS),
        _ => None,
    }
}

/// The image of a grid, which the file packs as `codec` says.
fn load<R: Read + Seek>(input: &mut Input<R>, codec: u16, [packed, whole]: [u64; 2]) -> Result<Vec<u8>> {
    let mut image = vec![];
    match codec {
        0 if packed == whole => input.load(&mut image, whole)?,
        0 => return Err(Problem::damage(format!("{whole} bytes of a grid"), packed.to_string())),
        1 => inflate::unpack(&piece(input)?, whole, &mut image)?,
        2 => unpack_pieces(input, whole, &mut image)?,
        _ => {
            let remedy = "write the file with zip or Blosc compression, or without any";
            return Err(Problem::new("codec 0, 1 or 2", codec.to_string(), remedy));
        }
    }
    Ok(image)
}

/// Packed bytes after their length.
fn piece<R: Read + Seek>(input: &mut Input<R>) -> Result<Vec<u8>> {
    let length = input.u64()?;
    let mut bytes = vec![];
    input.load(&mut bytes, length)?;
    Ok(bytes)
}

fn unpack_pieces<R: Read + Seek>(input: &mut Input<R>, whole: u64, image: &mut Vec<u8>) -> Result<()> {
    let mut plain = vec![];
    while (image.len() as u64) < whole {
        let count = PIECE.min(whole - image.len() as u64);
        blosc::unpack(&piece(input)?, count as usize, &mut plain)?;
        image.append(&mut plain);
    }
    Ok(())
}

fn grid(label: &Label, image: &Image) -> Result<Source> {
    let label = Label { class: class_name(image.u32(CLASS)?).into(), ..label.clone() };
    let name = label.name.clone();
    let to_world = to_world(image)?;
    let numbers = |leaf| Source::new(label.clone(), to_world, tree::read::<f32>(image, leaf)?);
    match image.u32(KIND)? {
        1 => numbers(Leaf::Plain),
        6 => Source::new(label, to_world, tree::read::<Vec3>(image, Leaf::Plain)?),
        13 => numbers(Leaf::Bits(4)),
        14 => numbers(Leaf::Bits(8)),
        15 => numbers(Leaf::Bits(16)),
        16 => numbers(Leaf::AnyBits),
        kind => {
            let expected = "a grid of type float, Vec3f, Fp4, Fp8, Fp16 or FpN";
            let found = format!("\"{}\" of type {}", shown(&name), kind_name(kind));
            let remedy = "name another grid with the parameter \"grid\", or convert this one to float";
            Err(Problem::new(expected, found, remedy))
        }
    }
}

/// Rows of a matrix, then a shift.
fn to_world(image: &Image) -> Result<DAffine3> {
    let vector = |at: usize| -> Result<DVec3> {
        Ok(DVec3::new(image.f64(at)?, image.f64(at + 8)?, image.f64(at + 16)?))
    };
    let rows = [vector(MAP_MATRIX)?, vector(MAP_MATRIX + 24)?, vector(MAP_MATRIX + 48)?];
    let matrix3 = DMat3::from_cols(rows[0], rows[1], rows[2]).transpose();
    Ok(DAffine3 { matrix3, translation: vector(MAP_SHIFT)? })
}
