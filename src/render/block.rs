//! A block: a fixed set of pixels scattered over the image, rendered together with a light cache of their own.

use super::{
    compiled::Ready,
    faults::{Cause, Fault},
    fill,
    fog::{PILOT_RAYS, Preview},
    pixel_sample,
};
use crate::{
    film::Film,
    math::{Channels, Spectrum, Vec2},
    sampling::{Sampler, Stream, stream::Purpose},
    scene::Scene,
    shape::Ray,
    transport::{
        Contribution, Estimator, LightCache, MisSums,
        observer::{Meeting, Observer, Sum},
        profile::Profile,
    },
};
use std::{cell::Cell, ops::Range};

/// Pixels (and light subpaths) of a block: a cache of this many walks still fits the processor's caches, and
/// its noise is shared by few enough pixels.
pub const PIXELS_PER_BLOCK: usize = 1024;

/// How an image's pixels are divided among blocks.
pub struct Blocks {
    pixels: usize,
    count: usize,
    /// Coprime to `pixels`: the pixels of a block lie this far apart, so that what they have in common (their
    /// light cache) shows nowhere as a pattern.
    stride: usize,
    walks_per_block: u64,
    heroes: u64,
    sampler: Sampler,
    /// The inverse of `stride` modulo `pixels`, where every pixel has a light subpath for itself.
    inverse: Option<usize>,
}

/// How a camera subpath starts.
pub struct CameraStart {
    /// Its random numbers.
    pub stream: Stream,
    /// The channel that samples distances.
    pub hero: usize,
    /// Where on the film [pixels].
    pub position: Vec2,
    /// Through which point of the aperture [m].
    pub aperture: Vec2,
    /// What it counts for.
    pub weight: f32,
    /// Which light subpath of its block it has for itself, where each has one.
    pub walk: usize,
}

/// The camera subpath of a pixel, and the block whose light subpaths it is connected to.
struct Sight {
    pixel: usize,
    block: usize,
    start: CameraStart,
}

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

    /// Nothing but what went wrong.
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

    /// Shows the pass, all of whose blocks have been added, to `see`, and starts the next one.
    pub fn finish(&mut self, see: impl FnOnce(&[Spectrum])) {
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

    /// What a pass says of `pixel`, whose block is among those added; they are the fraction `done` of all: the
    /// light subpaths that have been traced stand for those that have not.
    pub fn estimate(&self, pixel: usize, done: f32) -> Spectrum {
        self.camera[pixel] + self.light[pixel] / done
    }

    /// A plane, the image or a layer, as the first `done` of `blocks` show it; pixels of the others take the mean of those
    /// around them.
    pub fn pixels(&self, blocks: &Blocks, done: usize, width: usize, plane: usize) -> Vec<Spectrum> {
        let first = plane * blocks.pixels;
        let mut known = vec![false; blocks.pixels];
        let mut pixels = vec![Spectrum::ZERO; known.len()];
        for pixel in (0..done).flat_map(|block| blocks.pixels(block)) {
            pixels[pixel] = self.estimate(first + pixel, done as f32 / blocks.count() as f32);
            known[pixel] = true;
        }
        fill::fill(&mut pixels, &known, width);
        pixels
    }
}

/// Blocks that so many camera `subpaths` are, at least.
pub fn blocks_for(pixels: usize, subpaths: usize) -> usize {
    (subpaths * pixels.div_ceil(PIXELS_PER_BLOCK)).div_ceil(pixels.max(1))
}

impl Blocks {
    /// Divides `pixels`, each of which has `light_walks` light subpaths in a pass, for estimators of so many hero channels,
    /// whose walks draw from streams of `sampler`.
    pub fn new(pixels: usize, heroes: usize, sampler: Sampler, light_walks: f32) -> Self {
        Self::of_size(PIXELS_PER_BLOCK, pixels, heroes, sampler, light_walks)
    }

    /// The same with blocks of so many pixels.
    pub fn of_size(size: usize, pixels: usize, heroes: usize, sampler: Sampler, light_walks: f32) -> Self {
        let count = pixels.div_ceil(size).max(1);
        let golden = (pixels as f64 * 0.618_033_988_75) as usize;
        let stride = (golden.max(1)..).find(|s| gcd(*s, pixels) == 1).unwrap_or(1);
        let heroes = heroes as u64;
        let walks = (pixels.div_ceil(count) as f64 * f64::from(light_walks)).ceil() as u64;
        let walks_per_block = walks.div_ceil(heroes) * heroes;
        Self { pixels, count, stride, walks_per_block, heroes, sampler, inverse: None }
    }

