//! Grid files of all formats, seen alike.

use super::{
    super::Samples,
    convert::Convert,
    vol::{self, Vol},
};
use crate::{
    error::Result,
    math::{DAffine3, DMat3, DVec3, Spectrum},
    volume::files,
};
use std::path::Path;

/// What a file holds.
pub enum Values {
    /// A number per voxel.
    Grey(Box<dyn Samples<f32>>),
    /// A colour per voxel.
    Chromatic(Box<dyn Samples<Spectrum>>),
}

/// A grid as its file has it.
pub struct Source {
    /// The voxels.
    pub values: Values,
    /// From the unit cube to where the file says that the grid lies.
    pub to_file: DAffine3,
}

/// True if the extension of `path` is one of the formats that hold several grids by name, each with a place in the world.
pub fn is_vdb(path: &Path) -> bool {
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or("");
    ["vdb", "nvdb"].iter().any(|known| extension.eq_ignore_ascii_case(known))
}

/// Opens a grid file; the format follows from the extension, and is Mitsuba's `.vol` for any not known. `grid` is the
/// name of the one that is meant, for formats that hold several.
pub fn open(path: &Path, grid: Option<&str>, convert: Convert) -> Result<Source> {
    let explain = |problem: files::Problem| problem.at(path.display());
    if !is_vdb(path) {
        let Source { values, to_file } = vol::read(path)?;
        return Ok(Source { values: convert.of(values).map_err(explain)?, to_file });
    }
    let source = files::open(path, grid).map_err(explain)?;
    let to_file = source.to_world * cube_to(source.voxels());
    Ok(Source { values: convert.of_source(source).map_err(explain)?, to_file })
}

/// A grid of the file at `path` as Mitsuba's `.vol` holds it: where it lies and as it is.
pub fn to_vol(path: &Path, grid: Option<&str>) -> Result<Vol> {
    Vol::new(path, open(path, grid, Convert::No)?)
}

/// From the unit cube to a box.
fn cube_to([low, high]: [DVec3; 2]) -> DAffine3 {
    DAffine3 { matrix3: DMat3::from_diagonal(high - low), translation: low }
}
