//! Pilots: a few samples by all strategies, which tell how well any other counts of samples would do.
//!
//! By the balance heuristic, a sample that brought y has the second moment y^2 (sum of n p) / (sum of n' p) under counts n'
//! in place of n (after Grittmann et al. 2022, Efficiency-Aware Multiple Importance Sampling). So paths that strategies left
//! out would have to make count in full, however rarely the others make them: the strategies that do run have seen them.
//! Where light subpaths begin at learnt starts, each contribution also tells how often they would begin there otherwise; and
//! if walks went on with a constant part of today's probability, its number of vertices tells how often they would get there.
//! What samples of one pixel have in common is taken to stay as it is, or to weigh more by as much as they do.

use super::{
    Settings,
    block::Blocks,
    compiled::{self, Ready},
    follower::Follower,
    groups::Tiles,
    training,
};
use crate::{
    film::Film,
    math::{Channels, Spectrum, SpectrumExt, Vec2},
    sampling::Sampler,
    scene::{Scene, lights::EmissionSample},
    settings::options::{Effort, Guiding, Survival},
    transport::{
        Contribution, Departure, MisSums, Options, Strategies, Vertex, equiangular_applies,
        observer::{Meeting, Observer, StrategyKind},
        profile::Profile,
    },
};
use rayon::prelude::*;
use std::{
    collections::HashMap,
    panic::{AssertUnwindSafe, catch_unwind},
};

/// Of its random numbers; the same for all images of a scene, so that all of them are made alike.
const SEED: u64 = 0x7079_6c6f_7473;
/// Samples of each pixel that takes part: enough for a variance.
const PASSES: usize = 8;
/// Segments after which no further pass begins, but for the second one: where walks are long, few say enough.
const SEGMENTS: f64 = 2e6;
/// Longest path. Where walks hardly ever end, what comes later would be most of the time and little of the light.
const DEEPEST: u32 = 256;
/// Blocks of pixels that take part, at most.
const BLOCKS: usize = 2;
/// The image is divided into so many tiles across and down, at most, whose pixels count as one.
const TILES: u32 = 16;
/// Tiles with the greatest errors that are left out, as few samples decide there.
const OUTLIERS: f64 = 0.02;
/// By how much more than others learnt starts must be better. Light subpaths that reach the image, and connections to them,
/// take up to twice the time of those that do not, which counts do not say; and pilots find the noise of learnt starts less than
/// it turns out to be (they say 3.5 times better where the sun shines into a chapel and 1.5 times behind a frosted pane, of which
/// 1.7 and 1.0 are true).
const LEARNT: f64 = 3.0;
/// Starts are learnt if no more than this part of the light subpaths is seen, and some are worth tracing: training takes as long as
/// a pilot. Measured: of a scene lit through a small opening 0.0006, behind a frosted pane 0.02 and in a chapel 0.03.
const REMOTE: f64 = 0.03;
/// The same where none seem worth it: so few say little of that, nor of how seldom others find what they do.
const HIDDEN: f64 = 0.005;
/// Squared relative error of a pixel sample, where light is seen, above which it is asked whether a guide pays: where it is less,
/// asking takes longer than a guide could gain. Measured: 61 in a room lit through its keyhole and 40 under a skylight, where one
/// pays for all strategies; 4 to 27 in others lit through openings and round corners, where none does; 0.1 to 1.2 elsewhere.
const NOISY: f64 = 2.0;
/// Of a tile's second moment: variances below are rounding errors.
const LEAST_VARIANCE: f64 = 1e-3;
/// Other counts than all strategies' must be so much better: pilots are noisy.
const WORTHWHILE: f64 = 1.1;

/// Time of parts of a sample, over that of a segment of a walk, as measured in scenes of fog and smoke.
mod time {
    /// Setting out from the sensor or an emitter.
    pub const START: f64 = 0.5;
    /// The part of it that is spent on light subpaths which do not set out.
    pub const DROPPED: f64 = 0.1;
    /// A connection tried, by kind of strategy.
    pub const TRY: [f64; 5] = [0.1, 1.3, 0.7, 0.4, 2.0];
}

