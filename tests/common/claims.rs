//! Statistical claims: all those of a test are collected first, then judged together.

use statrs::distribution::{ContinuousCDF, StudentsT};
use std::fmt::Write as _;
use tyndall::math::Spectrum;

/// Chance that a test fails although all its claims hold, had its seeds been drawn again.
const SIGNIFICANCE: f64 = 1e-3;

/// Results are in single precision, so that even an estimate without variance is only as good as the rounding
/// errors of a path: this many units in the last place of the mean, as a standard error.
const ROUNDING: f64 = 16.0 * f32::EPSILON as f64 / 2.0;

/// What is compared of an image, one value per seed: its mean per channel and the means of its quarters.
#[derive(Clone, Debug)]
pub(crate) struct Sample {
    /// Per figure, per seed.
    figures: Vec<Vec<f64>>,
}

const NAMES: [&str; 7] = ["red", "green", "blue", "top left", "top right", "bottom left", "bottom right"];

impl Sample {
    /// Figures of `images`, independent estimates of one image of `width` pixels in a row.
    pub(crate) fn of(images: &[Vec<Spectrum>], width: usize) -> Self {
        let mut figures = vec![Vec::new(); NAMES.len()];
        for image in images {
            let height = image.len() / width;
            let mean = |channel: usize, keep: &dyn Fn(usize, usize) -> bool| {
                let chosen = image.iter().enumerate().filter(|(i, _)| keep(i % width, i / width));
                let values: Vec<f64> = chosen.map(|(_, v)| f64::from(v[channel])).collect();
                values.iter().sum::<f64>() / values.len() as f64
            };
            (0..3).for_each(|channel| figures[channel].push(mean(channel, &|_, _| true)));
            for quarter in 0..4 {
                let (right, low) = (quarter % 2 == 1, quarter / 2 == 1);
                let inside = |x: usize, y: usize| (x >= width / 2) == right && (y >= height / 2) == low;
                figures[3 + quarter].push(mean(1, &inside));
            }
        }
        Self { figures }
    }

    /// Every figure times `factor`.
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        self.map(|figure| figure.iter().map(|v| v * factor).collect())
    }

    /// Sum seed by seed.
    pub(crate) fn plus(&self, other: &Self) -> Self {
        self.with(other, |a, b| a + b)
    }

    fn map(&self, f: impl Fn(&Vec<f64>) -> Vec<f64>) -> Self {
        Self { figures: self.figures.iter().map(f).collect() }
    }

    fn with(&self, other: &Self, f: impl Fn(f64, f64) -> f64) -> Self {
        let figures = self.figures.iter().zip(&other.figures);
        Self { figures: figures.map(|(a, b)| a.iter().zip(b).map(|(a, b)| f(*a, *b)).collect()).collect() }
    }
}

/// Mean, and its variance, of independent values.
struct Moments {
    mean: f64,
    variance: f64,
    freedom: f64,
}

impl Moments {
    fn of(values: &[f64]) -> Self {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
        Self { mean, variance: squares / (n - 1.0) / n, freedom: n - 1.0 }
    }
}

struct Claim {
    what: String,
    found: f64,
    expected: f64,
    z: f64,
    p: f64,
}

/// Claims to be judged together: at least one true claim among them fails with probability [`SIGNIFICANCE`]
/// (Sidak's correction), however many there are.
#[derive(Default)]
pub(crate) struct Claims {
    claims: Vec<Claim>,
}

impl Claims {
    /// Nothing claimed yet.
    pub(crate) fn new() -> Self {
        Self::default()
    }

    /// `a` and `b` estimate the same image (Welch's t-test).
    pub(crate) fn equal(&mut self, what: &str, a: &Sample, b: &Sample) {
        for (name, (a, b)) in NAMES.iter().zip(a.figures.iter().zip(&b.figures)) {
            let (a, b) = (Moments::of(a), Moments::of(b));
            let variance = a.variance + b.variance;
            let freedom =
                variance.powi(2) / (a.variance.powi(2) / a.freedom + b.variance.powi(2) / b.freedom);
            self.add(format!("{what} ({name})"), a.mean, b.mean, variance, freedom);
        }
    }

    /// `a` and `b` estimate the same image from the same random numbers (t-test of their differences).
    pub(crate) fn equal_in_pairs(&mut self, what: &str, a: &Sample, b: &Sample) {
        let differences = a.with(b, |a, b| a - b);
        for (name, (difference, b)) in NAMES.iter().zip(differences.figures.iter().zip(&b.figures)) {
            let (difference, b) = (Moments::of(difference), Moments::of(b));
            let found = b.mean + difference.mean;
            self.add(format!("{what} ({name})"), found, b.mean, difference.variance, difference.freedom);
        }
    }

    /// Every figure of `a` is `expected` (t-test).
    pub(crate) fn equal_to(&mut self, what: &str, a: &Sample, expected: f64) {
        for (name, figure) in NAMES.iter().zip(&a.figures) {
            self.mean(&format!("{what} ({name})"), figure, expected);
        }
    }

    /// The mean of `values` is `expected` (t-test).
    pub(crate) fn mean(&mut self, what: &str, values: &[f64], expected: f64) {
        let found = Moments::of(values);
        self.add(what.to_owned(), found.mean, expected, found.variance, found.freedom);
    }

    /// Every pixel of `images` is `expected` in mean, in every channel.
    pub(crate) fn every_pixel(&mut self, what: &str, images: &[Vec<Spectrum>], expected: f64) {
        for pixel in 0..images[0].len() {
            for channel in 0..3 {
                let values: Vec<f64> = images.iter().map(|image| f64::from(image[pixel][channel])).collect();
                self.mean(&format!("{what} (pixel {pixel}, channel {channel})"), &values, expected);
            }
        }
    }

    fn add(&mut self, what: String, found: f64, expected: f64, variance: f64, freedom: f64) {
        let variance = variance + (ROUNDING * expected).powi(2);
        let z = if found == expected { 0.0 } else { (found - expected) / variance.sqrt() };
        let freedom = if freedom.is_finite() { freedom.max(1.0) } else { 1e6 };
        let p =
            if z.is_finite() { 2.0 * StudentsT::new(0.0, 1.0, freedom).unwrap().sf(z.abs()) } else { 0.0 };
        self.claims.push(Claim { what, found, expected, z, p });
    }

    /// Fails, naming every claim that cannot be held.
    pub(crate) fn settle(self) {
        assert!(!self.claims.is_empty(), "nothing was claimed");
        let level = 1.0 - (1.0 - SIGNIFICANCE).powf(1.0 / self.claims.len() as f64);
        let mut failures = String::new();
        for Claim { what, found, expected, z, .. } in self.claims.iter().filter(|claim| claim.p < level) {
            let relative = 100.0 * (found / expected - 1.0);
            let _ = write!(
                failures,
                "\n  {what}: {found:.6e} against {expected:.6e} ({relative:+.2} %), z = {z:.1}"
            );
        }
        assert!(failures.is_empty(), "of {} claims these do not hold:{failures}", self.claims.len());
    }
}
