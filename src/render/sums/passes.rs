//! An image that is being rendered: the sums of whole passes, and the finished blocks of one more. A render resumes
//! from it as if it had never stopped. Several of different samples merge into one.

use super::samples::Samples;
use crate::{
    film::{Film, accumulator::Accumulator, noise::Noise, sharing::Sharing},
    math::Spectrum,
    passes::{
        blocks::count_of,
        faults::Faults,
        pass::{Outcome, Pass},
    },
    render::image::{Image, Progress},
};
use std::time::Duration;

/// What a render knows.
#[derive(Clone, Debug)]
pub struct Sums {
    pub(in crate::render) accumulator: Accumulator,
    /// The samples that the accumulator holds.
    pub(in crate::render) samples: Samples,
    /// The unfinished pass.
    pub(in crate::render) pass: Pass,
    /// Its sample number.
    pub(in crate::render) sample: u64,
    /// Number of its finished blocks, which are the first ones.
    pub(in crate::render) blocks: usize,
    /// Time spent on all of it.
    pub(in crate::render) elapsed: Duration,
    /// The relative error of whole passes, if it is known.
    pub(in crate::render) noise: Option<Noise>,
    /// Number of passes that `noise` was estimated from.
    noted: u64,
    /// What went wrong on the way.
    pub(in crate::render) faults: Faults,
    width: usize,
    /// Pixels share the samples of a pass.
    is_shared: bool,
}

impl Sums {
    /// Nothing yet, for an image of `film` and so many `layers` that contributions are sorted into; with sums of
    /// products where layers of moments or variances need them.
    pub fn new(film: &Film, with_products: bool, layers: usize) -> Self {
        let accumulator =
            if with_products { Accumulator::with_products } else { Accumulator::new }(film.len());
        Self::of(accumulator.with_planes(1 + layers), Samples::default(), film.width as usize)
    }

    /// Whole passes of `samples`, of an image of `width` pixels across.
    pub(in crate::render) fn of(accumulator: Accumulator, samples: Samples, width: usize) -> Self {
        let (pass, noise, noted) = (
            Pass::new(accumulator.len_of_planes()),
            accumulator.noise(width, &|_| 0.0),
            accumulator.passes(),
        );
        Self {
            accumulator,
            samples,
            pass,
            sample: 0,
            blocks: 0,
            elapsed: Duration::ZERO,
            noise,
            noted,
            faults: Faults::default(),
            width,
            is_shared: false,
        }
    }

    /// The samples that every pixel has.
    pub fn samples(&self) -> &Samples {
        &self.samples
    }

    /// The fraction of the pixels that have one more.
    pub fn unfinished(&self) -> f64 {
        self.blocks as f64 / count_of(self.accumulator.len()) as f64
    }

    /// Pixels across and down.
    pub fn size(&self) -> (usize, usize) {
        (self.width, self.accumulator.len() / self.width)
    }

    /// Adds the whole passes of `other`, of the same image; the blocks of its unfinished pass are left out. False, and
    /// nothing is added, if they share samples.
    pub fn merge(&mut self, other: &Self) -> bool {
        let Some(samples) = self.samples.and(&other.samples) else { return false };
        self.samples = samples;
        self.accumulator.merge(&other.accumulator);
        self.note_noise(&|_| 0.0);
        self.faults.merge(&other.faults);
        self.elapsed += other.elapsed;
        true
    }

    /// Drops the blocks of an unfinished pass; returns their fraction of a pass.
    pub fn drop_unfinished(&mut self) -> f64 {
        let fraction = self.unfinished();
        self.pass.clear();
        self.blocks = 0;
        fraction
    }

    /// Goes on with `sample`; drops the unfinished blocks of another one.
    pub(in crate::render) fn start(&mut self, sample: u64) {
        if self.sample != sample {
            self.pass = Pass::new(self.accumulator.len_of_planes());
            (self.sample, self.blocks) = (sample, 0);
        }
    }

    /// Adds the next block of the pass of sample `sample`, of `count` blocks, whose pixels share samples by `sharing`.
    pub(in crate::render) fn add(
        &mut self,
        sample: u64,
        outcome: &Outcome,
        count: usize,
        sharing: Option<&Sharing<'_>>,
    ) {
        (self.sample, self.is_shared) = (sample, sharing.is_some());
        self.pass.add(outcome);
        self.faults.add(&outcome.faults);
        self.blocks += 1;
        if self.blocks == count {
            self.pass.finish(sharing, |pass| self.accumulator.add(sample, pass));
            self.samples.insert(sample);
            self.blocks = 0;
        }
    }

    /// The progress of the render that makes these sums, `elapsed` after it began.
    pub(in crate::render) fn progress(&self, elapsed: Duration, is_last: bool) -> Progress {
        let (passes, pixels) = (self.samples.count(), self.accumulator.len() as f64);
        let samples = ((passes as f64 + self.unfinished()) * pixels) as u64;
        Progress { samples, passes, elapsed, noise: self.noise, within: None, is_last }
    }

