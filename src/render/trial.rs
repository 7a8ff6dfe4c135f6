//! What a round of samples finds: contributions to the image, where their light starts, and the walks that found them. From it
//! come weights of starts, lessons for a guide, and how much of the second moment a guide leaves.

use super::{
    compiled::Ready,
    follower::{Followed, Follower},
    groups::Tiles,
    tracks::{Shares, Track, Tracks},
};
use crate::{
    bsdf::Transport,
    film::Film,
    guide::{Guide, Lesson},
    math::{Channels, Spectrum, SpectrumExt, Vec2},
    sampling::Thinning,
    scene::{
        Scene,
        lights::{EmissionSample, Start},
    },
    transport::{
        Contribution, Departure, MisSums, Strategies, Vertex,
        observer::{Meeting, Observer, StrategyKind},
        profile::Profile,
    },
};
use rayon::prelude::*;
use std::{collections::HashMap, ops::Range};

/// Tiles with the greatest second moments that are left out of it, as few samples decide there.
const OUTLIERS: f64 = 0.04;
/// The image is divided into so many tiles across and down, at most, whose pixels count as one.
const TILES: u32 = 8;
/// Lessons for the guide from each camera subpath of a round, at most on average.
const LESSONS: f64 = 3.0;
/// Of the image's mean, added to that of each tile.
const FLOOR: f64 = 0.1;

/// A contribution to a tile.
#[derive(Clone, Copy)]
struct Found {
    tile: usize,
    start: Option<Followed>,
    track: Option<Track>,
    /// Luminance; first of a sample, then as part of the mean over the tile.
    value: f64,
    /// Of each kind of strategy, in the weights.
    shares: [f32; StrategyKind::ALL.len()],
}

impl Found {
    /// Of strategies that begin at an emitter, in the weights.
    fn by_light(&self) -> f32 {
        self.shares[StrategyKind::Connection as usize] + self.shares[StrategyKind::Lens as usize]
    }
}

/// What a round of samples found.
#[derive(Default)]
pub(super) struct Trial {
    /// Of each block.
    found: Vec<Vec<Found>>,
    /// Of each block, for a guide.
    tracks: Vec<Tracks>,
    /// Of each tile.
    pixels: Vec<f64>,
    pub segments: f64,
}

impl Trial {
    /// Some blocks of some passes, numbered over all of them; what it finds is for a guide too or is not. None if it `is_over`
    /// before.
    pub fn run<P: Profile>(
        ready: &Ready<'_, P>,
        tasks: Range<usize>,
        for_guide: bool,
        is_over: &(dyn Fn() -> bool + Sync),
    ) -> Option<Self> {
        let blocks = ready.blocks.count();
        let tiles = Tiles::of(ready.film, TILES);
        let count = tasks.len() as f64;
        let part = |task| (!is_over()).then(|| part(ready, [task / blocks, task % blocks], for_guide));
        let parts: Vec<_> = tasks.into_par_iter().map(part).collect::<Option<_>>()?;
        let pixels = tiles.pixels();
        let mut samples = vec![0.0; pixels.len()];
        parts.iter().flat_map(|part| &part.pixels).for_each(|pixel| samples[tiles.at(*pixel)] += 1.0);
        let mut trial = Self { pixels, ..Self::default() };
        // Light subpaths traced stand for those of a pass.
        let per_pass = blocks as f64 / count;
        for part in parts {
            trial.segments += part.segments;
            let of_tile = |(pixel, found): (u32, Found)| Found { tile: tiles.at(pixel), ..found };
            let camera = part.camera.into_iter().map(of_tile);
            let camera = camera.map(|found| Found { value: found.value / samples[found.tile], ..found });
            let light = part.light.into_iter().map(of_tile);
            let light = light
                .map(|found| Found { value: found.value * per_pass / trial.pixels[found.tile], ..found });
            trial.found.push(camera.chain(light).collect());
            trial.tracks.extend(part.tracks);
        }
        Some(trial)
    }

