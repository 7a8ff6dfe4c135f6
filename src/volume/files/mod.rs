//! Volumes from files: OpenVDB (`.vdb`) and NanoVDB (`.nvdb`), as Blender, Houdini and EmberGen write them.
//!
//! Read are grids of numbers (`float`, `double`, also saved as half) and of three numbers (`vec3s`, `vec3d`). Not read,
//! and refused with a message that says what to do: points, integers, booleans and masks, maps that are not
//! affine (camera frustums), trees of other shape than 5-4-3, OpenVDB's file versions before 222 (2013) and files
//! written as a stream; of NanoVDB, layouts other than 32, types other than float, Vec3f and the quantised floats, and
//! memory dumps without a file's header. Checksums are not verified.
//!
//! No size is trusted until the file has yielded the bytes: a broken or hostile file ends in a [`Problem`].

mod blosc;
mod choice;
mod inflate;
mod input;
mod nvdb;
mod problem;
pub mod roles;
pub mod sequence;
mod sparse;
#[cfg(test)]
pub(super) mod tests;
mod value;
mod vdb;

pub use choice::Label;
pub use problem::Problem;
pub use sparse::Sparse;

use super::Samples as _;
use crate::math::{DAffine3, DVec3, Vec3};
use choice::{choose, shown};
use input::Input;
use sparse::Builder;
use std::{
    fs::File,
    io::{BufReader, Read, Seek},
    path::Path,
};
pub use value::Value;

/// One grid of a file.
#[derive(Debug)]
pub struct Source {
    /// What the file says of it.
    pub label: Label,
    /// From the grid's indices to the file's world. A sample lies at its integer index.
    pub to_world: DAffine3,
    /// The index of the first sample.
    pub low: [i64; 3],
    /// The values, as they are in the file: finite or not, negative or not.
    pub samples: Field,
    /// Other grids of the file that may have been meant: those of numbers, or of them the density.
    pub others: Vec<String>,
}

/// Values of either kind.
#[derive(Debug)]
pub enum Field {
    /// One number to a sample.
    Grey(Sparse<f32>),
    /// Three numbers to a sample: red, green and blue.
    Colour(Sparse<Vec3>),
}

/// The class of distances to a surface is refused where densities are meant.
fn surface(name: &str) -> Problem {
    let found = format!("\"{}\", a level set (distances to a surface)", shown(name));
    let remedy = "set \"convert\" to \"fog\", or convert it to a fog volume (in Houdini \"Convert VDB\", in OpenVDB \
                  sdfToFogVolume)";
    Problem::new("a grid of densities or colours", found, remedy)
}

impl Source {
    /// Numbers to a sample: 1 or 3.
    pub fn channels(&self) -> usize {
        match &self.samples {
            Field::Grey(_) => f32::CHANNELS,
            Field::Colour(_) => Vec3::CHANNELS,
        }
    }

    /// Samples along each axis, one more on every side than from the first to the last active one.
    pub fn size(&self) -> [usize; 3] {
        match &self.samples {
            Field::Grey(samples) => samples.size(),
            Field::Colour(samples) => samples.size(),
        }
    }

    /// The box of all voxels in indices: samples lie in the middle of their voxels.
    pub fn voxels(&self) -> [DVec3; 2] {
        let (low, size) = (self.low, self.size());
        let high = [0, 1, 2].map(|axis| (low[axis] + size[axis] as i64) as f64);
        [DVec3::from(low.map(|index| index as f64)) - 0.5, DVec3::from(high) - 0.5]
    }

    /// The same, unless the values are distances to a surface.
    pub fn no_surface(self) -> Result<Self> {
        if self.label.is_level_set() { Err(surface(&self.label.name)) } else { Ok(self) }
    }

    fn new<V: Value>(label: Label, to_world: DAffine3, builder: Builder<V>) -> Result<Self> {
        let determinant = to_world.matrix3.determinant();
        if !to_world.is_finite() || !determinant.is_finite() || determinant == 0.0 {
            let expected = "a finite map with an inverse, from indices to the world";
            let remedy = "give the grid voxels of a size, and export it again";
            return Err(Problem::new(expected, format!("{to_world:?}"), remedy));
        }
        let samples = builder.finish()?;
        Ok(Self { label, to_world, low: samples.low(), samples: V::field(samples), others: vec![] })
    }
}

type Result<T> = std::result::Result<T, Problem>;

/// A file whose table of grids has been read.
pub struct Archive<R = BufReader<File>> {
    input: Input<R>,
    entries: Entries,
}

enum Entries {
    Vdb(Vec<vdb::Entry>),
    Nvdb(Vec<nvdb::Entry>),
}

impl Archive {
    /// Opens the file at `path`. Its first bytes identify its format.
    pub fn open(path: &Path) -> Result<Self> {
        let file = File::open(path).map_err(|error| {
            let remedy = "check that the path exists and that you may access it";
            Problem::new("a file to read", error.to_string(), remedy)
        })?;
        Self::new(BufReader::new(file))
    }
}

impl<R: Read + Seek> Archive<R> {
    fn new(source: R) -> Result<Self> {
        let mut input = Input::new(source)?;
        let magic = input.array()?;
        let entries = if magic == vdb::MAGIC {
            Entries::Vdb(vdb::entries(&mut input)?)
        } else if nvdb::MAGICS.contains(&magic) {
            Entries::Nvdb(nvdb::entries(&mut input)?)
        } else {
            let found = format!("one that starts with \"{}\"", magic.escape_ascii());
            return Err(Problem::new("an OpenVDB or NanoVDB file", found, "give a .vdb or .nvdb file"));
        };
        Ok(Self { input, entries })
    }

    /// What the file says of its grids, in its order.
    pub fn labels(&mut self) -> Vec<Label> {
        match &self.entries {
            Entries::Vdb(entries) => entries.iter().map(|entry| vdb::label(&mut self.input, entry)).collect(),
            Entries::Nvdb(entries) => entries.iter().map(|entry| entry.label.clone()).collect(),
        }
    }

    /// Reads grid `number` of [`Self::labels`].
    pub fn source(&mut self, number: usize) -> Result<Source> {
        match &self.entries {
            Entries::Vdb(entries) => vdb::source(&mut self.input, entries, &entries[number]),
            Entries::Nvdb(entries) => nvdb::source(&mut self.input, &entries[number]),
        }
    }

    fn chosen(&mut self, grid: Option<&str>) -> Result<Source> {
        let labels = self.labels();
        let number = choose(&labels, grid)?;
        Ok(Source { others: roles::others(&labels, number), ..self.source(number)? })
    }
}

/// Reads the grid named `grid` of the file at `path`; where no name is given, the one named "density", or else the only
/// one there is.
pub fn open(path: &Path, grid: Option<&str>) -> Result<Source> {
    Archive::open(path)?.chosen(grid)
}
