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

/// The lowest window, from 2^-1039: that of a sum without terms.
const LOWEST: i64 = 2;

/// The window of what reaches 2^1013 or is no finite number: beyond that of every other, so that the sum is none either.
const NOT_FINITE: i64 = 58;

/// A sum's integers for the higher window and for the lower one, for a file: it is
/// (parts\[0\] 2^36 + parts\[1\]) 2^(36 window - 1111).
pub type Parts = (i16, [i64; 2]);

/// `N` sums of numbers below 2^1013, each off by less than 2^-[`WIDTH`] of its largest term, or 2^-1039, for every term.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ExactSums<const N: usize> {
    higher: [i64; N],
    lower: [i64; N],
    /// The numbers of the higher windows.
    windows: [i64; N],
}

impl<const N: usize> Default for ExactSums<N> {
    fn default() -> Self {
        Self { higher: [0; N], lower: [0; N], windows: [LOWEST; N] }
    }
}

#[expect(
    clippy::needless_range_loop,
    reason = "loops over several arrays in step, which the compiler makes vectors of"
)]
impl<const N: usize> ExactSums<N> {
    /// Adds a number to each. A sum with a term that is not finite is NaN.
    #[inline]
    pub fn add(&mut self, terms: [f64; N]) {
        // Of loops without branches the compiler makes a few instructions for all sums at once.
        let (mut scaled, mut fits) = ([0.0; N], true);
        for n in 0..N {
            scaled[n] = terms[n] * power_of_two(1075 - i64::from(WIDTH) * self.windows[n]);
            fits &= scaled[n].abs() < WINDOW;
        }
        if !fits {
            return self.add_beyond(terms);
        }
        for n in 0..N {
            let whole = scaled[n].trunc();
            self.higher[n] += integer(whole);
            self.lower[n] += integer(((scaled[n] - whole) * WINDOW).trunc());
        }
    }

    /// Adds numbers of which some reach beyond the windows.
    #[cold]
    fn add_beyond(&mut self, mut terms: [f64; N]) {
        for n in 0..N {
            let exponent = (terms[n].to_bits() >> 52 & 0x7ff) as i64;
            let window = ((exponent + 52) / i64::from(WIDTH)).max(LOWEST);
            self.raise(n, window);
            if window == NOT_FINITE {
                terms[n] = 0.0;
            }
        }
        self.add(terms);
    }

    /// Moves the sum `n` to `window` where it is not as high.
    fn raise(&mut self, n: usize, window: i64) {
        if window > self.windows[n] {
            let by = window - self.windows[n];
            (self.higher[n], self.lower[n]) = lowered((self.higher[n], self.lower[n]), by);
            self.windows[n] = window;
        }
    }

    /// Adds all terms of `other`.
    #[inline]
    pub fn merge(&mut self, other: &Self) {
        for n in 0..N {
            self.raise(n, other.windows[n]);
            let parts = (other.higher[n], other.lower[n]);
            let (higher, lower) = lowered(parts, self.windows[n] - other.windows[n]);
            self.higher[n] += higher;
            self.lower[n] += lower;
        }
    }

    /// Each of them.
    pub fn parts(&self) -> [Parts; N] {
        std::array::from_fn(|n| (self.windows[n] as i16, [self.higher[n], self.lower[n]]))
    }

    /// The sums of these.
    pub fn from_parts(parts: &[Parts; N]) -> Self {
        Self {
            higher: parts.map(|(_, [higher, _])| higher),
            lower: parts.map(|(_, [_, lower])| lower),
            windows: parts.map(|(window, _)| i64::from(window).clamp(LOWEST, NOT_FINITE)),
        }
    }

    /// Each of them, off by a rounding error or two.
    #[inline]
    pub fn values(&self) -> [f64; N] {
        let mut values = [f64::NAN; N];
        for n in 0..N {
            if self.windows[n] != NOT_FINITE {
                let whole = self.higher[n] as f64 + self.lower[n] as f64 / WINDOW;
                let scale = 1075 - i64::from(WIDTH) * self.windows[n];
                values[n] = whole * power_of_two(-scale);
            }
        }
        values
    }
}

/// 2^[`WIDTH`].
const WINDOW: f64 = (1u64 << WIDTH) as f64;

/// What remains of the integers of two windows where the windows are those `by` higher.
fn lowered((higher, lower): (i64, i64), by: i64) -> (i64, i64) {
    match by {
        0 => (higher, lower),
        1 => (0, higher),
        _ => (0, 0),
    }
}

/// A whole number below 2^51.
#[inline(always)]
fn integer(whole: f64) -> i64 {
    // Added to this, its bits are the last ones of the sum.
    const OFFSET: f64 = (3u64 << 51) as f64;
    (whole + OFFSET).to_bits() as i64 - OFFSET.to_bits() as i64
}

/// 2^`exponent`, which is that of a number with all digits.
#[inline(always)]
fn power_of_two(exponent: i64) -> f64 {
    f64::from_bits(((exponent + 1023) as u64) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{Stream, stream::Purpose};

    fn sum(terms: &[f64]) -> ExactSums<1> {
        terms.iter().fold(ExactSums::default(), |mut sum, term| {
            sum.add([*term]);
            sum
        })
    }

    fn value(terms: &[f64]) -> f64 {
        sum(terms).values()[0]
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
                let mut merged = ExactSums::default();
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
            let (plain, found): (f64, f64) = (terms.iter().sum(), value(&terms));
            let bound = 1000.0 * largest * (2f64.powi(-WIDTH) + f64::EPSILON);
            assert!((found - plain).abs() <= bound, "{span}: {found:e} {plain:e}");
        }
    }

    #[test]
    fn sums_side_by_side_do_not_disturb_each_other() {
        let columns: [Vec<f64>; 4] = [0.0, 20.0, 100.0, 1000.0].map(|span| numbers(300, span, span as u64));
        let mut all = ExactSums::<4>::default();
        (0..300).for_each(|row| all.add([0, 1, 2, 3].map(|column| columns[column][row])));
        assert_eq!(all.parts(), [0, 1, 2, 3].map(|column| sum(&columns[column]).parts()[0]));
        assert_eq!(ExactSums::from_parts(&all.parts()), all);
    }

    #[test]
    fn single_numbers_and_equal_ones_are_exact() {
        for x in [0.0, -0.0, 1.0, -1.5, 0.1f32.into(), 3e38, -1e-45, 1e-300, f32::MAX.into()] {
            // Single precision has few enough digits for the windows to hold every one of them.
            let x = f64::from(x as f32);
            assert_eq!(value(&[x]), x, "{x:e}");
            assert_eq!(value(&[x; 1000]), 1000.0 * x, "{x:e}");
            assert_eq!(value(&[x, -x]), 0.0, "{x:e}");
        }
        assert!((value(&[8e304]) / 8e304 - 1.0).abs() < 1e-11);
        // 2^-1039, the least that a sum holds.
        let least = f64::from_bits(1 << 35);
        assert_eq!(value(&[least; 3]), 3.0 * least);
    }

    #[test]
    fn what_no_sum_can_hold_is_no_number() {
        for terms in [[1.0, f64::NAN, 2.0], [f64::INFINITY, -1e300, 0.0], [0.0, 1.0, f64::MAX]] {
            assert!(value(&terms).is_nan(), "{terms:?}");
        }
        assert_eq!(value(&[1e-315, -1e-315, 1e-315]), 0.0);
    }
}
