//! Progressive pictures (P03T ch. 6): only the most informative pixels, by conductance maps and the pixels shaded so
//! far, are shaded; the others are interpolated. This is a biased preview for any estimator that shades pixel by pixel.
//! Connections of light subpaths to the lens are left out, for they hit any pixel.
//!
//! Pixels are chosen in batches, each by the results of the batches before: the picture does not depend on threads.

mod conductance;
mod mesh;
mod queue;
mod regions;
mod sight;
#[cfg(test)]
mod tests;

use super::{
    fog::Preview,
    image::{Image, Progress},
    instrument::Instrument,
    known::{Known, late},
    primary,
    subject::Stage,
    sums::Picture,
};
use crate::{
    error::Result,
    film::{Channel, Film, accumulator::Accumulator, layer::Layer},
    math::{DVec3, Spectrum, vec2},
    passes::{Settings, blocks::Blocks, faults::Faults, pass::Outcome},
    scene::Scene,
    settings::integrator::FogSettings,
};
use conductance::Maps;
use mesh::{Edge, Mesh};
use queue::{Queue, division};
use rayon::prelude::*;
use regions::Outlines;
use sight::Sight;
pub use sight::optical_depths;
use std::{
    collections::HashSet,
    time::{Duration, Instant},
};

/// How the first triangles are made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Between the corners of the image (P03T sec. 6.4).
    Straight,
    /// Along the outlines of regions that look alike, too (P03T sec. 6.5).
    Regions,
}

impl Method {
    /// Each as typed.
    pub const NAMES: [(&'static str, Self); 2] = [("straight", Self::Straight), ("regions", Self::Regions)];

    /// As typed.
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize].0
    }
}

/// A progressive picture to make.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progressive {
    /// Where it begins.
    pub method: Method,
    /// The part of the pixels to shade, in (0, 1].
    pub fraction: f64,
}

impl Progressive {
    /// Pixels to shade of an image of so many: its corners at least.
    pub fn pixels(&self, of: usize) -> usize {
        ((self.fraction * of as f64).round() as usize).clamp(of.min(4), of)
    }
}

/// Statistics of a finished picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shaded {
    /// By which method.
    pub method: Method,
    /// Pixels shaded.
    pub pixels: usize,
    /// Pixels of the image.
    pub of: usize,
    /// Time spent on feature maps.
    pub maps: Duration,
    /// Time spent on pixels.
    pub shading: Duration,
}

/// Least pixels of a batch, if there are enough edges; later batches have this part of the pixels shaded by then; and
/// most pixels of a batch.
const BATCH: usize = 64;
const BATCH_PART: usize = 16;
const LARGEST_BATCH: usize = 1024;
/// Pixels that share light subpaths; there are as many light subpaths.
const GROUP: usize = 16;

/// Makes a progressive picture of `scene` on `film`, whose sides are two pixels or longer, with exact alpha and
/// `layers` of surfaces. Each shaded pixel takes the number of samples in the budget of `settings`, which must have
/// one; pixels for which the time is too short are interpolated. With `fog`, pixels are shaded by that preview.
pub fn run(
    scene: &Scene,
    film: &Film,
    settings: &Settings,
    fog: Option<&FogSettings>,
    layers: &[Layer],
    wanted: Progressive,
    watch: &mut dyn FnMut(Progress, &dyn Picture),
) -> Result<(Image, Shaded)> {
    let started = Instant::now();
    // Not every pixel has samples.
    let settings = &Settings { film_samples: settings.film_samples.unshared(), ..*settings };
    let stage = Stage::still(Instrument::of_blocks(GROUP, scene, film, settings));
    let instrument = &stage.instrument;
    let fog = fog.map(|fog| Preview::of(&*instrument.compiled, fog, settings));
    let mut painter = Painter::new(instrument, fog, wanted, started);
    painter.paint(watch);
    let image = painter.image();
    let seen = primary::Pass::new(film, layers).run(&stage, painter.samples, late(settings, started))?;
    let known = Known { pixels: &image.pixels, passes: &Accumulator::new(0), seen: &seen };
    let mut layers = known.channels(layers, |_| Vec::new());
    layers.push(painter.counts());
    Ok((Image { alpha: seen.alpha, layers, ..image }, painter.shaded()))
}

