//! `serialized`: Mitsuba's compressed meshes, one or more to a file, in the layout that Mitsuba's documentation of the
//! plugin gives. No count is trusted until the stream has yielded the numbers.

use super::{
    mesh::{FACE_NORMALS, Mesh, MeshData},
    model::COMMON,
};
use crate::{
    description::{Params, Table, table},
    error::{Error, Result},
    math::{DMat4, DVec3, Vec2},
};
use flate2::bufread::ZlibDecoder;
use std::{
    fs::File,
    io::{self, BufReader, Read, Seek, SeekFrom},
    path::Path,
};

/// Its parameters.
pub(super) const TABLE: Table = table! {
    "A mesh from a file in Mitsuba's compressed format (.serialized).";
    file("filename", "The file."),
    integer("shape_index", within(0.0, u32::MAX as f64), Is(0.0), "Index of the mesh in the file, from 0.");
    FACE_NORMALS, COMMON
};

pub(super) fn build(params: &Params<'_>, world: DMat4) -> Result<Mesh> {
    let file = params.file("filename")?;
    let index = params.integer("shape_index")? as u32;
    let source = File::open(&file).map_err(|e| Error::io(&file, "read", &e))?;
    let mut container = Container::open(BufReader::new(source)).map_err(|fault| fault.at(&file))?;
    container.seek(index).map_err(|fault| fault.at(&file))?;
    let length = container.source.get_ref().metadata().map_err(|e| Error::io(&file, "read", &e))?.len();
    MeshData::check_memory(&file, length, MEMORY_PER_BYTE)?;
    let (data, has_colors) = container.read().map_err(|fault| fault.at(&file))?;
    if has_colors {
        let text = format!("{}: its vertex colours are not used", file.display());
        params.library.warn(params.location(), &text);
    }
    Mesh::build(params, world, &file, data)
}

/// What a compressed byte becomes in most meshes; for those that are compressed more, see `numbers`.
const MEMORY_PER_BYTE: u64 = 16;

/// Bits that say what a mesh has. Those for tangents and face normals change nothing, as in Mitsuba 3.
const NORMALS: u32 = 0x0001;
const UVS: u32 = 0x0002;
const COLORS: u32 = 0x0008;
const DOUBLE: u32 = 0x2000;

const FORMAT: u16 = 0x041c;

/// No mesh has a longer name (bytes).
const LONGEST_NAME: usize = 1 << 16;

/// What is wrong with a file.
enum Fault {
    Io(io::Error),
    Format { expected: &'static str, found: String },
}

impl From<io::Error> for Fault {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

impl Fault {
    fn new(expected: &'static str, found: impl Into<String>) -> Self {
        Self::Format { expected, found: found.into() }
    }

    fn at(self, file: &Path) -> Error {
        let remedy = "export the mesh again, or correct \"shape_index\"";
        match self {
            Self::Format { expected, found } => Error::new(file.display(), expected, found, remedy),
            Self::Io(error) => {
                let found = format!("one that is cut off or damaged ({error})");
                Error::new(file.display(), "a whole serialized mesh", found, remedy)
            }
        }
    }
}

/// An open file, at the start of a compressed stream.
struct Container {
    source: BufReader<File>,
    version: u16,
}

impl Container {
    fn open(mut source: BufReader<File>) -> std::result::Result<Self, Fault> {
        let (format, version) =
            (u16::from_le_bytes(bytes(&mut source)?), u16::from_le_bytes(bytes(&mut source)?));
        if format != FORMAT {
            return Err(Fault::new("a serialized mesh, which starts with 0x041c", format!("{format:#06x}")));
        }
        if !matches!(version, 3 | 4) {
            return Err(Fault::new("a serialized mesh of version 3 or 4", version.to_string()));
        }
        Ok(Self { source, version })
    }

