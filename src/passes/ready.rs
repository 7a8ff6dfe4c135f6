//! An estimator of one profile at work on blocks.

use super::{
    Settings,
    blocks::{Blocks, CameraStart, Division},
    compiled::Compiled,
    faults::{Cause, Fault, guarded},
    observe::BlockObserver,
    pass::Outcome,
    splats::Splats,
};
use crate::{
    film::{
        Film,
        sharing::{FilmSamples, Place, Sharing},
    },
    guide::Learnt,
    math::{Channels, Spectrum, Vec2},
    sampling::Stream,
    scene::{Scene, lights::Starts},
    shape::Ray,
    transport::{
        Connections, Contribution, Estimator, Interaction, LightCache, Options, Profile,
        observer::{Meeting, Observer, Sum},
    },
};
use std::{cell::Cell, ops::Range};

/// An estimator of profile `P` with all it takes to use it.
pub(super) struct Ready<'a, P: Profile> {
    estimator: Estimator<'a, P>,
    blocks: Blocks,
    scene: &'a Scene,
    film: &'a Film,
    film_samples: FilmSamples,
    seed: u64,
}

/// The camera subpath of a pixel, and the block whose light subpaths it is connected to.
struct Sight {
    pixel: usize,
    block: usize,
    start: CameraStart,
}

impl<'a, P: Profile> Ready<'a, P> {
    /// By what was `learnt`, with blocks of this `division`.
    pub(super) fn prepare(
        scene: &'a Scene,
        film: &'a Film,
        settings: &Settings,
        learnt: Learnt,
        division: Division,
    ) -> Box<dyn Compiled + 'a> {
        let Options { effort, connections, .. } = settings.options;
        let (pixels, heroes, sampler) = (film.len(), P::Channels::COUNT, settings.sampler);
        let blocks = match connections {
            Connections::Cached => {
                Blocks::of_size(division.size(), pixels, heroes, sampler, effort.light_walks)
            }
            // The light subpath of a pixel does not depend on how the image is rendered.
            Connections::All => Blocks::new(pixels, heroes, sampler, 1.0).paired(),
        };
        let (per_pass, per_block) = (blocks.walks_per_pass(), blocks.walks_per_block());
        let Settings { options, seed, film_samples, .. } = *settings;
        let estimator = Estimator::<P>::new(scene, options, learnt, seed, per_pass, per_block);
        let blocks = match division {
            Division::Image(_) if !estimator.needs_light_walks() => blocks.of_neighbours(),
            _ => blocks,
        };
        Box::new(Self { estimator, blocks, scene, film, film_samples, seed })
    }

    /// Where the camera subpaths of `pass` start within their pixels, if these share them.
    fn place(&self, pass: usize) -> Option<Place> {
        let place = || self.blocks.place(self.film, self.seed, pass);
        if self.film_samples == FilmSamples::Shared { place() } else { None }
    }

    #[inline]
    fn start(&self, pass: usize, pixel: usize, place: Option<Place>) -> CameraStart {
        self.blocks.camera_start((self.scene, self.film), self.seed, [pass, pixel], place)
    }

    /// Samples of pixels, connected to light subpaths of these numbers.
    fn sample(
        &self,
        pass: usize,
        walks: &mut dyn Iterator<Item = u64>,
        sights: &mut dyn Iterator<Item = Sight>,
    ) -> Outcome {
        let mut light = Splatted {
            film: self.film,
            film_samples: self.film_samples,
            splats: Splats::default(),
            sample: pass as u64,
            faults: Vec::new(),
        };
        let mut cache = LightCache::new(P::Channels::COUNT);
        walks.for_each(|walk| self.trace_light(pass, walk, &mut cache, &mut light));
        let mut faults = light.faults;
        let camera = sights.map(|Sight { pixel, block, start }| {
            let (weight, mut sum) = (start.weight, start.trace(&self.estimator, &cache, Sum::default()));
            if !sum.radiance.is_finite() {
                sum.radiance = self.finite_part(pass, block, pixel, &mut faults);
            }
            (pixel as u32, sum.radiance * weight)
        });
        Outcome::of_parts(camera.collect(), light.splats.into_values(), faults)
    }

    /// Traces light subpath number `walk` of `pass` into `cache`.
    #[inline]
    fn trace_light(
        &self,
        pass: usize,
        walk: u64,
        cache: &mut LightCache<P::MisSums>,
        observer: &mut impl Observer,
    ) {
        let mut stream = self.blocks.light_stream(self.seed, pass, walk);
        let hero = self.blocks.hero(self.seed, pass, walk);
        self.estimator.trace_light(cache, observer, hero, &mut stream);
    }

    /// Numbers of the light subpaths of `block`, if a strategy needs them.
    fn light_paths(&self, block: usize) -> Range<u64> {
        let all = self.blocks.light_paths(block);
        if self.estimator.needs_light_walks() { all } else { all.start..all.start }
    }

    /// The sum of the finite contributions of a sample of `pixel`: renders it again and checks each contribution.
    #[cold]
    fn finite_part(&self, pass: usize, block: usize, pixel: usize, faults: &mut Vec<Fault>) -> Spectrum {
        let mut finite = Finite {
            film: self.film,
            place: Fault {
                cause: Cause::NotFinite { s: 0, t: 0 },
                sample: pass as u64,
                pixel: Some(pixel as u32),
            },
            sum: Spectrum::ZERO,
            faults,
        };
        let mut cache = LightCache::new(P::Channels::COUNT);
        self.light_paths(block).for_each(|walk| self.trace_light(pass, walk, &mut cache, &mut finite));
        self.camera_start(pass, pixel).trace(&self.estimator, &cache, &mut finite as &mut dyn Observer);
        finite.sum
    }
}

