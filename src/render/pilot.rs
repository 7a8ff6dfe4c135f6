//! Pilots: a few samples by all strategies, which tell how well any other counts of samples would do.
//!
//! By the balance heuristic, a sample that brought y has the second moment y^2 (sum of n p) / (sum of n' p) under counts n'
//! in place of n (after Grittmann et al. 2022, Efficiency-Aware Multiple Importance Sampling). So paths that strategies left
//! out would have to make count in full, however rarely the others make them: the strategies that do run have seen them.
//! What samples of one pixel have in common is taken to stay as it is.

use super::{
    Settings,
    block::Blocks,
    compiled::{self, Ready},
};
use crate::{
    film::Film,
    math::{Spectrum, SpectrumExt, Vec2},
    sampling::Sampler,
    scene::Scene,
    settings::options::{Effort, Survival},
    transport::{
        Contribution, Departure, MisSums, Options, Strategies, equiangular_applies,
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
/// Of a tile's second moment: variances below are rounding errors.
const LEAST_VARIANCE: f64 = 1e-3;
/// Other counts than all strategies' must be so much better: pilots are noisy.
const WORTHWHILE: f64 = 1.1;

/// Time of parts of a sample, over that of a segment of a walk, as measured in scenes of fog and smoke.
mod time {
    /// Setting out from the sensor or an emitter.
    pub const START: f64 = 0.5;
    /// A connection tried, by kind of strategy.
    pub const TRY: [f64; 5] = [0.1, 1.3, 0.7, 0.4, 2.0];
}

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

/// The strategies among those of `settings` that are worth their time on `film`, how often, and when walks end; `is_complete`
/// says which sets of strategies leave no light out.
pub fn choose(
    scene: &Scene,
    film: &Film,
    settings: &Settings,
    is_complete: impl Fn(Strategies) -> bool,
) -> Choice {
    let all = settings.options.strategies;
    let base = Choice { among: all, strategies: all, effort: Effort::default(), gain: 1.0 };
    if scene.lights.is_empty() {
        return base;
    }
    let survivals = [Survival::Albedo, Survival::FourthRoot];
    let equiangular = all == Strategies::BDPT && equiangular_applies(scene);
    let options = Options { strategies: Strategies { equiangular, ..all }, ..settings.options };
    let with_all = Settings { options, ..*settings };
    let fly = || survivals.map(|survival| pilot(scene, film, &with_all, survival));
    // Renders survive a panic and say where it was.
    let Ok(pilots) = catch_unwind(AssertUnwindSafe(fly)) else { return base };
    let reference = pilots[0].error(&base) * pilots[0].time(&base);
    let choices = survivals.iter().zip(&pilots).flat_map(|(survival, pilot)| {
        let complete = candidates(options.strategies, *survival);
        let complete = complete.filter(|choice| is_complete(choice.strategies));
        complete.map(move |choice| Choice {
            among: all,
            gain: reference / (pilot.error(&choice) * pilot.time(&choice)),
            ..choice
        })
    });
    let best = choices.max_by(|a, b| a.worth().total_cmp(&b.worth()));
    best.filter(|best| best.worth() > WORTHWHILE && best.gain.is_finite()).unwrap_or(base)
}

/// A few samples of all strategies of `settings` at equal effort.
fn pilot(scene: &Scene, film: &Film, settings: &Settings, survival: Survival) -> Pilot {
    let effort = Effort { survival, ..Effort::default() };
    let max_depth = Some(settings.options.max_depth.map_or(DEEPEST, |depth| depth.min(DEEPEST)));
    let options = Options { effort, max_depth, ..settings.options };
    let settings = Settings { options, seed: SEED, sampler: Sampler::Independent, ..*settings };
    compiled::pilot(scene, film, &settings)
}

/// Every choice among the strategies of `all` where walks end by `survival`.
fn candidates(all: Strategies, survival: Survival) -> impl Iterator<Item = Choice> {
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
        let light_walks: &[f32] =
            if strategies.connection || strategies.lens { &[0.5, 1.0, 2.0] } else { &[1.0] };
        let pairs = connections.iter().flat_map(|count| light_walks.iter().map(|walks| (*count, *walks)));
        pairs.map(move |(connections, light_walks)| Choice {
            among: all,
            strategies,
            effort: Effort { survival, light_walks, connections },
            gain: 1.0,
        })
    })
}

