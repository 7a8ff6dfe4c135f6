//! How far an image is from a reference: the measures of a study, in double precision, every value alike.

use crate::math::{Spectrum, relative::Relative};
use serde::Serialize;

/// The share of the worst values that the trimmed measure leaves out.
const TRIMMED: f64 = 0.001;

/// Means over all values (pixels x channels) of an image x against its reference r.
///
/// Where a value of either is not finite every measure is NaN: such an image is broken, not noisy.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Measures {
    /// mean((x - r)^2) (radiance^2).
    pub mse: f64,
    /// Square root of the mean squared error (radiance).
    pub rmse: f64,
    /// mean((x - r)^2 / (r^2 + 0.01 m^2)), m the mean luminance of r.
    pub relmse: f64,
    /// The same without the worst 0.1 % of values (rounded down: of fewer than 1000 none is left out).
    pub trimmed_relmse: f64,
    /// mean(|x - r| / (|r| + 0.01 m)).
    pub mape: f64,
    /// mean(2 |x - r| / (|x| + |r| + 0.01 m)).
    pub smape: f64,
    /// mean(x) / mean(r) - 1: what is left of it where samples grow many is bias. 0 where the means are equal,
    /// infinite where only the reference's is 0.
    pub difference: f64,
    /// Pairs of values that are not both finite, or that one image lacks.
    pub not_finite: usize,
}

/// The measures of `image` against `reference`. Both have the same size; what one lacks counts as not finite.
pub fn measures(image: &[Spectrum], reference: &[Spectrum]) -> Measures {
    measures_of(image, reference, 3)
}

/// The same of the first `channels` (1 to 3) of every pixel.
pub fn measures_of(image: &[Spectrum], reference: &[Spectrum], channels: usize) -> Measures {
    let absent = Spectrum::NAN;
    let pixel = |pixels: &[Spectrum], at: usize| pixels.get(at).copied().unwrap_or(absent);
    let (to, mut sums) = (Relative::to(reference, channels), Sums::default());
    for at in 0..image.len().max(reference.len()) {
        let (x, r) = (pixel(image, at), pixel(reference, at));
        for channel in 0..channels {
            sums.add(f64::from(x[channel]), f64::from(r[channel]), to);
        }
    }
    sums.measures()
}

/// Mean of every channel.
pub fn means(pixels: &[Spectrum]) -> [f64; 3] {
    let sum = pixels.iter().fold(crate::math::DVec3::ZERO, |sum, pixel| sum + pixel.as_dvec3());
    (sum / pixels.len() as f64).to_array()
}

#[derive(Default)]
struct Sums {
    squares: f64,
    relative_squares: Vec<f64>,
    relative: f64,
    symmetric: f64,
    image: f64,
    reference: f64,
    not_finite: usize,
}

impl Sums {
    fn add(&mut self, x: f64, r: f64, to: Relative) {
        if !(x.is_finite() && r.is_finite()) {
            self.not_finite += 1;
            return;
        }
        let off = (x - r).abs();
        self.squares += off * off;
        self.relative_squares.push(to.square(off * off, r));
        self.relative += to.difference(off, r);
        self.symmetric += to.difference(2.0 * off, x.abs() + r.abs());
        self.image += x;
        self.reference += r;
    }

    fn measures(mut self) -> Measures {
        let not_finite = self.not_finite;
        if not_finite > 0 {
            // Of nothing left no mean is known: every quotient below is NaN.
            self = Self::default();
        }
        let count = self.relative_squares.len() as f64;
        let mse = self.squares / count;
        let equal = self.image == self.reference && count > 0.0;
        Measures {
            mse,
            rmse: mse.sqrt(),
            relmse: self.relative_squares.iter().sum::<f64>() / count,
            trimmed_relmse: trimmed_mean(&mut self.relative_squares),
            mape: self.relative / count,
            smape: self.symmetric / count,
            difference: if equal { 0.0 } else { (self.image / count) / (self.reference / count) - 1.0 },
            not_finite,
        }
    }
}

