//! Ranges of numbers.

use std::fmt::{self, Display, Formatter};

/// Numbers that are allowed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// The lower limit.
    pub low: f64,
    /// The upper limit.
    pub high: f64,
    /// True for a limit that is not allowed itself.
    pub open: [bool; 2],
}

/// Every finite number.
pub const ANY: Range = Range { low: f64::MIN, high: f64::MAX, open: [false; 2] };

/// Numbers that f32 holds have this limit, which is not worth a word.
pub const MAX: f64 = f32::MAX as f64;

/// From `low` to `high`, both allowed.
pub const fn within(low: f64, high: f64) -> Range {
    Range { low, high, open: [false; 2] }
}

/// Between `low` and `high`, neither allowed.
pub const fn between(low: f64, high: f64) -> Range {
    Range { low, high, open: [true; 2] }
}

/// Above `low`, `high` allowed.
pub const fn above(low: f64, high: f64) -> Range {
    Range { low, high, open: [true, false] }
}

impl Range {
    /// True if `number` is allowed.
    pub fn contains(&self, number: f64) -> bool {
        let low = if self.open[0] { number > self.low } else { number >= self.low };
        low && if self.open[1] { number < self.high } else { number <= self.high }
    }

    /// True if there is an upper limit worth telling.
    pub fn is_bounded(&self) -> bool {
        self.high < MAX
    }

    /// What is allowed, after "a number"; to be told of `number`, which is not.
    pub(super) fn told(&self, number: f64) -> String {
        let (low, high, is_above) = (plain(self.low), plain(self.high), number > self.high);
        match self.open {
            _ if *self == ANY => String::new(),
            [false, _] if !self.is_bounded() && !is_above => format!(" >= {low}"),
            [true, _] if !self.is_bounded() && !is_above => format!(" > {low}"),
            [false, false] => format!(" from {low} to {high}"),
            [true, true] => format!(" between {low} and {high} (both excluded)"),
            _ => format!(" above {low}, up to {high}"),
        }
    }
}

impl Display for Range {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(&self.told(self.low))
    }
}

/// A number in as few characters as tell it.
pub fn plain(number: f64) -> String {
    let size = number.abs();
    let is_short = size == 0.0 || (1e-4..1e7).contains(&size) || size.fract() == 0.0 && size < 1e12;
    if is_short { number.to_string() } else { format!("{number:e}") }
}