/// Survivals that are a constant part of the albedo: one pilot tells of all of them.
const OF_ALBEDO: [Survival; 3] = [Survival::Albedo, Survival::Shorter, Survival::Shortest];
/// That of each pilot, and those that it tells of.
const SURVIVALS: [(Survival, &[Survival]); 2] =
    [(Survival::Albedo, &OF_ALBEDO), (Survival::FourthRoot, &[Survival::FourthRoot])];

/// What was chosen, and how much it is worth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// Strategies that it could choose among, and equiangular sampling, which all of them do without.
    pub among: Strategies,
    /// Strategies that run.
    pub strategies: Strategies,
    /// How often.
    pub effort: Effort,
    /// Error x time by all strategies at equal effort, over that of this choice, as the pilot sees it.
    pub gain: f64,
}

/// The strategies among those of `settings` that are worth their time on `film`, how often, when walks end, and whether they
/// follow a guide; whether light subpaths begin at learnt `starts` may be decided already; `is_complete` says which sets of
/// strategies leave no light out.
pub fn choose(
    scene: &Scene,
    film: &Film,
    settings: &Settings,
    starts: Option<bool>,
    is_complete: &dyn Fn(Strategies) -> bool,
) -> Choice {
    let all = settings.options.strategies;
    let asks = match settings.options.effort.guide {
        Guiding::Usual => all == Strategies::BDPT,
        said => said == Guiding::Auto,
    };
    let guide = if asks { Guiding::Never } else { settings.options.effort.guide };
    let learnt_starts = starts == Some(true) && all.need_light_walks();
    let effort = Effort { learnt_starts, guide, ..Effort::default() };
    let base = Choice { among: all, strategies: all, effort, gain: 1.0 };
    if scene.lights.is_empty() {
        return base;
    }
    let pilots = Pilots { scene, film, settings, starts, is_complete, base };
    let fly = || pilots.choose(asks);
    // Renders survive a panic and say where it was.
    catch_unwind(AssertUnwindSafe(fly)).unwrap_or(base)
}

/// Those that are flown for one choice, and what they may choose.
#[derive(Clone, Copy)]
struct Pilots<'a> {
    scene: &'a Scene,
    film: &'a Film,
    settings: &'a Settings,
    starts: Option<bool>,
    is_complete: &'a dyn Fn(Strategies) -> bool,
    /// All strategies, with the guide and the starts that there are before any pilot.
    base: Choice,
}

impl Pilots<'_> {
    /// The best choice; with a guide if one `asks` for it and it pays.
    fn choose(&self, asks: bool) -> Choice {
        let pilots = self.fly(self.base.effort.learnt_starts);
        let is_noisy = || pilots[0].error_where_lit(&self.base) > NOISY;
        if asks && is_noisy() && training::guide_pays(self.scene, self.film, self.settings.options) {
            let effort = Effort { guide: Guiding::Always, ..self.base.effort };
            return Self { base: Choice { effort, ..self.base }, ..*self }.choose(false);
        }
        let best = self.best_of(&pilots);
        let most = if best.strategies.need_light_walks() { REMOTE } else { HIDDEN };
        let is_remote = self.starts.is_none() && pilots[0].seen_subpaths().is_some_and(|seen| seen <= most);
        if is_remote { self.best_of(&self.fly(true)) } else { best }
    }

    /// One by each of [`SURVIVALS`].
    fn fly(&self, learnt_starts: bool) -> [Pilot; SURVIVALS.len()] {
        let options = Options { strategies: self.strategies(), ..self.settings.options };
        let settings = Settings { options, ..*self.settings };
        SURVIVALS.map(|(survival, _)| {
            let effort = Effort { survival, learnt_starts, ..self.base.effort };
            pilot(self.scene, self.film, &settings, effort)
        })
    }

    /// All that may run: equiangular sampling, too, where it applies.
    fn strategies(&self) -> Strategies {
        let all = self.base.among;
        let equiangular = all == Strategies::BDPT && equiangular_applies(self.scene);
        Strategies { equiangular, ..all }
    }

    /// The best of the choices that `pilots` may make; that of all strategies if none is clearly better.
    fn best_of(&self, pilots: &[Pilot; SURVIVALS.len()]) -> Choice {
        let base = self.base;
        let error_time = |choice: &Choice, pilot: &Pilot| pilot.error(choice) * pilot.time(choice);
        let reference = error_time(&base, &pilots[0]);
        let mut choices = Vec::new();
        for (pilot, (_, survivals)) in pilots.iter().zip(SURVIVALS) {
            let by_survival = |survival: &Survival| self.allowed(*survival, pilot.is_learnt);
            choices.extend(survivals.iter().flat_map(by_survival).map(|choice| (choice, pilot)));
        }
        let judge = |(choice, pilot): (Choice, &Pilot)| Choice {
            gain: reference / error_time(&choice, pilot),
            ..choice
        };
        let judged: Vec<Choice> = choices.into_par_iter().map(judge).collect();
        let best = judged.into_iter().max_by(|a, b| a.worth().total_cmp(&b.worth()));
        best.filter(|best| best.worth() > WORTHWHILE * base.worth() && best.gain.is_finite()).unwrap_or(base)
    }

    /// The choices by `survival`, with learnt starts too if a pilot knows of them, that leave no light out and nothing open that
    /// is decided.
    fn allowed(&self, survival: Survival, learnt_starts: bool) -> Vec<Choice> {
        let may = |choice: &Choice| {
            let Choice { strategies, effort, .. } = choice;
            let decided = |learnt| !strategies.need_light_walks() || effort.learnt_starts == learnt;
            (self.is_complete)(*strategies) && self.starts.is_none_or(decided)
        };
        let effort = Effort { survival, learnt_starts, ..self.base.effort };
        let all = candidates(self.strategies(), effort).filter(may);
        all.map(|choice| Choice { among: self.base.among, ..choice }).collect()
    }
}

