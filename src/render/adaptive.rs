//! Stopping where every pixel's error is small enough (P03T A.2.3), without bias.
//!
//! A pixel that stops because its own samples look calm stops too soon where they happened to be low, and its mean is
//! biased for it. Hence two halves of independent passes: a pixel's mean over one half ends where the *other* half's
//! samples say that the error is small enough, so that the decision to stop is independent of the samples
//! that are averaged.
//!
//! What light subpaths contribute to the film is a mean over passes too, of every pixel at once: it ends for
//! a half where the last pixel of the other half has converged.

use super::{
    Progress,
    block::{Outcome, Pass},
    faults::Faults,
    instrument::{BLOCKS_AT_ONCE, Instrument},
    monitor::Stopwatch,
};
use crate::math::{DVec3, Spectrum, relative::Relative, spectrum::LUMINANCE};
use rayon::prelude::*;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// The precision required of every pixel: that its value is off by less than `error`, relative to it and a hundredth of
/// the image's mean luminance together (see [`Relative::difference`]); in every channel, with probability `confidence`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Precision {
    /// In (0, 1].
    pub error: f64,
    /// In (0, 1).
    pub confidence: f64,
}

/// How a render with a requested precision ended.
#[derive(Clone, Debug, PartialEq)]
pub struct Reached {
    /// The part of the pixels that are within the error, by what their samples say.
    pub share: f64,
    /// Samples taken of each pixel by camera subpaths.
    pub samples: Vec<u32>,
}

/// The result of an adaptive render.
pub(super) struct Developed {
    /// The image.
    pub pixels: Vec<Spectrum>,
    /// Passes over the image, both halves together.
    pub passes: u64,
    /// Root of the mean squared relative error, as what ends pixels measures it.
    pub noise: Option<f64>,
    /// Where and how far.
    pub reached: Reached,
    /// What went wrong on the way.
    pub faults: Faults,
}

/// Passes of a half before it is first examined: variances of fewer are too uncertain.
const FIRST_LOOK: u64 = 16;
/// Passes up to the next check over those up to the last: few checks, so that chance has few opportunities to
/// stop early.
const GROWTH: f64 = 1.25;
/// An image is black if light does not come in more than this part of the samples.
const RAREST: f64 = 1e-3;

/// The passes of one half.
struct Half {
    passes: u64,
    /// Sums over passes while a pixel is active.
    camera: Vec<DVec3>,
    /// Of squares of what a pass contributes, light subpaths included.
    squares: Vec<DVec3>,
    /// Sums over all passes.
    light: Vec<DVec3>,
    /// Squared relative error as this half's samples estimate it, kept once it is small enough.
    errors: Vec<f64>,
    /// The pixel has converged by this half.
    content: Vec<bool>,
    /// Mean luminance of the image; 0 before it is known.
    mean: f64,
    /// Means of camera subpaths, where the other half has ended them.
    ended: Vec<Option<DVec3>>,
    /// The same of light subpaths.
    ended_light: Option<Vec<DVec3>>,
}

impl Half {
    fn new(pixels: usize) -> Self {
        let zeros = || vec![DVec3::ZERO; pixels];
        Self {
            passes: 0,
            camera: zeros(),
            squares: zeros(),
            light: zeros(),
            errors: vec![f64::INFINITY; pixels],
            content: vec![false; pixels],
            mean: 0.0,
            ended: vec![None; pixels],
            ended_light: None,
        }
    }

