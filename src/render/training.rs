//! Training of the starts of light subpaths, and of the guide: a few samples by all strategies, round after round, each of
//! which begins its light subpaths, and follows walks, where those before it found that light reaches the image.
//!
//! A path that any strategy found counts for as much of its pixel as strategies that begin at an emitter are to make of it:
//! its contribution over the pixel's mean, times their share in the weights. In balance, starts are then as dense, together
//! with all other strategies, as their light is in the image. Next-event estimation finds openings long before light subpaths
//! do. Directions of walks count likewise, for what those strategies are to make that have to find them.
//!
//! No sample of the image teaches, so that all are independent. Those of high numbers follow what more rounds learnt: an image of
//! few samples learns little, one of many much, and each part of an image learns what the whole learns for the same samples.

use super::{
    Settings,
    block::blocks_for,
    budget::Budget,
    compiled::{self, Ready},
    radiance,
    tracks::{Shares, Track, Tracks},
};
use crate::{
    bsdf::Transport,
    film::Film,
    guide::{Guide, Learnt, Lesson},
    math::{Channels, Spectrum, SpectrumExt, Vec2, Vec3},
    sampling::{Sampler, Thinning},
    scene::{
        Scene,
        lights::{Densities, EmissionSample, EmitterSample, Lights, Start, Starts},
    },
    settings::options::{Effort, Guiding},
    transport::{
        Connections, Contribution, Departure, Heuristic, MisSums, Options, Strategies, Vertex,
        observer::{Meeting, Observer, StrategyKind},
        profile::{Profile, ProfileName},
    },
};
use rayon::prelude::*;
use std::{collections::HashMap, ops::Range, sync::Arc};

/// Of its random numbers; the same for all images of a scene, so that all of them are made alike.
const SEED: u64 = 0x7374_6172_7473;
/// Camera subpaths of the first round; each of the others has twice as many as the one before.
const FIRST: usize = 2048;
/// Rounds before an image is begun.
pub(super) const ROUNDS: usize = 4;
/// Of a guide, as many more as it takes to learn something, and to follow what is new in it, and while that brings much; up to so
/// many.
const FOLLOWED: usize = 6;
/// What two rounds leave of the second moment, at most, where they bring much.
const BRINGS: f64 = 0.9;
/// Rounds in all, of which the last two teach a guide.
const MOST_ROUNDS: usize = 8;
/// Of these, as many as there are at most while it is made.
pub(super) const LATER_ROUNDS: usize = MOST_ROUNDS - ROUNDS;
/// Samples of an image for each camera subpath of the first rounds that are learnt while it is made, before what they learn is worth
/// its time: a path that teaches takes 3 times as long as one of the image by camera and light subpaths, and some 10 times as long
/// by camera subpaths alone.
const PER_SUBPATH: f64 = 8.0;
const PER_CAMERA_SUBPATH: f64 = 24.0;
/// Segments after which no further round begins, without a guide and for one.
const SEGMENTS: f64 = 1e6;
const GUIDE_SEGMENTS: f64 = 4e6;
/// From so many rounds on a guide is given up where it does not seem to pay; where nothing is learnt, after one more.
const JUDGING_ROUNDS: usize = 3;
/// What a guide that pays leaves of the second moment, at most, by camera subpaths alone: looking up takes a sixth of the time, and
/// learning some.
const PAYS: f64 = 0.75;
/// The same by light subpaths too: connections look up at both ends, by which samples were seen to take 1.7 times as long.
const PAYS_CONNECTED: f64 = 0.5;
/// Tiles with the greatest second moments that are left out of it, as few samples decide there.
const OUTLIERS: f64 = 0.04;
/// Longest path: later vertices tell little of where light starts.
const DEEPEST: u32 = 32;
/// The image is divided into so many tiles across and down, at most, whose pixels count as one.
const TILES: u32 = 8;
/// Lessons for the guide from each camera subpath of a round, at most on average.
const LESSONS: f64 = 3.0;
/// Of the image's mean, added to that of each tile.
const FLOOR: f64 = 0.1;

