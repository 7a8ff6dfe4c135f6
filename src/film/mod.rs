//! Film: pixels, reconstruction filters, accumulation, files.

pub mod accumulator;
pub mod exr;
pub mod filter;
pub mod format;
pub mod layer;
mod lobes;
pub mod moments;
pub mod noise;
pub mod output;
pub mod png;
pub mod raster;
pub mod sharing;
pub mod view;

use crate::{
    error::Result,
    math::{Spectrum, Vec2, vec2},
    memory,
    sampling::{Stream, stream::Purpose},
};
use filter::{Axis, Filter};
use format::Format;
use sharing::{Place, Places, Sharing};

/// One value per pixel, and how it is called in a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// Its name, such as "R" or "normal.X".
    pub name: String,
    /// Row-major, top row first.
    pub values: Vec<f32>,
}

/// The part of a film that is rendered, as Mitsuba's crop window. The sensor sees the whole film.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// Pixels of the whole film, across and down.
    pub full_size: [u32; 2],
    /// The whole film's pixel in the window's top left corner.
    pub offset: [u32; 2],
    /// Pixels of the window, across and down.
    pub size: [u32; 2],
}

impl Window {
    /// All of a film of `width` x `height` pixels.
    pub fn whole(width: u32, height: u32) -> Self {
        Self { full_size: [width, height], offset: [0, 0], size: [width, height] }
    }

    /// True if it is all of its film.
    pub fn is_whole(&self) -> bool {
        self.size == self.full_size
    }
}

/// The image's size and reconstruction filter. A pixel's value is the average of radiance over the film,
/// weighted by the filter around the pixel's centre, the filter cut off at the image's border as in Mitsuba.
/// Film positions are in pixels of the window, (0, 0) its top left corner.
#[derive(Clone, Debug)]
pub struct Film {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Where in the whole film the image lies.
    pub window: Window,
    /// The same filter along both axes.
    pub filter: Filter,
    /// Also sampled this far beyond the window, where the filter still reaches its pixels: left and right, above and
    /// below (pixels).
    pub border: [[u32; 2]; 2],
    /// What is written.
    pub format: Format,
    across: Axis,
    down: Axis,
    /// How places within pixels are distributed where pixels share samples.
    places: Option<Places>,
}

impl Film {
    /// A film of which `window` is rendered; its sizes are > 0. With `sample_border` the filter is not cut off
    /// at the window's border.
    pub fn new(window: Window, filter: Filter, sample_border: bool, format: Format) -> Self {
        let border = if sample_border { reach(filter) } else { 0 };
        Self::bordered(window, filter, [[border; 2]; 2], format)
    }

    fn bordered(window: Window, filter: Filter, border: [[u32; 2]; 2], format: Format) -> Self {
        let [width, height] = window.size;
        let (across, down) = (Axis::new(filter, width, border[0]), Axis::new(filter, height, border[1]));
        // Filters that end within the pixel have nothing to share; where a film is sampled beyond its border, there are
        // no samples beyond to share.
        let is_shared = filter.radius() > 0.5 && border == [[0; 2]; 2];
        let places = is_shared.then(|| Places::new(&filter));
        Self { width, height, window, filter, border, format, across, down, places }
    }

    /// The part of `size` pixels from `corner` on, both within it. Its pixels show what they show in the whole: filters
    /// are cut off only where those of the whole are.
    pub fn part(&self, corner: [u32; 2], size: [u32; 2]) -> Self {
        let border = [0, 1].map(|axis| {
            let [before, after] = self.border[axis];
            let behind = self.window.size[axis] - corner[axis] - size[axis];
            [corner[axis] + before, behind + after].map(|sampled| sampled.min(reach(self.filter)))
        });
        let offset = [0, 1].map(|axis| self.window.offset[axis] + corner[axis]);
        Self::bordered(Window { offset, size, ..self.window }, self.filter, border, self.format)
    }

    /// The same image by pixels `divisor` times as wide and as high, one at least; it is cut off at its border.
    pub fn coarser(&self, divisor: u32) -> Self {
        let Window { full_size, offset, size } = self.window;
        let least = |pixels: [u32; 2]| pixels.map(|side| (side / divisor).max(1));
        let (size, offset) = (least(size), offset.map(|side| side / divisor));
        let whole = least(full_size);
        let full_size = [0, 1].map(|axis| whole[axis].max(offset[axis] + size[axis]));
        let format = Format { alpha: false, ..self.format };
        Self::new(Window { full_size, offset, size }, self.filter, false, format)
    }

    /// True if pixels can share samples.
    pub fn can_share(&self) -> bool {
        self.places.is_some()
    }

    /// Where the samples of a pass lie within their pixels, drawn from `stream`; none if its pixels cannot share them.
    #[inline]
    pub fn place(&self, stream: &mut Stream) -> Option<Place> {
        self.places.as_ref().map(|places| sharing::place(places, stream))
    }

