//! Errors relative to an image, in any unit of radiance.

use super::{Spectrum, SpectrumExt};

/// The share of the squared mean luminance that keeps relative squares finite where the image is black, and the share of
/// the mean luminance that does so for relative differences. As both scale with the image, no relative error depends on
/// the unit of its radiance.
const FLOOR: f64 = 0.01;

/// What errors are relative to: an image r of mean luminance m.
#[derive(Clone, Copy, Debug)]
pub struct Relative {
    mean: f64,
}

impl Relative {
    /// To an image of this mean luminance.
    pub fn to_mean(mean: f64) -> Self {
        Self { mean: mean.abs() }
    }

    /// To `image`, of which the first `channels` (1 to 3) count: three by luminance, fewer by their mean.
    pub fn to(image: &[Spectrum], channels: usize) -> Self {
        let size = |pixel: &Spectrum| match channels {
            3 => pixel.abs().luminance(),
            _ => pixel.to_array()[..channels].iter().map(|c| c.abs()).sum::<f32>() / channels as f32,
        };
        // One broken pixel must not decide for all.
        let sizes = image.iter().map(|pixel| f64::from(size(pixel))).filter(|size| size.is_finite());
        Self::to_mean(sizes.sum::<f64>() / image.len().max(1) as f64)
    }

    /// `square` / (r^2 + 0.01 m^2), of a squared difference or a variance.
    pub fn square(self, square: f64, r: f64) -> f64 {
        quotient(square, r * r + FLOOR * self.mean * self.mean)
    }

    /// `difference` / (|r| + 0.01 m).
    pub fn difference(self, difference: f64, r: f64) -> f64 {
        quotient(difference, r.abs() + FLOOR * self.mean)
    }
}

/// In a black image only equal values have no error.
fn quotient(error: f64, scale: f64) -> f64 {
    if error == 0.0 { 0.0 } else { error / scale }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_relative_error_depends_on_the_unit_of_radiance() {
        let errors = |unit: f32| {
            let image = [1.0, 0.0, 3.0].map(|value| Spectrum::splat(unit * value));
            let (to, unit) = (Relative::to(&image, 3), f64::from(unit));
            [to.square(unit * unit, 0.0), to.square(unit * unit, unit), to.difference(unit, 0.0)]
        };
        let one = errors(1.0);
        assert!(
            (one[0] / (9.0 / 16.0 * 100.0) - 1.0).abs() < 1e-5 && (one[2] - 75.0).abs() < 1e-3,
            "{one:?}"
        );
        for unit in [1e-12, 1e-3, 1e3, 1e12] {
            let found = errors(unit);
            assert!(one.iter().zip(found).all(|(one, found)| (found / one - 1.0).abs() < 1e-5), "{found:?}");
        }
    }

    #[test]
    fn of_black_images_only_equal_values_have_no_error() {
        let to = Relative::to(&[Spectrum::ZERO], 3);
        assert_eq!([to.square(0.0, 0.0), to.difference(0.0, 0.0)], [0.0; 2]);
        assert_eq!([to.square(1.0, 0.0), to.difference(1.0, 0.0)], [f64::INFINITY; 2]);
    }

    #[test]
    fn broken_pixels_and_further_channels_do_not_count() {
        let image = [Spectrum::splat(2.0), Spectrum::NAN];
        assert_eq!(Relative::to(&image, 3).square(1.0, 0.0), Relative::to_mean(1.0).square(1.0, 0.0));
        let layer = [super::super::vec3(-4.0, 9.0, 9.0)];
        assert_eq!(Relative::to(&layer, 1).difference(1.0, 0.0), 25.0);
    }
}
