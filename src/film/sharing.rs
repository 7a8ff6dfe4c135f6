//! Camera samples that neighbouring pixels share. In a pass, the sample of every pixel lies at the same place within it.
//! Each pixel then takes those of all pixels around it that its filter reaches, weighted by the filter over the density
//! of places. Every pass is an unbiased estimate of the filtered image. An even image comes out even, because the weights
//! add up to 1: places are distributed by the sum of all filters, or that sum is constant. At the border filters are cut
//! off, and the sum of the weights varies from pass to pass about 1.
//!
//! Filter importance sampling would leave each pixel one sample of a pass. Sharing divides the variance by 1 / integral
//! of f^2 (3.1 for a Gaussian of half a pixel), and makes the noise of neighbouring pixels alike.

use super::{
    Film,
    filter::{Axis, Filter},
    lobes,
};
use crate::{
    math::{Spectrum, Vec2},
    sampling::Stream,
};
use rayon::prelude::*;

/// Which camera samples pixels take.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FilmSamples {
    /// All that their filter reaches, if it reaches beyond the pixel and the film is not sampled beyond its border.
    #[default]
    Shared,
    /// Their own, distributed by their filter: filter importance sampling.
    Own,
    /// The same; and each contribution of a light subpath goes to one pixel, drawn by the filters, not to all that its
    /// place counts for. No pixels share noise.
    Apart,
}

impl FilmSamples {
    /// Each as typed.
    pub const NAMES: [(&'static str, Self); 3] =
        [("shared", Self::Shared), ("own", Self::Own), ("apart", Self::Apart)];

    /// As typed.
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize].0
    }

    /// The same, but no shared ones.
    pub fn unshared(self) -> Self {
        if self == Self::Shared { Self::Own } else { self }
    }

    /// Gives pixels of `film` the `value` that a light subpath of `pass` contributes at `place` (pixels).
    #[inline]
    pub fn splat(
        self,
        film: &Film,
        pass: u64,
        place: Vec2,
        value: Spectrum,
        mut add: impl FnMut(usize, Spectrum),
    ) {
        match self {
            Self::Shared | Self::Own => film.spread(place, value, add),
            Self::Apart => {
                if let Some((pixel, weight)) = film.pick(place, pass) {
                    add(pixel, value * weight);
                }
            }
        }
    }
}

/// Parts of a pixel's side; places are distributed evenly within each. The weights of an even image are off from 1 by
/// 2e-4 for a Gaussian of half a pixel. The estimate is unbiased with any number.
const PARTS: usize = 256;

/// A place within a pixel along one axis: the distance from the centre (pixels), and its density [1/pixel].
#[derive(Clone, Copy, Debug, PartialEq)]
struct Mark {
    offset: f32,
    density: f32,
}

/// Where the samples of a pass lie within their pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    across: Mark,
    down: Mark,
}

impl Place {
    /// From the pixel's centre (pixels).
    pub fn offset(&self) -> Vec2 {
        Vec2::new(self.across.offset, self.down.offset)
    }
}

/// How places within a pixel are distributed along an axis.
#[derive(Clone, Debug)]
pub(super) struct Places {
    /// The probability that a place lies before each part, and 1.
    cumulative: Vec<f32>,
}

impl Places {
    /// Those for `filter`: the sum of the filters of all pixels; even where it has negative lobes, as such filters add
    /// up to about 1.
    pub(super) fn new(filter: &Filter) -> Self {
        let is_even = matches!(filter, Filter::Cubic { .. } | Filter::Lanczos { .. });
        let parts: Vec<f64> = (0..PARTS).map(|part| if is_even { 1.0 } else { mass(filter, part) }).collect();
        let sum: f64 = parts.iter().sum();
        let before = parts.iter().scan(0.0, |before, mass| {
            *before += mass / sum;
            Some(*before as f32)
        });
        let mut cumulative: Vec<f32> = std::iter::once(0.0).chain(before).collect();
        if let Some(last) = cumulative.last_mut() {
            *last = 1.0;
        }
        Self { cumulative }
    }

    fn sample(&self, stream: &mut Stream) -> Mark {
        let u = stream.uniform();
        let part = self.cumulative.partition_point(|before| *before <= u) - 1;
        let parts = (self.cumulative.len() - 1) as f32;
        let mass = self.cumulative[part + 1] - self.cumulative[part];
        let within = ((u - self.cumulative[part]) / mass).min(1.0 - f32::EPSILON);
        Mark { offset: (part as f32 + within) / parts - 0.5, density: mass * parts }
    }

    /// Of each part, its middle and its probability.
    fn parts(&self) -> impl Iterator<Item = (Mark, f32)> + '_ {
        let parts = (self.cumulative.len() - 1) as f32;
        self.cumulative.windows(2).enumerate().filter(|(_, pair)| pair[1] > pair[0]).map(
            move |(part, pair)| {
                let mass = pair[1] - pair[0];
                (Mark { offset: (part as f32 + 0.5) / parts - 0.5, density: mass * parts }, mass)
            },
        )
    }
}

