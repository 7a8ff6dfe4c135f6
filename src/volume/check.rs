//! Is a density negative anywhere? Sums and waves of either sign may be, and nothing physical is.

use super::{Place, Volume, VolumeModel};
use crate::{
    description::Location,
    error::Error,
    math::{DVec3, Spectrum, Vec3},
};
use std::{cmp::Ordering, collections::BinaryHeap};

/// Where a density is below 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Negative {
    /// Recentred (m).
    pub position: Vec3,
    /// The value there.
    pub value: Spectrum,
}

impl Negative {
    /// The error that says so, for what is at `location` in the file.
    pub fn error(&self, location: &Location, place: &Place) -> Error {
        let [x, y, z] = (self.position.as_dvec3() + place.recentre).to_array();
        Error::new(
            location,
            "a density that is nowhere below 0",
            format!("{} at [{x:.6}, {y:.6}, {z:.6}]", self.value.min_element()),
            "add a constant to it, make its negative parts weaker, or bound it with \"min\" and \"max\"",
        )
    }
}

/// What lies this far below 0, times the greatest value, is taken for rounding.
const ROUNDING: f32 = 1e-6;

/// So many boxes are looked at.
const BOXES: usize = 20_000;

/// A box that may hold something below 0.
struct Doubt {
    low: Vec3,
    high: Vec3,
    /// No value in it is lower.
    least: f32,
}

impl PartialEq for Doubt {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Doubt {}

impl PartialOrd for Doubt {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Doubt {
    /// The lowest is looked at first.
    fn cmp(&self, other: &Self) -> Ordering {
        other.least.total_cmp(&self.least)
    }
}

impl Doubt {
    fn new(volume: &Volume, low: Vec3, high: Vec3) -> Self {
        Self { low, high, least: volume.range(low, high)[0].min_element() }
    }

    /// Cut in two along `axis`; none where f32 has nothing between.
    fn cut(&self, volume: &Volume, axis: usize) -> Option<[Self; 2]> {
        let middle = 0.5 * self.low[axis] + 0.5 * self.high[axis];
        if !(self.low[axis] < middle && middle < self.high[axis]) {
            return None;
        }
        let (mut left, mut right) = (self.high, self.low);
        (left[axis], right[axis]) = (middle, middle);
        Some([Self::new(volume, self.low, left), Self::new(volume, right, self.high)])
    }

    /// Cut where that raises the bounds most; along the longest side if no cut does more than another.
    fn halves(&self, volume: &Volume) -> Option<[Self; 2]> {
        let size = self.high - self.low;
        let cuts = (0..3).filter_map(|axis| Some((self.cut(volume, axis)?, size[axis])));
        let gain = |halves: &[Self; 2]| halves[0].least + halves[1].least;
        let best = cuts.max_by(|(a, x), (b, y)| gain(a).total_cmp(&gain(b)).then(x.total_cmp(y)));
        best.map(|(halves, _)| halves)
    }
}

/// The lowest of a few values in a box, its middle among them; `index` says where the others are.
fn lowest(volume: &Volume, low: Vec3, high: Vec3, index: usize) -> Negative {
    // Multiples of the plastic number's powers fill the cube evenly.
    let steps = DVec3::new(0.819_172_513_396_164_5, 0.671_043_606_703_789_2, 0.549_700_477_901_970_3);
    let points = (1..4).map(|i| ((4 * index + i) as f64 * steps).fract().as_vec3());
    let found = std::iter::once(Vec3::splat(0.5)).chain(points).map(|u| {
        let position = low + u * (high - low);
        Negative { position, value: volume.eval(position) }
    });
    let order = |a: &Negative, b: &Negative| a.value.min_element().total_cmp(&b.value.min_element());
    found.min_by(order).unwrap_or(Negative { position: low, value: Spectrum::ZERO })
}

/// Looks for a value below 0 in the box from `low` to `high`: the box is cut where its bounds say least until they say
/// that there is none, until one is found, or 20 000 boxes have been looked at, which passes. So what merely touches 0
/// passes, and so does what goes less than a millionth of the greatest value below it.
pub fn check_non_negative(volume: &Volume, low: Vec3, high: Vec3) -> Result<(), Negative> {
    let [_, most] = volume.range(low, high);
    let limit = -ROUNDING * most.abs().max_element();
    let mut doubts = BinaryHeap::from([Doubt::new(volume, low, high)]);
    for index in 0..BOXES {
        let Some(doubt) = doubts.pop().filter(|doubt| doubt.least < limit) else { return Ok(()) };
        let found = lowest(volume, doubt.low, doubt.high, index);
        if found.value.min_element() < limit {
            return Err(found);
        }
        doubts.extend(doubt.halves(volume).into_iter().flatten());
    }
    Ok(())
}

#[cfg(test)]
mod tests;
