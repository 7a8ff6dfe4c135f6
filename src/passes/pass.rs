//! A pass over the image, one sample of every pixel, block by block.

use super::{faults::Fault, fill};
use crate::{film::sharing::Sharing, math::Spectrum};

/// What a block adds to its pass.
#[derive(Default)]
pub struct Outcome {
    camera: Vec<(u32, Spectrum)>,
    light: Vec<(u32, Spectrum)>,
    /// What went wrong.
    pub faults: Vec<Fault>,
}

impl Outcome {
    /// What camera subpaths contributed to pixels.
    pub fn camera(&self) -> &[(u32, Spectrum)] {
        &self.camera
    }

    /// What camera and light subpaths contributed to pixels of any plane, and what went wrong.
    pub fn of_parts(camera: Vec<(u32, Spectrum)>, light: Vec<(u32, Spectrum)>, faults: Vec<Fault>) -> Self {
        Self { camera, light, faults }
    }

    /// Only faults.
    pub fn of_faults(faults: Vec<Fault>) -> Self {
        Self { faults, ..Self::default() }
    }
}

/// A pass over the image, and layers of it, block by block.
#[derive(Clone, Debug)]
pub struct Pass {
    camera: Vec<Spectrum>,
    light: Vec<Spectrum>,
    /// Pixels, and pixels of layers, that camera subpaths have been traced through.
    known: Vec<bool>,
}

impl Pass {
    /// No block of it is done.
    pub fn new(pixels: usize) -> Self {
        let nothing = || vec![Spectrum::ZERO; pixels];
        Self { camera: nothing(), light: nothing(), known: vec![false; pixels] }
    }

    /// Adds a block.
    pub fn add(&mut self, outcome: &Outcome) {
        for (pixel, value) in &outcome.camera {
            self.camera[*pixel as usize] += *value;
            self.known[*pixel as usize] = true;
        }
        outcome.light.iter().for_each(|(pixel, value)| self.light[*pixel as usize] += *value);
    }

    /// Shows the pass, all of whose blocks have been added, to `see`, and starts the next one. Camera samples are shared
    /// by pixels as `sharing` says.
    pub fn finish(&mut self, sharing: Option<&Sharing<'_>>, see: impl FnOnce(&[Spectrum])) {
        if let Some(sharing) = sharing {
            sharing.share(&mut self.camera);
        }
        self.camera.iter_mut().zip(&self.light).for_each(|(camera, light)| *camera += *light);
        see(&self.camera);
        self.clear();
    }

    /// What camera and light subpaths contributed to every pixel.
    pub fn parts(&self) -> (&[Spectrum], &[Spectrum]) {
        (&self.camera, &self.light)
    }

    /// Which pixels, and pixels of layers, camera subpaths have been traced through.
    pub fn known(&self) -> &[bool] {
        &self.known
    }

    /// A pass of these parts, equally long.
    pub fn of(camera: Vec<Spectrum>, light: Vec<Spectrum>, known: Vec<bool>) -> Self {
        Self { camera, light, known }
    }

    /// No block of it is done.
    pub fn clear(&mut self) {
        self.camera.fill(Spectrum::ZERO);
        self.light.fill(Spectrum::ZERO);
        self.known.fill(false);
    }

    /// The estimate of `pixel`, whose block has been added. The added blocks are the fraction `done` of all; their
    /// light subpaths stand for those of the others.
    pub fn estimate(&self, pixel: usize, done: f32) -> Spectrum {
        self.camera[pixel] + self.light[pixel] / done
    }

    /// A plane (the image or a layer) of so many pixels, of `width` across, from the fraction `done` of all blocks; pixels
    /// of the others take the mean of those around them.
    pub fn plane(&self, plane: usize, count: usize, width: usize, done: f32) -> Vec<Spectrum> {
        let (first, known) = (plane * count, &self.known[..count]);
        let value =
            |pixel: usize| if known[pixel] { self.estimate(first + pixel, done) } else { Spectrum::ZERO };
        let mut pixels: Vec<_> = (0..count).map(value).collect();
        fill::fill(&mut pixels, known, width);
        pixels
    }
}

#[cfg(test)]
impl Outcome {
    /// Grey contributions to pixels by camera subpaths and by light subpaths.
    pub fn of(camera: impl Iterator<Item = (usize, f32)>, light: impl Iterator<Item = (usize, f32)>) -> Self {
        let grey = |(pixel, value): (usize, f32)| (pixel as u32, Spectrum::splat(value));
        Self { camera: camera.map(grey).collect(), light: light.map(grey).collect(), faults: Vec::new() }
    }

    /// How many pixels have one.
    pub fn pixels(&self) -> usize {
        self.camera.len()
    }
}