    /// Goes to mesh number `index`: the end of the file says where it starts.
    fn seek(&mut self, index: u32) -> std::result::Result<(), Fault> {
        if index == 0 {
            return Ok(());
        }
        let end = self.source.seek(SeekFrom::End(-4))?;
        let count = u32::from_le_bytes(bytes(&mut self.source)?);
        if index >= count {
            let found = format!("\"shape_index\" {index} in a file of {count} meshes");
            return Err(Fault::new("the number of a mesh, from 0", found));
        }
        let width = if self.version == 4 { 8 } else { 4 };
        let back = width * u64::from(count - index);
        let entry = end.checked_sub(back);
        let entry = entry.ok_or_else(|| Fault::new("a table of meshes", format!("{count} meshes")))?;
        self.source.seek(SeekFrom::Start(entry))?;
        let start = if self.version == 4 {
            u64::from_le_bytes(bytes(&mut self.source)?)
        } else {
            u32::from_le_bytes(bytes(&mut self.source)?).into()
        };
        // A header of four bytes precedes every mesh.
        let start = start.checked_add(4).filter(|start| *start < end);
        let start = start.ok_or_else(|| Fault::new("a mesh inside the file", "one beyond its end"))?;
        self.source.seek(SeekFrom::Start(start))?;
        Ok(())
    }

    /// The mesh that starts here, and whether it has colours.
    fn read(self) -> std::result::Result<(MeshData, bool), Fault> {
        let mut stream = BufReader::new(ZlibDecoder::new(self.source));
        let flags = u32::from_le_bytes(bytes(&mut stream)?);
        if self.version == 4 {
            skip_name(&mut stream)?;
        }
        let (vertices, triangles) =
            (u64::from_le_bytes(bytes(&mut stream)?), u64::from_le_bytes(bytes(&mut stream)?));
        if vertices > u64::from(u32::MAX) || triangles > u64::from(u32::MAX) {
            let found = format!("{vertices} and {triangles}");
            return Err(Fault::new("at most 2^32 - 1 vertices and triangles", found));
        }
        let positions = numbers(&mut stream, flags & DOUBLE != 0, vertices * 3)?;
        let mut list = |flag: u32, width: u64| match flags & flag {
            0 => Ok(vec![]),
            _ => numbers(&mut stream, flags & DOUBLE != 0, vertices * width),
        };
        let (normals, uvs) = (list(NORMALS, 3)?, list(UVS, 2)?);
        drop(list(COLORS, 3)?);
        let triple = |list: Vec<f64>| list.as_chunks().0.iter().map(|p| DVec3::from_array(*p)).collect();
        let data = MeshData {
            attributes: vec![],
            positions: triple(positions),
            normals: triple(normals),
            uvs: uvs.as_chunks().0.iter().map(|[u, v]| Vec2::new(*u as f32, *v as f32)).collect(),
            triangles: read_triangles(&mut stream, triangles, vertices)?,
        };
        Ok((data, flags & COLORS != 0))
    }
}

fn bytes<const N: usize>(source: &mut impl Read) -> io::Result<[u8; N]> {
    let mut bytes = [0; N];
    source.read_exact(&mut bytes)?;
    Ok(bytes)
}

fn skip_name(stream: &mut impl Read) -> std::result::Result<(), Fault> {
    for _ in 0..LONGEST_NAME {
        if bytes::<1>(stream)? == [0] {
            return Ok(());
        }
    }
    Err(Fault::new("a name of at most 65535 bytes", "a longer one"))
}

/// `count` finite numbers; memory grows with what has been read, not with what was promised.
fn numbers(stream: &mut impl Read, double: bool, count: u64) -> std::result::Result<Vec<f64>, Fault> {
    let mut list = Vec::new();
    for _ in 0..count {
        let value = if double {
            f64::from_le_bytes(bytes(stream)?)
        } else {
            f32::from_le_bytes(bytes(stream)?).into()
        };
        if !value.is_finite() {
            return Err(Fault::new("finite numbers", value.to_string()));
        }
        reserve(&mut list)?;
        list.push(value);
    }
    Ok(list)
}

/// Room for one more.
fn reserve<T>(list: &mut Vec<T>) -> std::result::Result<(), Fault> {
    list.try_reserve(1)
        .map_err(|_| Fault::new("a mesh that fits into memory", format!("more than {} numbers", list.len())))
}

fn read_triangles(
    stream: &mut impl Read,
    count: u64,
    vertices: u64,
) -> std::result::Result<Vec<[u32; 3]>, Fault> {
    let mut triangles = Vec::new();
    for _ in 0..count {
        let mut triangle = [0; 3];
        for corner in &mut triangle {
            *corner = u32::from_le_bytes(bytes(stream)?);
            if u64::from(*corner) >= vertices {
                let found = format!("{corner} among {vertices}");
                return Err(Fault::new("the number of a vertex", found));
            }
        }
        reserve(&mut triangles)?;
        triangles.push(triangle);
    }
    Ok(triangles)
}
