//! `cosine`: a constant and waves, c_0 + sum c_i cos(k_i . x + phi_i) (BMA02 3.2.1).
//!
//! Every nested `wave` has an `amplitude` c_i, a `vector` k_i and a `phase` phi_i. The product of two cosines is two
//! waves: cos a cos b = (cos(a + b) + cos(a - b)) / 2.

use super::placed::{COMMON, Function, Line, Placed, parts};
use crate::{
    description::{Params, Table, table},
    error::{Error, Result},
    math::DVec3,
};
use std::{
    f64::consts::{PI, TAU},
    sync::Arc,
};

/// A sum of waves.
pub type Cosine = Placed<Waves>;

/// A constant and waves.
#[derive(Clone, Debug)]
pub struct Waves {
    constant: f64,
    waves: Arc<[Wave]>,
}

#[derive(Clone, Copy, Debug)]
struct Wave {
    amplitude: f64,
    /// (rad/m)
    vector: DVec3,
    /// At the origin (rad).
    phase: f64,
}

pub(super) const WAVE: Table = table! {
    "A wave of a `cosine`: amplitude cos(vector . x + phase).";
    number("amplitude", "", ANY, Is(1.0), "Amplitude, of either sign."),
    vector("vector", "rad/m", Required, "Wave vector, of length 2 pi over the wavelength."),
    number("phase", "rad", ANY, Is(0.0), "Phase at the origin."),
};

fn wave(params: &Params<'_>) -> Result<Wave> {
    Ok(Wave {
        amplitude: params.float("amplitude")?,
        vector: params.vector("vector")?,
        phase: params.float("phase")?,
    })
}

impl Wave {
    fn phase_at(&self, position: DVec3) -> f64 {
        self.vector.dot(position) + self.phase
    }

    /// Bounds of amplitude times cosine.
    fn range(&self, center: DVec3, half: DVec3) -> [f64; 2] {
        let middle = self.phase_at(center);
        let [least, most] = cosines(middle, self.vector.abs().dot(half) + 1e-13 * (1.0 + middle.abs()));
        let (a, b) = (self.amplitude * least, self.amplitude * most);
        [a.min(b), a.max(b)]
    }

    /// By the phase in the middle and half the change of phase: exact however short or long.
    fn integral(&self, line: &Line, first: f64, last: f64) -> f64 {
        let half = 0.5 * (last - first) * self.vector.dot(line.direction);
        let mean = if half == 0.0 { 1.0 } else { half.sin() / half };
        self.amplitude * (last - first) * mean * self.phase_at(line.at(0.5 * (first + last))).cos()
    }
}

/// Bounds of the cosine of angles within `half` of `middle`.
fn cosines(middle: f64, half: f64) -> [f64; 2] {
    let off = (middle - TAU * (middle / TAU).round()).abs();
    let (near, far) = (off - half, off + half);
    let most = if near <= 0.0 { 1.0 } else { near.cos() };
    [if far >= PI { -1.0 } else { far.cos() }, most]
}

impl Function for Waves {
    const TABLE: Table = table! {
        "A constant and waves: constant + sum of amplitude cos(vector . x + phase) (BMA02 3.2.1).";
        number("constant", "", ANY, Is(1.0), "The constant."),
        nested("volume", Required, "The waves, plugins `wave`.");
        COMMON
    };

    fn read(params: &Params<'_>) -> Result<Self> {
        let constant = params.float("constant")?;
        let waves = parts(params, "wave", &WAVE, wave)?;
        match waves.is_empty() {
            false => Ok(Self { constant, waves: waves.into() }),
            true => Err(Error::new(
                params.location(),
                "one or more nested waves",
                "none",
                "add a plugin \"wave\" with \"amplitude\", \"vector\" and \"phase\"",
            )),
        }
    }

    #[inline]
    fn eval(&self, position: DVec3) -> f64 {
        let value = |wave: &Wave| wave.amplitude * wave.phase_at(position).cos();
        self.constant + self.waves.iter().map(value).sum::<f64>()
    }

    fn range(&self, low: DVec3, high: DVec3) -> [f64; 2] {
        let (center, half) = (0.5 * (low + high), 0.5 * (high - low));
        let add = |[least, most]: [f64; 2], wave: &Wave| {
            let [a, b] = wave.range(center, half);
            let slack = 1e-14 * wave.amplitude.abs();
            [least + a - slack, most + b + slack]
        };
        let slack = 1e-14 * self.constant.abs();
        self.waves.iter().fold([self.constant - slack, self.constant + slack], add)
    }

    #[inline]
    fn integral(&self, line: &Line, first: f64, last: f64) -> f64 {
        let waves: f64 = self.waves.iter().map(|wave| wave.integral(line, first, last)).sum();
        self.constant * (last - first) + waves
    }

    #[cfg(test)]
    fn examples() -> Vec<Self> {
        let wave = |amplitude, vector: [f64; 3], phase| Wave { amplitude, vector: vector.into(), phase };
        let make = |constant, waves: &[Wave]| Self { constant, waves: waves.into() };
        let (fifth, tenth) = (0.2, 0.05);
        vec![
            make(1.0, &[wave(-0.5, [0.0; 3], 0.0)]),
            make(0.5, &[wave(0.5, [1.0, -2.0, 0.5], 0.3)]),
            make(0.0, &[wave(1.0, [1.0, 0.0, 0.0], -PI), wave(0.3, [40.0, 0.0, 30.0], 1.0)]),
            // BMA02 fig. 6.
            make(
                1.0,
                &[
                    wave(0.5, [0.0, 5.0 * PI, 0.0], 0.0),
                    wave(fifth, [0.7 * PI, 7.0 * PI, 0.0], 0.0),
                    wave(fifth, [-0.25 * PI, 5.0 * PI, 0.0], 0.0),
                    wave(tenth, [PI, 0.0, 0.5 * PI], 0.0),
                    wave(tenth, [PI, 0.0, -0.5 * PI], 0.0),
                ],
            ),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_of_cosines_hold_and_are_narrow() {
        for i in 0..2_000 {
            let (middle, half) = (f64::from(i) * 0.37 - 300.0, f64::from(i % 97) * 0.05);
            let [least, most] = cosines(middle, half);
            let values = (0..=2_000).map(|j| (middle + half * (f64::from(j) / 1_000.0 - 1.0)).cos());
            let (low, high) = values.fold((1.0f64, -1.0f64), |(a, b), v| (a.min(v), b.max(v)));
            assert!(least <= low + 1e-12 && most >= high - 1e-12);
            assert!(low - least < 1e-5 && most - high < 1e-5, "{middle} {half}");
        }
    }
}
