//! The error of an image, estimated from two independent halves of its samples.
//!
//! The error is that of relMSE, whose denominators are squares of the true image. A pixel's own mean is a bad stand-in
//! for the true one where few samples carry much light. The sample that makes the variance makes the mean too, and
//! their quotient is at most 1, however far such samples are above what is around them. Hence a pixel's mean counts
//! only as far as the means of its neighbours differ by more than their noise (Lee 1980); else their mean does. That
//! mean counts in the same way against what is around it, and so on to the whole image: where nine pixels of ten have
//! found no light yet, eight neighbours say nothing. A small lamp in view is no such sample, but only a look can tell:
//! pixels that carry much of the error are looked at.

use crate::math::relative::Relative;
use rayon::prelude::*;

/// Pixels across and down that are compared with each other, then cells of them, and so on.
const TILE: usize = 3;

/// The estimated relative error of an image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// The root of the mean over pixels of variance / (mean^2 + 0.01 m^2), by luminance, where m is that of the whole image.
    pub error: f64,
    /// Pixels that carry it: as many equal ones would make it as uncertain.
    pub carriers: f64,
}

/// A pixel's mean, and its variance.
type Moments = (f64, f64);

/// Pixels that are looked at, at most.
const LOOKS: usize = 64;

/// Least share of the error, and least factor by which a pixel is brighter than taken for, that is worth a look.
const WORTH: f64 = 1e-3;
const BRIGHTER: f64 = 2.0;

impl Noise {
    /// The noise of an image `width` pixels across, from the luminance of each pixel in either half; none where no
    /// pixel has any light yet. `seen` is the unscattered luminance of emitters in a pixel.
    pub fn of_halves(width: usize, halves: &[(f64, f64)], seen: &dyn Fn(usize) -> f64) -> Option<Self> {
        // The halves differ by the root of twice the variance of either, their mean varies by half of it.
        let moments = |(a, b): &(f64, f64)| (0.5 * (a + b), (0.5 * (a - b)).powi(2));
        let moments: Vec<Moments> = halves.par_iter().map(moments).collect();
        let finite = || moments.iter().filter(|(mean, _)| mean.is_finite());
        let count = finite().count() as f64;
        let mean = finite().map(|(mean, _)| mean).sum::<f64>() / count;
        if finite().all(|(mean, variance)| *mean == 0.0 && *variance == 0.0) {
            return None;
        }
        let to = Relative::to_mean(mean);
        let pixels = Level { width, cells: moments.clone() };
        let own =
            |(taken, (own, _)): (&Taken, &Moments)| if own.is_finite() { taken.with(*own) } else { 0.0 };
        let taken: Vec<f64> = pixels.taken().iter().zip(&moments).map(own).collect();
        let term = |((mean, variance), r): (&Moments, &f64)| {
            if mean.is_finite() { to.square(*variance, *r) } else { 0.0 }
        };
        let mut terms: Vec<f64> = moments.iter().zip(&taken).map(term).collect();
        look(&mut terms, &moments, &taken, to, seen);
        let (sum, squares) = terms.iter().map(|term| (*term, term * term)).fold((0.0, 0.0), both);
        Some(Self::of_sums(sum / count, squares / (count * count)))
    }

    /// The noise of independent parts: of the weighted sum of their squared errors.
    pub fn sum(parts: impl Iterator<Item = (f64, Self)>) -> Self {
        let term = |(weight, Self { error, carriers }): (f64, Self)| {
            let square = weight * error * error;
            (square, if square > 0.0 { square * square / carriers } else { 0.0 })
        };
        let (sum, squares) = parts.map(term).fold((0.0, 0.0), both);
        Self::of_sums(sum, squares)
    }

    fn of_sums(sum: f64, squares: f64) -> Self {
        let carriers = if squares > 0.0 { sum * sum / squares } else { f64::INFINITY };
        Self { error: sum.sqrt(), carriers }
    }

    /// The standard deviation of the error itself, relative to it.
    pub fn uncertainty(&self) -> f64 {
        0.5 / self.carriers.sqrt()
    }
}

fn both(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    (a.0 + b.0, a.1 + b.1)
}

/// An image of moments, one for each cell of [`TILE`] x [`TILE`] pixels, cells of those, and so on.
struct Level {
    width: usize,
    cells: Vec<Moments>,
}

