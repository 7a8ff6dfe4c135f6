//! Exact grids: along a ray the interpolant is a cubic in every cell; its depth is found and inverted cell by cell.

use super::{Extinction, Leg};
use crate::math::{Lanes, Section};

/// A flight to where the `hero` lane's depth is `remaining`.
#[inline]
pub fn fly<L: Lanes>(medium: &Extinction, section: &Section, hero: usize, remaining: f32) -> Leg<L> {
    super::closed_form::fly(medium, section, hero, remaining)
}