/// A few samples of all strategies of `settings`, with `effort` in its place.
fn pilot(scene: &Scene, film: &Film, settings: &Settings, effort: Effort) -> Pilot {
    let max_depth = Some(settings.options.max_depth.map_or(DEEPEST, |depth| depth.min(DEEPEST)));
    let options = Options { effort, max_depth, ..settings.options };
    let settings = Settings { options, seed: SEED, sampler: Sampler::Independent, ..*settings };
    compiled::pilot(scene, film, &settings)
}

/// Every choice among the strategies of `all` that is like `effort` but for its counts, and for learnt starts if it has them.
fn candidates(all: Strategies, effort: Effort) -> impl Iterator<Item = Choice> {
    let optional = [all.next_event, all.connection, all.lens, all.equiangular];
    let has = move |bits: u32| (0..4).all(|bit| bits >> bit & 1 == 0 || optional[bit as usize]);
    let sets = (0..16u32).filter(move |bits| has(*bits)).map(move |bits| Strategies {
        next_event: all.next_event && bits & 1 == 0,
        connection: all.connection && bits & 2 == 0,
        lens: all.lens && bits & 4 == 0,
        equiangular: all.equiangular && bits & 8 == 0,
        ..all
    });
    sets.flat_map(move |strategies| {
        let connections: &[u32] = if strategies.connection { &[1, 2, 4] } else { &[1] };
        let usual: &[f32] = if strategies.need_light_walks() { &[0.5, 1.0, 2.0] } else { &[1.0] };
        // Some of these are dropped as they begin.
        let more: &[f32] =
            if effort.learnt_starts && strategies.need_light_walks() { &[0.5, 1.0, 2.0, 4.0] } else { &[] };
        let light_walks =
            usual.iter().map(|walks| (*walks, false)).chain(more.iter().map(|walks| (*walks, true)));
        let efforts = light_walks.flat_map(move |(light_walks, learnt_starts)| {
            connections.iter().map(move |connections| Effort {
                light_walks,
                connections: *connections,
                learnt_starts,
                ..effort
            })
        });
        efforts.map(move |effort| Choice { among: all, strategies, effort, gain: 1.0 })
    })
}

/// A contribution to a tile.
struct Found {
    pixel: u32,
    /// Squared luminance; from [`Pilot`] on, its part in the second moment of a pixel sample in the tile.
    square: f64,
    shares: [f32; StrategyKind::ALL.len()],
    /// Vertices between the sensor and the emitter.
    vertices: u32,
    /// How often light subpaths would start there without learnt starts, over how often they do.
    unlearnt: f32,
}

/// How often something was done.
#[derive(Clone, Copy, Default)]
struct Work {
    walks: f64,
    /// Those that set out.
    begun: f64,
    segments: f64,
    tries: [f64; StrategyKind::ALL.len()],
    /// Vertices of light subpaths that are kept for connections.
    kept: f64,
    /// Light subpaths that the lens sees anything of.
    reaching: f64,
}