/// A picture in the making.
struct Painter<'a, 's> {
    instrument: &'a Instrument<'s>,
    fog: Option<Preview<'a>>,
    method: Method,
    /// Pixels to shade.
    goal: usize,
    /// Samples of each of them.
    samples: u64,
    started: Instant,
    maps: Maps,
    maps_time: Duration,
    shading_time: Duration,
    mesh: Mesh,
    queue: Queue,
    outlines: Outlines,
    /// Corners of outlines that have had their turn.
    corners: usize,
    /// Groups of pixels shaded so far.
    groups: usize,
    faults: Faults,
}

/// Pixels to shade together, each with a shaded pixel near it; and the edges that they divide.
#[derive(Default)]
struct Batch {
    pixels: Vec<(usize, Option<usize>)>,
    chosen: HashSet<usize>,
    edges: Vec<Edge>,
}

impl Batch {
    fn push(&mut self, pixel: usize, near: Option<usize>) {
        if self.chosen.insert(pixel) {
            self.pixels.push((pixel, near));
        }
    }
}

impl<'a, 's> Painter<'a, 's> {
    fn new(
        instrument: &'a Instrument<'s>,
        fog: Option<Preview<'a>>,
        wanted: Progressive,
        started: Instant,
    ) -> Self {
        let Instrument { film, settings, .. } = instrument;
        let (pixels, width) = (film.len(), film.width as usize);
        let looked = Instant::now();
        let maps = look(instrument);
        let outlines = match wanted.method {
            Method::Straight => Outlines::default(),
            Method::Regions => Outlines::of(&maps),
        };
        Self {
            instrument,
            fog,
            method: wanted.method,
            goal: wanted.pixels(pixels),
            samples: settings.budget.samples_per_pixel.unwrap_or(1),
            started,
            maps,
            maps_time: looked.elapsed(),
            shading_time: Duration::ZERO,
            mesh: Mesh::new(width, pixels),
            queue: Queue::new(),
            outlines,
            corners: 0,
            groups: 0,
            faults: Faults::default(),
        }
    }

    /// Shades batches until enough pixels are shaded or the budget is spent.
    fn paint(&mut self, watch: &mut dyn FnMut(Progress, &dyn Picture)) {
        let corners = self.image_corners();
        self.advance(corners);
        loop {
            let elapsed = self.started.elapsed();
            let is_last = self.mesh.len() >= self.goal || self.instrument.settings.budget.is_over(elapsed);
            let samples = self.mesh.len() as u64 * self.samples;
            let progress =
                Progress { samples, passes: self.samples, elapsed, noise: None, within: None, is_last };
            watch(progress, self);
            if is_last {
                return;
            }
            let batch = self.choose();
            self.advance(batch);
        }
    }

    fn image_corners(&self) -> Batch {
        let (width, pixels) = (self.maps.width(), self.maps.len());
        let mut batch = Batch::default();
        [0, width - 1, pixels - width, pixels - 1].into_iter().for_each(|pixel| batch.push(pixel, None));
        batch
    }

    /// The next batch: while there are corners of outlines, half of it (P03T sec. 6.5), and the worst edges. Once no edge can
    /// be divided, any pixels.
    fn choose(&mut self) -> Batch {
        let shaded = self.mesh.len();
        let size = (shaded / BATCH_PART).clamp(BATCH, LARGEST_BATCH).min(self.goal - shaded);
        let mut batch = Batch::default();
        while batch.pixels.len() < size.div_ceil(2) && self.corners < self.outlines.corners.len() {
            let corner = self.outlines.corners[self.corners];
            if self.mesh.at(corner).is_none() {
                batch.push(corner, None);
            }
            self.corners += 1;
        }
        while batch.pixels.len() < size {
            let Some(edge) = self.queue.pop(&self.mesh) else { break };
            let taken = |pixel| self.mesh.at(pixel).is_some() || batch.chosen.contains(&pixel);
            if let Some(pixel) = division(&self.maps, edge, taken) {
                batch.push(pixel, Some(edge[0] as usize));
                batch.edges.push(edge);
            }
        }
        if batch.pixels.is_empty() {
            let blocks: &Blocks = self.instrument.compiled.blocks();
            let all = (0..blocks.count()).flat_map(|block| blocks.pixels(0, block));
            all.filter(|pixel| self.mesh.at(*pixel).is_none())
                .take(size)
                .for_each(|pixel| batch.push(pixel, None));
        }
        batch
    }