impl<P: Profile> Compiled for Ready<'_, P> {
    fn scene(&self) -> &Scene {
        self.scene
    }
    fn film(&self) -> &Film {
        self.film
    }
    fn film_samples(&self) -> FilmSamples {
        self.film_samples
    }
    fn blocks(&self) -> &Blocks {
        &self.blocks
    }
    fn heroes(&self) -> usize {
        P::Channels::COUNT
    }
    fn starts(&self) -> Option<&Starts> {
        self.estimator.starts()
    }
    #[inline]
    fn camera_start(&self, pass: usize, pixel: usize) -> CameraStart {
        self.start(pass, pixel, self.place(pass))
    }
    fn own_start(&self, pass: usize, pixel: usize) -> CameraStart {
        self.start(pass, pixel, None)
    }
    fn sharing(&self, pass: usize) -> Option<Sharing<'_>> {
        self.place(pass).map(|place| self.film.sharing(place))
    }
    fn render(&self, pass: usize, block: usize, wants: &dyn Fn(usize) -> bool) -> Outcome {
        guarded(pass, |failed, at| {
            let is_wanted = |pixel: &usize| wants(*pixel) && !failed.contains(&(*pixel as u32));
            let place = self.place(pass);
            let mut sights = self.blocks.pixels(pass, block).filter(is_wanted).map(|pixel| {
                at.set(Some(pixel as u32));
                Sight { pixel, block, start: self.start(pass, pixel, place) }
            });
            self.sample(pass, &mut self.light_paths(block), &mut sights)
        })
    }
    fn shade(&self, pass: usize, block: usize, pixels: &[u32]) -> Outcome {
        guarded(pass, |failed, at| {
            let whole: Vec<u32> = pixels.iter().copied().filter(|pixel| !failed.contains(pixel)).collect();
            self.shade_whole(pass, block, &whole, at)
        })
    }
    fn observe(
        &self,
        pass: usize,
        block: usize,
        wants: &dyn Fn(usize) -> bool,
        observer: &mut dyn BlockObserver,
    ) {
        let mut cache = LightCache::new(P::Channels::COUNT);
        for walk in self.light_paths(block) {
            self.trace_light(pass, walk, &mut cache, &mut observer.light(walk));
        }
        observer.lit();
        let place = self.place(pass);
        for pixel in self.blocks.pixels(pass, block).filter(|pixel| wants(*pixel)) {
            let start = self.start(pass, pixel, place);
            let camera = observer.camera(pixel, &start);
            start.trace(&self.estimator, &cache, camera);
            observer.ended(pixel);
        }
    }
    fn light_walk(&self, pass: usize, walk: u64, mut observer: &mut dyn Observer) {
        self.trace_light(pass, walk, &mut LightCache::new(P::Channels::COUNT), &mut observer);
    }
    fn transmittance(&self, primary: Ray, stream: &mut Stream) -> Spectrum {
        self.estimator.transmittance(primary, stream)
    }
    fn first_interaction(&self, primary: Ray, stream: &mut Stream) -> Option<Interaction> {
        self.estimator.first_interaction(primary, stream)
    }
}