    fn add(&mut self, camera: &[Spectrum], light: &[Spectrum], active: &[bool]) {
        self.passes += 1;
        for (pixel, (camera, light)) in camera.iter().zip(light).enumerate() {
            let (camera, light) = (camera.as_dvec3(), light.as_dvec3());
            self.light[pixel] += light;
            if active[pixel] {
                let both = camera + light;
                self.camera[pixel] += camera;
                self.squares[pixel] += both * both;
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
    fn judge(&mut self, active: &[bool], width: usize, limits: &Limits) {
        if self.mean == 0.0 {
            let luminances = (0..self.camera.len()).map(|pixel| luminance(self.moments(pixel).0));
            // One broken sample must not decide for all pixels.
            let sum: f64 = luminances.filter(|luminance| luminance.is_finite()).sum();
            self.mean = sum / self.camera.len() as f64;
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

    /// Pixels without any light yet have no variance to judge by. They end with the last of the others, or in an image
    /// that is all black, after enough samples.
    fn judge_black(&mut self, limits: &Limits) {
        let is_black = |pixel: usize| self.squares[pixel] == DVec3::ZERO;
        let pixels = || 0..self.content.len();
        // What has no variance, such as an emitter in view, does not show that light was found elsewhere.
        let light_was_found = pixels().any(|pixel| !is_black(pixel) && self.errors[pixel] > 0.0);
        let waited = light_was_found || self.passes >= limits.passes_without_light;
        if waited && pixels().all(|pixel| is_black(pixel) || self.content[pixel]) {
            self.content.fill(true);
        }
    }

    /// Squared relative error that the mean over both halves has at a pixel, the greatest of its channels.
    fn error(&self, pixel: usize) -> f64 {
        let (mean, variance) = self.moments(pixel);
        if !mean.is_finite() {
            return f64::INFINITY;
        }
        let (to, passes) = (Relative::to_mean(self.mean), 2.0 * self.passes as f64);
        let of = |c: usize| to.difference((variance[c] / passes).sqrt(), mean[c]).powi(2);
        of(0).max(of(1)).max(of(2))
    }

    /// Neighbours are checked as well: a few samples may all have missed what makes a pixel's variance.
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
    fn end(&mut self, other: &Self) {
        let n = self.passes as f64;
        for (pixel, ended) in self.ended.iter_mut().enumerate() {
            if ended.is_none() && other.content[pixel] {
                *ended = Some(self.camera[pixel] / n);
            }
        }
        if self.ended_light.is_none() && other.content.iter().all(|content| *content) {
            self.ended_light = Some(self.light.iter().map(|sum| *sum / n).collect());
        }
    }

    /// The half's estimate of a pixel.
    fn value(&self, pixel: usize) -> DVec3 {
        let n = self.passes as f64;
        let light = self.ended_light.as_ref().map_or(self.light[pixel] / n, |light| light[pixel]);
        self.ended[pixel].unwrap_or(self.camera[pixel] / n) + light
    }
}

/// What ends a pixel, after some number of passes.
struct Limits {
    /// Of the relative error's standard deviation.
    squared_error: f64,
    /// Passes of a half without any light that make an image black.
    passes_without_light: u64,
}

impl Limits {
    /// Student's t makes up for variances that are estimates themselves (P03T A.2.3).
    fn after(passes: u64, precision: Precision) -> Self {
        let Precision { error, confidence } = precision;
        let tail = 0.5 * (1.0 - confidence);
        let t = StudentsT::new(0.0, 1.0, (passes - 1) as f64).map_or(f64::INFINITY, |t| -t.inverse_cdf(tail));
        // With this many passes, light that comes in more than a thousandth of all samples of every pixel has shown
        // itself somewhere with probability `confidence`, even if there were only one pixel.
        let unseen = (1.0 - confidence).ln() / (-RAREST).ln_1p();
        Self { squared_error: (error / t).powi(2), passes_without_light: unseen.ceil() as u64 }
    }
}

/// The two halves at work.
pub(super) struct Adaptive<'a> {
    bench: &'a Instrument<'a>,
    stopwatch: &'a Stopwatch,
    precision: Precision,
    halves: [Half; 2],
    active: Vec<bool>,
    /// Passes that a pixel has been active in.
    samples: Vec<u32>,
    /// The unfinished pass, and how many of its blocks are done.
    pass: Pass,
    blocks: usize,
    faults: Faults,
}

impl<'a> Adaptive<'a> {
    /// Nothing done yet.
    pub fn new(bench: &'a Instrument<'a>, precision: Precision, stopwatch: &'a Stopwatch) -> Self {
        let pixels = bench.film.len();
        let halves = [Half::new(pixels), Half::new(pixels)];
        let (active, samples, pass) = (vec![true; pixels], vec![0; pixels], Pass::new(pixels));
        Self {
            bench,
            stopwatch,
            precision,
            halves,
            active,
            samples,
            pass,
            blocks: 0,
            faults: Faults::default(),
        }
    }

    /// Renders until every pixel has converged or the budget is spent.
    pub fn run(mut self, progress: &mut dyn FnMut(Progress)) -> Developed {
        let mut goal = FIRST_LOOK;
        while self.active.iter().any(|active| *active) {
            let is_spent = !self.advance(goal, progress);
            self.look();
            if is_spent {
                break;
            }
            goal = (goal + 1).max((goal as f64 * GROWTH) as u64);
        }
        self.develop()
    }

    /// Renders until both halves have `goal` passes; false if the budget ends before. A pass that time does not suffice
    /// for is left out, unless it is the first.
    fn advance(&mut self, goal: u64, progress: &mut dyn FnMut(Progress)) -> bool {
        let (budget, count) = (self.bench.settings.budget, self.bench.compiled.blocks().count());
        let end = budget.samples_per_pixel.unwrap_or(u64::MAX).min(2 * goal);
        let (mut next, end_task) = (self.passes() as usize * count, end as usize * count);
        while next < end_task {
            let tasks = next..end_task.min(next + BLOCKS_AT_ONCE);
            let outcomes = self.work(tasks.clone());
            for (task, outcome) in tasks.clone().zip(&outcomes) {
                self.pass.add(outcome);
                self.faults.add(&outcome.faults);
                self.blocks += 1;
                if (task + 1) % count == 0 {
                    self.take();
                }
            }
            next += outcomes.len();
            progress(self.progress(next));
            if outcomes.len() < tasks.len() {
                return false;
            }
        }
        end == 2 * goal
    }

    /// Renders the active pixels of blocks, and their light subpaths, as far as the budget goes.
    fn work(&self, tasks: std::ops::Range<usize>) -> Vec<Outcome> {
        let wants = |pixel: usize| self.active[pixel];
        let is_over = || self.bench.settings.budget.is_over(self.stopwatch.elapsed());
        self.bench.work_until(tasks, is_over, |pass, block| self.bench.compiled.render(pass, block, &wants))
    }

    fn passes(&self) -> u64 {
        self.halves.iter().map(|half| half.passes).sum()
    }

    /// Passes take turns: even ones belong to the first half.
    fn take(&mut self) {
        let half = (self.passes() % 2) as usize;
        let (camera, light) = self.pass.parts();
        self.halves[half].add(camera, light, &self.active);
        self.samples.iter_mut().zip(&self.active).for_each(|(n, active)| *n += u32::from(*active));
        self.pass.clear();
        self.blocks = 0;
    }

    /// Ends what can be ended.
    fn look(&mut self) {
        let [first, second] = self.halves.each_ref().map(|half| half.passes);
        // Where the budget ended between the halves they are not equal; this check is the last one then.
        let passes = first.min(second);
        if passes < 2 {
            return;
        }
        let width = self.bench.film.width as usize;
        let limits = Limits::after(passes, self.precision);
        self.halves.iter_mut().for_each(|half| half.judge(&self.active, width, &limits));
        let [first, second] = &mut self.halves;
        first.end(second);
        second.end(first);
        for (pixel, active) in self.active.iter_mut().enumerate() {
            *active = first.ended[pixel].is_none() || second.ended[pixel].is_none();
        }
    }

    /// The fraction of the pixels that have converged.
    fn share(&self) -> f64 {
        self.active.iter().filter(|active| !**active).count() as f64 / self.active.len().max(1) as f64
    }

    fn progress(&self, tasks: usize) -> Progress {
        let samples = (tasks as u64 * self.active.len() as u64) / self.bench.compiled.blocks().count() as u64;
        let (passes, elapsed) = (self.passes(), self.stopwatch.elapsed());
        Progress { samples, passes, elapsed, noise: None, within: Some(self.share()), is_last: false }
    }

    /// The mean of the halves; what there is of the first pass where there is no more.
    fn develop(self) -> Developed {
        if self.passes() == 0 {
            let reached = Reached { share: 0.0, samples: self.samples };
            let width = self.bench.film.width as usize;
            let pixels = self.pass.pixels(self.bench.compiled.blocks(), self.blocks, width);
            return Developed { pixels, passes: 0, noise: None, reached, faults: self.faults };
        }
        let halves: Vec<&Half> = self.halves.iter().filter(|half| half.passes > 0).collect();
        let value = |pixel| halves.iter().map(|half| half.value(pixel)).sum::<DVec3>() / halves.len() as f64;
        let pixels = (0..self.active.len()).map(|pixel| value(pixel).as_vec3()).collect();
        let noise = (halves.iter().all(|half| half.errors[0].is_finite())).then(|| rms(&halves));
        let (passes, share) = (self.passes(), self.share());
        Developed {
            pixels,
            passes,
            noise,
            reached: Reached { share, samples: self.samples },
            faults: self.faults,
        }
    }
}

/// Root of the mean squared relative error, as the halves estimated it last.
fn rms(halves: &[&Half]) -> f64 {
    let errors = halves.iter().flat_map(|half| &half.errors);
    let count = halves.iter().map(|half| half.errors.len()).sum::<usize>().max(1);
    (errors.sum::<f64>() / count as f64).sqrt()
}

fn luminance(rgb: DVec3) -> f64 {
    rgb.dot(LUMINANCE.as_dvec3())
}