    /// Shades a batch and makes its triangles.
    fn advance(&mut self, batch: Batch) {
        let started = Instant::now();
        let pixels: Vec<u32> = batch.pixels.iter().map(|(pixel, _)| *pixel as u32).collect();
        let radiances = self.shade(&pixels);
        self.shading_time += started.elapsed();
        for ((pixel, near), radiance) in batch.pixels.iter().zip(radiances) {
            self.mesh.insert(*pixel, radiance, *near);
        }
        let changed = self.constrain();
        let Self { mesh, maps, queue, .. } = self;
        let around = batch.pixels.iter().map(|(pixel, _)| *pixel).chain(changed);
        let around: Vec<Edge> = around.flat_map(|pixel| mesh.edges_at(pixel)).collect();
        let left = batch.edges.into_iter().filter(|edge| mesh.has(*edge));
        queue.add(mesh, maps, around.into_iter().chain(left));
    }

    /// Makes edges of the pieces of outlines whose ends are shaded by now. Returns the pixels whose edges may have
    /// changed.
    fn constrain(&mut self) -> Vec<usize> {
        let Self { mesh, outlines, .. } = self;
        let is_shaded = |pixel: u32| mesh.at(pixel as usize).is_some();
        let (ready, open) = outlines.pieces.iter().partition(|[a, b]| is_shaded(*a) && is_shaded(*b));
        outlines.pieces = open;
        let ready: Vec<Edge> = ready;
        ready.into_iter().flat_map(|piece| mesh.constrain(piece)).collect()
    }

    /// The means of the samples of these pixels.
    fn shade(&mut self, pixels: &[u32]) -> Vec<Spectrum> {
        let groups: Vec<&[u32]> = pixels.chunks(GROUP).collect();
        let samples = self.samples as usize;
        let (instrument, first) = (self.instrument, self.groups);
        let tasks = (0..groups.len() * samples).into_par_iter();
        let outcomes: Vec<Outcome> = tasks
            .map(|task| {
                let (group, pass) = (task / samples, task % samples);
                match &self.fog {
                    None => instrument.compiled.shade(pass, first + group, groups[group]),
                    Some(fog) => fog.show(
                        &*instrument.compiled,
                        pass,
                        groups[group].iter().map(|pixel| *pixel as usize),
                    ),
                }
            })
            .collect();
        self.groups += groups.len();
        let mut sums = vec![DVec3::ZERO; pixels.len()];
        for (task, outcome) in outcomes.iter().enumerate() {
            self.faults.add(&outcome.faults);
            let group = task / samples;
            for (pixel, value) in outcome.camera() {
                let number = groups[group].iter().position(|other| other == pixel).unwrap_or(0);
                sums[group * GROUP + number] += value.as_dvec3();
            }
        }
        sums.into_iter().map(|sum| (sum / samples as f64).as_vec3()).collect()
    }

    /// How many samples each pixel took.
    fn counts(&self) -> Channel {
        let count = |pixel| if self.mesh.at(pixel).is_some() { self.samples as f32 } else { 0.0 };
        Channel { name: "samples.N".to_owned(), values: (0..self.maps.len()).map(count).collect() }
    }

    fn shaded(&self) -> Shaded {
        Shaded {
            method: self.method,
            pixels: self.mesh.len(),
            of: self.maps.len(),
            maps: self.maps_time,
            shading: self.shading_time,
        }
    }
}

impl Picture for Painter<'_, '_> {
    fn image(&self) -> Image {
        Image {
            pixels: self.mesh.paint(&self.maps),
            samples_per_pixel: self.samples,
            unfinished: 0.0,
            elapsed: self.started.elapsed(),
            noise: None,
            alpha: Vec::new(),
            layers: Vec::new(),
            reached: None,
            faults: self.faults.clone(),
        }
    }

    fn size(&self) -> (usize, usize) {
        (self.maps.width(), self.maps.len() / self.maps.width())
    }
}

/// The conductance maps of what `instrument` renders: one ray a pixel.
fn look(instrument: &Instrument<'_>) -> Maps {
    let Instrument { scene, film, settings, .. } = instrument;
    let width = film.width as usize;
    let middle = |pixel: usize| vec2((pixel % width) as f32 + 0.5, (pixel / width) as f32 + 0.5);
    let sights = (0..film.len()).into_par_iter();
    let sights = sights.map(|pixel| Sight::of(scene, middle(pixel), settings.options.hide_emitters));
    Maps::new(width, sights.collect())
}
