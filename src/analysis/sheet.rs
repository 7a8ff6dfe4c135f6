//! Images with captions on one sheet, row by row: those of strategies, a row a length of paths, as in Veach 1997, fig. 10.2 and
//! 10.3; and what a guide knows.

use super::lettering;
use crate::{
    error::Result,
    film,
    math::{Spectrum, SpectrumExt},
};
use std::path::Path;

/// Cells are made smaller by a whole factor until they are no wider or higher than this (pixels).
const LARGEST: usize = 256;
/// Between cells (pixels).
const GAP: usize = 4;
/// What lies between cells.
const GROUND: f32 = 0.2;
/// Of a row's brightest pixels this part is cut off by its exposure.
const CUT: f64 = 0.005;

/// Light of captions.
const INK: f32 = 0.9;
/// Images at least so wide have captions of twice the size (pixels).
const WIDE: usize = 96;

/// Images of equal size, those of a row under one exposure.
pub(super) struct Row {
    /// What stands at its left.
    pub caption: String,
    /// Factor on radiance.
    pub exposure: f64,
    /// What stands above each image, and its row-major pixels.
    pub images: Vec<(String, Vec<Spectrum>)>,
}

/// The exposure that shows all but the brightest pixels of `image`; 1 where it is black.
pub(super) fn exposure(image: &[Spectrum]) -> f64 {
    let mut lit: Vec<f32> =
        image.iter().map(|pixel| pixel.luminance()).filter(|l| l.is_finite() && *l > 0.0).collect();
    lit.sort_by(f32::total_cmp);
    let rank = (lit.len() as f64 * (1.0 - CUT)).ceil() as usize;
    lit.get(rank.saturating_sub(1)).map_or(1.0, |white| 1.0 / f64::from(*white))
}

/// Writes `rows` of images of `width` x `height` pixels to the PNG `path`, each row centred.
pub(super) fn write(path: &Path, width: usize, height: usize, rows: &[Row]) -> Result<()> {
    let layout = Layout::new(width, height, rows);
    let mut sheet = Sheet::new(layout.size());
    for (index, row) in rows.iter().enumerate() {
        let middle = layout.top(index) + layout.image[1] / 2;
        sheet.write(&row.caption, [GAP, middle.saturating_sub(layout.line() / 2)], layout.scale);
        for (column, (caption, image)) in row.images.iter().enumerate() {
            let [x, y] = [layout.left(row, column), layout.top(index)];
            let caption_left = x + layout.image[0] / 2 - layout.scale * lettering::width(caption) / 2;
            sheet.write(caption, [caption_left, y - GAP / 2 - layout.line()], layout.scale);
            let shown = shrunk(image, width, height, layout.factor).into_iter();
            let shown = shown.map(|value| (value * row.exposure as f32).clamp(Spectrum::ZERO, Spectrum::ONE));
            sheet.draw(&shown.collect::<Vec<_>>(), layout.image[0], [x, y]);
        }
    }
    film::png::write(path, sheet.size[0], sheet.size[1], &sheet.pixels)
}

/// Where everything is (pixels).
struct Layout {
    /// By which images are made smaller.
    factor: usize,
    /// Width and height of an image then.
    image: [usize; 2],
    /// Of captions, over the size of the font.
    scale: usize,
    /// Of the captions of rows.
    margin: usize,
    /// From an image to the one beside it.
    across: usize,
    rows: usize,
    /// Images of the longest row.
    most: usize,
}

impl Layout {
    fn new(width: usize, height: usize, rows: &[Row]) -> Self {
        let factor = width.max(height).div_ceil(LARGEST).max(1);
        let image = [width.div_ceil(factor), height.div_ceil(factor)];
        let scale = if image[0] >= WIDE { 2 } else { 1 };
        let widest = |captions: &mut dyn Iterator<Item = &String>| {
            scale * captions.map(|caption| lettering::width(caption)).max().unwrap_or(0)
        };
        let margin = widest(&mut rows.iter().map(|row| &row.caption)) + 2 * GAP;
        let captions = widest(&mut rows.iter().flat_map(|row| row.images.iter().map(|(caption, _)| caption)));
        let most = rows.iter().map(|row| row.images.len()).max().unwrap_or(0);
        Self { factor, image, scale, margin, across: image[0].max(captions) + GAP, rows: rows.len(), most }
    }