/// A contribution to a tile.
struct Found {
    pixel: u32,
    /// Squared luminance; from [`Pilot`] on, its part in the second moment of a pixel sample in the tile.
    square: f64,
    shares: [f32; StrategyKind::ALL.len()],
}

/// How often something was done.
#[derive(Clone, Copy, Default)]
struct Work {
    walks: f64,
    segments: f64,
    tries: [f64; StrategyKind::ALL.len()],
}

impl Work {
    fn and(mut self, other: &Self) -> Self {
        self.walks += other.walks;
        self.segments += other.segments;
        self.tries.iter_mut().zip(other.tries).for_each(|(tries, other)| *tries += other);
        self
    }
}

/// What the samples of one kind of walk bring.
#[derive(Default)]
struct Gathered {
    found: Vec<Found>,
    work: Work,
}

/// Sees walks and what they contribute; those of the camera to one pixel.
struct Gather<'a> {
    film: &'a Film,
    pixel: u32,
    weight: f32,
    sum: f64,
    gathered: Gathered,
}

impl<'a> Gather<'a> {
    fn new(film: &'a Film) -> Self {
        Self { film, pixel: 0, weight: 1.0, sum: 0.0, gathered: Gathered::default() }
    }

    /// The sum of what a camera subpath contributes to `pixel` follows, times `weight`.
    fn begin(&mut self, pixel: usize, weight: f32) {
        (self.pixel, self.weight, self.sum) = (pixel as u32, weight, 0.0);
        self.gathered.work.walks += 1.0;
    }
}

impl<S: MisSums> Observer<S> for Gather<'_> {
    fn covers(&self, film: Vec2) -> bool {
        self.film.covers(film)
    }

    fn depart(&mut self, _: &Departure<S>) {
        self.gathered.work.segments += 1.0;
    }

    fn stop(&mut self, kind: StrategyKind, _: u32, _: u32) {
        self.gathered.work.tries[kind as usize] += 1.0;
    }

    fn contribute(&mut self, _: u32, _: u32, meeting: Meeting<'_, S>, contribution: Option<&Contribution>) {
        let Some(Contribution { value, shares, .. }) = contribution.filter(|c| c.value.is_finite()) else {
            return;
        };
        let found = &mut self.gathered.found;
        let mut add = |pixel: u32, value: Spectrum| {
            let luminance = f64::from(value.luminance());
            found.push(Found { pixel, square: luminance * luminance, shares: *shares });
        };
        if let Meeting::Lens(film) = meeting {
            return self.film.spread(film, *value, |pixel, value| add(pixel as u32, value));
        }
        let value = *value * self.weight;
        add(self.pixel, value);
        self.sum += f64::from(value.luminance());
    }
}

/// What one block of one pass brings.
pub(super) struct Part {
    camera: Gathered,
    light: Gathered,
    /// Pixels with what camera subpaths contribute to them.
    sums: Vec<(u32, f64)>,
}

impl Part {
    fn segments(&self) -> f64 {
        self.camera.work.segments + self.light.work.segments
    }
}

/// The samples of `block` in `pass`.
pub(super) fn part<P: Profile>(ready: &Ready<'_, P>, pass: usize, block: usize) -> Part {
    let Ready { estimator, blocks, scene, film, seed } = ready;
    let (mut light, mut camera) = (Gather::new(film), Gather::new(film));
    let mut observer: &mut dyn Observer<P::MisSums> = &mut light;
    let cache = blocks.trace_light(estimator, *seed, pass, block, &mut observer);
    light.gathered.work.walks = blocks.walks_per_block() as f64;
    let sums = blocks.pixels(block).map(|pixel| {
        let start = blocks.camera_start(scene, film, *seed, pass, pixel);
        camera.begin(pixel, start.weight);
        let observer: &mut dyn Observer<P::MisSums> = &mut camera;
        start.trace(estimator, &cache, observer);
        (pixel as u32, camera.sum)
    });
    let sums = sums.collect();
    Part { camera: camera.gathered, light: light.gathered, sums }
}

/// A set of pixels that lie together.
#[derive(Clone, Copy, Default)]
struct Tile {
    pixels: f64,
    /// Camera subpaths; 0 where the tile is left out.
    samples: f64,
    mean: f64,
    /// The variance of a pixel sample by all strategies less its second moment as the sum of those of its contributions.
    rest: f64,
}

