//! Exact grids: along a ray the interpolant is a cubic in every cell; its depth is found and inverted cell by cell.

use super::{DistanceSample, Extinction, closed_form};
use crate::{
    density::{VolumeModel, grid::Reached},
    math::{Lanes, Section},
};

/// Optical depth along `section`: the grid knows where it ends.
#[inline]
pub fn depth<L: Lanes>(medium: &Extinction, section: &Section) -> L {
    medium.volume.integral::<L>(section).scaled(medium.scale)
}

/// A flight to where the `hero` lane's depth is `remaining`.
#[inline]
pub fn sample_distance<L: Lanes>(
    medium: &Extinction,
    section: &Section,
    hero: usize,
    remaining: f32,
) -> DistanceSample<L> {
    let Some(grid) = medium.volume.grid() else {
        return closed_form::sample_distance(medium, section, hero, remaining);
    };
    match grid.invert(section, L::splat(medium.scale), hero, remaining) {
        Reached::Within { t, depth, .. } => {
            DistanceSample { spent: remaining, ..DistanceSample::exact(Some(t), depth, hero) }
        }
        Reached::Beyond { depth } => DistanceSample::exact(None, depth, hero),
    }
}
