//! OpenVDB's files: a header, a table of grids, and each grid's metadata, map and tree. The layout is that which the
//! sources of OpenVDB 10 (openvdb/io, openvdb/tree, openvdb/math/Maps.h) write and read.

mod archive;
mod map;
mod tree;
mod values;

use super::{
    Result, Source,
    choice::{Label, shown},
    input::Input,
    problem::Problem,
    value::{Format, Value},
};
use crate::math::Vec3;
use archive::Metadata;
pub(super) use archive::{Entry, read as entries};
use std::io::{Read, Seek};
use values::Coding;

/// First bytes of every file.
pub(super) const MAGIC: [u8; 8] = *b" BDV\0\0\0\0";

/// What the file says of the grid of `entry`; of no class where its notes are damaged.
pub(super) fn label<R: Read + Seek>(input: &mut Input<R>, entry: &Entry) -> Label {
    let mut notes = || {
        input.seek(entry.grid)?;
        input.u32()?;
        Metadata::read(input)
    };
    let Metadata { class, of_blender, of_fluids, .. } = notes().unwrap_or_default();
    let label = entry.label();
    let channels = numbers(entry).ok().map(|(_, channels)| channels);
    let is_z_up = label.is_z_up || of_blender || of_fluids;
    Label { class, channels, is_z_up, is_of_fluids: of_fluids, ..label }
}

/// Reads the grid of `entry`, one of `entries`.
pub(super) fn source<R: Read + Seek>(
    input: &mut Input<R>,
    entries: &[Entry],
    entry: &Entry,
) -> Result<Source> {
    let (format, channels) = numbers(entry)?;
    input.seek(entry.grid)?;
    let mut packing = input.u32()?;
    let metadata = Metadata::read(input)?;
    let to_world = map::read(input)?;
    let mut half = metadata.half || entry.half;
    let mut start = entry.blocks;
    if let Some(parent) = archive::parent(entries, entry)? {
        // A grid that shares the tree of another has only a map of its own.
        input.seek(parent.grid)?;
        packing = input.u32()?;
        half = Metadata::read(input)?.half || parent.half;
        map::read(input)?;
        start = parent.blocks;
    }
    let coding = Coding::new(packing, half, format)?;
    let label = Label { class: metadata.class, channels: Some(channels), ..entry.label() };
    if channels == f32::CHANNELS {
        Source::new(label, to_world, tree::read::<f32, R>(input, coding, start)?)
    } else {
        Source::new(label, to_world, tree::read::<Vec3, R>(input, coding, start)?)
    }
}

/// How an entry's numbers are written, and how many make a value.
fn numbers(entry: &Entry) -> Result<(Format, usize)> {
    match entry.kind.as_str() {
        "Tree_float_5_4_3" => Ok((Format::Float, f32::CHANNELS)),
        "Tree_double_5_4_3" => Ok((Format::Double, f32::CHANNELS)),
        "Tree_vec3s_5_4_3" => Ok((Format::Float, Vec3::CHANNELS)),
        "Tree_vec3d_5_4_3" => Ok((Format::Double, Vec3::CHANNELS)),
        kind => {
            let expected = "a grid of type float, double, vec3s or vec3d, in a tree of shape 5-4-3";
            let found = format!("\"{}\" of type {}", shown(&entry.label().name), shown(kind));
            let remedy = if kind.contains("ptdata") || kind.contains("ptidx") {
                "make a fog volume of the points (in Houdini \"VDB from Particles\", in Blender \"Points to Volume\")"
            } else {
                "name another grid with the parameter \"grid\", or convert this one to float"
            };
            Err(Problem::new(expected, found, remedy))
        }
    }
}