    /// The same where every pixel has one of the light subpaths for itself, of which there are as many: both have the same
    /// hero channel, and a light subpath's random numbers are spread evenly over the samples of its pixel.
    pub fn paired(self) -> Self {
        Self { inverse: Some(inverse(self.stride, self.pixels)), ..self }
    }

    /// Number of blocks.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Light subpaths of one block, a multiple of the number of hero channels.
    pub fn walks_per_block(&self) -> u64 {
        self.walks_per_block
    }

    /// Light subpaths of one pass.
    pub fn walks_per_pass(&self) -> u64 {
        self.walks_per_block * self.count as u64
    }

    /// The pixels of `block`.
    pub fn pixels(&self, block: usize) -> impl Iterator<Item = usize> + '_ {
        self.places(block).map(|place| self.pixel_at(place))
    }

    /// Places of the pixels of `block` in the order of all pixels.
    fn places(&self, block: usize) -> Range<usize> {
        block * self.pixels / self.count..(block + 1) * self.pixels / self.count
    }

    fn pixel_at(&self, place: usize) -> usize {
        (place as u128 * self.stride as u128 % self.pixels as u128) as usize
    }

    /// Which of its block's light subpaths `pixel` has for itself; 0 where none has.
    fn walk_of(&self, pixel: usize) -> usize {
        self.home(pixel).map_or(0, |(_, number)| number)
    }

    /// The block of `pixel` and its number there, where that is the number of its light subpath too.
    fn home(&self, pixel: usize) -> Option<(usize, usize)> {
        let place = (pixel as u128 * self.inverse? as u128 % self.pixels as u128) as usize;
        // The last block that begins there or before.
        let block = ((place + 1) * self.count - 1) / self.pixels;
        Some((block, place - self.places(block).start))
    }

    /// Where the camera subpath of `pixel` in `pass` starts.
    #[inline]
    pub fn camera_start(
        &self,
        scene: &Scene,
        film: &Film,
        seed: u64,
        pass: usize,
        pixel: usize,
    ) -> CameraStart {
        let (mut stream, hero) = self.camera_stream(seed, pass, pixel);
        let (position, weight) = film.sample(pixel, &mut stream);
        let aperture = scene.sensor.sample_aperture(&mut stream);
        CameraStart { stream, hero, position, aperture, weight, walk: self.walk_of(pixel) }
    }

    /// The random numbers of the camera subpath of `pixel` in `pass`, and its hero channel.
    #[inline]
    fn camera_stream(&self, seed: u64, pass: usize, pixel: usize) -> (Stream, usize) {
        let mut stream = self.sampler.stream(seed, pixel as u64, pass as u64, 0, 1, Purpose::Camera);
        let hero = if self.heroes > 1 { stream.below(self.heroes as usize) } else { 0 };
        (stream, hero)
    }

    /// The random numbers of light subpath `walk` of a pass. All walks of a block contribute to the same
    /// pixels: a sampler that distributes them evenly distributes all of them together, pass after pass; unless each belongs to
    /// a pixel.
    #[inline]
    pub fn light_stream(&self, seed: u64, pass: usize, walk: u64) -> Stream {
        if self.inverse.is_some() {
            return self.sampler.stream(seed, walk, pass as u64, 0, 1, Purpose::Light);
        }
        let per_block = self.walks_per_block;
        self.sampler.stream(seed, walk / per_block, pass as u64, walk % per_block, per_block, Purpose::Light)
    }

    /// Renders one sample of every pixel of `block` that `wants` one, and says which pixel it is `at`.
    pub fn render<P: Profile>(
        &self,
        ready: &Ready<'_, P>,
        pass: usize,
        block: usize,
        wants: &dyn Fn(usize) -> bool,
        at: &Cell<Option<u32>>,
    ) -> Outcome {
        let Ready { scene, film, seed, .. } = ready;
        let mut starts = self.pixels(block).filter(|pixel| wants(*pixel)).map(|pixel| {
            at.set(Some(pixel as u32));
            Sight { pixel, block, start: self.camera_start(scene, film, *seed, pass, pixel) }
        });
        self.sample(ready, pass, &mut self.light_paths(block), &mut starts)
    }

    /// Renders one sample of each of `pixels`, connected to the light subpaths of a block of that number, which need not
    /// be theirs; where every pixel has one for itself, to that.
    pub fn shade<P: Profile>(
        &self,
        ready: &Ready<'_, P>,
        pass: usize,
        block: usize,
        pixels: &[u32],
        at: &Cell<Option<u32>>,
    ) -> Outcome {
        let Ready { scene, film, seed, .. } = ready;
        let mut starts = pixels.iter().enumerate().map(|(walk, pixel)| {
            at.set(Some(*pixel));
            let pixel = *pixel as usize;
            let start = CameraStart { walk, ..self.camera_start(scene, film, *seed, pass, pixel) };
            Sight { pixel, block: self.home(pixel).map_or(block, |(own, _)| own), start }
        });
        let own = |(home, number): (usize, usize)| self.light_paths(home).start + number as u64;
        match self.inverse {
            None => self.sample(ready, pass, &mut self.light_paths(block), &mut starts),
            Some(_) => {
                let homes = pixels.iter().filter_map(|pixel| self.home(*pixel as usize));
                self.sample(ready, pass, &mut homes.map(own), &mut starts)
            }
        }
    }

    /// Renders samples that are connected to light subpaths of these numbers.
    fn sample<P: Profile>(
        &self,
        ready: &Ready<'_, P>,
        pass: usize,
        walks: &mut dyn Iterator<Item = u64>,
        starts: &mut dyn Iterator<Item = Sight>,
    ) -> Outcome {
        let Ready { estimator, film, seed, .. } = ready;
        let mut light = Splatted { film, values: Vec::new(), sample: pass as u64, faults: Vec::new() };
        let cache = self.trace_walks(estimator, *seed, pass, walks, &mut light);
        let mut faults = light.faults;
        let camera = starts.map(|Sight { pixel, block, start }| {
            let (weight, mut sum) = (start.weight, start.trace(estimator, &cache, Sum::default()));
            if !sum.radiance.is_finite() {
                sum.radiance = finite_part(ready, pass, block, pixel, &mut faults);
            }
            (pixel as u32, sum.radiance * weight)
        });
        Outcome { camera: camera.collect(), light: light.values, faults }
    }

    /// Traces the light subpaths of `block`, which `observer` sees; their cache.
    #[inline]
    pub fn trace_light<P: Profile>(
        &self,
        estimator: &Estimator<'_, P>,
        seed: u64,
        pass: usize,
        block: usize,
        observer: &mut impl Observer<P::MisSums>,
    ) -> LightCache<P::MisSums> {
        self.trace_walks(estimator, seed, pass, &mut self.light_paths(block), observer)
    }

    /// The same of light subpaths of these numbers.
    fn trace_walks<P: Profile>(
        &self,
        estimator: &Estimator<'_, P>,
        seed: u64,
        pass: usize,
        walks: &mut dyn Iterator<Item = u64>,
        observer: &mut impl Observer<P::MisSums>,
    ) -> LightCache<P::MisSums> {
        let mut cache = LightCache::new(P::Channels::COUNT);
        if estimator.needs_light_walks() {
            for walk in walks {
                let mut stream = self.light_stream(seed, pass, walk);
                estimator.trace_light(&mut cache, observer, self.hero(seed, pass, walk), &mut stream);
            }
        }
        cache
    }

    /// Numbers of the light subpaths of `block` in a pass.
    pub fn light_paths(&self, block: usize) -> Range<u64> {
        let first = block as u64 * self.walks_per_block;
        first..first + self.walks_per_block
    }

    /// The channel that samples the distances of a light subpath: all equally often in every block, or that of the pixel that
    /// it belongs to.
    pub fn hero(&self, seed: u64, pass: usize, walk: u64) -> usize {
        let (block, number) = (walk / self.walks_per_block, walk % self.walks_per_block);
        let places = self.places(block as usize);
        if self.inverse.is_some() && self.heroes > 1 && number < places.len() as u64 {
            return self.camera_stream(seed, pass, self.pixel_at(places.start + number as usize)).1;
        }
        (number % self.heroes) as usize
    }
}

