//! The passes of one half of a render to a precision, and when they are enough for a pixel (P03T A.2.3).

use crate::{
    math::{DVec3, Spectrum, relative::Relative, spectrum::LUMINANCE},
    render::image::Precision,
};
use rayon::prelude::*;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// An image is black if at most this part of the samples finds light.
const RAREST: f64 = 1e-3;

/// The passes of one half, over the image and its layers. Sums and means of layers follow those of the image, and end
/// with its pixels.
#[derive(Clone, Debug)]
pub(in crate::render) struct Half {
    pub passes: u64,
    /// Sums over passes while a pixel is active.
    pub camera: Vec<DVec3>,
    /// Sums of the squares of a pass's contributions, including light subpaths.
    pub squares: Vec<DVec3>,
    /// Sums over all passes.
    pub light: Vec<DVec3>,
    /// Squared relative error as estimated by this half's samples, kept once it is small enough.
    pub errors: Vec<f64>,
    /// This half says that the pixel has converged.
    pub content: Vec<bool>,
    /// Mean luminance of the image; 0 before it is known.
    pub mean: f64,
    /// Means of camera subpaths, where the other half has ended them.
    pub ended: Vec<Option<DVec3>>,
    /// The same of light subpaths.
    pub ended_light: Option<Vec<DVec3>>,
}

impl Half {
    /// No pass yet over so many `planes`.
    pub(crate) fn new(pixels: usize, planes: usize) -> Self {
        let zeros = || vec![DVec3::ZERO; pixels * planes];
        Self {
            passes: 0,
            camera: zeros(),
            squares: vec![DVec3::ZERO; pixels],
            light: zeros(),
            errors: vec![f64::INFINITY; pixels],
            content: vec![false; pixels],
            mean: 0.0,
            ended: vec![None; pixels * planes],
            ended_light: None,
        }
    }

    /// Adds what a pass contributed.
    pub(crate) fn add(&mut self, camera: &[Spectrum], light: &[Spectrum], active: &[bool]) {
        self.passes += 1;
        for (index, (camera, light)) in camera.iter().zip(light).enumerate() {
            let (camera, light) = (camera.as_dvec3(), light.as_dvec3());
            self.light[index] += light;
            if active[index % active.len()] {
                let both = camera + light;
                self.camera[index] += camera;
                self.squares.get_mut(index).into_iter().for_each(|sum| *sum += both * both);
            }
        }
    }

    /// Mean and variance of a pass at a pixel that is active.
    fn moments(&self, pixel: usize) -> (DVec3, DVec3) {
        let n = self.passes as f64;
        let mean = (self.camera[pixel] + self.light[pixel]) / n;
        let variance = (self.squares[pixel] / n - mean * mean) * (n / (n - 1.0));
        (mean, variance.max(DVec3::ZERO))
    }

    /// Examines the samples of the active pixels.
    pub(crate) fn judge(&mut self, active: &[bool], width: usize, limits: &Limits) {
        if self.mean == 0.0 {
            let luminances = (0..active.len()).map(|pixel| luminance(self.moments(pixel).0));
            // One broken sample must not decide for all pixels.
            let sum: f64 = luminances.filter(|luminance| luminance.is_finite()).sum();
            self.mean = sum / active.len() as f64;
        }
        for pixel in (0..active.len()).filter(|pixel| active[*pixel]) {
            if !self.content[pixel] {
                self.errors[pixel] = self.error(pixel);
            }
        }
        let newly: Vec<usize> = (0..active.len())
            .into_par_iter()
            .filter(|pixel| active[*pixel] && !self.content[*pixel] && self.is_calm(*pixel, width, limits))
            .collect();
        newly.into_iter().for_each(|pixel| self.content[pixel] = true);
        self.judge_black(limits);
    }

