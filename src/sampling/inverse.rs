//! Inverse distribution functions, for numbers whose order must be kept. u = (bits + 1/2) 2^-64 is distinct from both 0
//! and 1, so that either tail is as fine as it should be.

use statrs::function::erf::erfc_inv;

const SCALE: f64 = 1.0 / (1u128 << 64) as f64;

/// The distance of u from the nearer end of (0, 1), and whether this end is 1.
fn nearer_end(bits: u64) -> (f64, bool) {
    let high = bits >> 63 == 1;
    let steps = if high { !bits } else { bits };
    ((steps as f64 + 0.5) * SCALE, high)
}

/// Exponential with mean 1: -ln(1 - u), rising with `bits`.
pub(super) fn exponential(bits: u64) -> f64 {
    match nearer_end(bits) {
        (rest, true) => -rest.ln(),
        (u, false) => -(-u).ln_1p(),
    }
}

/// Standard normal, rising with `bits`.
pub(super) fn normal(bits: u64) -> f64 {
    let (rest, high) = nearer_end(bits);
    let size = std::f64::consts::SQRT_2 * erfc_inv(2.0 * rest);
    if high { size } else { -size }
}

#[cfg(test)]
mod tests {
    use super::*;
    use statrs::distribution::{ContinuousCDF, Normal};

    /// Bits for which u is as given, from below or from above.
    fn bits(u: f64, from_above: bool) -> u64 {
        let steps = (u / SCALE) as u64;
        if from_above { !steps } else { steps }
    }

    #[test]
    fn both_tails_of_the_exponential_are_exact() {
        for depth in [1e-12, 1e-7, 1e-3, 0.3, 0.69, 0.7, 2.0, 10.0, 40.0f64] {
            let from_above = depth > 1.0;
            let u = if from_above { (-depth).exp() } else { -(-depth).exp_m1() };
            let x = exponential(bits(u, from_above));
            // At 40 there are some 78 steps left of the 2^64.
            let slack = if depth < 39.0 { 1e-6 } else { 1e-3 };
            assert!((x - depth).abs() < slack * depth, "{depth}: {x}");
        }
        assert!(exponential(0) > 0.0 && exponential(u64::MAX) < 46.0);
        assert!(exponential((1 << 63) - 1) <= exponential(1 << 63));
    }

    #[test]
    fn the_normal_is_what_statistics_says() {
        let truth = Normal::standard();
        for z in [-8.0, -4.0, -1.0, -1e-6, 0.5, 3.0, 8.0f64] {
            let x = normal(bits(truth.sf(z.abs()), z > 0.0));
            assert!((x - z).abs() < 1e-4 + 1e-6 * z.abs(), "{z}: {x}");
        }
        assert!(normal(0).is_finite() && normal(0) == -normal(u64::MAX));
    }
}
