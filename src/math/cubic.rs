//! Cubic equations with one real root.

/// The only real y with y^3 + 3 a^2 y = 2 b, for a > 0: 2 a sinh(asinh(b / a^3) / 3). It rises with b, is odd in it, and
/// has all its digits, as nothing cancels.
#[inline]
pub fn root(a: f64, b: f64) -> f64 {
    2.0 * a * ((b / (a * a * a)).asinh() / 3.0).sinh()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_solve_their_equations() {
        for a in [1e-3f64, 0.6, 1.0, 40.0] {
            for b in [0.0, 1e-12, -0.3, 2.0, -1e6] {
                let y = root(a, b);
                let size = (y * y * y).abs().max(2.0 * f64::abs(b)).max(1e-300);
                assert!((y * y * y + 3.0 * a * a * y - 2.0 * b).abs() <= 1e-13 * size, "{a} {b}: {y}");
                assert_eq!(root(a, -b), -y);
            }
        }
    }
}
