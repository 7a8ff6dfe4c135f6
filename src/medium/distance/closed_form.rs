//! Closed form: the volume integrates itself, and a bracketed Newton iteration inverts the integral.

use super::{DistanceSample, Extinction};
use crate::math::{Channels, RaySegment};

/// Most steps, each of Newton or a bisection: enough for the last bit of an f32.
const STEPS: u32 = 48;

/// Optical depth along `segment`.
#[inline]
pub(super) fn depth<L: Channels>(medium: &Extinction, segment: &RaySegment) -> L {
    match medium.clip(segment) {
        None => L::splat(0.0),
        Some([first, last]) => medium.depth_between(segment, first, last),
    }
}

/// A flight to where the `hero` channel's depth is `remaining`.
#[inline]
pub(super) fn sample_distance<L: Channels>(
    medium: &Extinction,
    segment: &RaySegment,
    hero: usize,
    remaining: f32,
) -> DistanceSample<L> {
    let Some([first, last]) = medium.clip(segment) else { return DistanceSample::empty() };
    let whole: L = medium.depth_between(segment, first, last);
    if whole.hero(hero) <= remaining {
        return DistanceSample::exact(None, whole, hero);
    }
    let t = invert::<L>(medium, segment, [first, last], hero, remaining, whole.hero(hero));
    let depth: L = medium.depth_between(segment, first, t);
    DistanceSample { spent: remaining, ..DistanceSample::exact(Some(t), depth, hero) }
}

/// Where the depth from `first` on is `remaining`, which is below `whole`, the depth up to `last`.
fn invert<L: Channels>(
    medium: &Extinction,
    segment: &RaySegment,
    [first, last]: [f32; 2],
    hero: usize,
    remaining: f32,
    whole: f32,
) -> f32 {
    let (mut low, mut high) = (first, last);
    let mut t = first + (last - first) * (remaining / whole).clamp(0.0, 1.0);
    for _ in 0..STEPS {
        let excess = medium.depth_between::<L>(segment, first, t).hero(hero) - remaining;
        if excess > 0.0 {
            high = t
        } else {
            low = t
        }
        if excess.abs() <= 1e-7 * remaining {
            break;
        }
        let slope = medium.at::<L>(segment.at(t)).hero(hero);
        let newton = t - excess / slope;
        // A flat stretch sends the Newton step out of the bracket, and so does a step that would hardly move.
        let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        if next == t || low >= high {
            break;
        }
        t = next;
    }
    t
}
