//! Sums that do not depend on the order of their terms: the same bits for any partition of them.
//!
//! The exponents of all numbers are divided into windows of [`WIDTH`] bits. A sum keeps an integer for the highest
//! window that any of its terms reaches and one for the window below; a term is cut at the windows' borders, and what
//! falls lower is dropped. Which windows are kept depends on the largest term alone, and integers add up exactly
//! (after Demmel and Nguyen, "Parallel Reproducible Summation", 2015).

/// Bits of a window. A term occupies at most this many of the 63 bits of an integer: 2^27 terms cannot overflow it.
const WIDTH: i32 = 36;

/// Terms of a sum, at most.
pub const MOST_TERMS: u64 = 1 << (63 - WIDTH);

/// The window of what is no finite number: beyond that of every other, so that the sum is none either.
const NOT_FINITE: i16 = i16::MAX;

/// A sum of finite numbers, off by less than 2^-[`WIDTH`] of its largest term for every term.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ExactSum {
    /// The higher window's part, and the lower one's.
    parts: [i64; 2],
    /// The number of the higher window; 0 before the first term other than 0.
    window: i16,
}

impl ExactSum {
    /// Adds a number. A sum with a term that is not finite is NaN.
    #[inline]
    pub fn add(&mut self, term: f64) {
        let (exponent, fraction) = (term.to_bits() >> 52 & 0x7ff, term.to_bits() & ((1 << 52) - 1));
        if exponent == 0 || exponent == 0x7ff {
            return self.add_rare(term);
        }
        // The last bit of the number is bit `exponent` of all that numbers can have.
        let (lowest, digits) = (exponent as i32, fraction | 1 << 52);
        let window = (lowest + 52) / WIDTH;
        let shift = lowest - (window - 1) * WIDTH;
        let lower = if shift >= 0 { digits << shift } else { digits >> -shift } & ((1 << WIDTH) - 1);
        let (upper, lower) = ((digits >> (WIDTH - shift)) as i64, lower as i64);
        let parts = if term < 0.0 { [-upper, -lower] } else { [upper, lower] };
        if i32::from(self.window) == window {
            self.parts = [self.parts[0] + parts[0], self.parts[1] + parts[1]];
        } else {
            self.merge(&Self { parts, window: window as i16 });
        }
    }

    /// Adds 0, a number below the smallest that has all digits, or what is no number.
    #[cold]
    fn add_rare(&mut self, term: f64) {
        if !term.is_finite() {
            self.window = NOT_FINITE;
        } else if term != 0.0 {
            // Its highest bit is below those of all others, in window 0 or 1.
            let scaled = term.abs().to_bits() as i64 * 2;
            let (window, upper, lower) = if scaled < 1 << WIDTH {
                (0, scaled, 0)
            } else {
                (1, scaled >> WIDTH, scaled & ((1 << WIDTH) - 1))
            };
            let sign = if term < 0.0 { -1 } else { 1 };
            self.merge(&Self { parts: [sign * upper, sign * lower], window });
        }
    }

    /// Adds all terms of `other`.
    #[inline]
    pub fn merge(&mut self, other: &Self) {
        let (high, low) = if self.window >= other.window { (*self, *other) } else { (*other, *self) };
        self.window = high.window;
        self.parts = match high.window - low.window {
            0 => [high.parts[0] + low.parts[0], high.parts[1] + low.parts[1]],
            1 => [high.parts[0], high.parts[1] + low.parts[0]],
            _ => high.parts,
        };
    }

    /// Its window and parts, for a file: the sum is (parts\[0\] 2^36 + parts\[1\]) 2^(36 window - 1111).
    pub fn to_parts(self) -> (i16, [i64; 2]) {
        (self.window, self.parts)
    }

    /// The sum that has these.
    pub fn from_parts(window: i16, parts: [i64; 2]) -> Self {
        Self { parts, window }
    }

    /// The sum, off by a rounding error or two.
    #[inline]
    pub fn value(&self) -> f64 {
        if self.window == NOT_FINITE {
            return f64::NAN;
        }
        // Of bit 1 of all that numbers can have, whose weight is 2^-1074.
        let scale = (i32::from(self.window) - 1) * WIDTH - 1075;
        let whole = self.parts[0] as f64 * (1u64 << WIDTH) as f64 + self.parts[1] as f64;
        let half = scale / 2;
        whole * power_of_two(half) * power_of_two(scale - half)
    }
}

/// 2^`exponent`, which is that of a number with all digits.
fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((exponent + 1023) as u64) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{Stream, stream::Purpose};

    fn sum(terms: &[f64]) -> ExactSum {
        terms.iter().fold(ExactSum::default(), |mut sum, term| {
            sum.add(*term);
            sum
        })
    }

    /// Numbers of either sign and of every size between 2^-span and 2^span.
    fn numbers(count: usize, span: f64, index: u64) -> Vec<f64> {
        let mut stream = Stream::new(1996, index, 0, Purpose::Pilot);
        let mut one = |_| {
            let size = (2.0 * f64::from(stream.uniform()) - 1.0) * span;
            (f64::from(stream.uniform()) - 0.3) * size.exp2()
        };
        (0..count).map(&mut one).collect()
    }

    #[test]
    fn any_order_and_any_partition_gives_the_same_bits() {
        for (index, span) in (0..).zip([0.0, 1.0, 10.0, 40.0, 120.0, 1000.0]) {
            let terms = numbers(300, span, index);
            let all = sum(&terms);
            let backwards: Vec<f64> = terms.iter().rev().copied().collect();
            assert_eq!(sum(&backwards), all, "{span}");
            for parts in [2, 3, 7, 300] {
                let chunks = terms.chunks(terms.len().div_ceil(parts));
                let mut merged = ExactSum::default();
                chunks.rev().for_each(|chunk| merged.merge(&sum(chunk)));
                assert_eq!(merged, all, "{span} in {parts}");
            }
        }
    }

    #[test]
    fn a_sum_is_as_near_as_it_says() {
        for (index, span) in (0..).zip([0.0, 5.0, 30.0, 100.0]) {
            let terms = numbers(1000, span, index);
            let largest = terms.iter().fold(0.0, |most: f64, term| most.max(term.abs()));
            let (plain, found): (f64, f64) = (terms.iter().sum(), sum(&terms).value());
            let bound = 1000.0 * largest * (2f64.powi(-WIDTH) + f64::EPSILON);
            assert!((found - plain).abs() <= bound, "{span}: {found:e} {plain:e}");
        }
    }

    #[test]
    fn single_numbers_and_equal_ones_are_exact() {
        let tiny = f64::from_bits(1);
        for x in [0.0, -0.0, 1.0, -1.5, 0.1f32.into(), 3e38, -1e-45, tiny, f64::MIN_POSITIVE, f32::MAX.into()]
        {
            // Single precision has few enough digits for the windows to hold every one of them.
            let x = f64::from(x as f32);
            assert_eq!(sum(&[x]).value(), x, "{x:e}");
            assert_eq!(sum(&[x; 1000]).value(), 1000.0 * x, "{x:e}");
            assert_eq!(sum(&[x, -x]).value(), 0.0, "{x:e}");
        }
        assert!(
            sum(&[1.0, f64::NAN, 2.0]).value().is_nan() && sum(&[f64::INFINITY, -1e300]).value().is_nan()
        );
        assert!((sum(&[f64::MAX]).value() / f64::MAX - 1.0).abs() < 1e-11);
    }
}