impl Work {
    fn and(mut self, other: &Self) -> Self {
        self.walks += other.walks;
        self.begun += other.begun;
        self.segments += other.segments;
        self.kept += other.kept;
        self.reaching += other.reaching;
        self.tries.iter_mut().zip(other.tries).for_each(|(tries, other)| *tries += other);
        self
    }
}

/// What the samples of one kind of walk bring.
#[derive(Default)]
struct Recorded {
    found: Vec<Found>,
    /// By each of [`OF_ALBEDO`], in place of the survival that there was as the albedo's.
    work: Works,
    /// The work of light subpaths without learnt starts.
    unlearnt: Works,
}

type Works = [Work; OF_ALBEDO.len()];

/// Sees walks and what they contribute; those of the camera to one pixel.
struct Recorder<'a> {
    film: &'a Film,
    follower: Follower<'a>,
    pixel: u32,
    weight: f32,
    sum: f64,
    /// The light subpath at hand is seen.
    is_seen: bool,
    /// How often the walk at hand would have gone on so far, by each of [`OF_ALBEDO`].
    reached: [f64; OF_ALBEDO.len()],
    recorded: Recorded,
}

impl<'a> Recorder<'a> {
    fn new(film: &'a Film, follower: Follower<'a>) -> Self {
        Self {
            film,
            follower,
            pixel: 0,
            weight: 1.0,
            sum: 0.0,
            is_seen: false,
            reached: [1.0; OF_ALBEDO.len()],
            recorded: Recorded::default(),
        }
    }

    /// The sum of what a camera subpath of channel `hero` contributes to `pixel` follows, times `weight`.
    fn begin(&mut self, pixel: usize, hero: usize, weight: f32) {
        self.follower.begin(hero);
        (self.pixel, self.weight, self.sum) = (pixel as u32, weight, 0.0);
        self.recorded.work.iter_mut().for_each(|work| work.walks += 1.0);
    }

    /// Counts some work of the walk at hand.
    fn count(&mut self, counter: impl Fn(&mut Work) -> &mut f64) {
        let unlearnt = f64::from(self.follower.unlearnt());
        let Recorded { work, unlearnt: works, .. } = &mut self.recorded;
        for ((reached, work), works) in self.reached.iter().zip(work).zip(works) {
            *counter(work) += reached;
            *counter(works) += reached * unlearnt;
        }
    }
}

impl<S: MisSums> Observer<S> for Recorder<'_> {
    fn covers(&self, film: Vec2) -> bool {
        self.film.covers(film)
    }

    fn emit(&mut self, start: &EmissionSample, hero: usize) {
        self.follower.emit(start, hero);
        self.is_seen = false;
    }

    fn depart(&mut self, departure: &Departure<S>) {
        self.follower.depart(departure);
        self.reached = OF_ALBEDO.map(|survival| f64::from(survival.factor()).powi(departure.edges as i32));
        self.count(|work| &mut work.segments);
        if departure.edges == 0 {
            self.count(|work| &mut work.begun);
        }
    }

    fn arrive(&mut self, vertex: &Vertex<S>) {
        self.follower.arrive(vertex);
    }

    fn keep(&mut self) {
        self.follower.keep();
        self.count(|work| &mut work.kept);
    }

    fn stop(&mut self, kind: StrategyKind, _: u32, _: u32) {
        self.count(|work| &mut work.tries[kind as usize]);
    }

    fn contribute(&mut self, s: u32, t: u32, meeting: Meeting<'_, S>, contribution: Option<&Contribution>) {
        let Some(Contribution { value, shares, .. }) = contribution.filter(|c| c.value.is_finite()) else {
            return;
        };
        let unlearnt = self.follower.start(s, t, &meeting).map_or(1.0, |followed| followed.unlearnt);
        let found = &mut self.recorded.found;
        let mut add = |pixel: u32, value: Spectrum| {
            let luminance = f64::from(value.luminance());
            let square = luminance * luminance;
            found.push(Found { pixel, square, shares: *shares, vertices: s + t - 2, unlearnt });
        };
        if let Meeting::Lens(film) = meeting {
            if !self.is_seen {
                self.recorded.work.iter_mut().for_each(|work| work.reaching += 1.0);
                self.is_seen = true;
            }
            return self.film.spread(film, *value, |pixel, value| add(pixel as u32, value));
        }
        let value = *value * self.weight;
        add(self.pixel, value);
        self.sum += f64::from(value.luminance());
    }
}

