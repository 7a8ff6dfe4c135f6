//! Motion blur: when the shutter is open, and at what time each pass over the image sees the scene.
//!
//! All camera and light subpaths of a pass share one time, so that every connection is made in a static scene. The
//! times of passes are a golden-ratio sequence with a random start. Any consecutive passes are spread evenly, and each
//! alone is uniform. The sequence is unrelated to the base-2 points of low-discrepancy samplers, which count passes
//! too.

use super::{batch, sensors};
use crate::{
    description::{Object, Params, Property, Value},
    error::{Error, Result},
    math::DVec3,
    sampling::{Stream, stream::Purpose},
    sensor::SHUTTER,
    volume::{WIND, grid::VELOCITY},
};

/// When a camera's shutter opens and closes, after the scene's time (s).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shutter {
    /// First,
    pub(super) opens: f64,
    /// and last.
    pub(super) closes: f64,
}

/// 1 over the golden ratio: its multiples, modulo 1, lie as evenly as those of any number.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

impl Shutter {
    /// That of the camera of `root`, which is the first sensor.
    pub fn of(root: &Object) -> Result<Self> {
        let root = batch::expand(root)?;
        let Some(camera) = sensors::sensors(&root).next() else { return Ok(Self::default()) };
        let is_keyed = |property: &&Property| {
            SHUTTER.contains(&property.name.as_str()) && matches!(property.value, Value::Keyframes(_))
        };
        if let Some(Property { name, location, .. }) = camera.properties.iter().find(is_keyed) {
            let remedy = "give a number of seconds after the scene's time";
            return Err(Error::new(location, format!("one number for \"{name}\""), "keyframes", remedy));
        }
        let [opens, closes] = SHUTTER.map(|name| camera.number(name));
        let opens = opens.unwrap_or(0.0);
        Ok(Self { opens, closes: closes.unwrap_or(0.0).max(opens) })
    }

    /// True if it is open no longer than an instant.
    pub fn is_instant(self) -> bool {
        self.opens == self.closes
    }

    /// Halfway between the two (s).
    pub(super) fn middle(self) -> f64 {
        0.5 * (self.opens + self.closes)
    }

    /// Displacement, at least and at most (m), while it is open, for velocities within bounds (m/s).
    pub(super) fn ways(self, velocities: [DVec3; 2]) -> [DVec3; 2] {
        let ends = [self.opens, self.closes].into_iter().flat_map(|time| velocities.map(|v| v * time));
        ends.fold([DVec3::ZERO; 2], |[low, high], way| [low.min(way), high.max(way)])
    }

    /// When a `pass` of renders with `seed` sees the scene (s).
    pub(super) fn moment(self, seed: u64, pass: u64) -> f64 {
        let first = Stream::new(seed, 0, 0, Purpose::Shutter).uniform_precisely();
        self.opens + (self.closes - self.opens) * (first + pass as f64 * GOLDEN).fract()
    }
}

/// A shutter that closes before it opens is an error.
pub(super) fn check(camera: &Params<'_>) -> Result<()> {
    let (opens, closes) = (camera.float(SHUTTER[0])?, camera.optional_float(SHUTTER[1])?);
    if let Some(closes) = closes.filter(|closes| *closes < opens) {
        let expected = format!("a time not before \"{}\", {opens} s", SHUTTER[0]);
        return Err(camera.complain(SHUTTER[1], expected, format!("{closes} s")));
    }
    Ok(())
}

/// True for objects that drift although their description is constant: in a wind, or by their own velocity.
pub(super) fn drifts(object: &Object) -> bool {
    object.plugin == WIND || object.properties.iter().any(|property| property.name == VELOCITY)
}

/// True if something in `object`, which has no smoke in it, drifts.
pub(super) fn has_drifting(object: &Object) -> bool {
    let below = |property: &Property| match &property.value {
        Value::Object(child) => has_drifting(child),
        _ => false,
    };
    drifts(object) || object.properties.iter().any(below)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whichever passes a render has, they see times that lie evenly.
    #[test]
    fn times_of_consecutive_passes_lie_evenly() {
        let shutter = Shutter { opens: -1.0, closes: 3.0 };
        for (seed, first, count) in [(0, 0, 16), (1, 7, 16), (2, 1_000_000, 64), (3, 12, 5), (4, 3, 1)] {
            let mut times: Vec<f64> = (first..first + count).map(|pass| shutter.moment(seed, pass)).collect();
            times.sort_by(f64::total_cmp);
            assert!(times.iter().all(|time| (-1.0..3.0).contains(time)));
            let next = times.iter().skip(1).copied().chain([times[0] + 4.0]);
            let widest = times.iter().zip(next).map(|(a, b)| b - a).fold(0.0, f64::max);
            // The three distances between multiples of the golden ratio.
            assert!(widest <= 4.0 * 2.2 / count as f64, "{first}: {widest}");
        }
    }

    /// Each alone is uniform over the exposure.
    #[test]
    fn the_time_of_a_pass_is_uniform_over_seeds() {
        let shutter = Shutter { opens: 0.0, closes: 1.0 };
        let (seeds, bins) = (20_000, 20);
        let mut counts = vec![0.0; bins];
        (0..seeds).for_each(|seed| counts[(shutter.moment(seed, 5) * bins as f64) as usize] += 1.0);
        let expected = seeds as f64 / bins as f64;
        let chi: f64 = counts.iter().map(|count: &f64| (count - expected).powi(2) / expected).sum();
        assert!(chi < 43.8, "0.1 % of uniform numbers are beyond that: {chi}");
    }

    #[test]
    fn the_way_of_smoke_is_that_of_both_ends() {
        let shutter = Shutter { opens: -0.5, closes: 2.0 };
        let [low, high] = shutter.ways([DVec3::new(-1.0, 0.0, 1.0), DVec3::new(3.0, 0.0, 2.0)]);
        assert_eq!((low, high), (DVec3::new(-2.0, 0.0, -1.0), DVec3::new(6.0, 0.0, 4.0)));
    }
}