    /// Height of a line of captions.
    fn line(&self) -> usize {
        self.scale * lettering::HEIGHT
    }

    /// From a row to the next.
    fn down(&self) -> usize {
        self.image[1] + self.line() + 2 * GAP
    }

    fn size(&self) -> [usize; 2] {
        [self.margin + self.most * self.across + GAP, self.rows * self.down() + GAP]
    }

    /// Of the images in row `index`.
    fn top(&self, index: usize) -> usize {
        index * self.down() + self.line() + GAP + GAP / 2
    }

    /// Of the image in `column` of a row.
    fn left(&self, row: &Row, column: usize) -> usize {
        let indent = (self.most - row.images.len()) * self.across / 2;
        self.margin + indent + column * self.across + (self.across - self.image[0]) / 2
    }
}

/// What is drawn on.
struct Sheet {
    size: [usize; 2],
    pixels: Vec<Spectrum>,
}

impl Sheet {
    fn new(size: [usize; 2]) -> Self {
        Self { size, pixels: vec![Spectrum::splat(GROUND); size[0] * size[1]] }
    }

    /// Draws an image of so many pixels `across`.
    fn draw(&mut self, image: &[Spectrum], across: usize, [left, top]: [usize; 2]) {
        for (y, line) in image.chunks(across).enumerate() {
            let at = (top + y) * self.size[0] + left;
            self.pixels[at..at + line.len()].copy_from_slice(line);
        }
    }

    fn write(&mut self, text: &str, [left, top]: [usize; 2], scale: usize) {
        let dots = (0..scale * scale).map(|i| [i % scale, i / scale]);
        for ([x, y], [dx, dy]) in lettering::ink(text).flat_map(|at| dots.clone().map(move |dot| (at, dot))) {
            self.pixels[(top + scale * y + dy) * self.size[0] + left + scale * x + dx] = Spectrum::splat(INK);
        }
    }
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
    fn a_sheet_has_room_for_images_and_captions() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sheet.png");
        let image = vec![Spectrum::splat(0.25); 300 * 2];
        let row = |count: usize| Row {
            caption: "1".to_owned(),
            exposure: 4.0,
            images: vec![("(0,2)".to_owned(), image.clone()); count],
        };
        write(&path, 300, 2, &[row(2), row(3)]).unwrap();
        let sheet = image::open(&path).unwrap().to_rgb8();
        // Captions are twice as large as the font: 16 high and wide.
        assert_eq!(sheet.dimensions(), (24 + 3 * 154 + 4, 2 * (1 + 16 + 8) + 4));
        let is = |x: u32, y: u32, value: u8| sheet.get_pixel(x, y).0 == [value; 3];
        let top = 16 + 4 + 2;
        assert!(is(24 + 77 + 2, top, 255) && !is(24 + 77 + 1, top, 255) && !is(24 + 77 + 2, top - 1, 255));
        let ink = |x: std::ops::Range<u32>, y: std::ops::Range<u32>| {
            let darkest = sheet.get_pixel(0, 0).0;
            x.flat_map(|x| y.clone().map(move |y| (x, y))).any(|(x, y)| sheet.get_pixel(x, y).0 != darkest)
        };
        assert!(ink(4..20, 10..34), "the caption of the row");
        assert!(ink(24 + 77..24 + 77 + 150, 0..20), "the caption of an image");
    }

    /// Images narrower than their captions stand apart.
    #[test]
    fn small_images_have_whole_captions() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sheet.png");
        let image = ("equiangular".to_owned(), vec![Spectrum::ONE; 4]);
        let row = Row { caption: "> 6".to_owned(), exposure: 1.0, images: vec![image; 2] };
        write(&path, 2, 2, &[row]).unwrap();
        assert_eq!(image::image_dimensions(&path).unwrap(), (24 + 8 + 2 * (88 + 4) + 4, 2 + 8 + 8 + 4));
        write(&path, 2, 2, &[]).unwrap();
    }
}
