//! The sRGB transfer function (IEC 61966-2-1), and the radiance that a screen shows as white.

use super::{Spectrum, SpectrumExt};

/// The transfer function, both ways, of one channel in [0, 1].
pub trait Srgb {
    /// From linear to encoded.
    fn srgb_encoded(self) -> Self;
    /// From encoded to linear.
    fn srgb_decoded(self) -> Self;
}

macro_rules! srgb {
    ($($float:ty),*) => {$(
        impl Srgb for $float {
            fn srgb_encoded(self) -> Self {
                if self <= 0.003_130_8 { 12.92 * self } else { 1.055 * self.powf(1.0 / 2.4) - 0.055 }
            }
            fn srgb_decoded(self) -> Self {
                if self <= 0.04045 { self / 12.92 } else { ((self + 0.055) / 1.055).powf(2.4) }
            }
        }
    )*};
}

srgb!(f32, f64);

/// The nearest byte for an encoded channel in [0, 1].
pub fn byte(encoded: f32) -> u8 {
    (255.0 * encoded).round() as u8
}

/// A pixel as if nothing had gone wrong with it: NaN and negative channels are black. The bound keeps products of two
/// finite.
pub fn shown(pixel: Spectrum) -> Spectrum {
    Spectrum::from_array(pixel.to_array().map(|c| if c > 0.0 { c.min(1e18) } else { 0.0 }))
}

/// The luminance that a `share` of `pixels` do not exceed; none of no pixels.
pub fn white(pixels: &[Spectrum], share: f64) -> Option<f32> {
    let mut luminances: Vec<f32> = pixels.iter().map(|pixel| shown(*pixel).luminance()).collect();
    let rank = ((luminances.len() as f64 * share).ceil() as usize).checked_sub(1)?;
    Some(*luminances.select_nth_unstable_by(rank, f32::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_has_the_values_of_the_standard_and_an_inverse() {
        for (linear, encoded) in [(0.0, 0.0), (0.001, 0.012_92), (0.214_041, 0.5), (1.0, 1.0)] {
            assert!((f64::srgb_encoded(linear) - encoded).abs() < 1e-6, "{linear}");
            assert!((f64::srgb_decoded(encoded) - linear).abs() < 1e-6, "{encoded}");
            assert!((f32::srgb_encoded(linear as f32) - encoded as f32).abs() < 1e-6, "{linear}");
        }
    }

    #[test]
    fn white_is_what_a_share_of_the_pixels_reach() {
        let mut pixels = vec![Spectrum::splat(0.5); 96];
        pixels.extend([Spectrum::splat(1e30), Spectrum::splat(f32::NAN), Spectrum::NEG_ONE, Spectrum::ONE]);
        let white = |share| white(&pixels, share).unwrap();
        assert!((white(0.95) - 0.5).abs() < 1e-6 && (white(0.99) - 1.0).abs() < 1e-6 && white(1.0) > 1e17);
        assert_eq!(super::white(&[], 0.5), None);
    }
}
