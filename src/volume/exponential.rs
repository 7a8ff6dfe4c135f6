//! `exponential`: fog that thins with height, exp(-(up . x - height) / scale_height).
//!
//! Far below, 60 scale heights under `height`, it grows no further: there it has risen by 1e26 already.

use super::placed::{COMMON, Function, Line, Placed};
use crate::{
    description::{Params, Table, table},
    error::Result,
    math::DVec3,
};

/// Height fog.
pub type Exponential = Placed<Haze>;

/// The function itself.
#[derive(Clone, Debug)]
pub struct Haze {
    /// A unit vector.
    up: DVec3,
    height: f64,
    scale_height: f64,
}

/// The exponent grows to this and no further.
const MOST: f64 = 60.0;

/// Exponents are kept within this, so that their differences exist.
const HUGE: f64 = 1e300;

impl Haze {
    fn exponent(&self, along_up: f64) -> f64 {
        ((self.height - along_up) / self.scale_height).clamp(-HUGE, HUGE)
    }
}

/// The mean of exp from `top` - `fall` to `top`.
fn mean(top: f64, fall: f64) -> f64 {
    let mean = if fall == 0.0 { 1.0 } else { -(-fall).exp_m1() / fall };
    top.exp() * mean
}

impl Function for Haze {
    const TABLE: Table = table! {
        "Fog that thins with height: exp(-(up . x - height) / scale_height).";
        vector("up", "", At([0.0, 1.0, 0.0]), "Up direction; need not be normalised."),
        number("height", "", ANY, Is(0.0), "Height at which it equals `value`."),
        number("scale_height", "", above(0.0, f64::MAX), Is(1.0), "Height over which it falls to 1/e.");
        COMMON
    };

    fn read(params: &Params<'_>) -> Result<Self> {
        let given = params.vector("up")?;
        let up = given
            .try_normalize()
            .ok_or_else(|| params.complain("up", "a vector > 0 in length", given.to_string()))?;
        let (height, scale_height) = (params.float("height")?, params.float("scale_height")?);
        Ok(Self { up, height, scale_height })
    }

    #[inline]
    fn eval(&self, position: DVec3) -> f64 {
        self.exponent(self.up.dot(position)).min(MOST).exp()
    }

    fn range(&self, low: DVec3, high: DVec3) -> [f64; 2] {
        let (middle, half) = (self.up.dot(0.5 * (low + high)), self.up.abs().dot(0.5 * (high - low)));
        let half = half + 1e-14 * (middle.abs() + half);
        let value = |along: f64| self.exponent(along).min(MOST).exp();
        [value(middle + half) * (1.0 - 1e-12), value(middle - half) * (1.0 + 1e-12)]
    }

    #[inline]
    fn integral(&self, line: &Line, first: f64, last: f64) -> f64 {
        let ends = [first, last].map(|t| self.exponent(self.up.dot(line.at(t))));
        let (least, most) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
        let length = last - first;
        if least >= MOST {
            return length * MOST.exp();
        }
        // The share of the segment where the exponent is held.
        let held = if most > MOST { (most - MOST) / (most - least) } else { 0.0 };
        let top = most.min(MOST);
        length * (held * MOST.exp() + (1.0 - held) * mean(top, top - least))
    }

    #[cfg(test)]
    fn examples() -> Vec<Self> {
        let make = |up: [f64; 3], height, scale_height| Self {
            up: DVec3::from(up).normalize(),
            height,
            scale_height,
        };
        vec![
            make([0.0, 1.0, 0.0], 0.0, 1.0),
            make([1.0, -2.0, 0.5], 1.0, 0.3),
            make([0.0, 0.0, 1.0], -2.0, 1e6),
            make([0.0, 0.0, -1.0], 0.0, 0.03),
        ]
    }
}
