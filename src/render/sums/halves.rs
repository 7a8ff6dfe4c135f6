//! What a render to a precision knows: two halves of independent passes.

use super::half::{Half, Limits, luminance};
use crate::{
    film::{Film, noise::Noise},
    math::{DVec3, Spectrum},
    passes::{
        blocks::count_of,
        faults::Faults,
        pass::{Outcome, Pass},
    },
    render::image::{Image, Precision, Progress, Reached},
};
use std::time::Duration;

/// Passes of a half before it is first examined: variances of fewer are too uncertain.
pub(in crate::render) const FIRST_LOOK: u64 = 16;
/// Least samples of the whole image in a half before then: pixels with few neighbours cannot see by these that they
/// lack rare light.
const FIRST_SAMPLES: u64 = 1024;

/// The state of a render to a precision: two halves of whole passes, and the finished blocks of one more. A render
/// resumes from it as if it had never stopped.
#[derive(Clone, Debug)]
pub struct Halves {
    pub(in crate::render) precision: Precision,
    pub(in crate::render) halves: [Half; 2],
    /// Passes of each half up to the next check.
    pub(in crate::render) goal: u64,
    /// Passes that a pixel has been active in.
    pub(in crate::render) samples: Vec<u32>,
    /// The unfinished pass.
    pub(in crate::render) pass: Pass,
    /// Number of its finished blocks, which are the first ones.
    pub(in crate::render) blocks: usize,
    /// Time spent on all of it.
    pub(in crate::render) elapsed: Duration,
    /// What went wrong on the way.
    pub(in crate::render) faults: Faults,
    pub(in crate::render) width: usize,
    /// Pixels that need more samples.
    pub(in crate::render) active: Vec<bool>,
}

impl Halves {
    /// Nothing done yet, for an image of `film` with this precision, and for so many `layers` that contributions are
    /// sorted into.
    pub fn new(film: &Film, precision: Precision, layers: usize) -> Self {
        Self::of(
            [0; 2].map(|_| Half::new(film.len(), 1 + layers)),
            precision,
            FIRST_LOOK.max(FIRST_SAMPLES.div_ceil(film.len().max(1) as u64)),
            film.width as usize,
        )
    }

    /// Whole passes, of an image of `width` pixels across.
    pub(in crate::render) fn of(halves: [Half; 2], precision: Precision, goal: u64, width: usize) -> Self {
        let active = active(&halves);
        let (pixels, pass) = (active.len(), Pass::new(halves[0].camera.len()));
        Self {
            precision,
            halves,
            goal,
            samples: vec![0; pixels],
            pass,
            blocks: 0,
            elapsed: Duration::ZERO,
            faults: Faults::default(),
            width,
            active,
        }
    }

    /// Passes over the image, both halves together.
    pub fn passes(&self) -> u64 {
        self.halves.iter().map(|half| half.passes).sum()
    }

    /// The fraction of the pixels that have converged.
    pub fn share(&self) -> f64 {
        self.active.iter().filter(|active| !**active).count() as f64 / self.active.len() as f64
    }

    /// Pixels across and down.
    pub fn size(&self) -> (usize, usize) {
        (self.width, self.active.len() / self.width)
    }

    /// The fraction of the blocks that have one more pass.
    fn unfinished(&self) -> f64 {
        self.blocks as f64 / count_of(self.active.len()) as f64
    }

