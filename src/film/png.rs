//! PNG images: what was estimated, made fit for a screen.
//!
//! The tone curve of the view `standard`: luminance L becomes L (1 + L / w^2) / (1 + L) (Reinhard et al. 2002, eq. 4),
//! where the white point w is the larger of 1 and the luminance that 99.5 % of the pixels do not exceed. An image
//! without highlights (w = 1) is thus shown as it is, and w itself becomes white. Hue is kept: a colour is scaled
//! by what its luminance is scaled by, and where a channel would then exceed 1, mixed with grey of the same
//! luminance until none does. Then comes the sRGB transfer function and rounding to 8 bits. NaN and negative
//! channels are shown black, infinite ones white.

use super::{
    output,
    view::{Display, encoded},
};
use crate::{
    error::{Error, Result},
    math::{
        Spectrum, SpectrumExt,
        srgb::{shown, white},
    },
};
use png::{BitDepth, ColorType, Decoder, DecodingError, Encoder};
use std::{
    fs::File,
    io::{self, BufReader},
    path::Path,
};

/// The share of pixels that are not brighter than the white point.
const BELOW_WHITE: f64 = 0.995;

/// Writes `pixels` (row-major, top row first; linear sRGB) to `path`, tone-mapped.
pub fn write(path: &Path, width: usize, height: usize, pixels: &[Spectrum]) -> Result<()> {
    write_with(path, width, height, pixels, Display::default(), None)
}

/// The same, shown so, with how the image was made, as [`made`] gives it again.
pub fn write_with(
    path: &Path,
    width: usize,
    height: usize,
    pixels: &[Spectrum],
    display: Display,
    made: Option<&str>,
) -> Result<()> {
    output::check_size(path, width, height, pixels.len())?;
    encode(path, width, height, &display.bytes(pixels), made)
}

/// Writes `bytes`, 8-bit sRGB, three a pixel, as they are.
pub fn write_bytes(path: &Path, width: usize, height: usize, bytes: &[u8]) -> Result<()> {
    output::check_size(path, width, height, bytes.len() / 3)?;
    encode(path, width, height, bytes, None)
}

fn encode(path: &Path, width: usize, height: usize, bytes: &[u8], made: Option<&str>) -> Result<()> {
    output::write(path, |file| {
        let size = |n: usize| u32::try_from(n).map_err(io::Error::other);
        let mut encoder = Encoder::new(file, size(width)?, size(height)?);
        encoder.set_color(ColorType::Rgb);
        encoder.set_depth(BitDepth::Eight);
        if let Some(made) = made {
            encoder.add_itxt_chunk(MADE.to_owned(), made.to_owned())?;
        }
        let mut writer = encoder.write_header()?;
        writer.write_image_data(bytes)?;
        Ok(writer.finish()?)
    })
}

/// How the image at `path` was made, if it says so.
pub fn made(path: &Path) -> Result<Option<String>> {
    let file = File::open(path).map_err(|error| Error::io(path, "read", &error))?;
    let refuse = |error: DecodingError| {
        let remedy = "name a PNG file that a program has written whole";
        Error::new(path.display(), "a PNG image", error.to_string(), remedy)
    };
    let read = Decoder::new(BufReader::new(file)).read_info().map_err(refuse)?;
    let texts = &read.info().utf8_text;
    Ok(texts.iter().find(|text| text.keyword == MADE).and_then(|text| text.get_text().ok()))
}

/// Keyword of the text.
const MADE: &str = "tyndall";

/// How radiance becomes what a screen shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ToneCurve {
    /// The curve of this page, with its white point (luminance).
    White(f32),
    /// This many times the radiance, cut off at 1.
    Scale(f32),
}

impl ToneCurve {
    /// That with which `pixels` are written.
    pub fn of(pixels: &[Spectrum]) -> Self {
        Self::White(white(pixels, BELOW_WHITE).map_or(1.0, |white| white.max(1.0)))
    }

    /// A pixel as shown: sRGB-encoded channels in [0, 1].
    pub fn show(self, pixel: Spectrum) -> Spectrum {
        encoded(self.map(pixel))
    }

    /// The same in linear channels.
    pub fn map(self, pixel: Spectrum) -> Spectrum {
        match self {
            Self::White(white) => displayed(shown(pixel), white),
            Self::Scale(scale) => (shown(pixel) * scale).min(Spectrum::ONE),
        }
    }
}

fn displayed(pixel: Spectrum, white: f32) -> Spectrum {
    let luminance = pixel.luminance();
    if luminance <= 0.0 {
        return Spectrum::ZERO;
    }
    let (l, w) = (f64::from(luminance), f64::from(white));
    let mapped = (l * (1.0 + l / (w * w)) / (1.0 + l)) as f32;
    if mapped >= 1.0 {
        return Spectrum::ONE;
    }
    let scaled = pixel * (mapped / luminance);
    let most = scaled.max_element();
    if most <= 1.0 {
        return scaled;
    }
    let grey = Spectrum::splat(mapped);
    grey + (scaled - grey) * ((1.0 - mapped) / (most - mapped))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::vec3;

    fn tone_mapped(pixels: &[Spectrum]) -> Vec<u8> {
        Display::default().bytes(pixels)
    }

    #[test]
    fn images_without_highlights_are_shown_as_they_are() {
        let pixels = [vec3(0.0, 0.5, 1.0), vec3(0.2, 0.2, 0.2)];
        assert_eq!(tone_mapped(&pixels), [0, 188, 255, 124, 124, 124]);
    }

    #[test]
    fn broken_pixels_neither_panic_nor_spoil_the_others() {
        let mut pixels = vec![Spectrum::splat(0.5); 997];
        pixels.extend([
            Spectrum::splat(f32::NAN),
            Spectrum::splat(f32::INFINITY),
            Spectrum::splat(f32::NEG_INFINITY),
        ]);
        let bytes = tone_mapped(&pixels);
        assert_eq!(bytes[..3], [188; 3]);
        assert_eq!(bytes[997 * 3..], [0, 0, 0, 255, 255, 255, 0, 0, 0]);
        assert_eq!(tone_mapped(&[vec3(f32::MAX, 0.0, 0.0), vec3(f32::MIN_POSITIVE, 0.0, 0.0)]).len(), 6);
    }

    #[test]
    fn the_curve_rises_to_white_at_the_white_point() {
        let at = |l: f32| displayed(Spectrum::splat(l), 8.0).x;
        assert!((at(8.0) - 1.0).abs() < 1e-6 && at(1e12) == 1.0);
        let levels: Vec<_> = (0..100).map(|i| at(0.08 * i as f32)).collect();
        assert!(levels.windows(2).all(|pair| pair[0] < pair[1]));
    }

    #[test]
    fn bright_colours_keep_hue_and_luminance() {
        let pixel = vec3(0.0, 0.0, 6.0);
        let shown = displayed(pixel, 4.0);
        let l = pixel.luminance();
        let mapped = l * (1.0 + l / 16.0) / (1.0 + l);
        assert!((shown.luminance() - mapped).abs() < 1e-5);
        assert!(shown.z <= 1.0 + 1e-6 && shown.x == shown.y && shown.x < shown.z);
    }

    #[test]
    fn the_file_holds_the_bytes() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("image.png");
        write(&path, 2, 1, &[vec3(1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0)]).unwrap();
        let image = image::open(&path).unwrap().to_rgb8();
        assert_eq!((image.dimensions(), image.into_raw()), ((2, 1), vec![255, 0, 0, 0, 255, 0]));
    }
}
