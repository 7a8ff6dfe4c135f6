//! A block: a set of pixels, rendered together with a light cache of their own. They are scattered over the image. If no
//! light subpaths are cached, they are neighbours in all passes but the first: their rays meet the same parts of the scene,
//! which are then in the processor's caches.

use crate::{
    film::{Film, sharing::Place},
    math::Vec2,
    sampling::{Sampler, Stream, stream::Purpose},
    scene::Scene,
    transport::{Estimator, LightCache, Profile, observer::Observer},
};
use std::ops::Range;

/// Pixels (and light subpaths) of a block: a cache of this many walks still fits the processor's caches, and
/// its noise is shared by few enough pixels.
pub const PIXELS_PER_BLOCK: usize = 1024;

/// How an image's pixels are divided among blocks.
pub struct Blocks {
    pixels: usize,
    count: usize,
    /// Distance between the pixels of a block, coprime to `pixels`: the noise that they share (their light cache) shows
    /// no pattern.
    stride: usize,
    walks_per_block: u64,
    heroes: u64,
    sampler: Sampler,
    /// The inverse of `stride` modulo `pixels`, where every pixel has a light subpath for itself.
    inverse: Option<usize>,
    /// Distance between one block of neighbours and the next, in blocks; none where all blocks are scattered.
    block_stride: Option<usize>,
}

/// How a camera subpath starts.
pub struct CameraStart {
    /// Its random numbers.
    pub stream: Stream,
    /// The channel that samples distances.
    pub hero: usize,
    /// Where on the film (pixels).
    pub position: Vec2,
    /// Through which point of the aperture (m).
    pub aperture: Vec2,
    /// Its weight.
    pub weight: f32,
    /// The light subpath of its block that belongs to it alone, where each has one.
    pub walk: usize,
}

/// How an image is divided into blocks of so many pixels.
#[derive(Clone, Copy, Debug)]
pub enum Division {
    /// To be rendered.
    Image(usize),
    /// A few blocks of which are to stand for the image.
    Sample(usize),
}

impl Division {
    /// Pixels of a block.
    pub fn size(self) -> usize {
        let (Self::Image(size) | Self::Sample(size)) = self;
        size
    }
}

/// Number of blocks of an image of so many `pixels`.
pub fn count_of(pixels: usize) -> usize {
    pixels.div_ceil(PIXELS_PER_BLOCK).max(1)
}

/// Least number of blocks with so many camera `subpaths`.
pub fn blocks_for(pixels: usize, subpaths: usize) -> usize {
    (subpaths * pixels.div_ceil(PIXELS_PER_BLOCK)).div_ceil(pixels.max(1))
}

impl Blocks {
    /// Divides `pixels` into blocks. Each pixel has `light_walks` light subpaths in a pass; estimators have so many
    /// hero channels (`heroes`); walks draw from streams of `sampler`.
    pub fn new(pixels: usize, heroes: usize, sampler: Sampler, light_walks: f32) -> Self {
        Self::of_size(PIXELS_PER_BLOCK, pixels, heroes, sampler, light_walks)
    }

    /// The same with blocks of so many pixels.
    pub fn of_size(size: usize, pixels: usize, heroes: usize, sampler: Sampler, light_walks: f32) -> Self {
        let count = pixels.div_ceil(size).max(1);
        let heroes = heroes as u64;
        let walks = (pixels.div_ceil(count) as f64 * f64::from(light_walks)).ceil() as u64;
        let walks_per_block = walks.div_ceil(heroes) * heroes;
        let (stride, inverse, block_stride) = (golden_stride(pixels), None, None);
        Self { pixels, count, stride, walks_per_block, heroes, sampler, inverse, block_stride }
    }

    /// The same with neighbours in blocks of all passes but the first, which is shown before it is whole; for estimators that
    /// need no light subpaths.
    pub fn of_neighbours(self) -> Self {
        Self { block_stride: Some(golden_stride(self.count)), ..self }
    }

    /// The same with one light subpath per pixel, which belongs to it alone. Both have the same hero channel, and the
    /// light subpath's random numbers are spread evenly over the samples of its pixel.
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

