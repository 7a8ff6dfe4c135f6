//! Operations of a wrap mode on ranges of samples and on coordinates.

use crate::math::Wrap;

impl Wrap {
    /// The least and the greatest index that represent those from `low` to `high`; all in between are taken for
    /// hit, which may be too many.
    pub fn indices(self, [low, high]: [i64; 2], size: usize) -> [usize; 2] {
        let n = size as i64;
        if self != Self::Clamp && low.div_euclid(n) != high.div_euclid(n) {
            return [0, size - 1];
        }
        let (a, b) = (self.index(low, size), self.index(high, size));
        [a.min(b), a.max(b)]
    }

    /// The coordinate in [0, 1] that represents `x`, in units of the cube.
    #[inline]
    pub fn coordinate(self, x: f64) -> f64 {
        if (0.0..=1.0).contains(&x) && !(self == Self::Repeat && x == 1.0) {
            return x;
        }
        match self {
            Self::Clamp => x.clamp(0.0, 1.0),
            Self::Repeat => x - x.floor(),
            Self::Mirror => {
                let within = x - 2.0 * (0.5 * x).floor();
                within.min(2.0 - within)
            }
        }
    }

    /// Bounds of the coordinates that represent those from `low` to `high`.
    pub fn interval(self, low: f64, high: f64) -> [f64; 2] {
        if self != Self::Clamp && low.floor() != high.floor() {
            return [0.0, 1.0];
        }
        let (a, b) = (self.coordinate(low), self.coordinate(high));
        [a.min(b), a.max(b)]
    }
}