    /// Estimates the noise again if a pass was added since. `seen` (emitters in view) tells small lamps from rare
    /// samples; without it, the noise is too large where there are such lamps in view.
    pub(in crate::render) fn note_noise(&mut self, seen: &dyn Fn(usize) -> f64) {
        if self.noted != self.accumulator.passes() {
            (self.noise, self.noted) = (self.accumulator.noise(self.width, seen), self.accumulator.passes());
        }
    }

    /// The same, even if no pass was added: noise read from a file was estimated without a scene.
    pub(in crate::render) fn note_last_noise(&mut self, seen: &dyn Fn(usize) -> f64) {
        self.noted = u64::MAX;
        self.note_noise(seen);
    }

    /// The mean. In its finished blocks, the unfinished pass is weighted by its finished fraction: the fewer the
    /// blocks, the less certain the light that it found. No pixel is biased. Pixels without any sample take the mean of
    /// those around them. Where pixels share samples, a pass counts once it is whole; but before the first one is, each
    /// pixel shows what was found within it.
    pub fn pixels(&self) -> Vec<Spectrum> {
        self.plane(0)
    }

    /// The same of a plane: 0 is the image, those of layers follow.
    pub(in crate::render) fn plane(&self, plane: usize) -> Vec<Spectrum> {
        let (count, done) = (self.accumulator.len(), self.unfinished() as f32);
        if self.accumulator.passes() == 0 {
            return self.pass.plane(plane, count, self.width, done);
        }
        let (mut pixels, passes) = (self.accumulator.mean_of(plane), self.accumulator.passes() as f32);
        if self.is_shared {
            return pixels;
        }
        for (pixel, mean) in pixels.iter_mut().enumerate().filter(|(pixel, _)| self.pass.known()[*pixel]) {
            let both = *mean * passes + self.pass.estimate(plane * count + pixel, done) * done;
            *mean = both / (passes + done);
        }
        pixels
    }

    /// The image so far, without alpha and layers.
    pub(in crate::render) fn image(&self) -> Image {
        Image {
            pixels: self.pixels(),
            samples_per_pixel: self.samples.count(),
            unfinished: if self.is_shared && self.samples.count() > 0 { 0.0 } else { self.unfinished() },
            elapsed: self.elapsed,
            noise: self.noise,
            alpha: Vec::new(),
            layers: Vec::new(),
            reached: None,
            faults: self.faults.clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        film::{Window, filter::Filter, format::Format},
        passes::blocks::Blocks,
        sampling::Sampler,
    };

    /// A film of four blocks.
    fn film() -> Film {
        Film::new(Window::whole(64, 64), Filter::Box, false, Format::default())
    }

    fn blocks() -> Blocks {
        Blocks::new(64 * 64, 1, Sampler::Independent, 0.0).of_neighbours()
    }

    /// `block` with 1 for every pixel of its own, and half of it for every pixel by light.
    fn outcome(pass: u64, block: usize) -> Outcome {
        let own = blocks().pixels(pass as usize, block).map(|pixel| (pixel, 1.0)).collect::<Vec<_>>();
        Outcome::of(own.into_iter(), (0..64 * 64).map(|pixel| (pixel, 0.5)))
    }

    #[test]
    fn a_pass_may_end_after_any_block() {
        let (count, mut sums) = (blocks().count(), Sums::new(&film(), false, 0));
        for task in 0..3 * count {
            let sample = (task / count) as u64;
            sums.start(sample);
            sums.add(sample, &outcome(sample, task % count), count, None);
            let pixels = sums.pixels();
            // Whatever is done: 1 by its own samples, and by light a half for each of the blocks.
            let expected = 1.0 + 0.5 * count as f32;
            assert!(
                pixels.iter().all(|pixel| (pixel.x - expected).abs() < 1e-5),
                "after {task}: {}",
                pixels[0]
            );
        }
        assert_eq!((sums.samples().count(), sums.unfinished()), (3, 0.0));
    }

    #[test]
    fn a_file_holds_all_of_it() {
        let (film, folder) = (film(), tempfile::tempdir().unwrap());
        let path = folder.path().join("a.sums");
        for (products, tasks, layers) in [(false, 1, 0), (true, 4, 2), (true, 7, 1)] {
            let mut sums = Sums::new(&film, products, layers);
            for task in 0..tasks {
                let sample = (task / 4) as u64;
                sums.start(sample);
                sums.add(sample, &outcome(sample, task % 4), 4, None);
            }
            sums.note_noise(&|_| 0.0);
            sums.elapsed = Duration::from_secs(3);
            super::super::file::write(&path, &sums, &"made".into()).unwrap();
            let (read, made) = super::super::file::read(&path).unwrap();
            assert_eq!(format!("{read:?}"), format!("Samples({sums:?})"));
            assert_eq!(made, "made");
        }
    }
}