    /// The pixels of `block` in `pass`.
    pub fn pixels(&self, pass: usize, block: usize) -> impl Iterator<Item = usize> + '_ {
        let neighbours = self.block_stride.filter(|_| pass > 0);
        let places = self.places(neighbours.map_or(block, |stride| block * stride % self.count));
        places.map(move |place| if neighbours.is_some() { place } else { self.pixel_at(place) })
    }

    /// Places of the pixels of `block` in the order of all pixels.
    fn places(&self, block: usize) -> Range<usize> {
        block * self.pixels / self.count..(block + 1) * self.pixels / self.count
    }

    fn pixel_at(&self, place: usize) -> usize {
        (place as u128 * self.stride as u128 % self.pixels as u128) as usize
    }

    /// Number of pixels.
    pub fn pixel_count(&self) -> usize {
        self.pixels
    }

    /// The light subpath of its block that belongs to `pixel` alone; 0 where none does.
    fn walk_of(&self, pixel: usize) -> usize {
        self.home(pixel).map_or(0, |(_, number)| number)
    }

    /// The block of `pixel` and its number there, if this is also the number of its light subpath.
    pub fn home(&self, pixel: usize) -> Option<(usize, usize)> {
        let place = (pixel as u128 * self.inverse? as u128 % self.pixels as u128) as usize;
        // The last block that begins there or before.
        let block = ((place + 1) * self.count - 1) / self.pixels;
        Some((block, place - self.places(block).start))
    }

    /// Where the camera subpaths of `pass` start within their pixels, if these can share them.
    pub fn place(&self, film: &Film, seed: u64, pass: usize) -> Option<Place> {
        // A number that no pixel has.
        let (mut stream, _) = self.camera_stream(seed, pass, self.pixels);
        film.place(&mut stream)
    }

    /// Where the camera subpath of `pixel` in `pass` starts: at `place`, if pixels share their samples.
    #[inline]
    pub fn camera_start(
        &self,
        (scene, film): (&Scene, &Film),
        seed: u64,
        [pass, pixel]: [usize; 2],
        place: Option<Place>,
    ) -> CameraStart {
        let (mut stream, hero) = self.camera_stream(seed, pass, pixel);
        let (position, weight) = match place {
            None => film.sample(pixel, &mut stream),
            Some(place) => {
                // The place has these coordinates of the pass's point; all later ones are spread evenly beside them.
                stream.square();
                (film.position(pixel, place), 1.0)
            }
        };
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

    /// The random numbers of light subpath `walk` of a pass. All walks of a block contribute to the same pixels: unless
    /// each belongs to a pixel, the sampler spreads all of them evenly together, pass after pass.
    #[inline]
    pub fn light_stream(&self, seed: u64, pass: usize, walk: u64) -> Stream {
        if self.inverse.is_some() {
            return self.sampler.stream(seed, walk, pass as u64, 0, 1, Purpose::Light);
        }
        let per_block = self.walks_per_block;
        self.sampler.stream(seed, walk / per_block, pass as u64, walk % per_block, per_block, Purpose::Light)
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
    /// Traces the camera subpath from here, connected to the light subpaths of `cache`; `observer` sees it.
    #[inline]
    pub fn trace<P: Profile, R: Observer>(
        mut self,
        estimator: &Estimator<'_, P>,
        cache: &LightCache<P::MisSums>,
        observer: R,
    ) -> R {
        let Self { position, aperture, hero, walk, .. } = self;
        estimator.sample_pixel(cache, [position, aperture], (hero, walk), observer, &mut self.stream)
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

/// About the golden section of `n`, coprime to it.
fn golden_stride(n: usize) -> usize {
    let golden = (n as f64 * 0.618_033_988_75) as usize;
    (golden.max(1)..).find(|stride| gcd(*stride, n) == 1).unwrap_or(1)
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
            let of = || Blocks::new(pixels, 1, Sampler::Independent, 0.0);
            for (blocks, pass) in [(of(), 0), (of(), 1), (of().of_neighbours(), 0), (of().of_neighbours(), 1)]
            {
                let mut seen = vec![0; pixels];
                (0..blocks.count()).flat_map(|b| blocks.pixels(pass, b)).for_each(|p| seen[p] += 1);
                assert!(seen.iter().all(|n| *n == 1), "{pixels}, pass {pass}");
            }
            assert_eq!(Blocks::new(pixels, 3, Sampler::Sobol, 0.25).walks_per_block() % 3, 0);
        }
    }

    #[test]
    fn every_pixel_has_a_light_subpath_of_its_own_and_of_its_channel() {
        for pixels in [1, 2, 3, 7, 1023, 1024, 1025, 48 * 48, 160 * 120] {
            let blocks = Blocks::new(pixels, 3, Sampler::Sobol, 1.0).paired();
            for block in 0..blocks.count() {
                let walks: Vec<usize> = blocks.pixels(0, block).map(|pixel| blocks.walk_of(pixel)).collect();
                assert!(walks.iter().copied().eq(0..walks.len()), "{pixels}: {walks:?}");
                assert!(walks.len() as u64 <= blocks.walks_per_block());
                for (pixel, walk) in blocks.pixels(0, block).zip(blocks.light_paths(block)) {
                    assert_eq!(blocks.hero(5, 2, walk), blocks.camera_stream(5, 2, pixel).1);
                }
            }
        }
    }
}