/// What one block of one pass brings.
pub(super) struct Part {
    camera: Recorded,
    light: Recorded,
    /// Pixels with what camera subpaths contribute to them.
    sums: Vec<(u32, f64)>,
}

impl Part {
    fn segments(&self) -> f64 {
        self.camera.work[0].segments + self.light.work[0].segments
    }
}

/// The samples of `block` in `pass`.
pub(super) fn part<P: Profile>(ready: &Ready<'_, P>, pass: usize, block: usize) -> Part {
    let Ready { estimator, blocks, scene, film, seed } = ready;
    let follower = Follower::new(&scene.lights, estimator.starts(), P::Channels::COUNT);
    let mut light = Recorder::new(film, follower);
    let mut observer: &mut dyn Observer<P::MisSums> = &mut light;
    let cache = blocks.trace_light(estimator, *seed, pass, block, &mut observer);
    let walks = if estimator.needs_light_walks() { blocks.walks_per_block() as f64 } else { 0.0 };
    let Recorded { work, unlearnt, .. } = &mut light.recorded;
    work.iter_mut().chain(unlearnt).for_each(|work| work.walks = walks);
    let mut camera = Recorder::new(film, light.follower.of_cache());
    let sums = blocks.pixels(block).map(|pixel| {
        let start = blocks.camera_start(scene, film, *seed, pass, pixel);
        camera.begin(pixel, start.hero, start.weight);
        let observer: &mut dyn Observer<P::MisSums> = &mut camera;
        start.trace(estimator, &cache, observer);
        (pixel as u32, camera.sum)
    });
    let sums = sums.collect();
    Part { camera: camera.recorded, light: light.recorded, sums }
}

/// A set of pixels that lie together.
#[derive(Clone, Copy, Default)]
struct Tile {
    pixels: f64,
    /// Camera subpaths.
    samples: f64,
    mean: f64,
    /// The variance of a pixel sample by all strategies less its second moment as the sum of those of its contributions.
    rest: f64,
}

/// What the samples say.
pub(super) struct Pilot {
    tiles: Vec<Tile>,
    /// Contributions other than zero, each with its tile.
    found: Vec<(u32, Found)>,
    camera: Works,
    light: Works,
    /// That of light subpaths without learnt starts.
    light_unlearnt: Works,
    /// Light subpaths began at learnt starts.
    is_learnt: bool,
}

impl Pilot {
    /// Gathers the samples of `ready`.
    pub fn fly<P: Profile>(ready: &Ready<'_, P>) -> Self {
        let blocks = ready.blocks.count().min(BLOCKS);
        let mut parts: Vec<Part> = Vec::new();
        for pass in 0..PASSES {
            let done: f64 = parts.iter().map(Part::segments).sum();
            if pass >= 2 && done > SEGMENTS {
                break;
            }
            parts.par_extend((0..blocks).into_par_iter().map(|block| part(ready, pass, block)));
        }
        Self::of(parts, ready.film, &ready.blocks, ready.estimator.starts().is_some())
    }

