//! What a light tree knows of an emitter, and of many at once: sums over their light.

use crate::math::DVec3;
use std::ops::Add;

/// Power, and its moments over where light leaves and in which directions.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Moments {
    /// Power, in any unit that is common to all.
    pub power: f64,
    /// Power times position.
    first: DVec3,
    /// Power times squared distance from the origin.
    second: f64,
    /// Power times unit direction.
    direction: DVec3,
}

/// This part of a cluster's variance is added to the squared distance to its centre. In the middle of a ball full of
/// lamps, the mean of 1/d^2 is 3/R^2, and the variance 3/5 R^2.
pub(super) const SOFTNESS: f64 = 0.55;

/// The longest lobe: of light within some 15 degrees. What is narrower gets no narrower estimate.
const LONGEST_LOBE: f64 = 0.97;

impl Moments {
    /// Light from `position` in unit `direction`.
    pub(crate) fn ray(power: f64, position: DVec3, direction: DVec3) -> Self {
        let second = power * position.length_squared();
        Self { power, first: power * position, second, direction: power * direction }
    }

    /// Light of the same irradiance `fluence` (W/m^2) anywhere within `reach` (m) of `centre`: a cluster so large that
    /// distance has no effect.
    pub(crate) fn everywhere(fluence: f64, centre: DVec3, reach: f64) -> Self {
        let power = 4.0 * std::f64::consts::PI * fluence * SOFTNESS * reach.powi(2);
        let second = power * (centre.length_squared() + reach.powi(2));
        Self { power, first: power * centre, second, direction: DVec3::ZERO }
    }

    /// The same with `power`, where there is any.
    pub(crate) fn of_power(self, power: f64) -> Self {
        let factor = power / self.power;
        Self {
            power,
            first: self.first * factor,
            second: self.second * factor,
            direction: self.direction * factor,
        }
    }

    /// The same with light from around as well: mean squared distances are more by `variance` (m^2).
    pub(crate) fn spread_by(self, variance: f64) -> Self {
        Self { second: self.second + self.power * variance, ..self }
    }

    /// Where its light comes from, on average.
    pub(crate) fn centre(&self) -> DVec3 {
        self.first / self.power
    }

    /// Mean squared distance from the centre (m^2).
    pub(crate) fn variance(&self) -> f64 {
        (self.second / self.power - self.centre().length_squared()).max(0.0)
    }

    /// Power times the mean squared distance from the centre.
    pub(crate) fn spread(&self) -> f64 {
        (self.second - self.first.length_squared() / self.power).max(0.0)
    }

    /// The mean of its directions, shorter than 1.
    pub(crate) fn lobe(&self) -> DVec3 {
        (self.direction / self.power).clamp_length_max(LONGEST_LOBE)
    }
}

impl Add for Moments {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            power: self.power + other.power,
            first: self.first + other.first,
            second: self.second + other.second,
            direction: self.direction + other.direction,
        }
    }
}
