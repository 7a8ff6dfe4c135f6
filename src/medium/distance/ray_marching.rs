//! Ray marching (LW96 sec. 5): the segment through the medium is cut into intervals, each treated as
//! homogeneous.
//!
//! The cuts divide the whole chord of the line through the medium's box, wherever a walk on it starts or ends: both
//! directions of a segment see the same intervals, so that T(x, y) = T(y, x), and a flight is sampled from the same
//! depths that connections use. Only the transmittance is biased: at vertices the medium has its own coefficients.

use super::{DistanceSample, Extinction};
use crate::math::{Channels, RaySegment, Vec3, boxes};

/// Intervals of at most this length (m).
#[derive(Clone, Copy, Debug)]
pub struct RayMarching {
    /// The longest interval (m).
    pub step: f32,
}

/// The intervals that a segment crosses.
struct Intervals {
    /// t where the chord begins, possibly behind the segment's origin.
    start: f32,
    /// Length of an interval (m).
    width: f32,
    /// The part of the segment in the box.
    first: f32,
    last: f32,
    index: u32,
    until: u32,
}

/// One of these intervals.
struct Interval {
    /// t of its middle.
    middle: f32,
    first: f32,
    last: f32,
}

impl Iterator for Intervals {
    type Item = Interval;

    #[inline]
    fn next(&mut self) -> Option<Interval> {
        if self.index >= self.until {
            return None;
        }
        let at = |index: u32| self.start + self.width * index as f32;
        let first = if at(self.index) < self.first { self.first } else { at(self.index) };
        let last = at(self.index + 1).min(self.last);
        let middle = self.start + self.width * (self.index as f32 + 0.5);
        self.index += 1;
        Some(Interval { middle, first, last: last.max(first) })
    }
}

impl RayMarching {
    #[inline]
    fn intervals(&self, medium: &Extinction, segment: &RaySegment) -> Option<Intervals> {
        let [first, last] = medium.clip(segment)?;
        let [start, end] = chord(segment, medium.low, medium.high, [first, last]);
        let count = ((end - start) / self.step).ceil().clamp(1.0, 1e6);
        let width = (end - start) / count;
        let index = ((first - start) / width).floor().clamp(0.0, count - 1.0) as u32;
        let until = ((last - start) / width).ceil().clamp(1.0, count) as u32;
        Some(Intervals { start, width, first, last, index, until })
    }

    /// Optical depth along `segment`.
    #[inline]
    pub fn depth<L: Channels>(&self, medium: &Extinction, segment: &RaySegment) -> L {
        let Some(intervals) = self.intervals(medium, segment) else { return L::splat(0.0) };
        intervals.fold(L::splat(0.0), |sum, interval| {
            sum + medium.at::<L>(segment.at(interval.middle)).scaled(interval.last - interval.first)
        })
    }

    /// A flight to where the `hero` channel's depth is `remaining`.
    #[inline]
    pub fn sample_distance<L: Channels>(
        &self,
        medium: &Extinction,
        segment: &RaySegment,
        hero: usize,
        remaining: f32,
    ) -> DistanceSample<L> {
        let Some(intervals) = self.intervals(medium, segment) else { return DistanceSample::empty() };
        let mut depth = L::splat(0.0);
        for interval in intervals {
            let sigma_t = medium.at::<L>(segment.at(interval.middle));
            let beyond = depth + sigma_t.scaled(interval.last - interval.first);
            if beyond.hero(hero) > remaining {
                let t = interval.first + (remaining - depth.hero(hero)) / sigma_t.hero(hero);
                let t = t.clamp(interval.first, interval.last);
                let depth = depth + sigma_t.scaled(t - interval.first);
                return landed(medium, segment, t, depth, sigma_t, hero);
            }
            depth = beyond;
        }
        DistanceSample::exact(None, depth, hero)
    }
}

/// A collision sampled by the interval's `sigma_t`, at a point with its own coefficient.
#[inline]
fn landed<L: Channels>(
    medium: &Extinction,
    segment: &RaySegment,
    t: f32,
    depth: L,
    sigma_t: L,
    hero: usize,
) -> DistanceSample<L> {
    let own = medium.at::<L>(segment.at(t)).hero(hero);
    let sample = DistanceSample::exact(Some(t), depth, hero);
    DistanceSample { ratio: sample.ratio.scaled(own / sigma_t.hero(hero)), ..sample }
}

/// The range of t in which the segment's line is in the box, also before 0 and beyond its end; at least `within`.
#[inline]
fn chord(segment: &RaySegment, low: Vec3, high: Vec3, within: [f32; 2]) -> [f32; 2] {
    let (origin, direction) = (segment.origin.as_dvec3(), segment.direction.as_dvec3());
    let everywhere = [f64::NEG_INFINITY, f64::INFINITY];
    let [start, end] = boxes::narrowed(origin, direction, [low.as_dvec3(), high.as_dvec3()], everywhere);
    [(start as f32).min(within[0]), (end as f32).max(within[1])]
}