    fn of(parts: Vec<Part>, film: &Film, blocks: &Blocks, is_learnt: bool) -> Self {
        let all = Tiles::of(film, TILES);
        let tile = |pixel| all.at(pixel);
        let mut tiles: Vec<Tile> =
            all.pixels().into_iter().map(|pixels| Tile { pixels, ..Tile::default() }).collect();
        for (pixel, _) in parts.iter().flat_map(|part| &part.sums) {
            tiles[tile(*pixel)].samples += 1.0;
        }
        let works: [fn(&Part) -> &Works; 3] =
            [|part| &part.camera.work, |part| &part.light.work, |part| &part.light.unlearnt];
        let [camera, light, light_unlearnt] = works.map(|works| {
            std::array::from_fn(|i| parts.iter().fold(Work::default(), |sum, part| sum.and(&works(part)[i])))
        });
        // Light subpaths traced stand for those of a pass.
        let per_pass = blocks.walks_per_pass() as f64 / light[0].walks.max(1.0);
        let variances = variances(&parts);
        let mut found = Vec::new();
        for part in parts {
            for (pixel, sum) in part.sums {
                let tile = &mut tiles[tile(pixel)];
                tile.mean += sum / tile.samples;
                tile.rest += variances[&pixel] / tile.samples;
            }
            for one in part.camera.found {
                let index = tile(one.pixel);
                let square = one.square / tiles[index].samples;
                tiles[index].rest -= square;
                found.push((index as u32, Found { square, ..one }));
            }
            for one in part.light.found {
                let index = tile(one.pixel);
                let scale = per_pass / tiles[index].pixels;
                tiles[index].mean += one.square.sqrt() * scale;
                found.push((index as u32, Found { square: one.square * scale, ..one }));
            }
        }
        found.retain(|(_, found)| found.square > 0.0);
        Self { tiles, found, camera, light, light_unlearnt, is_learnt }
    }

    /// The part of the light subpaths that is seen; none of none. Where it is small, it may be worth learning where light should start.
    fn seen_subpaths(&self) -> Option<f64> {
        let [Work { reaching, walks, .. }, ..] = self.light;
        (walks > 0.0).then(|| reaching / walks)
    }

    /// Time of a pixel sample, in segments.
    fn time(&self, Choice { strategies, effort, .. }: &Choice) -> f64 {
        let camera = &self.camera[index(effort.survival)];
        let light = self.light_work(effort);
        let longer = if effort.learnt_starts { LEARNT } else { 1.0 };
        let mut camera_time = time::START * camera.walks + camera.segments;
        let dropped = (light.walks - light.begun).max(0.0);
        let mut light_time = time::START * light.begun + time::DROPPED * dropped + light.segments;
        for kind in StrategyKind::ALL.into_iter().filter(|kind| strategies.has(*kind)) {
            let factor = if kind == StrategyKind::Connection { f64::from(effort.connections) } else { 1.0 };
            camera_time += factor * time::TRY[kind as usize] * camera.tries[kind as usize];
            light_time += time::TRY[kind as usize] * light.tries[kind as usize];
        }
        let light_walks = if strategies.need_light_walks() { f64::from(effort.light_walks) } else { 0.0 };
        longer * (camera_time / camera.walks.max(1.0) + light_walks * light_time / light.walks.max(1.0))
    }

    /// The squared relative error of a pixel sample, on average over the image, the worst tiles left out; infinite where light is
    /// left out in any of them.
    fn error(&self, choice: &Choice) -> f64 {
        let mut errors = self.errors(choice);
        errors.sort_unstable_by(f64::total_cmp);
        if errors.last().is_some_and(|worst| worst.is_infinite()) {
            return f64::INFINITY;
        }
        let kept = errors.len() - (OUTLIERS * errors.len() as f64) as usize;
        let pixels: f64 = self.seen().map(|(_, tile)| tile.pixels).sum();
        errors[..kept].iter().sum::<f64>() / pixels.max(1.0)
    }

    /// The same over the tiles that light was seen in, none of them left out: where few samples find any, the others look free of
    /// noise. Infinite where no light was seen at all.
    fn error_where_lit(&self, choice: &Choice) -> f64 {
        let is_lit = |(_, tile): &(usize, &Tile)| tile.mean > 0.0;
        let pixels: f64 = self.seen().filter(is_lit).map(|(_, tile)| tile.pixels).sum();
        if pixels > 0.0 { self.errors(choice).iter().sum::<f64>() / pixels } else { f64::INFINITY }
    }

