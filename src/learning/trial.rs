//! What a round of samples finds: contributions to the image, where their light starts, and the walks that found them. From it
//! come weights of starts, lessons for a guide, and how much of the second moment a guide leaves.

use super::{
    follower::{Followed, Follower},
    paths::{Shares, Track, Tracks},
    tiles::Tiles,
};
use crate::{
    bsdf::Transport,
    film::Film,
    guide::{Guide, Lesson},
    math::{Spectrum, SpectrumExt, Vec2},
    passes::{blocks::CameraStart, compiled::Compiled, observe::BlockObserver},
    sampling::Thinning,
    scene::{
        Scene,
        lights::{EmissionSample, Start},
    },
    transport::{
        Contribution, Event, Leg, Strategies,
        observer::{Meeting, Observer},
        strategy::StrategyKind,
    },
};
use rayon::prelude::*;
use std::{collections::HashMap, ops::Range};

/// Part of the tiles, those of the greatest second moments, that is left out: few samples decide there.
const OUTLIERS: f64 = 0.04;
/// Most tiles of the image across and down; the pixels of a tile count as one.
const TILES: u32 = 8;
/// Lessons for the guide from each camera subpath of a round, at most on average.
const LESSONS: f64 = 3.0;
/// Part of the image's mean that is added to the mean of each tile.
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
    /// The share of strategies that begin at an emitter, in the weights.
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
    /// Renders `tasks`, blocks numbered over all passes, and records walks too if `for_guide`. None if it `is_over`
    /// before.
    pub(super) fn run(
        compiled: &dyn Compiled,
        tasks: Range<usize>,
        for_guide: bool,
        is_over: &(dyn Fn() -> bool + Sync),
    ) -> Option<Self> {
        let blocks = compiled.blocks().count();
        let tiles = Tiles::of(compiled.film(), TILES);
        let count = tasks.len() as f64;
        let part = |task| (!is_over()).then(|| part(compiled, [task / blocks, task % blocks], for_guide));
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
            let camera = part.found.into_iter().map(of_tile);
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

    /// The starts and their weights. Shares of strategies are factors where starts `compete` with other strategies.
    pub(super) fn weights(&self, compete: bool) -> Vec<(Start, f32)> {
        let value = self.values();
        let weight = |found: &Found| value(found) * if compete { found.by_light() } else { 1.0 };
        let mut all: Vec<(Start, f32)> = Vec::new();
        for found in &self.found {
            // All contributions of one light subpath belong to one start.
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

    /// The same for next-event estimation. They are said to begin where the light first arrives, and count by the shares of
    /// all strategies that may sample their directions, if next-event estimation is one of them.
    pub(super) fn arriving(&self) -> Vec<(Start, f32)> {
        let value = self.values();
        let arriving = |found: &Found| {
            let Followed { start, arrives, .. } = found.start?;
            let joined = found.shares[StrategyKind::NextEvent as usize];
            let weight = if joined > 0.0 { value(found) * (joined + found.by_light()) } else { 0.0 };
            Some((Start { position: arrives, ..start }, weight))
        };
        let all = self.found.iter().flatten().filter_map(arriving);
        all.filter(|(_, weight)| weight.is_finite() && *weight > 0.0).collect()
    }

    /// The part that `guide`, which the samples followed, left of the second moment of `strategies`.
    pub(super) fn second_moment(&self, strategies: Strategies, guide: &Guide) -> f64 {
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

    /// The lessons for walks by `strategies`, from so many `samples`. If there are too many, some of little weight
    /// stand for others.
    pub(super) fn lessons(&self, strategies: Strategies, samples: f64) -> Vec<Lesson> {
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

/// What `compiled` finds in one block of one pass.
fn part(compiled: &dyn Compiled, [pass, block]: [usize; 2], for_guide: bool) -> Recorder<'_> {
    let (scene, heroes) = (compiled.scene(), compiled.heroes());
    let mut recorder = Recorder {
        scene,
        film: compiled.film(),
        follower: Follower::new(&scene.lights, compiled.starts(), heroes),
        tracks: for_guide.then(|| Tracks::new(heroes)),
        transport: Transport::Importance,
        pixels: Vec::new(),
        weight: 1.0,
        light: Vec::new(),
        found: Vec::new(),
        segments: 0.0,
    };
    compiled.observe(pass, block, &|_| true, &mut recorder);
    recorder
}

/// Sees the walks of a block and what they contribute; those of the camera to the last of its pixels.
struct Recorder<'a> {
    scene: &'a Scene,
    film: &'a Film,
    follower: Follower<'a>,
    tracks: Option<Tracks>,
    /// Of the walks at hand.
    transport: Transport,
    /// Those that camera subpaths went through.
    pixels: Vec<u32>,
    weight: f32,
    /// By light subpaths.
    light: Vec<(u32, Found)>,
    /// By walks of the kind at hand.
    found: Vec<(u32, Found)>,
    segments: f64,
}

impl BlockObserver for Recorder<'_> {
    fn light(&mut self, _: u64) -> &mut dyn Observer {
        self
    }

    fn lit(&mut self) {
        self.light = std::mem::take(&mut self.found);
        self.follower.leave_light();
        self.transport = Transport::Radiance;
    }

    fn camera(&mut self, pixel: usize, start: &CameraStart) -> &mut dyn Observer {
        self.follower.begin(start.hero);
        self.pixels.push(pixel as u32);
        self.weight = start.weight;
        self
    }
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

impl Observer for Recorder<'_> {
    fn covers(&self, film: Vec2) -> bool {
        self.film.covers(film)
    }

    fn emit(&mut self, start: &EmissionSample, hero: usize) {
        self.follower.emit(start, hero);
    }

    fn depart(&mut self, leg: &Leg) {
        self.follower.depart(leg);
        self.segments += 1.0;
        if let (0, Some(tracks)) = (leg.edges, &mut self.tracks) {
            tracks.begin();
        }
    }

    fn arrive(&mut self, event: Event<'_>) {
        self.follower.arrive(&event);
        if let Some(tracks) = &mut self.tracks {
            tracks.arrive(self.scene, self.transport, &event);
        }
    }

    fn keep(&mut self, place: usize) {
        self.follower.keep(place);
        if let Some(tracks) = &mut self.tracks {
            tracks.keep(self.follower.hero, place);
        }
    }

    fn contribute(&mut self, s: u32, t: u32, meeting: Meeting<'_>, contribution: Option<&Contribution>) {
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
            _ => (self.pixels[self.pixels.len() - 1], value.luminance() * self.weight),
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
        learning::training,
        passes::{
            Settings,
            blocks::{PIXELS_PER_BLOCK, blocks_for},
            compiled,
        },
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
            let effort = Effort { guide: Guiding::Always, ..Effort::default() };
            let options = Options { strategies: Strategies::BDPT, effort, ..integrator.options };
            let settings = training::of_learning(training::options_of_learning(options));
            let learnt = training::learn_rounds(&scene, &film, &Settings { options, ..settings }, 6);
            let tasks = blocks_for(film.len(), 1 << 17);
            let trial = |learnt: &Learnt, tasks: Range<usize>| {
                let compiled = compiled::by_kind(&scene, &film, &settings, learnt.clone(), PIXELS_PER_BLOCK);
                Trial::run(&*compiled, tasks, true, &|| false).unwrap()
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