    /// Pixels without any light yet have no variance to judge by. They end with the last of the others or, if the whole
    /// image is black, after enough samples.
    fn judge_black(&mut self, limits: &Limits) {
        let is_black = |pixel: usize| self.squares[pixel] == DVec3::ZERO;
        let pixels = || 0..self.content.len();
        // A pixel without variance, such as an emitter in view, does not show that light was found elsewhere.
        let light_was_found = pixels().any(|pixel| !is_black(pixel) && self.errors[pixel] > 0.0);
        let waited = light_was_found || self.passes >= limits.passes_without_light;
        if waited && pixels().all(|pixel| is_black(pixel) || self.content[pixel]) {
            self.content.fill(true);
        }
    }

    /// Squared relative error of the mean over both halves at a pixel; the greatest of its channels.
    fn error(&self, pixel: usize) -> f64 {
        let (mean, variance) = self.moments(pixel);
        if !mean.is_finite() {
            return f64::INFINITY;
        }
        let (to, passes) = (Relative::to_mean(self.mean), 2.0 * self.passes as f64);
        let of = |c: usize| to.difference((variance[c] / passes).sqrt(), mean[c]).powi(2);
        of(0).max(of(1)).max(of(2))
    }

    /// Neighbours are checked as well: a few samples may all have missed the cause of a pixel's variance.
    fn is_calm(&self, pixel: usize, width: usize, limits: &Limits) -> bool {
        self.squares[pixel] != DVec3::ZERO
            && self.errors[pixel].max(self.around(pixel, width)) <= limits.squared_error
    }

    /// The mean over a pixel and its up to eight neighbours.
    fn around(&self, pixel: usize, width: usize) -> f64 {
        let height = self.errors.len() / width;
        let (x, y) = (pixel % width, pixel / width);
        let rows = y.saturating_sub(1)..=(y + 1).min(height - 1);
        let columns = x.saturating_sub(1)..=(x + 1).min(width - 1);
        let (mut sum, mut count) = (0.0, 0.0);
        for row in rows {
            for column in columns.clone() {
                sum += self.errors[row * width + column];
                count += 1.0;
            }
        }
        sum / count
    }

    /// Ends the means of this half where `other` has converged.
    pub(crate) fn end(&mut self, other: &Self) {
        let n = self.passes as f64;
        for (index, ended) in self.ended.iter_mut().enumerate() {
            if ended.is_none() && other.content[index % other.content.len()] {
                *ended = Some(self.camera[index] / n);
            }
        }
        if self.ended_light.is_none() && other.content.iter().all(|content| *content) {
            self.ended_light = Some(self.light.iter().map(|sum| *sum / n).collect());
        }
    }

    /// The half's estimate of a pixel, of the image or of a layer.
    pub(crate) fn value(&self, pixel: usize) -> DVec3 {
        let n = self.passes as f64;
        let light = self.ended_light.as_ref().map_or(self.light[pixel] / n, |light| light[pixel]);
        self.ended[pixel].unwrap_or(self.camera[pixel] / n) + light
    }
}

/// The limits at which a pixel ends, after some number of passes.
pub(in crate::render) struct Limits {
    /// Square of the limit on the relative error's standard deviation.
    squared_error: f64,
    /// Passes of a half without any light that make an image black.
    passes_without_light: u64,
}

impl Limits {
    /// Student's t accounts for variances that are themselves estimates (P03T A.2.3).
    pub(crate) fn after(passes: u64, precision: Precision) -> Self {
        let Precision { error, confidence } = precision;
        let tail = 0.5 * (1.0 - confidence);
        let t = StudentsT::new(0.0, 1.0, (passes - 1) as f64).map_or(f64::INFINITY, |t| -t.inverse_cdf(tail));
        // After this many passes, light in more than a thousandth of every pixel's samples has shown itself with
        // probability `confidence`, even in an image of one pixel.
        let unseen = (1.0 - confidence).ln() / (-RAREST).ln_1p();
        Self { squared_error: (error / t).powi(2), passes_without_light: unseen.ceil() as u64 }
    }
}

/// Of linear RGB.
pub(in crate::render) fn luminance(rgb: DVec3) -> f64 {
    rgb.dot(LUMINANCE.as_dvec3())
}