    /// Adds the next of `count` blocks of a pass.
    pub(in crate::render) fn add(&mut self, outcome: &Outcome, count: usize) {
        self.pass.add(outcome);
        self.faults.add(&outcome.faults);
        self.blocks += 1;
        if self.blocks == count {
            self.take();
        }
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

    /// Ends the means of pixels that have converged.
    pub(in crate::render) fn look(&mut self) {
        let [first, second] = self.halves.each_ref().map(|half| half.passes);
        // The halves are unequal if the budget ended between them; then this check is the last one.
        let passes = first.min(second);
        if passes < 2 {
            return;
        }
        let limits = Limits::after(passes, self.precision);
        self.halves.iter_mut().for_each(|half| half.judge(&self.active, self.width, &limits));
        let [first, second] = &mut self.halves;
        first.end(second);
        second.end(first);
        self.active = active(&self.halves);
    }

    pub(in crate::render) fn progress(&self, elapsed: Duration, is_last: bool) -> Progress {
        let (passes, pixels) = (self.passes(), self.active.len() as f64);
        let samples = ((passes as f64 + self.unfinished()) * pixels) as u64;
        Progress { samples, passes, elapsed, noise: None, within: Some(self.share()), is_last }
    }

    /// The mean of the halves, or the unfinished first pass, in a plane: 0 is the image, those of layers follow.
    pub(in crate::render) fn plane(&self, plane: usize) -> Vec<Spectrum> {
        if self.passes() == 0 {
            return self.pass.plane(plane, self.active.len(), self.width, self.unfinished() as f32);
        }
        let halves: Vec<&Half> = self.halves.iter().filter(|half| half.passes > 0).collect();
        let value = |pixel| halves.iter().map(|half| half.value(pixel)).sum::<DVec3>() / halves.len() as f64;
        let first = plane * self.active.len();
        (0..self.active.len()).map(|pixel| value(first + pixel).as_vec3()).collect()
    }

    /// The relative error of the mean, if both halves have passes; `seen` tells what pixels see of emitters.
    pub(in crate::render) fn noise(&self, seen: &dyn Fn(usize) -> f64) -> Option<Noise> {
        if self.halves.iter().any(|half| half.passes == 0) {
            return None;
        }
        let [a, b] = &self.halves;
        let both = |pixel| (luminance(a.value(pixel)), luminance(b.value(pixel)));
        Noise::of_halves(self.width, &(0..self.active.len()).map(both).collect::<Vec<_>>(), seen)
    }

    /// The image so far, without alpha and layers.
    pub(in crate::render) fn image(&self) -> Image {
        let samples = match self.passes() {
            0 => self.unfinished(),
            _ => self.samples.iter().map(|n| f64::from(*n)).sum::<f64>() / self.samples.len() as f64,
        };
        Image {
            pixels: self.plane(0),
            samples_per_pixel: samples as u64,
            unfinished: samples.fract(),
            elapsed: self.elapsed,
            noise: self.noise(&|_| 0.0),
            alpha: Vec::new(),
            layers: Vec::new(),
            reached: Some(Reached { share: self.share(), samples: self.samples.clone() }),
            faults: self.faults.clone(),
        }
    }
}

/// A pixel is active until both of its means have ended.
fn active([first, second]: &[Half; 2]) -> Vec<bool> {
    let ended = first.ended.iter().zip(&second.ended).take(first.content.len());
    ended.map(|(first, second)| first.is_none() || second.is_none()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        film::{Window, filter::Filter, format::Format},
        passes::blocks::Blocks,
        render::sums::{AnySums, file},
        sampling::Sampler,
    };

    /// A film of four blocks, after some of them and a check after 32 passes; the lower half of it is `noisy`.
    fn halves(blocks: usize, noisy: bool) -> Halves {
        let film = Film::new(Window::whole(64, 64), Filter::Box, false, Format::default());
        let mut halves = Halves::new(&film, Precision { error: 0.5, confidence: 0.9 }, 1);
        let division = Blocks::new(film.len(), 1, Sampler::Independent, 0.0).of_neighbours();
        for block in 0..blocks {
            let pass = block / 4;
            let rare = if pass % 16 == 0 { 50.0 } else { 0.0 };
            let value = |pixel| if noisy && pixel >= 2048 { rare } else { (1 + pass % 2) as f32 };
            let camera =
                division.pixels(pass, block % 4).map(|pixel| (pixel, value(pixel))).collect::<Vec<_>>();
            halves.add(&Outcome::of(camera.into_iter(), [(pass % 5, 0.1)].into_iter()), 4);
            if block + 1 == 32 * 4 {
                halves.look();
            }
        }
        halves
    }

    #[test]
    fn a_file_holds_all_of_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.sums");
        for (blocks, noisy, done) in [(1, true, 0.0), (7, true, 0.0), (162, true, 0.5), (130, false, 1.0)] {
            let mut halves = halves(blocks, noisy);
            (halves.elapsed, halves.goal) = (Duration::from_secs(3), 20);
            assert!((halves.share() - done).abs() < 0.02, "{blocks}: {}", halves.share());
            file::write(&path, &halves, &"made".into()).unwrap();
            let (read, made) = file::read(&path).unwrap();
            assert_eq!(format!("{read:?}"), format!("{:?}", AnySums::Adaptive(halves)));
            assert_eq!(made, "made");
        }
    }
}