impl CameraStart {
    /// The camera subpath from here, which `observer` sees, connected to the light subpaths of `cache`.
    #[inline]
    pub fn trace<P: Profile, R: Observer<P::MisSums>>(
        mut self,
        estimator: &Estimator<'_, P>,
        cache: &LightCache<P::MisSums>,
        observer: R,
    ) -> R {
        let Self { position, aperture, hero, walk, .. } = self;
        estimator.sample_pixel(cache, [position, aperture], (hero, walk), observer, &mut self.stream)
    }
}

impl Blocks {
    /// Shows one sample of every pixel of `block` as a preview.
    pub fn show(&self, preview: &Preview<'_>, film: &Film, seed: u64, pass: usize, block: usize) -> Outcome {
        let camera =
            self.pixels(block).map(|pixel| (pixel as u32, self.show_pixel(preview, film, seed, pass, pixel)));
        Outcome { camera: camera.collect(), light: Vec::new(), faults: Vec::new() }
    }

    /// Shows one sample of `pixel` as a preview.
    pub fn show_pixel(
        &self,
        preview: &Preview<'_>,
        film: &Film,
        seed: u64,
        pass: usize,
        pixel: usize,
    ) -> Spectrum {
        let mut start = self.camera_start(preview.scene, film, seed, pass, pixel);
        let ray = preview.scene.sensor.ray(start.position, start.aperture).ray;
        preview.radiance(ray, &mut start.stream) * start.weight
    }