/// What renders by `settings` learn before their first sample: where light subpaths start that reach the image, where walks go,
/// and what camera subpaths end in, as far as they ask for it. Kept with the scene.
pub fn learn_for(scene: &Scene, film: &Film, settings: &Settings) -> Learnt {
    learn_rounds(scene, film, settings, ROUNDS)
}

/// The rounds whose guide the samples of `pass` follow, one of each pixel: the more samples there are before it, the more is
/// learnt, as the root of their number, for each round brings less than the one before. It is the same whatever samples a render
/// begins with.
pub fn rounds_for(film: &Film, settings: &Settings, pass: usize) -> usize {
    let light = settings.options.strategies.need_light_walks();
    let least = FIRST as f64 * if light { PER_SUBPATH } else { PER_CAMERA_SUBPATH };
    let subpaths = film.len() as f64 * pass as f64;
    let is_due = |rounds: &usize| subpaths >= least * (1_usize << (2 * rounds - ROUNDS - 1)) as f64;
    (ROUNDS + 1..=MOST_ROUNDS).take_while(is_due).last().unwrap_or(ROUNDS)
}

/// Learns a guide for `settings` by so many `rounds`; false if it `is_over` before.
pub(super) fn learn_until(
    scene: &Scene,
    film: &Film,
    settings: &Settings,
    rounds: usize,
    is_over: &(dyn Fn() -> bool + Sync),
) -> bool {
    Training::recall(scene, film, Wanted::by(settings.options, true)).go_on(rounds, is_over).is_some()
}

/// What renders by `settings` learn by so many `rounds`.
pub fn learn_rounds(scene: &Scene, film: &Film, settings: &Settings, rounds: usize) -> Learnt {
    let Options { strategies, effort, max_depth, .. } = settings.options;
    let wanted = Wanted::by(settings.options, follows_guide(scene, film, settings));
    let after = |rounds| match wanted {
        Wanted { starts: None, guide: None, .. } => Learnt::default(),
        _ => {
            let training = &mut Training::recall(scene, film, wanted);
            let learnt = training.go_on(rounds, &|| false).unwrap_or_default();
            Learnt { starts: learnt.starts.filter(|_| effort.learnt_starts), ..learnt }
        }
    };
    let first = after(ROUNDS);
    let learnt = if rounds > ROUNDS { after(rounds) } else { first.clone() };
    // Camera subpaths that end before they gather need nothing to end in.
    if !strategies.gather || max_depth.is_some_and(|depth| depth <= 2) {
        return learnt;
    }
    let most_bounces = radiance::most_bounces(max_depth);
    let settings = of_learning(wanted.options);
    let radiance = || Arc::new(radiance::learn(scene, film, &settings, &first, most_bounces));
    let key = format!("{} {most_bounces}", wanted.key(film));
    Learnt { radiance: Some(scene.lights.radiance.recall(key, radiance)), ..learnt }
}

/// True if walks by `settings` follow a guide.
pub fn follows_guide(scene: &Scene, film: &Film, settings: &Settings) -> bool {
    match settings.options.effort.guide {
        Guiding::Usual | Guiding::Never => false,
        Guiding::Always => true,
        Guiding::Auto => guide_pays(scene, film, settings.options),
    }
}

/// True if it would pay that walks by `options` follow a guide, as the first rounds of learning it foresee.
pub fn guide_pays(scene: &Scene, film: &Film, options: Options) -> bool {
    Training::recall(scene, film, Wanted::by(options, true)).pays()
}

/// What is to be learnt.
#[derive(Clone, Copy, Debug)]
struct Wanted {
    /// Starts of light subpaths, which compete with other strategies or do not.
    starts: Option<bool>,
    /// A guide, for these strategies.
    guide: Option<Strategies>,
    /// What it is learnt by.
    options: Options,
}

impl Wanted {
    /// For renders by `options`, which follow a guide or do not.
    fn by(options: Options, guided: bool) -> Self {
        let Options { strategies, effort, max_depth, .. } = options;
        Self {
            // Camera subpaths that never hit an emitter share nothing with light subpaths. A guide of both is learnt with starts
            // whether they are wanted or not, so that a pilot that tries both, and what it chooses, share it; one of camera
            // subpaths alone is better learnt without.
            starts: (effort.learnt_starts || guided && strategies.need_light_walks())
                .then_some(strategies.emitter_hit),
            // What a pilot leaves out later changes nothing.
            guide: guided.then_some(if strategies.need_light_walks() {
                Strategies::BDPT
            } else {
                strategies
            }),
            options: Options {
                strategies: Strategies::BDPT,
                effort: Effort::default(),
                connections: Connections::default(),
                heuristic: Heuristic::Balance,
                max_depth: Some(max_depth.map_or(DEEPEST, |depth| depth.min(DEEPEST))),
                forced_interaction: false,
                ..options
            },
        }
    }

