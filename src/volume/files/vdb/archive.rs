//! What an OpenVDB file says of itself: its version, its grids, and what is noted of these.

use super::super::{Problem, Result, choice::Label, input::Input};
use std::io::{Read, Seek};

/// File versions that are read: from the first whose nodes leave out inactive values on.
const VERSIONS: std::ops::RangeInclusive<u32> = 222..=224;

/// Separates a name from its number where several grids have the same name.
const SEPARATOR: char = '\x1e';

/// Ends the type of a grid whose numbers are saved as half.
const HALF: &str = "_HalfFloat";

/// Length of a file's identifier (bytes).
const IDENTIFIER: u64 = 36;

/// A row of the table of grids.
pub(crate) struct Entry {
    /// Name with its number, as the file has it.
    name: String,
    /// Name of the grid whose tree this one shares; empty if none.
    parent: String,
    /// Type of the tree.
    pub kind: String,
    /// True if numbers are saved as half.
    pub half: bool,
    /// True if the file says that Blender wrote it.
    of_blender: bool,
    /// Offset of its metadata.
    pub grid: u64,
    /// Offset of its blocks of values.
    pub blocks: u64,
}

impl Entry {
    /// The name as users give it, and the type.
    pub(crate) fn label(&self) -> Label {
        let name = match self.name.split_once(SEPARATOR) {
            Some((name, number)) => format!("{name}[{number}]"),
            None => self.name.clone(),
        };
        let half = if self.half { " as half" } else { "" };
        Label { name, kind: format!("{}{half}", self.kind), is_z_up: self.of_blender, ..Label::default() }
    }
}

/// Reads the table of grids; the input is positioned after the magic bytes.
pub(crate) fn read<R: Read + Seek>(input: &mut Input<R>) -> Result<Vec<Entry>> {
    let version = input.u32()?;
    if !VERSIONS.contains(&version) {
        let expected = format!("OpenVDB file version {} to {}", VERSIONS.start(), VERSIONS.end());
        let remedy = "save the file with another version of OpenVDB";
        return Err(Problem::new(expected, version.to_string(), remedy));
    }
    // The library's version, of two numbers.
    input.skip(8)?;
    if input.array::<1>()? == [0] {
        let found = "one written as a stream, without";
        let remedy = "open the file with OpenVDB and write it again as a file, not as a stream";
        return Err(Problem::new("an OpenVDB file with a table of its grids", found, remedy));
    }
    input.skip(IDENTIFIER)?;
    let of_blender = Metadata::read(input)?.of_blender;
    (0..input.u32()?).map(|_| Ok(Entry { of_blender, ..entry(input)? })).collect()
}

fn entry<R: Read + Seek>(input: &mut Input<R>) -> Result<Entry> {
    let (name, kind, parent) = (input.text()?, input.text()?, input.text()?);
    let (grid, blocks, end) = (input.u64()?, input.u64()?, input.u64()?);
    // The next row follows the grid. Were it before, there might be no end of rows.
    if end < input.position() {
        let expected = format!("a grid that ends after byte {}", input.position());
        return Err(Problem::damage(expected, format!("one that ends at byte {end}")));
    }
    input.seek(end)?;
    let (kind, half) = match kind.strip_suffix(HALF) {
        Some(kind) => (kind.into(), true),
        None => (kind, false),
    };
    Ok(Entry { name, parent, kind, half, of_blender: false, grid, blocks })
}

/// The entry whose tree `entry` shares, if it has none of its own.
pub(super) fn parent<'a>(entries: &'a [Entry], entry: &Entry) -> Result<Option<&'a Entry>> {
    if entry.parent.is_empty() {
        return Ok(None);
    }
    let is_parent = |other: &&Entry| other.name == entry.parent && other.kind == entry.kind;
    let found = entries.iter().find(is_parent).filter(|other| other.parent.is_empty());
    found.map(Some).ok_or_else(|| Problem::damage("the grid whose tree another shares", "none"))
}

/// Who Blender is, as the `creator` of files; and what only its fluids note of grids.
const BLENDER: &str = "Blender";
const FLUIDS: &str = "file_base_resolution";

/// What is noted of a grid or a file, as far as it matters here.
#[derive(Default)]
pub(super) struct Metadata {
    /// What the values are meant for.
    pub class: String,
    /// True if numbers are saved as half.
    pub half: bool,
    /// True if Blender wrote it.
    pub of_blender: bool,
    /// True if its fluids did.
    pub of_fluids: bool,
}

impl Metadata {
    /// Reads all of a grid's notes, or a file's.
    pub(super) fn read<R: Read + Seek>(input: &mut Input<R>) -> Result<Self> {
        let mut metadata = Self::default();
        for _ in 0..input.u32()? {
            let (name, kind) = (input.text()?, input.text()?);
            metadata.of_fluids |= name == FLUIDS;
            match (name.as_str(), kind.as_str()) {
                ("class", "string") => metadata.class = input.text()?,
                ("creator", "string") => metadata.of_blender |= input.text()?.starts_with(BLENDER),
                ("is_saved_as_half_float", "bool") => {
                    let length = input.u32()?;
                    let mut bytes = vec![];
                    input.load(&mut bytes, length.into())?;
                    metadata.half = bytes.iter().any(|byte| *byte != 0);
                }
                _ => {
                    let length = input.u32()?;
                    input.skip(length.into())?;
                }
            }
        }
        Ok(metadata)
    }
}
