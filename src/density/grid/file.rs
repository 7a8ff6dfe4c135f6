//! Grid files of all formats, seen alike.

use super::{super::Samples, vol};
use crate::{
    error::Result,
    math::{DAffine3, Spectrum},
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

/// Opens a grid file; the format follows from the extension, and is Mitsuba's `.vol` for any not known.
pub fn open(path: &Path) -> Result<Source> {
    vol::read(path)
}
