//! Light on a screen with an exposure that the viewer chooses.
//!
//! An inlined image holds the cube root of its light over four times the scene's white: two stops above white survive
//! in 8 bits, and dark pixels keep as many levels as sRGB gives them. The page turns that into sRGB by an SVG filter
//! with a table of 256 entries, which a slider replaces.

use crate::math::{
    Spectrum,
    srgb::{self, Srgb as _},
};

/// What an image can hold of light, in whites.
pub(super) const HEADROOM: f64 = 4.0;

/// The share of pixels that are not brighter than white.
const BELOW_WHITE: f64 = 0.95;

/// No number: seen at once among all colours of light.
const BROKEN: [u8; 3] = [255, 0, 255];

/// The radiance that is shown as white: 95 % of the pixels are not brighter. Where that many are black, the brightest
/// decides.
pub(super) fn white(reference: &[Spectrum]) -> f64 {
    let levels = [BELOW_WHITE, 1.0].into_iter().filter_map(|share| srgb::white(reference, share));
    levels.map(f64::from).find(|level| *level > 0.0).unwrap_or(1.0)
}

/// Three bytes a pixel.
pub(super) fn encoded(pixels: &[Spectrum], white: f64) -> Vec<u8> {
    pixels.iter().flat_map(|pixel| encoded_pixel(*pixel, white)).collect()
}

fn encoded_pixel(pixel: Spectrum, white: f64) -> [u8; 3] {
    if pixel.is_nan() {
        return BROKEN;
    }
    pixel.to_array().map(|light| {
        let share = (f64::from(light) / (HEADROOM * white)).clamp(0.0, 1.0);
        (255.0 * share.cbrt()).round() as u8
    })
}

/// What the filter makes of each byte, as SVG's `tableValues`.
pub(super) fn table() -> String {
    let entries: Vec<String> = (0..=255u8).map(|byte| format!("{:.4}", displayed(byte))).collect();
    entries.join(" ")
}

/// The sRGB value, 0 to 1, of a byte that [`encoded`] made.
fn displayed(byte: u8) -> f64 {
    (HEADROOM * (f64::from(byte) / 255.0).powi(3)).min(1.0).srgb_encoded()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::vec3;

    #[test]
    fn light_up_to_white_is_shown_as_it_is() {
        for light in [0.0, 1e-3, 0.01, 0.1, 0.5, 1.0] {
            let [byte, ..] = encoded_pixel(Spectrum::splat(3.0 * light as f32), 3.0);
            // Half a byte of the cube root is 1.5 / 255 / (its share) of the light.
            let error = 0.6 / 255.0 / (light / HEADROOM).cbrt().max(0.02);
            assert!((displayed(byte) - light.srgb_encoded()).abs() < error, "{light}: {}", displayed(byte));
        }
        assert!(displayed(0) == 0.0 && displayed(255) > 0.999_999);
        assert_eq!(table().split(' ').count(), 256);
    }

    #[test]
    fn white_is_what_all_but_the_brightest_reach() {
        let mut pixels = vec![Spectrum::splat(0.5); 96];
        pixels.extend([Spectrum::splat(1e30); 4]);
        assert!((white(&pixels) - 0.5).abs() < 1e-6);
        assert_eq!(white(&[Spectrum::ZERO; 9]), 1.0);
        assert_eq!(white(&[Spectrum::splat(f32::NAN)]), 1.0);
        let mut dark = vec![Spectrum::ZERO; 999];
        dark.push(vec3(0.0, 2.0, 0.0));
        assert!((white(&dark) - 2.0 * 0.715_16).abs() < 1e-6);
    }

    #[test]
    fn what_is_no_light_is_told_apart() {
        let pixels = [vec3(f32::NAN, 0.0, 0.0), vec3(-1.0, 0.0, f32::INFINITY)];
        assert_eq!(encoded(&pixels, 1.0), [255, 0, 255, 0, 0, 255]);
    }
}