/// What the samples say.
pub(super) struct Pilot {
    tiles: Vec<Tile>,
    /// Contributions, each with its tile.
    found: Vec<(u32, Found)>,
    camera: Work,
    light: Work,
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
        Self::of(parts, ready.film, &ready.blocks)
    }

    fn of(parts: Vec<Part>, film: &Film, blocks: &Blocks) -> Self {
        let (width, height) = (film.width, film.len() as u32 / film.width);
        let (across, down) = (width.min(TILES), height.min(TILES));
        let tile =
            |pixel: u32| (pixel / width * down / height * across + pixel % width * across / width) as usize;
        let mut tiles = vec![Tile::default(); (across * down) as usize];
        (0..film.len() as u32).for_each(|pixel| tiles[tile(pixel)].pixels += 1.0);
        for (pixel, _) in parts.iter().flat_map(|part| &part.sums) {
            tiles[tile(*pixel)].samples += 1.0;
        }
        let [camera, light] = [|part: &Part| part.camera.work, |part: &Part| part.light.work]
            .map(|work| parts.iter().fold(Work::default(), |sum, part| sum.and(&work(part))));
        // Light subpaths traced stand for those of a pass.
        let per_pass = blocks.walks_per_pass() as f64 / light.walks.max(1.0);
        let variances = variances(&parts);
        let mut found = Vec::new();
        for part in parts {
            for (pixel, sum) in part.sums {
                let tile = &mut tiles[tile(pixel)];
                tile.mean += sum / tile.samples;
                tile.rest += variances[&pixel] / tile.samples;
            }
            for Found { pixel, square, shares } in part.camera.found {
                let (index, square) = (tile(pixel), square / tiles[tile(pixel)].samples);
                tiles[index].rest -= square;
                found.push((index as u32, Found { pixel, square, shares }));
            }
            for Found { pixel, square, shares } in part.light.found {
                let index = tile(pixel);
                let scale = per_pass / tiles[index].pixels;
                tiles[index].mean += square.sqrt() * scale;
                found.push((index as u32, Found { pixel, square: square * scale, shares }));
            }
        }
        let mut pilot = Self { tiles, found, camera, light };
        pilot.leave_out_outliers();
        pilot
    }

    /// Time of a pixel sample, in segments.
    fn time(&self, Choice { strategies, effort, .. }: &Choice) -> f64 {
        let Self { camera, light, .. } = self;
        let mut camera_time = time::START * camera.walks + camera.segments;
        let mut light_time = time::START * light.walks + light.segments;
        for kind in StrategyKind::ALL.into_iter().filter(|kind| strategies.has(*kind)) {
            let factor = if kind == StrategyKind::Connection { f64::from(effort.connections) } else { 1.0 };
            camera_time += factor * time::TRY[kind as usize] * camera.tries[kind as usize];
            light_time += time::TRY[kind as usize] * light.tries[kind as usize];
        }
        let light_walks =
            if strategies.connection || strategies.lens { f64::from(effort.light_walks) } else { 0.0 };
        camera_time / camera.walks.max(1.0) + light_walks * light_time / light.walks.max(1.0)
    }

    /// The squared relative error of a pixel sample, on average over the image; infinite where something is left out.
    fn error(&self, choice: &Choice) -> f64 {
        let errors = self.errors(choice.counts());
        let pixels: f64 = self.seen().map(|tile| tile.pixels).sum();
        errors.iter().sum::<f64>() / pixels.max(1.0)
    }

    /// Those of the pixels of every tile, added up, by so many samples of each kind of strategies.
    fn errors(&self, counts: [f64; StrategyKind::ALL.len()]) -> Vec<f64> {
        let mut moments = vec![0.0; self.tiles.len()];
        for (tile, Found { square, shares, .. }) in self.found.iter().filter(|(_, found)| found.square > 0.0)
        {
            let left: f64 = (0..counts.len()).map(|kind| f64::from(shares[kind]) * counts[kind]).sum();
            moments[*tile as usize] += square / left;
        }
        let pixels: f64 = self.seen().map(|tile| tile.pixels).sum();
        let mean = self.seen().map(|tile| tile.pixels * tile.mean).sum::<f64>() / pixels.max(1.0);
        let floor = 0.01 * mean * mean;
        let relative = |(tile, moment): (&Tile, &f64)| {
            if tile.samples == 0.0 && moment.is_finite() {
                return 0.0;
            }
            let variance = (moment + tile.rest).max(LEAST_VARIANCE * moment);
            tile.pixels * variance / (tile.mean * tile.mean + floor)
        };
        self.tiles.iter().zip(&moments).map(relative).collect()
    }

    fn seen(&self) -> impl Iterator<Item = &Tile> {
        self.tiles.iter().filter(|tile| tile.samples > 0.0)
    }

    /// The same tiles for every choice, the worst by all strategies alike: the worst by another choice may be those that it
    /// is bad for.
    fn leave_out_outliers(&mut self) {
        let errors = self.errors([1.0, 1.0, 1.0, 1.0, 0.0]);
        let mut order: Vec<usize> =
            (0..errors.len()).filter(|tile| self.tiles[*tile].samples > 0.0).collect();
        order.sort_by(|a, b| errors[*b].total_cmp(&errors[*a]));
        order.truncate((OUTLIERS * order.len() as f64) as usize);
        order.into_iter().for_each(|tile| self.tiles[tile].samples = 0.0);
    }
}

