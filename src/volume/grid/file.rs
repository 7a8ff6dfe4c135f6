//! Grid files of all formats, seen alike.

use super::{super::Samples, vol};
use crate::{
    error::Result,
    math::{DAffine3, DVec3, Spectrum},
    volume::files::{self, Field},
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
pub fn open(path: &Path, grid: Option<&str>) -> Result<Source> {
    if !is_vdb(path) {
        return vol::read(path);
    }
    let source = files::open(path, grid).map_err(|problem| problem.at(path.display()))?;
    let values = match source.samples {
        Field::Grey(samples) => Values::Grey(Box::new(samples)),
        Field::Colour(samples) => Values::Chromatic(Box::new(samples)),
    };
    let size = match &values {
        Values::Grey(samples) => samples.size(),
        Values::Chromatic(samples) => samples.size(),
    };
    // Samples lie at integer indices, in the middle of their voxels.
    let low = DVec3::from(source.low.map(|index| index as f64 - 0.5));
    let box_of_voxels = DAffine3 {
        matrix3: crate::math::DMat3::from_diagonal(DVec3::from(size.map(|n| n as f64))),
        translation: low,
    };
    Ok(Source { values, to_file: source.to_world * box_of_voxels })
}