impl<P: Profile> Ready<'_, P> {
    /// See [`Compiled::shade`]; says which pixel it is `at`.
    fn shade_whole(&self, pass: usize, block: usize, pixels: &[u32], at: &Cell<Option<u32>>) -> Outcome {
        let blocks = &self.blocks;
        let is_paired = pixels.first().is_some_and(|pixel| blocks.home(*pixel as usize).is_some());
        let mut sights = pixels.iter().enumerate().map(|(walk, pixel)| {
            at.set(Some(*pixel));
            let pixel = *pixel as usize;
            let start = CameraStart { walk, ..self.camera_start(pass, pixel) };
            Sight { pixel, block: blocks.home(pixel).map_or(block, |(own, _)| own), start }
        });
        if !is_paired {
            return self.sample(pass, &mut self.light_paths(block), &mut sights);
        }
        let needed = self.estimator.needs_light_walks();
        let homes = pixels.iter().filter(|_| needed).filter_map(|pixel| blocks.home(*pixel as usize));
        let own = |(home, number): (usize, usize)| blocks.light_paths(home).start + number as u64;
        self.sample(pass, &mut homes.map(own), &mut sights)
    }
}

/// What light subpaths contributed to the film.
struct Splatted<'a> {
    film: &'a Film,
    film_samples: FilmSamples,
    splats: Splats,
    sample: u64,
    faults: Vec<Fault>,
}

impl Observer for Splatted<'_> {
    #[inline]
    fn covers(&self, film: Vec2) -> bool {
        self.film.covers(film)
    }

    #[inline]
    fn contribute(&mut self, s: u32, t: u32, meeting: Meeting<'_>, contribution: Option<&Contribution>) {
        let (Meeting::Lens(film), Some(Contribution { value, .. })) = (meeting, contribution) else { return };
        if !value.is_finite() {
            let cause = Cause::NotFinite { s, t };
            return self.faults.push(Fault { cause, sample: self.sample, pixel: None });
        }
        let splats = &mut self.splats;
        let add = |pixel, value| splats.push(pixel as u32, value);
        self.film_samples.splat(self.film, self.sample, film, *value, add);
    }
}

/// Adds up the finite contributions of a camera subpath, and notes the others as faults.
struct Finite<'a> {
    film: &'a Film,
    /// A fault at this place, without its cause.
    place: Fault,
    sum: Spectrum,
    faults: &'a mut Vec<Fault>,
}

impl Observer for Finite<'_> {
    fn covers(&self, film: Vec2) -> bool {
        self.film.covers(film)
    }

    fn contribute(&mut self, s: u32, t: u32, meeting: Meeting<'_>, contribution: Option<&Contribution>) {
        match (meeting, contribution) {
            (Meeting::Lens(_), _) | (_, None) => {}
            (_, Some(Contribution { value, .. })) if value.is_finite() => self.sum += *value,
            _ => self.faults.push(Fault { cause: Cause::NotFinite { s, t }, ..self.place.clone() }),
        }
    }
}