impl Level {
    /// The cells of this level's cells. One without a number has none itself.
    fn coarser(&self) -> Self {
        let width = self.width.div_ceil(TILE);
        let height = (self.cells.len() / self.width).div_ceil(TILE);
        let mean = |cell| {
            let members = self.members(cell, width);
            let (sum, variance) = members.iter().map(|member| self.cells[*member]).fold((0.0, 0.0), both);
            let count = members.len() as f64;
            (sum / count, variance / (count * count))
        };
        Self { width, cells: (0..width * height).into_par_iter().map(mean).collect() }
    }

    /// The cells within `cell` of a level `width` across that are numbers.
    fn members(&self, cell: usize, width: usize) -> Vec<usize> {
        let (left, top) = (TILE * (cell % width), TILE * (cell / width));
        let rows = top..(top + TILE).min(self.cells.len() / self.width);
        let columns = left..(left + TILE).min(self.width);
        let members = rows.flat_map(|y| columns.clone().map(move |x| y * self.width + x));
        members.filter(|member| self.cells[*member].0.is_finite()).collect()
    }

    /// What each cell is taken for: 0 if it is no number.
    fn taken(&self) -> Vec<Taken> {
        if self.cells.len() == 1 {
            return vec![Taken { prior: self.cells[0].0, content: 1.0 }];
        }
        let coarser = self.coarser();
        let of_cell = |(cell, around): (usize, &Taken)| {
            let members = self.members(cell, coarser.width);
            let moments: Vec<Moments> = members.iter().map(|member| self.cells[*member]).collect();
            members.into_iter().zip(Taken::of_cell(&moments, around)).collect::<Vec<_>>()
        };
        let around = coarser.taken();
        let found: Vec<_> = around.par_iter().enumerate().flat_map_iter(of_cell).collect();
        let mut taken = vec![Taken { prior: 0.0, content: 0.0 }; self.cells.len()];
        found.into_iter().for_each(|(member, value)| taken[member] = value);
        taken
    }
}

/// What a pixel or a cell is taken for.
#[derive(Clone, Copy)]
struct Taken {
    /// What its surroundings say.
    prior: f64,
    /// The part of its neighbours' spread that is no noise.
    content: f64,
}

impl Taken {
    /// What the members of a cell are taken for, if the cell is taken for `around`. The mean of the others stands for
    /// the cell's own: where they differ from their surroundings by noise alone, the surroundings are the better guess.
    fn of_cell(members: &[Moments], around: &Self) -> Vec<Self> {
        let count = members.len() as f64;
        if members.len() < 2 {
            return members.iter().map(|_| *around).collect();
        }
        let (sum, variance) = members.iter().copied().fold((0.0, 0.0), both);
        let (mean, variance) = (sum / count, variance / count);
        let spread = members.iter().map(|(own, _)| (own - mean).powi(2)).sum::<f64>() / (count - 1.0);
        let content = if spread > variance { (spread - variance) / spread } else { 0.0 };
        let prior = |(own, _): &Moments| around.with((sum - own) / (count - 1.0));
        members.iter().map(|own| Self { prior: prior(own), content }).collect()
    }

    /// With its `own` mean.
    fn with(&self, own: f64) -> f64 {
        self.prior + self.content * (own - self.prior)
    }
}

