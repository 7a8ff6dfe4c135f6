//! Gauss-Legendre quadrature: exact for polynomials, with positive weights, so that nothing cancels.

use std::f64::consts::PI;

/// Points in (-1, 1) with weights that sum to 1: exact means of polynomials up to the degree 2 `count` - 1.
pub(super) fn gauss(count: usize) -> Vec<[f64; 2]> {
    (0..count).map(|i| node(count, i)).collect()
}

/// The i-th root of the Legendre polynomial of degree `count` by Newton's steps, and its weight.
fn node(count: usize, i: usize) -> [f64; 2] {
    let mut x = (PI * (i as f64 + 0.75) / (count as f64 + 0.5)).cos();
    for _ in 0..20 {
        let [p, slope] = legendre(count, x);
        x -= p / slope;
    }
    let [_, slope] = legendre(count, x);
    [x, 1.0 / ((1.0 - x * x) * slope * slope)]
}

/// The Legendre polynomial and its derivative, by the recurrence of three terms.
fn legendre(degree: usize, x: f64) -> [f64; 2] {
    let (mut before, mut p) = (0.0, 1.0);
    for k in 1..=degree {
        let k = k as f64;
        (before, p) = (p, ((2.0 * k - 1.0) * x * p - (k - 1.0) * before) / k);
    }
    [p, degree as f64 * (before - x * p) / (1.0 - x * x)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_of_powers_are_exact() {
        for count in 1..=16 {
            for power in 0..2 * count as i32 {
                let mean: f64 = gauss(count).iter().map(|[x, weight]| weight * x.powi(power)).sum();
                let exact = if power % 2 == 0 { 1.0 / f64::from(power + 1) } else { 0.0 };
                assert!((mean - exact).abs() < 1e-14, "{count} {power}: {mean} {exact}");
            }
        }
    }
}
