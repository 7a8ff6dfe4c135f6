//! The inverse of the error function in single precision.

/// The greatest number below 1: the inverse ends there and at its negative, near 3.8.
pub const LAST: f32 = 1.0 - 0.5 * f32::EPSILON;

/// erf^-1(x) / x in powers of w = -ln(1 - x^2), for w < 5.
const MIDDLE: [f32; 8] = [
    0.886_226_7,
    0.232_021_37,
    0.011_509_27,
    -0.002_256_756,
    -0.000_202_778_3,
    8.512_2e-5,
    -8.709_638e-6,
    3.156_439e-7,
];

/// The same in powers of the root of w, above.
const ENDS: [f32; 7] =
    [2.148_117, -2.710_331, 2.499_148, -0.906_188_4, 0.186_289, -0.020_525_9, 0.000_945_120_9];

/// The number whose error function is `x`, within 3e-6 of it, relative; `x` beyond `LAST` counts as that.
#[inline]
pub fn erf_inv(x: f32) -> f32 {
    let x = x.clamp(-LAST, LAST);
    let w = -((1.0 - x) * (1.0 + x)).ln();
    x * if w < 5.0 { polynomial(&MIDDLE, w) } else { polynomial(&ENDS, w.sqrt()) }
}

#[inline]
fn polynomial(coefficients: &[f32], x: f32) -> f32 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * x + c)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_the_inverse() {
        let inner = (-999..1_000).map(|i| i as f32 / 1_000.0);
        let outer = (4..24).map(|i| 1.0 - 0.5f32.powi(i));
        for x in inner.chain(outer).chain([LAST]) {
            let (found, exact) = (erf_inv(x), statrs::function::erf::erf_inv(f64::from(x)) as f32);
            assert!((found - exact).abs() <= 3e-6 * exact.abs(), "{x}: {found} for {exact}");
        }
        assert_eq!((erf_inv(1.0), erf_inv(-1.0)), (erf_inv(LAST), -erf_inv(LAST)));
    }
}