impl Choice {
    /// Its gain, or what is left of that where it has to make up for what no integrator has of itself.
    fn worth(&self) -> f64 {
        if self.strategies.equiangular { self.gain / WORTHWHILE } else { self.gain }
    }

    /// Samples of every kind of strategies, over those of all at equal effort.
    fn counts(&self) -> [f64; StrategyKind::ALL.len()] {
        StrategyKind::ALL.map(|kind| match kind {
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
        scene::build,
        settings::Overrides,
        transport::profile::ProfileName,
    };
    use std::path::Path;

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

    /// A corner of the image that other strategies hardly see, or do not, decides against them.
    #[test]
    fn what_a_choice_is_bad_for_is_no_outlier() {
        let found = |shares| Found { pixel: 0, square: 1.0, shares };
        let pilot = |corner| {
            let tiles = vec![Tile { pixels: 1.0, samples: 1.0, mean: 0.7, rest: 0.0 }; 100];
            let found = (0..100)
                .map(|tile| (tile, found(if tile == 7 { corner } else { [1.0, 0.0, 0.0, 0.0, 0.0] })));
            let work = Work { walks: 1.0, ..Work::default() };
            let mut pilot = Pilot { tiles, found: found.collect(), camera: work, light: work };
            pilot.leave_out_outliers();
            pilot
        };
        let effort = Effort::default();
        let all = Choice { among: Strategies::BDPT, strategies: Strategies::BDPT, effort, gain: 1.0 };
        let without = Choice { strategies: Strategies::PT, ..all };
        for (corner, most) in [([1e-6, 0.0, 0.0, 1.0, 0.0], 1e7), ([0.0, 0.0, 0.0, 1.0, 0.0], f64::INFINITY)]
        {
            let pilot = pilot(corner);
            assert!(pilot.error(&all) < 10.0);
            assert!((1e3..=most).contains(&pilot.error(&without)), "{}", pilot.error(&without));
        }
    }

    /// From the samples of all strategies, the noise of others is known before they run. What samples have in common is not.
    #[test]
    fn pilots_foresee_the_noise_of_other_counts() {
        for scene in ["lampbox_down.xml", "efficiency/glass_fog_sky.xml"] {
            let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(scene);
            let overrides = Overrides { size: Some((24, 24)), ..Overrides::default() };
            let setup = build::build(&format::read(&path, &[]).unwrap(), overrides).unwrap();
            let options = Options { strategies: Strategies::BDPT, ..setup.integrator.options };
            let (sampler, budget) = (Sampler::Independent, Budget::ENDLESS);
            let settings = Settings { options, sampler, budget, seed: 0, profile: ProfileName::Everything };
            let pilot = pilot(&setup.scene, &setup.film, &settings, Survival::Albedo);
            let relative = |choice: Choice| {
                let Choice { strategies, effort, .. } = choice;
                let settings = Settings { options: Options { strategies, effort, ..options }, ..settings };
                pilot.error(&choice) / measured(&Instrument::new(&setup.scene, &setup.film, &settings))
            };
            let (among, effort) = (Strategies::BDPT, Effort::default());
            let all = Choice { among, strategies: among, effort, gain: 1.0 };
            let four = Effort { connections: 4, ..all.effort };
            for other in [Choice { strategies: Strategies::PT, ..all }, Choice { effort: four, ..all }] {
                let (found, usual) = (relative(other), relative(all));
                assert!((0.6..1.7).contains(&(found / usual)), "{scene}, {other:?}: {found} {usual}");
            }
        }
    }
}
