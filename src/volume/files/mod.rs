//! Volumes from files: OpenVDB (`.vdb`) and NanoVDB (`.nvdb`), as Blender, Houdini and EmberGen write them.
//!
//! Read are grids of numbers (`float`, `double`, also saved as half) and of three numbers (`vec3s`, `vec3d`). Not read,
//! and refused with a message that says what to do: level sets, points, integers, booleans and masks, maps that are not
//! affine (camera frustums), trees of other shape than 5-4-3, OpenVDB's file versions before 222 (2013) and files
//! written as a stream; of NanoVDB, layouts other than 32, types other than float, Vec3f and the quantised floats, and
//! memory dumps without a file's header. Checksums are not verified.
//!
//! Nothing is believed of a size until the file has yielded the bytes: a broken or hostile file ends in a [`Problem`].

mod blosc;
mod choice;
mod inflate;
mod input;
mod nvdb;
mod problem;
mod sparse;
#[cfg(test)]
mod tests;
mod value;
mod vdb;

pub use problem::Problem;
pub use sparse::Sparse;

use crate::math::{DAffine3, Vec3};
use input::Input;
use sparse::Builder;
use std::{
    fs::File,
    io::{BufReader, Read, Seek},
    path::Path,
};
use value::Value;

/// One grid of a file.
#[derive(Debug)]
pub struct Source {
    /// Its name, with a number in brackets where several have the same.
    pub name: String,
    /// From the grid's indices to the file's world. A sample lies at its integer index.
    pub to_world: DAffine3,
    /// The index of the first sample.
    pub low: [i64; 3],
    /// The values, as they are in the file: finite or not, negative or not.
    pub samples: Field,
}

/// Values of either kind.
#[derive(Debug)]
pub enum Field {
    /// One number to a sample.
    Grey(Sparse<f32>),
    /// Three numbers to a sample: red, green and blue.
    Colour(Sparse<Vec3>),
}

impl Source {
    /// Numbers to a sample: 1 or 3.
    pub fn channels(&self) -> usize {
        match &self.samples {
            Field::Grey(_) => f32::CHANNELS,
            Field::Colour(_) => Vec3::CHANNELS,
        }
    }

    fn new<V: Value>(name: String, to_world: DAffine3, builder: Builder<V>) -> Result<Self> {
        let determinant = to_world.matrix3.determinant();
        if !to_world.is_finite() || !determinant.is_finite() || determinant == 0.0 {
            let expected = "a finite map with an inverse, from indices to the world";
            let remedy = "give the grid voxels of a size, and export it again";
            return Err(Problem::new(expected, format!("{to_world:?}"), remedy));
        }
        let samples = builder.finish()?;
        Ok(Self { name, to_world, low: samples.low(), samples: V::field(samples) })
    }
}

type Result<T> = std::result::Result<T, Problem>;

/// Reads the grid named `grid` of the file at `path`; where no name is given, the one named "density", or else the only
/// one there is. The first bytes of a file identify its format.
pub fn open(path: &Path, grid: Option<&str>) -> Result<Source> {
    let file = File::open(path).map_err(|error| {
        let remedy = "check that the path exists and that you may access it";
        Problem::new("a file to read", error.to_string(), remedy)
    })?;
    read(BufReader::new(file), grid)
}

fn read(source: impl Read + Seek, grid: Option<&str>) -> Result<Source> {
    let mut input = Input::new(source)?;
    let magic = input.array()?;
    if magic == vdb::MAGIC {
        vdb::read(&mut input, grid)
    } else if nvdb::MAGICS.contains(&magic) {
        nvdb::read(&mut input, grid)
    } else {
        let found = format!("one that starts with \"{}\"", magic.escape_ascii());
        Err(Problem::new("an OpenVDB or NanoVDB file", found, "give a .vdb or .nvdb file"))
    }
}