/// The integral of the filters of all pixels over this part of one.
fn mass(filter: &Filter, part: usize) -> f64 {
    let reach = reach(filter) as i64;
    let [from, to] = [part, part + 1].map(|end| end as f64 / PARTS as f64 - 0.5);
    let of_pixel = |k: i64| lobes::integrals(filter, k as f64 + from, k as f64 + to).iter().sum::<f64>();
    (-reach..=reach).map(of_pixel).sum()
}

/// How many pixels away a sample may count.
fn reach(filter: &Filter) -> usize {
    (filter.radius() + 0.5).ceil() as usize
}

/// The weights of samples along one axis, by how many pixels they lie after the pixel that takes them: from -`reach` on.
#[derive(Clone, Debug)]
struct Taps<'a> {
    axis: &'a Axis,
    reach: usize,
    weights: Vec<f32>,
}

impl<'a> Taps<'a> {
    fn new(axis: &'a Axis, mark: Mark) -> Self {
        let reach = reach(&axis.filter);
        let distance = |tap: usize| tap as f32 - reach as f32 + mark.offset;
        let weights = (0..=2 * reach).map(|tap| axis.filter.value(distance(tap)) / mark.density).collect();
        Self { axis, reach, weights }
    }

    /// What `pixel` takes, where `sample` tells those along the axis.
    #[inline]
    fn taken(&self, pixel: usize, sample: impl Fn(usize) -> Spectrum) -> Spectrum {
        let size = self.axis.size as usize;
        let skipped = self.reach.saturating_sub(pixel);
        let first = (pixel + skipped).saturating_sub(self.reach);
        let weights = self.weights.iter().skip(skipped).zip(first..size);
        let sum: Spectrum =
            weights.filter(|(weight, _)| **weight != 0.0).map(|(weight, at)| sample(at) * *weight).sum();
        sum * self.axis.scales[pixel]
    }
}

/// How pixels share the samples of a pass.
#[derive(Clone, Debug)]
pub struct Sharing<'a> {
    across: Taps<'a>,
    down: Taps<'a>,
}

impl<'a> Sharing<'a> {
    pub(super) fn new([across, down]: [&'a Axis; 2], place: Place) -> Self {
        Self { across: Taps::new(across, place.across), down: Taps::new(down, place.down) }
    }

    /// Replaces the samples of pixels by what pixels take of them, in an image or several planes one behind the other.
    pub fn share(&self, samples: &mut [Spectrum]) {
        let [width, height] = [&self.across, &self.down].map(|taps| taps.axis.size as usize);
        samples.chunks_mut(width * height).for_each(|plane| self.share_plane(plane));
    }

    fn share_plane(&self, plane: &mut [Spectrum]) {
        let width = self.across.axis.size as usize;
        let mut rows = vec![Spectrum::ZERO; plane.len()];
        rows.par_chunks_mut(width).zip(plane.par_chunks(width)).for_each(|(taken, row)| {
            taken.iter_mut().enumerate().for_each(|(x, taken)| *taken = self.across.taken(x, |x| row[x]));
        });
        plane.par_chunks_mut(width).enumerate().for_each(|(y, taken)| {
            for (x, taken) in taken.iter_mut().enumerate() {
                *taken = self.down.taken(y, |y| rows[y * width + x]);
            }
        });
    }
}

/// Where the samples of a pass lie, drawn from `stream`. The filter is the same along both axes.
pub(super) fn place(places: &Places, stream: &mut Stream) -> Place {
    Place { across: places.sample(stream), down: places.sample(stream) }
}

/// The part of the variance of independent samples that sharing leaves along `axis`.
pub(super) fn variance_left(axis: &Axis, places: &Places) -> f64 {
    let scale = f64::from(axis.scales[axis.size as usize / 2]);
    let of_part = |(mark, mass): (Mark, f32)| {
        let squares = Taps::new(axis, mark).weights.into_iter().map(|weight| f64::from(weight).powi(2));
        f64::from(mass) * squares.sum::<f64>() * scale * scale
    };
    places.parts().map(of_part).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        film::{Film, Window, format::Format},
        math::{DVec3, vec2},
        sampling::{Sampler, stream::Purpose},
    };

    const FILTERS: [Filter; 6] = [
        Filter::Tent { radius: 1.0 },
        Filter::Tent { radius: 1.7 },
        Filter::Gaussian { stddev: 0.5 },
        Filter::Gaussian { stddev: 1.2 },
        Filter::Cubic { b: 0.0, c: 0.5 },
        Filter::Lanczos { lobes: 3 },
    ];

    fn film(filter: Filter, size: [u32; 2]) -> Film {
        Film::new(Window::whole(size[0], size[1]), filter, false, Format::default())
    }

    fn place(film: &Film, pass: u64) -> Place {
        film.place(&mut Sampler::Sobol.stream(5, 77, pass, 0, 1, Purpose::Study)).unwrap()
    }