    /// What contributions count for: their parts of the means of their tiles.
    fn values(&self) -> impl Fn(&Found) -> f32 + Sync {
        let mut means = vec![0.0; self.pixels.len()];
        self.found.iter().flatten().for_each(|found| means[found.tile] += found.value);
        let pixels: f64 = self.pixels.iter().sum();
        let mean = means.iter().zip(&self.pixels).map(|(mean, pixels)| mean * pixels).sum::<f64>() / pixels;
        move |found| (found.value * self.pixels[found.tile] / (means[found.tile] + FLOOR * mean)) as f32
    }

    /// What starts count for; shares in the weights do where they `compete` with other strategies.
    pub fn weights(&self, compete: bool) -> Vec<(Start, f32)> {
        let value = self.values();
        let weight = |found: &Found| value(found) * if compete { found.by_light() } else { 1.0 };
        let mut all: Vec<(Start, f32)> = Vec::new();
        for found in &self.found {
            // What one light subpath contributed tells of one start.
            let mut of_walks = HashMap::new();
            for found in found {
                let (Some(followed), weight) = (found.start, weight(found)) else { continue };
                let known = followed.walk.map(|walk| *of_walks.entry(walk).or_insert(all.len()));
                match known.and_then(|index| all.get_mut(index)) {
                    Some((_, sum)) => *sum += weight,
                    None => all.push((followed.start, weight)),
                }
            }
        }
        all.retain(|(_, weight)| weight.is_finite() && *weight > 0.0);
        all
    }

    /// What `guide`, which the samples followed, left of the second moment of what `strategies` bring.
    pub fn second_moment(&self, strategies: Strategies, guide: &Guide) -> f64 {
        let value = self.values();
        let mut tiles = vec![[0.0; 2]; self.pixels.len()];
        for (tile, moments) in self.moments(strategies, Some(guide), value).into_iter().flatten() {
            tiles[tile].iter_mut().zip(moments).for_each(|(sum, moment)| *sum += moment);
        }
        tiles.sort_unstable_by(|a, b| b[0].total_cmp(&a[0]));
        let kept = &tiles[(OUTLIERS * tiles.len() as f64) as usize..];
        let [guided, unguided] = [0, 1].map(|index| kept.iter().map(|moments| moments[index]).sum::<f64>());
        if unguided > 0.0 { guided / unguided } else { 1.0 }
    }

    /// Second moments of what `strategies` bring, with `guide`, which the samples followed if there was one, and without it: of what
    /// each part found, the tiles and their moments.
    fn moments(
        &self,
        strategies: Strategies,
        guide: Option<&Guide>,
        value: impl Fn(&Found) -> f32 + Sync,
    ) -> Vec<Vec<(usize, [f64; 2])>> {
        let of = |part: usize| {
            let tracks = &self.tracks[part];
            let known = guide.map(|guide| tracks.known(guide, strategies));
            let moments = |found: &Found| {
                let (track, shares) = found.track.zip(Shares::of(&found.shares, strategies))?;
                let guided = f64::from(value(found)).powi(2) / f64::from(shares.of_all);
                let unguided = known.as_ref().map_or(1.0, |known| tracks.unguided(&track, &shares, known));
                Some((found.tile, [guided, guided / unguided]))
            };
            self.found[part].iter().filter_map(moments).collect()
        };
        (0..self.found.len()).into_par_iter().map(of).collect()
    }