    /// Rays through pixels all over the film, with random numbers of their own.
    pub fn pilot_rays<'a>(
        &'a self,
        scene: &'a Scene,
        film: &'a Film,
        seed: u64,
    ) -> impl Iterator<Item = (Ray, Stream)> + 'a {
        (0..PILOT_RAYS).map(move |index| {
            let pixel = (index as u128 * self.pixels as u128 / PILOT_RAYS as u128) as usize;
            let mut stream = Stream::new(seed, index as u64, 0, Purpose::Pilot);
            let (position, _) = film.sample(pixel, &mut stream);
            let aperture = scene.sensor.sample_aperture(&mut stream);
            (scene.sensor.ray(position, aperture).ray, stream)
        })
    }
}

/// What a sample of `pixel` adds up to without contributions that are no finite numbers: it is made again, and looked at
/// one by one.
#[cold]
fn finite_part<P: Profile>(
    ready: &Ready<'_, P>,
    pass: usize,
    block: usize,
    pixel: usize,
    faults: &mut Vec<Fault>,
) -> Spectrum {
    let mut sum = Spectrum::ZERO;
    for (s, t, value) in pixel_sample::camera(ready, pass, block, pixel).contributions() {
        if value.is_finite() {
            sum += value;
        } else {
            let (cause, pixel) = (Cause::NotFinite { s, t }, Some(pixel as u32));
            faults.push(Fault { cause, sample: pass as u64, pixel });
        }
    }
    sum
}

/// What light subpaths contributed to the film.
struct Splatted<'a> {
    film: &'a Film,
    values: Vec<(u32, Spectrum)>,
    sample: u64,
    faults: Vec<Fault>,
}

impl<S: MisSums> Observer<S> for Splatted<'_> {
    #[inline]
    fn covers(&self, film: Vec2) -> bool {
        self.film.covers(film)
    }

    #[inline]
    fn contribute(&mut self, s: u32, t: u32, meeting: Meeting<'_, S>, contribution: Option<&Contribution>) {
        let (Meeting::Lens(film), Some(Contribution { value, .. })) = (meeting, contribution) else { return };
        if !value.is_finite() {
            let cause = Cause::NotFinite { s, t };
            return self.faults.push(Fault { cause, sample: self.sample, pixel: None });
        }
        let values = &mut self.values;
        self.film.spread(film, *value, |pixel, value| values.push((pixel as u32, value)));
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

/// The number that times `a`, coprime to `n`, is 1 modulo `n`: by Euclid's extended algorithm.
fn inverse(a: usize, n: usize) -> usize {
    let (mut before, mut at) = ((n as i64, 0i64), ((a % n.max(1)) as i64, 1i64));
    while at.0 != 0 {
        let times = before.0 / at.0;
        (before, at) = (at, (before.0 - times * at.0, before.1 - times * at.1));
    }
    before.1.rem_euclid(n.max(1) as i64) as usize
}

fn gcd(a: usize, b: usize) -> usize {
    if b == 0 { a } else { gcd(b, a % b) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_hold_every_pixel_once() {
        for pixels in [1, 2, 7, 1024, 1025, 48 * 48, 640 * 480] {
            let blocks = Blocks::new(pixels, 1, Sampler::Independent, 1.0);
            let mut seen = vec![0; pixels];
            (0..blocks.count()).flat_map(|b| blocks.pixels(b)).for_each(|p| seen[p] += 1);
            assert!(seen.iter().all(|n| *n == 1), "{pixels}");
            assert_eq!(Blocks::new(pixels, 3, Sampler::Sobol, 0.25).walks_per_block() % 3, 0);
        }
    }

    #[test]
    fn every_pixel_has_a_light_subpath_of_its_own_and_of_its_channel() {
        for pixels in [1, 2, 3, 7, 1023, 1024, 1025, 48 * 48, 160 * 120] {
            let blocks = Blocks::new(pixels, 3, Sampler::Sobol, 1.0).paired();
            for block in 0..blocks.count() {
                let walks: Vec<usize> = blocks.pixels(block).map(|pixel| blocks.walk_of(pixel)).collect();
                assert!(walks.iter().copied().eq(0..walks.len()), "{pixels}: {walks:?}");
                assert!(walks.len() as u64 <= blocks.walks_per_block());
                for (pixel, walk) in blocks.pixels(block).zip(blocks.light_paths(block)) {
                    assert_eq!(blocks.hero(5, 2, walk), blocks.camera_stream(5, 2, pixel).1);
                }
            }
        }
    }
}
