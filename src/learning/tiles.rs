//! Groups of pixels, for estimates of few samples.

use crate::film::Film;

/// The tiles of an image, whose pixels count as one.
pub(super) struct Tiles {
    width: u32,
    height: u32,
    across: u32,
    down: u32,
}

impl Tiles {
    /// At most so `many` across and down.
    pub(super) fn of(film: &Film, many: u32) -> Self {
        let (width, height) = (film.width, film.height);
        Self { width, height, across: width.min(many), down: height.min(many) }
    }

    /// How many lie side by side.
    pub(super) fn across(&self) -> usize {
        self.across as usize
    }

    /// That of a pixel.
    pub(super) fn at(&self, pixel: u32) -> usize {
        let Self { width, height, across, down } = *self;
        (pixel / width * down / height * across + pixel % width * across / width) as usize
    }

    /// How many pixels each has.
    pub(super) fn pixels(&self) -> Vec<f64> {
        let mut pixels = vec![0.0; (self.across * self.down) as usize];
        (0..self.width * self.height).for_each(|pixel| pixels[self.at(pixel)] += 1.0);
        pixels
    }
}