    /// Where walks by `strategies` should go, from so many `samples`; if there are too many lessons, some of those with little
    /// weight stand for others.
    pub fn lessons(&self, strategies: Strategies, samples: f64) -> Vec<Lesson> {
        let value = self.values();
        let each = |part: usize, take: &mut dyn FnMut(f32, &dyn Fn() -> Lesson)| {
            for found in &self.found[part] {
                let Some((track, shares)) = found.track.zip(Shares::of(&found.shares, strategies)) else {
                    continue;
                };
                let weight = value(found);
                if weight.is_finite() && weight > 0.0 {
                    self.tracks[part].lessons(&track, &shares, (weight, part % 2), &mut *take);
                }
            }
        };
        let parts = || (0..self.found.len()).into_par_iter();
        let total = |part| {
            let mut total = 0.0;
            each(part, &mut |weight, _| total += f64::from(weight));
            total
        };
        let step =
            (parts().map(total).collect::<Vec<f64>>().iter().sum::<f64>() / (LESSONS * samples)) as f32;
        let lessons = |part| {
            let (mut thinning, mut lessons) = (Thinning::by(step), Vec::new());
            each(part, &mut |weight, lesson| {
                let kept = thinning.keeps(weight);
                lessons.extend(kept.map(|weight| Lesson { weight: samples as f32 * weight, ..lesson() }));
            });
            lessons
        };
        parts().flat_map_iter(lessons).collect()
    }
}

/// What one block of one pass finds.
struct Part {
    camera: Vec<(u32, Found)>,
    light: Vec<(u32, Found)>,
    tracks: Option<Tracks>,
    /// Those that camera subpaths went through.
    pixels: Vec<u32>,
    segments: f64,
}

fn part<P: Profile>(ready: &Ready<'_, P>, [pass, block]: [usize; 2], for_guide: bool) -> Part {
    let Ready { estimator, blocks, scene, film, seed } = ready;
    let mut recorder = Recorder {
        scene,
        film,
        follower: Follower::new(&scene.lights, estimator.starts(), P::Channels::COUNT),
        tracks: for_guide.then(|| Tracks::new(P::Channels::COUNT)),
        transport: Transport::Importance,
        pixel: 0,
        weight: 1.0,
        found: Vec::new(),
        segments: 0.0,
    };
    let mut observer: &mut dyn Observer<P::MisSums> = &mut recorder;
    let cache = blocks.trace_light(estimator, *seed, pass, block, &mut observer);
    let light = std::mem::take(&mut recorder.found);
    recorder.transport = Transport::Radiance;
    let pixels: Vec<u32> = blocks.pixels(block).map(|pixel| pixel as u32).collect();
    for pixel in &pixels {
        let start = blocks.camera_start(scene, film, *seed, pass, *pixel as usize);
        recorder.follower.begin(start.hero);
        (recorder.pixel, recorder.weight) = (*pixel, start.weight);
        let observer: &mut dyn Observer<P::MisSums> = &mut recorder;
        start.trace(estimator, &cache, observer);
    }
    let Recorder { found: camera, tracks, segments, .. } = recorder;
    Part { camera, light, tracks, pixels, segments }
}

/// Sees walks and what they contribute; those of the camera to one pixel.
struct Recorder<'a> {
    scene: &'a Scene,
    film: &'a Film,
    follower: Follower<'a>,
    tracks: Option<Tracks>,
    /// Of the walks at hand.
    transport: Transport,
    pixel: u32,
    weight: f32,
    found: Vec<(u32, Found)>,
    segments: f64,
}

impl Recorder<'_> {
    /// The luminance that the image gains where a light subpath is seen through `film`, and the pixel that gains most.
    fn splat(&self, film: Vec2, value: Spectrum) -> (u32, f32) {
        let (mut brightest, mut most, mut sum) = (0, 0.0, 0.0);
        self.film.spread(film, value, |pixel, value| {
            let value = value.luminance();
            sum += value;
            if value > most {
                (brightest, most) = (pixel as u32, value);
            }
        });
        (brightest, sum)
    }
}