    /// Those of the pixels of every tile, added up.
    fn errors(&self, choice: &Choice) -> Vec<f64> {
        let mut moments = vec![(0.0, 0.0); self.tiles.len()];
        let learnt = choice.effort.learnt_starts;
        // Connections to each vertex are as many, however many vertices light subpaths leave.
        let draws = self.light[0].kept.max(1.0) / self.light_work(&choice.effort).kept.max(1.0);
        let factor = choice.effort.survival.factor();
        let survived: Vec<f32> = (0..=DEEPEST).map(|vertices| factor.powi(vertices as i32)).collect();
        // Of all vertices between, both walks together went on from one less where they were connected to an emitter or the
        // lens, and from two less where they were connected to each other.
        let [hits, next_event, connections, lens, equiangular] =
            StrategyKind::each(|kind| choice.counts()[kind as usize] as f32 / factor);
        let (hits, connections) = (hits * factor, connections * draws as f32 / factor);
        for (tile, Found { square, shares, vertices, unlearnt, .. }) in &self.found {
            let begun = if learnt { 1.0 } else { *unlearnt };
            // Written out: all choices go through all contributions.
            let camera = shares[0] * hits + shares[1] * next_event + shares[4] * equiangular;
            let light = shares[2] * connections + shares[3] * lens;
            let moment = square / f64::from(camera + begun * light);
            let (moments, usual) = &mut moments[*tile as usize];
            *moments += moment / f64::from(survived[*vertices as usize]);
            *usual += moment;
        }
        let pixels: f64 = self.seen().map(|(_, tile)| tile.pixels).sum();
        let mean = self.seen().map(|(_, tile)| tile.pixels * tile.mean).sum::<f64>() / pixels.max(1.0);
        let floor = 0.01 * mean * mean;
        let relative = |(index, tile): (usize, &Tile)| {
            // What a walk contributes at several vertices weighs more by the same factor, where it goes on less often.
            let (moment, usual) = moments[index];
            let rest = if usual > 0.0 { tile.rest * moment / usual } else { tile.rest };
            let variance = (moment + rest).max(LEAST_VARIANCE * moment);
            tile.pixels * variance / (tile.mean * tile.mean + floor)
        };
        self.seen().map(relative).collect()
    }

    /// The work of light subpaths by `effort`.
    fn light_work(&self, effort: &Effort) -> &Work {
        let works = if effort.learnt_starts { &self.light } else { &self.light_unlearnt };
        &works[index(effort.survival)]
    }

    fn seen(&self) -> impl Iterator<Item = (usize, &Tile)> {
        self.tiles.iter().enumerate().filter(|(_, tile)| tile.samples > 0.0)
    }
}

/// Of the work by `survival` among that of a pilot.
fn index(survival: Survival) -> usize {
    OF_ALBEDO.iter().position(|of_albedo| *of_albedo == survival).unwrap_or(0)
}

impl Choice {
    /// Its gain, or what is left of that where it has to make up for what pilots do not see: of equiangular sampling, that no
    /// integrator has it of itself; of light subpaths, that evenly spread samples do less for them (under the sky of a pool
    /// they were found 5 % better than path tracing, and are 6 % worse).
    fn worth(&self) -> f64 {
        let costs = [self.strategies.equiangular, self.strategies.need_light_walks()];
        costs.into_iter().filter(|cost| *cost).fold(self.gain, |worth, _| worth / WORTHWHILE)
    }

    /// Samples of every kind of strategies, over those of all at equal effort.
    fn counts(&self) -> [f64; StrategyKind::ALL.len()] {
        StrategyKind::each(|kind| match kind {
            _ if !self.strategies.has(kind) => 0.0,
            StrategyKind::Connection => f64::from(self.effort.connections),
            StrategyKind::Lens => f64::from(self.effort.light_walks),
            _ => 1.0,
        })
    }
}

