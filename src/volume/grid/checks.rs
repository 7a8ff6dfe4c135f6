//! How far a grid reaches, and what is refused or made simpler before it is built.

use super::{
    Bricks, Values, Wrap,
    lattice::{Brick, Extent, Filter, Lattice},
    voxel::Voxel,
};
use crate::{
    error::{Error, Result},
    math::{DAffine3, DVec3, Spectrum, SpectrumExt},
    memory,
};
use std::{path::Path, sync::Arc};

/// How far the values reach in the coordinates of the unit cube, of which the box counts from `low` to `high`.
pub(super) fn reach(values: &Values, wrap: Wrap, [low, high]: [DVec3; 2]) -> [DVec3; 2] {
    let cube = [DVec3::ZERO, DVec3::ONE];
    let is_cube = (low.abs() + (high - 1.0).abs()).max_element() < 1e-6;
    let is_empty_beyond = || {
        wrap == Wrap::Clamp
            && match values {
                Values::Grey(samples) => is_empty_border(&**samples),
                Values::Chromatic(samples) => is_empty_border(&**samples),
            }
    };
    if is_cube || is_empty_beyond() { cube } else { [low.min(cube[0]), high.max(cube[1])] }
}

/// So many bytes must be free for a grid of `size` voxels.
pub(super) fn check_memory(path: &Path, [x, y, z]: [usize; 3], bytes: Option<u64>) -> Result<()> {
    let remedy = "give a coarser or smaller grid, or more memory";
    memory::check(path.display(), "a grid", &format!("{x} x {y} x {z} voxels"), bytes, remedy)
}

/// The list of bricks, empty ones included, must fit in memory.
pub(super) fn check_bricks(path: &Path, size: [usize; 3], extent: &Extent) -> Result<()> {
    let count = extent.size().iter().try_fold(1u64, |count, n| count.checked_mul(*n as u64));
    check_memory(path, size, count.and_then(|count| count.checked_mul(size_of::<Brick<Spectrum>>() as u64)))
}

/// True if all samples on the border are 0.
pub(super) fn is_empty_border<V: Voxel>(samples: &(impl super::super::Samples<V> + ?Sized)) -> bool {
    let size = samples.size();
    let zero = V::splat(0.0);
    (0..3).all(|axis| {
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        [0, size[axis] - 1].into_iter().all(|k| {
            (0..size[i]).all(|a| {
                (0..size[j]).all(|b| {
                    let mut at = [k; 3];
                    (at[i], at[j]) = (a, b);
                    samples.at(at).same(zero)
                })
            })
        })
    })
}

/// The cells that cover the part of the unit cube's coordinates from `low` to `high`, and the shift from the cube
/// (times the number of voxels) to them.
pub(super) fn extent(size: [usize; 3], filter: Filter, [low, high]: [DVec3; 2]) -> (Extent, DVec3) {
    let scale = DVec3::from(size.map(|n| n as f64));
    // Interpolation goes from centre to centre.
    let offset = if filter == Filter::Trilinear { -0.5 } else { 0.0 };
    let (first, last) = ((low * scale + offset).floor(), (high * scale + offset).ceil());
    let shift = offset - first;
    let cells = (last - first).to_array().map(|n| (n as usize).max(1));
    let counted = [low, high].map(|end| (end * scale + shift).to_array());
    (Extent { first: first.to_array().map(|x| x as i64), cells, counted }, shift)
}

/// A chromatic lattice, or a grey one where all its colours are.
pub(super) fn collapse(lattice: Lattice<Spectrum>) -> Bricks {
    let is_grey = lattice.values().all(|color| color.is_grey());
    if is_grey {
        Bricks::Grey(Arc::new(lattice.map(|color| color.x)))
    } else {
        Bricks::Chromatic(Arc::new(lattice))
    }
}

/// A grid may lie so many times its size away from the middle of the scene, for its voxels to be
/// distinguishable.
pub(super) const FARTHEST: f64 = 1e12;

pub(super) fn check_place(path: &Path, to_world: &DAffine3, to_local: &DAffine3) -> Result<()> {
    let away = to_local.transform_vector3(to_world.translation).abs().max_element();
    if away <= FARTHEST {
        return Ok(());
    }
    let found = format!("one {away:e} times its size away");
    let remedy = "place it nearer with \"to_world\" (a wind moves it too), or make it larger";
    Err(Error::new(
        path.display(),
        "a grid within 1e12 times its size of the middle of the scene",
        found,
        remedy,
    ))
}

pub(super) fn check_box(path: &Path, to_file: &DAffine3) -> Result<()> {
    if to_file.is_finite() && to_file.matrix3.determinant() != 0.0 {
        return Ok(());
    }
    let found = format!("one whose edges are {}", to_file.matrix3);
    let remedy = "correct the box in the file's header, or set \"use_grid_bbox\" to false";
    Err(Error::new(path.display(), "a bounding box with a finite volume", found, remedy))
}