    /// Film positions `at`, seen: smooth, and different across and down.
    fn picture(at: Vec2) -> Spectrum {
        Spectrum::new((0.3 * at.x).exp(), 1.0 + 0.2 * at.y * at.y, if at.x > 2.3 { 1.0 } else { 0.0 })
    }

    fn pass(film: &Film, place: Place) -> Vec<Spectrum> {
        let mut samples: Vec<Spectrum> =
            (0..film.len()).map(|pixel| picture(film.position(pixel, place))).collect();
        film.sharing(place).share(&mut samples);
        samples
    }

    /// The mean of passes is what filters make of the picture, at borders too and on films smaller than the filter.
    #[test]
    fn shared_samples_average_to_the_filtered_image() {
        const STEPS: u32 = 200;
        for (filter, size) in FILTERS.into_iter().flat_map(|f| [[6, 5], [1, 2]].map(|size| (f, size))) {
            let film = film(filter, size);
            let mut truth = vec![DVec3::ZERO; film.len()];
            for (x, y) in (0..size[0] * STEPS).flat_map(|x| (0..size[1] * STEPS).map(move |y| (x, y))) {
                let at = (vec2(x as f32, y as f32) + 0.5) / STEPS as f32;
                let step = 1.0 / f64::from(STEPS * STEPS);
                film.spread(at, picture(at), |pixel, share| truth[pixel] += share.as_dvec3() * step);
            }
            let passes = 1 << 14;
            let mut mean = vec![DVec3::ZERO; film.len()];
            for number in 0..passes {
                let image = pass(&film, place(&film, number));
                let part = 1.0 / passes as f64;
                mean.iter_mut().zip(image).for_each(|(mean, value)| *mean += value.as_dvec3() * part);
            }
            for (pixel, (mean, truth)) in mean.iter().zip(&truth).enumerate() {
                let off = (*mean - *truth).abs().max_element();
                assert!(off < 5e-3, "{filter:?} {size:?} {pixel}: {mean}, not {truth}");
            }
        }
    }

    /// Every pass of an even picture is even, but for the pixels whose filter is cut off.
    #[test]
    fn a_pass_over_an_even_picture_is_even() {
        for filter in FILTERS {
            let film = film(filter, [16, 15]);
            let reach = reach(&filter) as u32;
            // Lanczos' filters do not quite add up to a constant.
            let most = if matches!(filter, Filter::Lanczos { .. }) { 0.1 } else { 5e-3 };
            for number in 0..100 {
                let place = place(&film, number);
                let mut samples = vec![Spectrum::ONE; film.len()];
                film.sharing(place).share(&mut samples);
                let is_inner = |x: u32, size: u32| x >= reach && x + reach < size;
                for (x, y) in (0..16).flat_map(|x| (0..15).map(move |y| (x, y))) {
                    let value = samples[(y * 16 + x) as usize].x;
                    let off = (value - 1.0).abs();
                    assert!(
                        !is_inner(x, 16) || !is_inner(y, 15) || off < most,
                        "{filter:?} {place:?}: {value}"
                    );
                }
            }
        }
    }

    /// The variance left of independent samples is what was promised; a third for the default filter.
    #[test]
    fn the_variance_left_is_known() {
        for filter in FILTERS {
            let film = film(filter, [32, 32]);
            let (mut squares, mut count) = (0.0, 0.0);
            for number in 0..400 {
                let place = place(&film, number);
                let mut stream = Stream::new(9, 1, number, Purpose::Study);
                let mut samples: Vec<Spectrum> =
                    (0..film.len()).map(|_| Spectrum::splat(stream.normal())).collect();
                film.sharing(place).share(&mut samples);
                for pixel in (8..24).flat_map(|y| (8..24).map(move |x| y * 32 + x)) {
                    squares += f64::from(samples[pixel].x).powi(2);
                    count += 1.0;
                }
            }
            let (found, told) = (squares / count, film.variance_left());
            assert!((found / told - 1.0).abs() < 0.03, "{filter:?}: {found}, not {told}");
        }
        let left = film(Filter::Gaussian { stddev: 0.5 }, [32, 32]).variance_left();
        assert!((left * 4.0 * std::f64::consts::PI * 0.25 - 1.0).abs() < 0.03, "{left}");
    }

    #[test]
    fn narrow_filters_and_films_sampled_beyond_their_border_share_nothing() {
        let gaussian = Filter::Gaussian { stddev: 0.5 };
        let bordered = Film::new(Window::whole(4, 4), gaussian, true, Format::default());
        let narrow = [Filter::Box, Filter::Tent { radius: 0.5 }, Filter::Gaussian { stddev: 0.1 }];
        assert!(narrow.into_iter().all(|filter| !film(filter, [4, 4]).can_share()));
        assert!(!bordered.can_share());
        assert_eq!(bordered.variance_left(), 1.0);
    }
}