/// Sample variance of what camera subpaths contribute to each pixel that takes part.
fn variances(parts: &[Part]) -> HashMap<u32, f64> {
    let mut sums: HashMap<u32, (f64, f64, f64)> = HashMap::new();
    for (pixel, value) in parts.iter().flat_map(|part| &part.sums) {
        let (n, sum, square) = sums.entry(*pixel).or_default();
        *n += 1.0;
        *sum += value;
        *square += value * value;
    }
    let variance = |(n, sum, square): (f64, f64, f64)| ((square - sum * sum / n) / (n - 1.0)).max(0.0);
    sums.into_iter().map(|(pixel, sums)| (pixel, variance(sums))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        format,
        render::{budget::Budget, instrument::Instrument},
        scene::build::{self, Setup},
        settings::Overrides,
        transport::profile::ProfileName,
    };
    use std::path::Path;

    /// A small image of a scene, by `strategies`.
    fn small(scene: &str, strategies: Strategies) -> (Setup, Settings) {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(scene);
        let overrides = Overrides { size: Some((24, 24)), ..Overrides::default() };
        let setup = build::build(&format::read(&path, &[]).unwrap(), overrides).unwrap();
        let options = Options { strategies, ..setup.integrator.options };
        let (sampler, budget) = (Sampler::Independent, Budget::ENDLESS);
        (setup, Settings { options, sampler, budget, seed: 0, profile: ProfileName::Everything })
    }

    #[test]
    fn path_tracing_has_no_light_starts_to_learn() {
        let (setup, settings) = small("efficiency/glass_fog_sky.xml", Strategies::PT);
        let pilot = pilot(&setup.scene, &setup.film, &settings, Effort::default());
        assert_eq!(pilot.seen_subpaths(), None);
    }

    /// Relative variance of pixel samples, as their images show it.
    fn measured(instrument: &Instrument<'_>) -> f64 {
        let mut sums = vec![(0.0, 0.0); instrument.film.len()];
        let n = 400.0;
        instrument.passes(0..n as usize, &mut |image| {
            for ((sum, square), value) in sums.iter_mut().zip(image) {
                let luminance = f64::from(value.luminance());
                *sum += luminance;
                *square += luminance * luminance;
            }
        });
        let mean = sums.iter().map(|(sum, _)| sum / n).sum::<f64>() / sums.len() as f64;
        let relative = |(sum, square): &(f64, f64)| {
            let of_pixel = sum / n;
            (square / n - of_pixel * of_pixel) / (of_pixel * of_pixel + 0.01 * mean * mean)
        };
        let mut all: Vec<f64> = sums.iter().map(relative).collect();
        all.sort_unstable_by(f64::total_cmp);
        all[..(0.98 * sums.len() as f64) as usize].iter().sum::<f64>() / sums.len() as f64
    }

    /// A corner of the image that other strategies do not see decides against them, however small.
    #[test]
    fn what_a_choice_leaves_out_is_no_outlier() {
        let found = |shares| Found { pixel: 0, square: 1.0, shares, vertices: 1, unlearnt: 1.0 };
        let tiles = vec![Tile { pixels: 1.0, samples: 1.0, mean: 0.7, rest: 0.0 }; 100];
        let corner = |tile| if tile == 7 { [0.0, 0.0, 0.0, 1.0, 0.0] } else { [1.0, 0.0, 0.0, 0.0, 0.0] };
        let found = (0..100).map(|tile| (tile, found(corner(tile)))).collect();
        let work = [Work { walks: 1.0, ..Work::default() }; 3];
        let pilot = Pilot { tiles, found, camera: work, light: work, light_unlearnt: work, is_learnt: false };
        let effort = Effort::default();
        let all = Choice { among: Strategies::BDPT, strategies: Strategies::BDPT, effort, gain: 1.0 };
        assert!(pilot.error(&all) < 10.0);
        assert_eq!(pilot.error(&Choice { strategies: Strategies::PT, ..all }), f64::INFINITY);
    }

    /// From the samples of all strategies, the noise of others is known before they run. What samples have in common is not.
    #[test]
    fn pilots_foresee_the_noise_of_other_counts() {
        for scene in ["lampbox_down.xml", "efficiency/glass_fog_sky.xml"] {
            let (setup, settings) = small(scene, Strategies::BDPT);
            let learnt = Effort { learnt_starts: true, ..Effort::default() };
            let pilot = pilot(&setup.scene, &setup.film, &settings, learnt);
            let relative = |choice: Choice| {
                let Choice { strategies, effort, .. } = choice;
                let options = Options { strategies, effort, ..settings.options };
                let settings = Settings { options, ..settings };
                pilot.error(&choice) / measured(&Instrument::new(&setup.scene, &setup.film, &settings))
            };
            let (among, effort) = (Strategies::BDPT, Effort::default());
            let all = Choice { among, strategies: among, effort, gain: 1.0 };
            let four = Effort { connections: 4, ..all.effort };
            let shorter = Effort { survival: Survival::Shorter, ..all.effort };
            let others = [Choice { strategies: Strategies::PT, ..all }, Choice { effort: four, ..all }];
            for other in others.into_iter().chain([Choice { effort: shorter, ..all }]) {
                let (found, usual) = (relative(other), relative(all));
                assert!((0.6..1.7).contains(&(found / usual)), "{scene}, {other:?}: {found} {usual}");
            }
        }
    }
}
