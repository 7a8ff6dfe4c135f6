//! LDR-FLIP (Andersson et al. 2020): how far two images look different when they are shown in turn.

use crate::math::Spectrum;

/// FLIP of every pixel of `[image, reference]`, both sRGB-encoded; none if the program was built without it.
#[cfg(feature = "flip")]
pub(super) fn map(
    pixels: [&[Spectrum]; 2],
    width: usize,
    height: usize,
    pixels_per_degree: f32,
) -> Option<Vec<f32>> {
    use crate::math::srgb::byte;
    // Both fit: no side of a picture is longer than 65536.
    let (width, height) = (u32::try_from(width).ok()?, u32::try_from(height).ok()?);
    let [image, reference] = pixels.map(|pixels| {
        let bytes: Vec<u8> = pixels.iter().flat_map(|pixel| pixel.to_array().map(byte)).collect();
        nv_flip::FlipImageRgb8::with_data(width, height, &bytes)
    });
    Some(nv_flip::flip(reference, image, pixels_per_degree).to_vec())
}

/// Without the feature `flip` nobody knows.
#[cfg(not(feature = "flip"))]
pub(super) fn map(_: [&[Spectrum]; 2], _: usize, _: usize, _: f32) -> Option<Vec<f32>> {
    None
}
