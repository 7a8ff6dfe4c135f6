//! Angles of directions, where maps and cells are looked up by them and the system's functions would take most of the time.

use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI};

/// tan(pi/8): where atan is taken about pi/4 in place of 0.
const TAN_PI_8: f32 = 0.414_213_56;

/// As [`f32::atan2`] within 3 units in the last place, for finite numbers that are not both 0 (0 of those): the polynomial is that of
/// Moshier's Cephes library.
#[inline]
pub fn atan2(y: f32, x: f32) -> f32 {
    let (across, along) = (x.abs(), y.abs());
    let (low, high) = (across.min(along), across.max(along).max(f32::MIN_POSITIVE));
    let (near, t) =
        if low > TAN_PI_8 * high { (FRAC_PI_4, (low - high) / (low + high)) } else { (0.0, low / high) };
    let z = t * t;
    let cubic = ((8.053_744_5e-2 * z - 1.387_768_6e-1) * z + 1.997_771_1e-1) * z - 3.333_295e-1;
    let first = near + (t + t * (z * cubic));
    let upper = if along > across { FRAC_PI_2 - first } else { first };
    let angle = if x.is_sign_negative() { PI - upper } else { upper };
    angle.copysign(y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_are_those_of_the_standard_library() {
        for step in 0..400_000 {
            let angle = f64::from(step) * 1e-5 * std::f64::consts::PI - 2.0 * std::f64::consts::PI;
            let length = 10f64.powi(step % 60 - 30);
            let (y, x) = ((length * angle.sin()) as f32, (length * angle.cos()) as f32);
            let (found, exact) = (f64::from(atan2(y, x)), f64::from(y).atan2(f64::from(x)));
            assert!((found - exact).abs() <= 3.0 * f64::from(f32::EPSILON) * exact.abs(), "{y} {x}: {found}");
        }
        for (y, x) in
            [(0.0, 1.0), (-0.0, 1.0), (0.0, -1.0), (-0.0, -1.0), (1.0, 0.0), (-1.0, -0.0), (0.0, 0.0)]
        {
            assert_eq!(atan2(y, x), f32::atan2(y, x), "{y} {x}");
        }
    }
}