    /// Equal where the same is learnt.
    fn key(&self, film: &Film) -> String {
        format!("{:?} {self:?}", (film.window, film.border, film.filter))
    }
}

/// Samples of `options` that teach.
fn of_learning(options: Options) -> Settings {
    Settings {
        options,
        seed: SEED,
        sampler: Sampler::Independent,
        budget: Budget::ENDLESS,
        profile: ProfileName::Everything,
    }
}

/// What a scene teaches, round by round.
struct Training<'a> {
    scene: &'a Scene,
    film: &'a Film,
    wanted: Wanted,
    known: Known,
}

/// What is known by now.
#[derive(Clone, Default)]
struct Known {
    /// After each round, for those walks that a render runs.
    learnt: Vec<Learnt>,
    /// After the last, for all walks.
    latest: Learnt,
    /// Of the last round.
    lessons: Arc<Vec<Lesson>>,
    /// Blocks of passes that were traced, and their segments.
    tasks: usize,
    segments: f64,
}

impl<'a> Training<'a> {
    /// As far as it is known with the scene.
    fn recall(scene: &'a Scene, film: &'a Film, wanted: Wanted) -> Self {
        let known = scene.lights.learnt.known(&wanted.key(film)).unwrap_or_default();
        Self { scene, film, wanted, known }
    }

    /// What there is to follow after so many rounds and those that follow what was new by then; none if it `is_over` before.
    fn go_on(&mut self, rounds: usize, is_over: &(dyn Fn() -> bool + Sync)) -> Option<Learnt> {
        let had = self.known.learnt.len();
        while self.after(rounds).is_none() && self.round(is_over) {}
        if self.known.learnt.len() > had {
            self.keep();
        }
        self.after(rounds).cloned()
    }

    fn keep(&self) {
        self.scene.lights.learnt.keep(self.wanted.key(self.film), self.known.clone());
    }

    fn after(&self, rounds: usize) -> Option<&Learnt> {
        let done = self.known.learnt.len();
        let last = (rounds..=done).find(|rounds| self.is_settled(*rounds));
        self.known.learnt.get(last.or(self.has_ended().then_some(done))? - 1)
    }

    /// True once no further round should begin.
    fn has_ended(&self) -> bool {
        let most = if self.wanted.guide.is_some() { GUIDE_SEGMENTS } else { SEGMENTS };
        self.known.segments > most
    }

    /// True if what is learnt after so many rounds need not be tried out by another.
    fn is_settled(&self, rounds: usize) -> bool {
        rounds >= FOLLOWED || !self.is_new(rounds) && !self.brings_much(rounds)
    }

    /// True if guides get better so fast that an image had better wait for the next.
    fn brings_much(&self, rounds: usize) -> bool {
        let left = |rounds| self.guide(rounds).map_or(1.0, |guide| guide.second_moment);
        self.wanted.guide.is_some() && left(rounds) < BRINGS * left(rounds.saturating_sub(2))
    }

    /// The guide after so many rounds.
    fn guide(&self, rounds: usize) -> Option<&Guide> {
        self.known.learnt.get(rounds.checked_sub(1)?)?.guide.as_deref()
    }

    /// True if nothing is known of what the guide learnt last would bring: there is none yet, or it is the first, with portals or
    /// at all.
    fn is_new(&self, rounds: usize) -> bool {
        let has_portals = |guide: &Guide| !guide.portals().is_empty();
        let is_first = |guide| {
            self.guide(rounds - 1).is_none_or(|followed| has_portals(guide) && !has_portals(followed))
        };
        self.wanted.guide.is_some() && self.guide(rounds).is_none_or(is_first)
    }

