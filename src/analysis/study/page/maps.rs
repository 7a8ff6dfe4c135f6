//! False colours of what went wrong: relative squared errors, and relative variances, on one logarithmic scale.

use super::figures::power_of_ten;
use crate::{
    analysis::picture,
    math::{Spectrum, relative::Relative},
};

/// The squared error of each pixel over the reference's square: its mean over the image is relMSE.
pub(in crate::analysis::study) fn errors(image: &[Spectrum], reference: &[Spectrum]) -> Vec<f64> {
    let to = Relative::to(reference, 3);
    means(image, reference, |x, r| to.square((x - r).powi(2), r))
}

/// The variance of each pixel over the reference's square: what [`errors`] are in the mean, but for bias.
pub(super) fn variances(variance: &[Spectrum], reference: &[Spectrum]) -> Vec<f64> {
    let to = Relative::to(reference, 3);
    means(variance, reference, |variance, r| to.square(variance, r))
}

/// Means over channels of what `of` makes of values and those of the reference.
fn means(image: &[Spectrum], reference: &[Spectrum], of: impl Fn(f64, f64) -> f64) -> Vec<f64> {
    let pixel = |(x, r): (&Spectrum, &Spectrum)| {
        let channel = |c: usize| of(f64::from(x[c]), f64::from(r[c]));
        (channel(0) + channel(1) + channel(2)) / 3.0
    };
    image.iter().zip(reference).map(pixel).collect()
}

/// A logarithmic scale of whole decades.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scale {
    /// The power of ten that is black.
    pub low: i32,
    /// The power of ten that is brightest.
    pub high: i32,
}

impl Scale {
    /// Of all `values` together: the least decades that 98 % of those above 0 lie in, from two to six.
    pub(super) fn of<'a>(values: impl Iterator<Item = &'a f64>) -> Self {
        let mut logs: Vec<f64> = values.filter(|v| **v > 0.0 && v.is_finite()).map(|v| v.log10()).collect();
        logs.sort_by(f64::total_cmp);
        let Some(last) = logs.len().checked_sub(1) else { return Self { low: -6, high: 0 } };
        let at = |share: f64| logs[(share * last as f64) as usize];
        let high = at(0.99).ceil() as i32;
        let low = (at(0.01).floor() as i32).clamp(high - 6, high - 2);
        Self { low, high }
    }

    /// Where `value` is on the bar: 0 at the low end and below, 1 at the high end and above.
    fn share(self, value: f64) -> f64 {
        let share = (value.log10() - f64::from(self.low)) / f64::from(self.high - self.low);
        share.clamp(0.0, 1.0)
    }

    /// Three bytes a pixel.
    pub(super) fn coloured(self, values: &[f64]) -> Vec<u8> {
        let share = |value: &f64| if *value <= 0.0 { 0.0 } else { self.share(*value) as f32 };
        picture::false_colour(&values.iter().map(share).collect::<Vec<_>>(), (0.0, 1.0))
    }

    /// The whole scale in a row of 256 pixels.
    pub(super) fn bar() -> Vec<u8> {
        let shares: Vec<f32> = (0..=255u8).map(|k| f32::from(k) / 255.0).collect();
        picture::false_colour(&shares, (0.0, 1.0))
    }

    /// What is written beside the bar: texts for some decades, both ends among them, and where (%).
    pub(super) fn ticks(self) -> Vec<(String, f64)> {
        let decades = f64::from(self.high - self.low);
        let place = |k: i32| 100.0 * f64::from(k - self.low) / decades;
        // More texts than three or four do not fit.
        let step = match self.high - self.low {
            decades if decades <= 3 => 1,
            decades if decades % 2 == 0 => decades / 2,
            decades => decades,
        };
        (self.low..=self.high).step_by(step as usize).map(|k| (power_of_ten(k), place(k))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_those_of_relmse() {
        let (image, reference) = ([Spectrum::splat(0.3)], [Spectrum::splat(0.1)]);
        assert!((errors(&image, &reference)[0] - 0.04 / 0.0101).abs() < 1e-5);
        assert!((variances(&image, &reference)[0] - 0.3 / 0.0101).abs() < 1e-4);
        assert_eq!(errors(&[Spectrum::ZERO], &[Spectrum::ZERO]), [0.0]);
    }

    #[test]
    fn the_scale_holds_what_there_is() {
        let values: Vec<f64> = (0..1000).map(|k| 10f64.powf(-4.0 + 3.0 * f64::from(k) / 999.0)).collect();
        assert_eq!(Scale::of(values.iter()), Scale { low: -4, high: -1 });
        assert_eq!(Scale::of([0.0, f64::NAN].iter()), Scale { low: -6, high: 0 });
        assert_eq!(Scale::of([1.0; 5].iter()), Scale { low: -2, high: 0 });
        let wide = Scale::of([1e-300, 1e300].iter());
        assert!(wide.high - wide.low <= 6, "{wide:?}");
    }

    #[test]
    fn colours_run_from_dark_to_bright() {
        let scale = Scale { low: -2, high: 0 };
        let bytes = scale.coloured(&[0.0, 1e-2, 0.1, 1.0, 1e9, f64::INFINITY, f64::NAN]);
        let sums: Vec<u32> = bytes.chunks(3).map(|c| c.iter().map(|b| u32::from(*b)).sum()).collect();
        assert!(sums[0] == sums[1] && sums[1] < sums[2] && sums[2] < sums[3], "{sums:?}");
        assert_eq!(bytes[9..12], bytes[12..15]);
        assert_eq!(bytes[18..], [0, 255, 0]);
        let ticks = scale.ticks();
        assert_eq!(ticks.first().unwrap().1, 0.0);
        assert_eq!(ticks.last().unwrap(), &("10⁰".to_owned(), 100.0));
    }
}
