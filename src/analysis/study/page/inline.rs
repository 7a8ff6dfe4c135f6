//! Images within the page itself: PNG in a data URI.

use crate::{
    error::{Error, Result},
    math::Spectrum,
};
use base64::{Engine as _, engine::general_purpose::STANDARD};
use image::{
    ExtendedColorType, ImageEncoder,
    codecs::png::{CompressionType, FilterType, PngEncoder},
};

/// `bytes`, three a pixel, as the value of `src`.
pub(super) fn uri(width: usize, height: usize, bytes: &[u8]) -> Result<String> {
    let unfit = |error: &dyn std::fmt::Display| {
        Error::new("study.html", "an image that fits into it", error.to_string(), "study smaller images")
    };
    let [wide, high] = [width, height].map(u32::try_from);
    let (wide, high) = (wide.map_err(|error| unfit(&error))?, high.map_err(|error| unfit(&error))?);
    let mut png = Vec::new();
    PngEncoder::new_with_quality(&mut png, CompressionType::Best, FilterType::Adaptive)
        .write_image(bytes, wide, high, ExtendedColorType::Rgb8)
        .map_err(|error| unfit(&error))?;
    Ok(format!("data:image/png;base64,{}", STANDARD.encode(png)))
}

/// A size that can be averaged down.
#[derive(Clone, Copy, Debug)]
pub(super) struct Size {
    /// Pixels across, of what is read.
    pub width: usize,
    /// Pixels down.
    pub height: usize,
    /// Pixels a side of a block that becomes one, at least 1.
    pub shrink: usize,
}

impl Size {
    /// Pixels across and down, of what is shown.
    pub(super) fn shown(self) -> [usize; 2] {
        [self.width, self.height].map(|side| side.div_ceil(self.shrink))
    }

    /// The mean of each block; at the right and the lower border blocks may be smaller.
    fn averaged<T: Copy + std::iter::Sum<T>>(self, values: &[T], divided: impl Fn(T, usize) -> T) -> Vec<T> {
        let [across, down] = self.shown();
        let block = |index: usize| {
            let (x, y) = (index % across * self.shrink, index / across * self.shrink);
            let rows = y..(y + self.shrink).min(self.height);
            let columns = x..(x + self.shrink).min(self.width);
            let count = rows.len() * columns.len();
            let row = |y: usize| values[y * self.width + columns.start..y * self.width + columns.end].iter();
            divided(rows.flat_map(row).copied().sum(), count)
        };
        (0..across * down).map(block).collect()
    }

    /// An image at the size that is shown.
    pub(super) fn colours(self, pixels: &[Spectrum]) -> Vec<Spectrum> {
        self.averaged(pixels, |sum, count| sum / count as f32)
    }

    /// A map at the size that is shown.
    pub(super) fn values(self, values: &[f64]) -> Vec<f64> {
        self.averaged(values, |sum, count| sum / count as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_holds_what_the_image_does() {
        let bytes = [255, 0, 0, 0, 255, 0, 1, 2, 3, 4, 5, 6];
        let uri = uri(2, 2, &bytes).unwrap();
        let png = STANDARD.decode(uri.strip_prefix("data:image/png;base64,").unwrap()).unwrap();
        let image = image::load_from_memory(&png).unwrap().into_rgb8();
        assert_eq!((image.dimensions(), image.into_raw()), ((2, 2), bytes.to_vec()));
    }

    #[test]
    fn blocks_become_their_means() {
        let size = Size { width: 3, height: 2, shrink: 2 };
        assert_eq!(size.values(&[1.0, 2.0, 5.0, 3.0, 6.0, 7.0]), [3.0, 6.0]);
        let same = Size { shrink: 1, ..size };
        assert_eq!(same.values(&[1.0, 2.0, 5.0, 3.0, 6.0, 7.0]), [1.0, 2.0, 5.0, 3.0, 6.0, 7.0]);
        assert_eq!(size.colours(&[Spectrum::ONE; 6]), [Spectrum::ONE; 2]);
    }
}
