//! Exact grids: along a ray the interpolant is a cubic in every cell; its depth is found and inverted cell by cell.

use super::{Extinction, Leg, closed_form};
use crate::{
    density::grid::Reached,
    math::{Lanes, Section},
};

/// A flight to where the `hero` lane's depth is `remaining`.
#[inline]
pub fn fly<L: Lanes>(medium: &Extinction, section: &Section, hero: usize, remaining: f32) -> Leg<L> {
    let Some(grid) = medium.volume.grid() else { return closed_form::fly(medium, section, hero, remaining) };
    match grid.invert(section, L::splat(medium.scale), hero, remaining) {
        Reached::Within { t, depth, .. } => Leg { spent: remaining, ..Leg::exact(Some(t), depth, hero) },
        Reached::Beyond { depth } => Leg::exact(None, depth, hero),
    }
}
