//! A pass over the image, one sample of every pixel, block by block.

use super::{blocks::Blocks, faults::Fault, fill};
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
}

impl Pass {
    /// No block of it is done.
    pub fn new(pixels: usize) -> Self {
        Self { camera: vec![Spectrum::ZERO; pixels], light: vec![Spectrum::ZERO; pixels] }
    }

    /// Adds a block.
    pub fn add(&mut self, outcome: &Outcome) {
        outcome.camera.iter().for_each(|(pixel, value)| self.camera[*pixel as usize] += *value);
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

    /// A pass of these parts.
    pub fn of(camera: Vec<Spectrum>, light: Vec<Spectrum>) -> Self {
        Self { camera, light }
    }

    /// No block of it is done.
    pub fn clear(&mut self) {
        self.camera.fill(Spectrum::ZERO);
        self.light.fill(Spectrum::ZERO);
    }

    /// The estimate of `pixel`, whose block has been added. The added blocks are the fraction `done` of all; their
    /// light subpaths stand for those of the others.
    pub fn estimate(&self, pixel: usize, done: f32) -> Spectrum {
        self.camera[pixel] + self.light[pixel] / done
    }

    /// A plane (the image or a layer) from the first `done` of `blocks`; pixels of the others take the mean of those
    /// around them.
    pub fn pixels(&self, blocks: &Blocks, done: usize, width: usize, plane: usize) -> Vec<Spectrum> {
        let first = plane * blocks.pixel_count();
        let mut known = vec![false; blocks.pixel_count()];
        let mut pixels = vec![Spectrum::ZERO; known.len()];
        for pixel in (0..done).flat_map(|block| blocks.pixels(block)) {
            pixels[pixel] = self.estimate(first + pixel, done as f32 / blocks.count() as f32);
            known[pixel] = true;
        }
        fill::fill(&mut pixels, &known, width);
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