impl<S: MisSums> Observer<S> for Recorder<'_> {
    fn covers(&self, film: Vec2) -> bool {
        self.film.covers(film)
    }

    fn emit(&mut self, start: &EmissionSample, hero: usize) {
        self.follower.emit(start, hero);
    }

    fn depart(&mut self, departure: &Departure<S>) {
        self.follower.depart(departure);
        self.segments += 1.0;
        if let (0, Some(tracks)) = (departure.edges, &mut self.tracks) {
            tracks.begin();
        }
    }

    fn arrive(&mut self, vertex: &Vertex<S>) {
        self.follower.arrive(vertex);
        if let Some(tracks) = &mut self.tracks {
            tracks.arrive(self.scene, self.transport, vertex);
        }
    }

    fn keep(&mut self) {
        self.follower.keep();
        if let Some(tracks) = &mut self.tracks {
            tracks.keep(self.follower.hero);
        }
    }

    fn contribute(&mut self, s: u32, t: u32, meeting: Meeting<'_, S>, contribution: Option<&Contribution>) {
        let Some(Contribution { value, shares, .. }) = contribution.filter(|c| c.value.is_finite()) else {
            return;
        };
        let start = self.follower.start(s, t, &meeting);
        let hero = self.follower.hero;
        let track = self.tracks.as_ref().and_then(|tracks| tracks.track(self.scene, &meeting, hero));
        let (value, shares) = (*value, *shares);
        let found = |value: f32| Found { tile: 0, start, track, value: f64::from(value.max(0.0)), shares };
        let (pixel, value) = match meeting {
            Meeting::Lens(film) => self.splat(film, value),
            _ => (self.pixel, value.luminance() * self.weight),
        };
        if value > 0.0 {
            self.found.push((pixel, found(value)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        format,
        guide::Learnt,
        render::{Settings, block::blocks_for, compiled, training},
        scene::build::{self, Setup},
        settings::{
            Overrides,
            options::{Effort, Guiding},
        },
        testing,
        transport::Options,
    };
    use statrs::distribution::{ContinuousCDF, Normal};
    use std::path::Path;

    /// What walks that follow a guide say of walks without it, those say themselves.
    #[test]
    fn second_moments_without_a_guide_are_known_with_it() {
        let most = -Normal::standard().inverse_cdf(testing::significance(6) / 2.0);
        for fog in ["0", "1"] {
            let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/gallery/cornell_e.json");
            let read = format::read(&path, &[("medium".to_owned(), fog.to_owned())]).unwrap();
            let overrides = Overrides { size: Some((16, 16)), ..Overrides::default() };
            let Setup { scene, film, integrator, .. } = build::build(&read, overrides).unwrap();
            let effort = Effort { guide: Guiding::Always, learnt_starts: false, ..Effort::default() };
            let options = Options { strategies: Strategies::BDPT, effort, ..integrator.options };
            let settings = training::of_learning(training::options_of_learning(options));
            let learnt = training::learn_rounds(&scene, &film, &Settings { options, ..settings }, 6);
            let tasks = blocks_for(film.len(), 1 << 17);
            let trial = |learnt: &Learnt, tasks: Range<usize>| {
                compiled::trial(&scene, &film, &settings, learnt.clone(), tasks, true, &|| false).unwrap()
            };
            let with = trial(&learnt, 1000..1000 + tasks);
            let without = trial(&Learnt::default(), 5000..5000 + tasks);
            for strategies in [Strategies::PT, Strategies::LT, Strategies::BDPT] {
                let moments = |trial: &Trial, guide: Option<&Guide>| {
                    let parts = trial.moments(strategies, guide, |found| found.value as f32);
                    let sum =
                        |part: &Vec<(usize, [f64; 2])>| part.iter().map(|(_, moments)| moments[1]).sum();
                    let of: Vec<f64> = parts.iter().map(sum).collect();
                    let n = of.len() as f64;
                    let mean = of.iter().sum::<f64>() / n;
                    (mean, of.iter().map(|part| (part - mean).powi(2)).sum::<f64>() / (n - 1.0) / n)
                };
                let (known, variance) = moments(&with, learnt.guide.as_deref());
                let (seen, other) = moments(&without, None);
                let z = (known - seen) / (variance + other).sqrt();
                assert!(z.abs() < most, "fog {fog}, {strategies:?}: {known} of {seen}, {z} standard errors");
            }
        }
    }
}
