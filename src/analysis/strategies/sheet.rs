//! Pyramids of images on one sheet: a row a length of paths, in it the strategies by their light vertices, as in Veach
//! 1997, fig. 10.2 and 10.3.

use crate::{
    error::Result,
    film,
    math::{Spectrum, SpectrumExt},
};
use std::path::Path;

/// Cells are made smaller by a whole factor until they are no wider or higher than this [pixels].
const LARGEST: usize = 256;
/// Between cells [pixels].
const GAP: usize = 4;
/// What lies between cells.
const GROUND: f32 = 0.2;
/// Of a row's brightest pixels this part is cut off by its exposure.
const CUT: f64 = 0.005;

/// Images of equal size, those of a row under one exposure.
pub struct Row {
    /// Factor on radiance.
    pub exposure: f64,
    /// Row-major pixels.
    pub images: Vec<Vec<Spectrum>>,
}

/// The exposure that shows all but the brightest pixels of `image`; 1 where it is black.
pub fn exposure(image: &[Spectrum]) -> f64 {
    let mut lit: Vec<f32> =
        image.iter().map(|pixel| pixel.luminance()).filter(|l| l.is_finite() && *l > 0.0).collect();
    lit.sort_by(f32::total_cmp);
    let rank = (lit.len() as f64 * (1.0 - CUT)).ceil() as usize;
    lit.get(rank.saturating_sub(1)).map_or(1.0, |white| 1.0 / f64::from(*white))
}

/// Writes `rows` of images of `width` x `height` pixels to the PNG `path`, each row centred.
pub fn write(path: &Path, width: usize, height: usize, rows: &[Row]) -> Result<()> {
    let factor = width.max(height).div_ceil(LARGEST);
    let (w, h) = (width.div_ceil(factor), height.div_ceil(factor));
    let most = rows.iter().map(|row| row.images.len()).max().unwrap_or(0);
    let (across, down) = (most * (w + GAP) + GAP, rows.len() * (h + GAP) + GAP);
    let mut sheet = vec![Spectrum::splat(GROUND); across * down];
    for (index, row) in rows.iter().enumerate() {
        let left = GAP + (most - row.images.len()) * (w + GAP) / 2;
        let top = GAP + index * (h + GAP);
        for (column, image) in row.images.iter().enumerate() {
            let small = shrunk(image, width, height, factor);
            for (y, line) in small.chunks(w).enumerate() {
                let at = (top + y) * across + left + column * (w + GAP);
                for (pixel, value) in sheet[at..at + w].iter_mut().zip(line) {
                    *pixel = (*value * row.exposure as f32).clamp(Spectrum::ZERO, Spectrum::ONE);
                }
            }
        }
    }
    film::png::write(path, across, down, &sheet)
}

/// Means of squares of `factor` pixels, cut at the borders.
fn shrunk(image: &[Spectrum], width: usize, height: usize, factor: usize) -> Vec<Spectrum> {
    let (w, h) = (width.div_ceil(factor), height.div_ceil(factor));
    let mean = |x: usize, y: usize| {
        let columns = x * factor..((x + 1) * factor).min(width);
        let lines = y * factor..((y + 1) * factor).min(height);
        let count = columns.len() * lines.len();
        let sum = lines.flat_map(|y| columns.clone().map(move |x| image[y * width + x])).sum::<Spectrum>();
        sum / count as f32
    };
    (0..h).flat_map(|y| (0..w).map(move |x| (x, y))).map(|(x, y)| mean(x, y)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_images_are_means() {
        let image: Vec<Spectrum> = (0..6).map(|i| Spectrum::splat(i as f32)).collect();
        assert_eq!(shrunk(&image, 3, 2, 1), image);
        assert_eq!(shrunk(&image, 3, 2, 2), [Spectrum::splat(2.0), Spectrum::splat(3.5)]);
    }

    #[test]
    fn exposure_makes_the_brightest_white_and_stands_black() {
        let image: Vec<Spectrum> = (1..=1000).map(|i| Spectrum::splat(i as f32)).collect();
        assert!((exposure(&image) - 1.0 / 995.0).abs() < 1e-6);
        assert_eq!(exposure(&[Spectrum::ZERO; 4]), 1.0);
        assert_eq!(exposure(&[]), 1.0);
    }

    #[test]
    fn a_sheet_is_as_large_as_its_longest_row() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sheet.png");
        let image = vec![Spectrum::splat(0.25); 300 * 2];
        let row = |count: usize| Row { exposure: 4.0, images: vec![image.clone(); count] };
        write(&path, 300, 2, &[row(2), row(3)]).unwrap();
        let sheet = image::open(&path).unwrap().to_rgb8();
        assert_eq!(sheet.dimensions(), (3 * 154 + 4, 2 * 5 + 4));
        assert_eq!(sheet.get_pixel(4 + 77, 4).0, [255; 3]);
        assert_ne!(sheet.get_pixel(4, 4).0, [255; 3]);
    }
}