    /// True if a guide pays; what is learnt is kept then.
    fn pays(&mut self) -> bool {
        for rounds in 1.. {
            while self.known.learnt.len() < rounds {
                self.round(&|| false);
            }
            let is_last = rounds >= ROUNDS && self.is_settled(rounds)
                || self.has_ended() && rounds == self.known.learnt.len();
            if !self.may_pay(rounds, is_last) {
                return false;
            }
            if is_last {
                break;
            }
        }
        self.keep();
        true
    }

    /// False where after so many rounds a guide does not seem to leave less of the second moment than one that pays, or in the end
    /// was not seen to. What portals give is seen in the round after that in which they are found.
    fn may_pay(&self, rounds: usize, is_last: bool) -> bool {
        let Some(guide) = self.guide(rounds) else { return rounds <= JUDGING_ROUNDS };
        let connects = self.wanted.guide.is_some_and(|strategies| strategies.need_light_walks());
        let bound = if connects { PAYS_CONNECTED } else { PAYS };
        guide.second_moment < bound || !is_last && (self.is_new(rounds) || rounds < JUDGING_ROUNDS)
    }

    /// One more round; false if it `is_over` before it ends.
    fn round(&mut self, is_over: &(dyn Fn() -> bool + Sync)) -> bool {
        let Self { scene, film, wanted, known } = self;
        let subpaths = FIRST << known.learnt.len();
        let tasks = known.tasks..known.tasks + blocks_for(film.len(), subpaths);
        let end = tasks.end;
        let settings = of_learning(wanted.options);
        let followed = known.latest.clone();
        let trial = compiled::trial(scene, film, &settings, followed, tasks, wanted.guide.is_some(), is_over);
        let Some(trial) = trial else { return false };
        (known.tasks, known.segments) = (end, known.segments + trial.segments);
        if let Some(compete) = wanted.starts {
            known.latest.starts = Starts::learn(&scene.lights, trial.weights(compete)).map(Arc::new);
        }
        let mut learnt = known.latest.clone();
        if let Some(strategies) = wanted.guide {
            let lessons = trial.lessons(strategies, subpaths as f64);
            let left = |guide: &Arc<Guide>| trial.second_moment(strategies, guide);
            let second_moment = known.latest.guide.as_ref().map_or(1.0, left);
            let guide = Guide::learn([&known.lessons[..], &lessons].concat(), wanted.options.basis);
            let guide = guide.map(|guide| Arc::new(guide.judged(second_moment)));
            known.lessons = Arc::new(lessons);
            known.latest.guide.clone_from(&guide);
            // Light's walks found paths for those of the camera, which go on alone.
            learnt.guide = match strategies.need_light_walks() {
                true => guide,
                false => guide.map(|guide| Arc::new(Guide::clone(&guide).only(Transport::Radiance))),
            };
        }
        known.learnt.push(learnt);
        true
    }
}

/// Follows walks, to tell where the light of each contribution starts.
pub(super) struct Follower<'a> {
    lights: &'a Lights,
    starts: Option<&'a Starts>,
    /// The last vertex of the walk at hand, or where it set out from.
    last: Vec3,
    hero: usize,
    walks: u32,
    /// That of the light subpath at hand.
    current: Option<Followed>,
    /// Those of the vertices in the cache, per hero channel in the cache's order.
    kept: Vec<Vec<Followed>>,
}

/// Where light starts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Followed {
    pub start: Start,
    /// How often light subpaths start there without what was learnt, over how often they do.
    pub unlearnt: f32,
    /// The number of the light subpath that did.
    walk: Option<u32>,
}

impl<'a> Follower<'a> {
    pub fn new(lights: &'a Lights, starts: Option<&'a Starts>, heroes: usize) -> Self {
        Self {
            lights,
            starts,
            last: Vec3::ZERO,
            hero: 0,
            walks: 0,
            current: None,
            kept: vec![Vec::new(); heroes],
        }
    }

    /// To follow camera subpaths that are connected to the vertices kept here.
    pub fn of_cache(self) -> Self {
        Self { current: None, ..self }
    }

    /// A camera subpath of channel `hero` follows.
    pub fn begin(&mut self, hero: usize) {
        self.hero = hero;
    }