    /// How pixels share the samples of a pass that lie at `place`.
    pub fn sharing(&self, place: Place) -> Sharing<'_> {
        Sharing::new([&self.across, &self.down], place)
    }

    /// The part that sharing leaves of the variance of camera samples: 1 if pixels cannot share them.
    pub fn variance_left(&self) -> f64 {
        let of = |places| [&self.across, &self.down].map(|axis| sharing::variance_left(axis, places));
        self.places.as_ref().map_or(1.0, |places| of(places).iter().product())
    }

    /// Number of pixels.
    pub fn len(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// True for a film without pixels.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Bytes of an image of it with so many `channels` of four bytes.
    pub fn bytes(&self, channels: usize) -> u64 {
        [u64::from(self.width), u64::from(self.height), channels as u64]
            .iter()
            .fold(4, |bytes: u64, factor| bytes.saturating_mul(*factor))
    }

    /// An error unless memory holds what a render onto it keeps of every pixel, in numbers of four bytes.
    pub fn check_memory(&self, numbers: usize) -> Result<()> {
        let size = format!("{} x {} pixels", self.width, self.height);
        let remedy = "choose a smaller --size, fewer layers or fewer --batches";
        memory::check("the film", "a render", &size, Some(self.bytes(numbers)), remedy)
    }

    /// A film position distributed by the magnitude of the filter of `pixel` (row-major index), and the weight
    /// of a sample there: 1, but for filters with negative lobes.
    #[inline]
    pub fn sample(&self, pixel: usize, stream: &mut Stream) -> (Vec2, f32) {
        let (x, y) = (pixel % self.width as usize, pixel / self.width as usize);
        let (x, across) = self.across.sample(x, stream);
        let (y, down) = self.down.sample(y, stream);
        (vec2(x, y), across * down)
    }

    /// The film position at `place` within `pixel` (row-major index).
    #[inline]
    pub fn position(&self, pixel: usize, place: Place) -> Vec2 {
        let (x, y) = (pixel % self.width as usize, pixel / self.width as usize);
        vec2(x as f32 + 0.5, y as f32 + 0.5) + place.offset()
    }

    /// True if a film position counts for some pixel.
    #[inline]
    pub fn covers(&self, film: Vec2) -> bool {
        self.across.covers(film.x) && self.down.covers(film.y)
    }

    /// One of the pixels whose filter covers `film`, drawn by the magnitude of their shares, and the weight of a
    /// contribution there. Position and pass decide which.
    pub fn pick(&self, film: Vec2, pass: u64) -> Option<(usize, f32)> {
        let [x, y] = film.to_array().map(|x| u64::from(x.to_bits()));
        let mut stream = Stream::new(0, x << 32 | y, pass, Purpose::Splat);
        let (x, across) = self.across.pick(film.x, &mut stream)?;
        let (y, down) = self.down.pick(film.y, &mut stream)?;
        Some((y * self.width as usize + x, across * down))
    }

    /// Gives every pixel whose filter covers `film` its share of `value`, which negative lobes make negative.
    #[inline]
    pub fn spread(&self, film: Vec2, value: Spectrum, mut add: impl FnMut(usize, Spectrum)) {
        for (y, wy) in self.down.weights(film.y) {
            for (x, wx) in self.across.weights(film.x) {
                let weight = wx * wy;
                if weight != 0.0 {
                    add(y * self.width as usize + x, value * weight);
                }
            }
        }
    }
}

/// How far beyond a pixel its filter is not 0 (pixels).
fn reach(filter: Filter) -> u32 {
    (filter.radius() - 0.5).ceil() as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pixels of a part take the same samples, and give the same shares, as in the whole.
    #[test]
    fn parts_show_what_the_whole_shows() {
        let filter = Filter::Lanczos { lobes: 3 };
        for border in [false, true] {
            let whole = Film::new(Window::whole(9, 8), filter, border, Format::default());
            for (corner, size) in [([0, 0], [9, 8]), ([0, 2], [3, 6]), ([4, 3], [1, 2]), ([3, 0], [6, 1])] {
                let part = whole.part(corner, size);
                for (x, y) in [(0, 0), (size[0] - 1, size[1] - 1)] {
                    let pixel = (y * size[0] + x) as usize;
                    let same = ((y + corner[1]) * 9 + x + corner[0]) as usize;
                    let sampled =
                        |film: &Film, pixel| film.sample(pixel, &mut Stream::new(3, 0, 0, Purpose::Study));
                    let ((at, weight), (at_whole, weight_whole)) =
                        (sampled(&part, pixel), sampled(&whole, same));
                    let moved = at + vec2(corner[0] as f32, corner[1] as f32);
                    assert!(
                        (moved - at_whole).length() < 1e-5 && weight == weight_whole,
                        "{corner:?} {size:?}"
                    );
                    let share = |film: &Film, at, pixel| {
                        let mut sum = 0.0;
                        film.spread(at, Spectrum::ONE, |p, value| {
                            sum += if p == pixel { value.x } else { 0.0 }
                        });
                        sum
                    };
                    assert!((share(&part, at, pixel) - share(&whole, moved, same)).abs() < 1e-5);
                }
            }
        }
    }

    /// What is spread evenly over the film makes every pixel 1, by negative shares too.
    #[test]
    fn an_even_light_makes_an_even_image() {
        const STEPS: u32 = 120;
        for (filter, border) in [Filter::Box, Filter::Cubic { b: 0.0, c: 0.5 }, Filter::Lanczos { lobes: 3 }]
            .into_iter()
            .flat_map(|filter| [(filter, false), (filter, true)])
        {
            let film = Film::new(Window::whole(4, 3), filter, border, Format::default());
            let mut image = vec![0.0; film.len()];
            let border = film.border[0][0];
            let at = |i: u32| (i as f32 + 0.5) / STEPS as f32 - border as f32;
            for y in 0..(film.height + 2 * border) * STEPS {
                for x in 0..(film.width + 2 * border) * STEPS {
                    assert!(film.covers(vec2(at(x), at(y))));
                    let share = Spectrum::splat(1.0 / (STEPS * STEPS) as f32);
                    film.spread(vec2(at(x), at(y)), share, |pixel, value| image[pixel] += f64::from(value.x));
                }
            }
            assert!(image.iter().all(|value| (value - 1.0).abs() < 2e-3), "{filter:?}: {image:?}");
        }
    }
}