/// Corrects the `terms` of pixels that are much brighter than they are `taken` for. Those that carry most are corrected
/// by what is `seen`, the others in the same proportion.
fn look(terms: &mut [f64], moments: &[Moments], taken: &[f64], to: Relative, seen: &dyn Fn(usize) -> f64) {
    let total: f64 = terms.iter().sum();
    let is_odd = |pixel: &usize| moments[*pixel].0 > BRIGHTER * taken[*pixel].abs();
    let carries = |pixel: &usize| terms[*pixel] * LOOKS as f64 > WORTH * total;
    let mut odd: Vec<usize> = (0..terms.len()).filter(|pixel| is_odd(pixel) && carries(pixel)).collect();
    odd.sort_by(|a, b| terms[*b].total_cmp(&terms[*a]).then(a.cmp(b)));
    let (first, others) = odd.split_at(odd.len().min(LOOKS));
    let before: f64 = first.iter().map(|pixel| terms[*pixel]).sum();
    for pixel in first {
        terms[*pixel] = to.square(moments[*pixel].1, taken[*pixel].max(seen(*pixel)));
    }
    let after: f64 = first.iter().map(|pixel| terms[*pixel]).sum();
    for pixel in others {
        let (own, variance) = moments[*pixel];
        let least = to.square(variance, own);
        terms[*pixel] = least + (terms[*pixel] - least) * after / before;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{Stream, stream::Purpose};

    /// `passes` a half of samples that are `bright` with some probability, over 64 x 64 pixels.
    fn halves(passes: u64, value: impl Fn(usize, &mut Stream) -> f64) -> Vec<(f64, f64)> {
        let half = |pixel: usize, half: u64| {
            let sample = |pass| value(pixel, &mut Stream::new(half, pixel as u64, pass, Purpose::Study));
            (0..passes).map(sample).sum::<f64>() / passes as f64
        };
        (0..4096).map(|pixel| (half(pixel, 0), half(pixel, 1))).collect()
    }

    /// Samples of mean 1, of which few carry half the light; beside an edge that has no noise.
    #[test]
    fn rare_bright_samples_do_not_hide_themselves() {
        for rarity in [0.5, 0.03, 0.002] {
            let rare = |stream: &mut Stream| {
                0.5 + if f64::from(stream.uniform()) < rarity { 0.5 / rarity } else { 0.0 }
            };
            let value = |pixel: usize, stream: &mut Stream| if pixel % 64 < 20 { 30.0 } else { rare(stream) };
            let found = Noise::of_halves(64, &halves(8, value), &|_| 0.0).unwrap();
            let mean = (20.0 * 30.0 + 44.0) / 64.0;
            let variance = 0.25 * (1.0 / rarity - 1.0) / 16.0;
            let truth = (44.0 / 64.0 * variance / (1.0 + 0.01 * mean * mean)).sqrt();
            let ratio = found.error / truth;
            assert!((ratio - 1.0).abs() < 0.02 + 3.0 * found.uncertainty(), "{rarity}: {ratio}, {found:?}");
            assert!((ratio - 1.0).abs() < 0.15, "{rarity}: {ratio}");
        }
    }

    /// One pixel of twenty has found light: nine of them say little, all of them say how bright each is.
    #[test]
    fn tiles_without_light_are_not_taken_for_black() {
        let rarity = 0.003;
        let value = |_: usize, stream: &mut Stream| {
            if f64::from(stream.uniform()) < rarity { 1.0 / rarity } else { 0.0 }
        };
        let found = Noise::of_halves(64, &halves(8, value), &|_| 0.0).unwrap();
        let truth = ((1.0 / rarity - 1.0) / 16.0 / 1.01).sqrt();
        assert!(
            (found.error / truth - 1.0).abs() < 0.02 + 3.0 * found.uncertainty(),
            "{found:?}, not {truth}"
        );
    }

    /// Every pixel is as bright as it is.
    #[test]
    fn content_is_no_noise() {
        let value = |pixel: usize, stream: &mut Stream| {
            (1.0 + (pixel * 7919 % 64) as f64) * (1.0 + 0.2 * f64::from(stream.normal()))
        };
        let found = Noise::of_halves(64, &halves(8, value), &|_| 0.0).unwrap();
        assert!((found.error / 0.05 - 1.0).abs() < 0.1, "{found:?}");
    }

    #[test]
    fn nothing_seen_is_not_known() {
        assert_eq!(Noise::of_halves(3, &[(0.0, 0.0); 9], &|_| 0.0), None);
        assert_eq!(
            Noise::of_halves(3, &[(1.0, 1.0); 9], &|_| 0.0),
            Some(Noise { error: 0.0, carriers: f64::INFINITY })
        );
        assert!(
            Noise::of_halves(3, &[(1.0, 1.0), (f64::NAN, 1.0), (1.0, 2.0)], &|_| 0.0).unwrap().error > 0.0
        );
    }

    #[test]
    fn one_pixel_carries_what_it_alone_has() {
        let mut halves = [(1.0, 1.0); 64];
        halves[9] = (0.0, 300.0);
        let found = Noise::of_halves(8, &halves, &|_| 0.0).unwrap();
        assert!((found.carriers - 1.0).abs() < 1e-9 && found.error > 10.0, "{found:?}");
        let mean = Noise::sum([(0.25, found); 2].into_iter());
        assert!(
            (mean.carriers - 2.0).abs() < 1e-9 && (mean.error / found.error - 0.5f64.sqrt()).abs() < 1e-9
        );
    }

    /// A lamp that covers a part of one pixel, which half of the samples hit.
    #[test]
    fn what_is_seen_is_no_rare_sample() {
        let mut halves = [(1.0, 1.0); 64];
        halves[9] = (0.0, 300.0);
        let seen = |pixel: usize| if pixel == 9 { 150.0 } else { 0.0 };
        let found = Noise::of_halves(8, &halves, &seen).unwrap();
        assert!((found.error * 8.0 - 1.0).abs() < 0.01, "{found:?}");
    }
}