    pub fn emit(&mut self, sample: &EmissionSample, hero: usize) {
        self.hero = hero;
        let start = sample.start();
        let learnt = Densities { point: sample.pdf, direction: sample.pdf_direction };
        let walk = Some(self.walks);
        self.walks += 1;
        self.current = Some(Followed { start, unlearnt: ratio(sample.unlearnt, learnt), walk });
    }

    pub fn depart<S: MisSums>(&mut self, departure: &Departure<S>) {
        self.last = departure.position;
    }

    pub fn arrive<S: MisSums>(&mut self, vertex: &Vertex<S>) {
        self.last = vertex.position();
    }

    pub fn keep(&mut self) {
        self.kept[self.hero].extend(self.current);
    }

    /// How often light subpaths start like the one at hand without what was learnt, over how often they do.
    pub fn unlearnt(&self) -> f32 {
        self.current.map_or(1.0, |followed| followed.unlearnt)
    }

    /// Where the light of a contribution starts; none where it comes straight from the emitter to the lens.
    pub fn start<S: MisSums>(&self, s: u32, t: u32, meeting: &Meeting<'_, S>) -> Option<Followed> {
        match meeting {
            _ if s + t < 3 => None,
            Meeting::Light(index, _) => Some(self.kept[self.hero][*index]),
            Meeting::Lens(_) => self.current,
            Meeting::Met(subpath, sample) => Some(self.found(sample, self.last, subpath.incoming)),
            Meeting::Emitter(sample) => self.joined(sample, self.last),
            Meeting::Pivot(_, vertex, sample) => self.joined(sample, vertex.position()),
        }
    }

    fn joined(&self, sample: &EmitterSample, reference: Vec3) -> Option<Followed> {
        let (direction, _) = sample.point.seen_from(reference)?;
        Some(self.found(sample, reference, -direction))
    }

    fn found(&self, sample: &EmitterSample, reference: Vec3, direction: Vec3) -> Followed {
        let start = Start::towards(sample.light, &sample.point, reference, direction);
        let unlearnt = Densities { point: sample.pdf_start, direction: sample.pdf_direction };
        let learnt = self.starts.map(|starts| starts.densities(self.lights, &start, unlearnt));
        Followed { start, unlearnt: learnt.map_or(1.0, |learnt| ratio(unlearnt, learnt)), walk: None }
    }
}

fn ratio(unlearnt: Densities, learnt: Densities) -> f32 {
    let ratio = unlearnt.both() / learnt.both();
    if ratio.is_finite() { ratio } else { 1.0 }
}

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
    segments: f64,
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
    fn weights(&self, compete: bool) -> Vec<(Start, f32)> {
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
    fn second_moment(&self, strategies: Strategies, guide: &Guide) -> f64 {
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
    fn lessons(&self, strategies: Strategies, samples: f64) -> Vec<Lesson> {
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

/// The tiles of an image, whose pixels count as one.
pub(super) struct Tiles {
    width: u32,
    height: u32,
    across: u32,
    down: u32,
}

impl Tiles {
    /// At most so `many` across and down.
    pub fn of(film: &Film, many: u32) -> Self {
        let (width, height) = (film.width, film.height);
        Self { width, height, across: width.min(many), down: height.min(many) }
    }

    /// That of a pixel.
    pub fn at(&self, pixel: u32) -> usize {
        let Self { width, height, across, down } = *self;
        (pixel / width * down / height * across + pixel % width * across / width) as usize
    }

    /// How many pixels each has.
    pub fn pixels(&self) -> Vec<f64> {
        let mut pixels = vec![0.0; (self.across * self.down) as usize];
        (0..self.width * self.height).for_each(|pixel| pixels[self.at(pixel)] += 1.0);
        pixels
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        format,
        scene::build::{self, Setup},
        settings::Overrides,
        testing,
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
            let options = Options { strategies: Strategies::BDPT, ..integrator.options };
            let wanted = Wanted::by(options, true);
            let wanted = Wanted { starts: None, ..wanted };
            let learnt = Training::recall(&scene, &film, wanted).go_on(FOLLOWED, &|| false).unwrap();
            let tasks = blocks_for(film.len(), 1 << 17);
            let trial = |learnt: &Learnt, tasks: Range<usize>| {
                let settings = of_learning(wanted.options);
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
