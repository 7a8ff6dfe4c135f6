//! Film: pixels, reconstruction filters, accumulation, files.

pub mod accumulator;
pub mod exr;
pub mod filter;
pub mod output;
pub mod png;

use crate::math::{Spectrum, Vec2, vec2};
use crate::sampling::Stream;
use filter::{Axis, Filter};

/// The image's size and reconstruction filter. A pixel's value is the average of radiance over the film,
/// weighted by the filter around the pixel's centre, the filter cut off at the image's border as in Mitsuba.
#[derive(Clone, Debug)]
pub struct Film {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// The same filter along both axes.
    pub filter: Filter,
    across: Axis,
    down: Axis,
}

impl Film {
    /// A film of `width` x `height` pixels, both > 0.
    pub fn new(width: u32, height: u32, filter: Filter) -> Self {
        let (across, down) = (Axis::new(filter, width), Axis::new(filter, height));
        Self { width, height, filter, across, down }
    }

    /// Number of pixels.
    pub fn len(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// True for a film without pixels.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// A film position distributed by the filter of `pixel` (row-major index).
    #[inline]
    pub fn sample(&self, pixel: usize, stream: &mut Stream) -> Vec2 {
        let (x, y) = (pixel % self.width as usize, pixel / self.width as usize);
        vec2(self.across.sample(x, stream), self.down.sample(y, stream))
    }

    /// True if a film position counts for some pixel.
    #[inline]
    pub fn covers(&self, film: Vec2) -> bool {
        film.x >= 0.0 && film.y >= 0.0 && film.x < self.width as f32 && film.y < self.height as f32
    }

    /// Gives every pixel whose filter covers `film` its share of `value`.
    #[inline]
    pub fn spread(&self, film: Vec2, value: Spectrum, mut add: impl FnMut(usize, Spectrum)) {
        for (y, wy) in self.down.weights(film.y) {
            for (x, wx) in self.across.weights(film.x) {
                let weight = wx * wy;
                if weight > 0.0 {
                    add(y * self.width as usize + x, value * weight);
                }
            }
        }
    }
}
