//! Exact grids: along a ray the interpolant is a cubic in every cell. Depths are computed and inverted cell by cell.

use super::{DistanceSample, Extinction, closed_form};
use crate::{
    math::{Channels, RaySegment},
    volume::{VolumeModel, grid::Reached},
};

/// Optical depth along `segment`: the grid computes where it ends.
#[inline]
pub(super) fn depth<L: Channels>(medium: &Extinction, segment: &RaySegment) -> L {
    medium.volume.integral::<L>(segment).scaled(medium.scale)
}

/// A flight to where the `hero` channel's depth is `remaining`.
#[inline]
pub(super) fn sample_distance<L: Channels>(
    medium: &Extinction,
    segment: &RaySegment,
    hero: usize,
    remaining: f32,
) -> DistanceSample<L> {
    let Some(grid) = medium.volume.grid() else {
        return closed_form::sample_distance(medium, segment, hero, remaining);
    };
    match grid.invert(segment, L::splat(medium.scale), hero, remaining) {
        Reached::Within { t, depth, .. } => {
            DistanceSample { spent: remaining, ..DistanceSample::exact(Some(t), depth, hero) }
        }
        Reached::Beyond { depth } => DistanceSample::exact(None, depth, hero),
    }
}