/// The mean without the largest 0.1 %; changes the order of `values`.
fn trimmed_mean(values: &mut [f64]) -> f64 {
    let kept = values.len() - (values.len() as f64 * TRIMMED) as usize;
    if kept < values.len() {
        values.select_nth_unstable_by(kept, f64::total_cmp);
    }
    values[..kept].iter().sum::<f64>() / kept as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::vec3;

    fn close(found: f64, expected: f64) -> bool {
        (found - expected).abs() <= 1e-6 * expected.abs()
    }

    /// By hand, for x = (1, 0, 2) and r = (0.5, 0, 4), of luminance m = 0.5 R + 4 B: squares 0.25, 0, 4 relative to r^2
    /// + 0.01 m^2; absolute 0.5, 0, 2 relative to |r| + 0.01 m, and twice them to |x| + |r| + 0.01 m.
    #[test]
    fn measures_are_those_worked_out_by_hand() {
        let m = measures(&[vec3(1.0, 0.0, 2.0)], &[vec3(0.5, 0.0, 4.0)]);
        assert!(close(m.mse, 4.25 / 3.0) && close(m.rmse, (4.25f64 / 3.0).sqrt()), "{m:?}");
        let floor = 0.5 * 0.212_671 + 4.0 * 0.072_169;
        let (square, floor) = (0.01 * floor * floor, 0.01 * floor);
        assert!(close(m.relmse, (0.25 / (0.25 + square) + 4.0 / (16.0 + square)) / 3.0), "{m:?}");
        assert!(close(m.mape, (0.5 / (0.5 + floor) + 2.0 / (4.0 + floor)) / 3.0), "{m:?}");
        assert!(close(m.smape, (1.0 / (1.5 + floor) + 4.0 / (6.0 + floor)) / 3.0), "{m:?}");
        assert!(close(m.difference, 3.0 / 4.5 - 1.0) && m.trimmed_relmse == m.relmse, "{m:?}");
        let red = measures_of(&[vec3(1.0, 0.0, 2.0)], &[vec3(0.5, 0.0, 4.0)], 1);
        assert!(close(red.mse, 0.25) && close(red.difference, 1.0), "{red:?}");
    }

    #[test]
    fn equal_images_are_at_no_distance_black_ones_too() {
        for pixel in [Spectrum::ZERO, vec3(1e-30, 3.0, 1e30)] {
            let m = measures(&[pixel], &[pixel]);
            let all = [m.mse, m.rmse, m.relmse, m.trimmed_relmse, m.mape, m.smape, m.difference];
            assert_eq!((all, m.not_finite), ([0.0; 7], 0));
        }
        assert_eq!(measures(&[Spectrum::ONE], &[Spectrum::ZERO]).difference, f64::INFINITY);
    }

    /// 999 values are 0.1 off 1, one is 10 off: 2 of 2001 values are left out.
    #[test]
    fn trimming_leaves_out_the_worst_values() {
        let mut image = vec![Spectrum::splat(1.1); 667];
        image[333].y = 11.0;
        let reference = vec![Spectrum::ONE; 667];
        let m = measures(&image, &reference);
        assert!((m.relmse - (2000.0 * 0.01 + 100.0) / 1.01 / 2001.0).abs() < 1e-6, "{m:?}");
        assert!((m.trimmed_relmse - 0.01 / 1.01).abs() < 1e-6, "{m:?}");
    }

    #[test]
    fn broken_values_are_counted_and_spoil_every_measure() {
        let broken = [vec3(1.0, f32::NAN, 1.0), vec3(f32::INFINITY, 1.0, 1.0)];
        for (image, reference, count) in
            [(&broken[..], &[Spectrum::ONE; 2][..], 2), (&broken, &broken, 2), (&[Spectrum::ONE], &broken, 4)]
        {
            let m = measures(image, reference);
            let all = [m.mse, m.rmse, m.relmse, m.trimmed_relmse, m.mape, m.smape, m.difference];
            assert!(all.iter().all(|measure| measure.is_nan()), "{m:?}");
            assert_eq!(m.not_finite, count);
        }
        assert!(measures(&[], &[]).mse.is_nan());
    }

    #[test]
    fn means_are_those_of_each_channel() {
        assert_eq!(means(&[vec3(1.0, 2.0, 3.0), vec3(3.0, 0.0, -3.0)]), [2.0, 1.0, 0.0]);
    }
}
