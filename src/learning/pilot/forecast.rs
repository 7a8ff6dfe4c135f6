//! Forecasts of other choices, from the samples of a pilot by all strategies.
//!
//! By the balance heuristic, a sample of the contribution y has the second moment y^2 (sum of n p) / (sum of n' p)
//! under counts n' in place of n (after Grittmann et al. 2022, Efficiency-Aware Multiple Importance Sampling). So paths
//! of strategies that a choice leaves out count in full, however rarely its others make them: the pilot has seen them.
//! With aimed or learnt starts, each contribution also says how often light subpaths would start there otherwise, and how
//! often next-event estimation would find it. The albedos of a path say how often walks would survive if they ended more
//! often.
//!
//! Two contributions to one sample also add their product to its second moment: a walk connected to a sky at each of
//! many vertices brings a sum, a walk that hits the sky a single number. This product is known under other counts and
//! roulettes as well; see [`Forecast::errors`]. The squared mean, which the variance lacks, comes from pairs of samples
//! of a pixel.

use super::{
    CONNECTIONS, Choice, End, WALKS_END,
    moments::{Counts, Subpaths, Sums, Weighed},
    record::{Found, Part, Work, Works, part},
};
use crate::{
    film::Film,
    learning::tiles::Tiles,
    passes::{blocks::Blocks, compiled::Compiled},
    settings::options::{Effort, LightStarts, Sky, Survival},
    transport::{lengths, strategy::StrategyKind},
};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Most tiles of the image across and down; the pixels of a tile count as one.
const TILES: u32 = 16;
/// The part of the tiles, those of the greatest errors, in which few samples decide.
const FEW: f64 = 0.02;
/// Contributions to a tile that count as much for its level as the tiles around.
const AROUND: f64 = 8.0;
/// Variances below this part of a tile's second moment are rounding errors.
const LEAST_VARIANCE: f64 = 1e-3;

/// Segments after which no pass begins, except the second: where walks are long, few say enough.
const SEGMENTS: f64 = 2e6;
/// Pixels of a block of a pilot: fewer than those of an image, so that pilots may be short.
pub(crate) const PIXELS_PER_BLOCK: usize = 256;

/// Times of the parts of a sample, over that of a segment of a walk, measured in scenes of fog and smoke. In 29 other
/// scenes drawn at random, forecast times were off by 14 % (one standard deviation), or 13 % with these numbers fitted
/// to them.
mod time {
    /// Setting out from the sensor or an emitter.
    pub(super) const START: f64 = 0.5;
    /// The part of this for a light subpath that does not set out.
    pub(super) const DROPPED: f64 = 0.1;
    /// A connection tried, by kind of strategy.
    pub(super) const TRY: [f64; 5] = [0.1, 1.3, 0.7, 0.4, 2.0];
}

/// A set of pixels that lie together.
#[derive(Clone, Copy, Default)]
pub(super) struct Tile {
    pub pixels: f64,
    /// Camera subpaths.
    pub samples: f64,
    pub mean: f64,
    /// What its errors are measured against: its mean if many contributions make it, else rather that of the tiles
    /// around. A rare bright path that makes the mean of its tile would seem to be a small error of it.
    pub level: f64,
}

/// The squared relative error of a pixel sample, on average over the image; infinite where light is left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Error {
    /// Its part in most tiles.
    pub usual: f64,
    /// Its part in the few tiles of the greatest errors.
    pub few: f64,
}

impl Error {
    /// All of it.
    pub fn all(self) -> f64 {
        self.usual + self.few
    }
}

/// What the samples say.
pub(crate) struct Forecast {
    pub(super) tiles: Vec<Tile>,
    /// Pixels with samples of camera subpaths: the tile, and the number of samples.
    pub(super) pixels: Vec<(usize, f64)>,
    /// Contributions other than zero, each with its tile.
    pub(super) found: Vec<(u32, Found)>,
    pub(super) camera: Works,
    pub(super) light: Works,
    /// The work of light subpaths that start as emitters emit.
    pub(super) light_emitted: Works,
    /// Where light subpaths started.
    pub(super) starts: LightStarts,
    /// When walks ended.
    pub(super) survival: Survival,
}

impl Forecast {
    /// Gathers the samples of so many `passes` over at least so many `pixels` of `compiled`, whose walks start and end by
    /// `effort`. Images will have the part `left` of the variance that camera samples have here.
    pub(super) fn fly(
        compiled: &dyn Compiled,
        Effort { survival, starts, .. }: Effort,
        [passes, pixels]: [usize; 2],
        left: f64,
    ) -> Self {
        let blocks = pixels.div_ceil(PIXELS_PER_BLOCK).clamp(1, compiled.blocks().count());
        let mut parts: Vec<Part> = Vec::new();
        for pass in 0..passes {
            let done: f64 = parts.iter().map(|part| part.segments(index(End::AtOnce(survival)))).sum();
            if pass >= 2 && done > SEGMENTS {
                break;
            }
            parts.par_extend((0..blocks).into_par_iter().map(|block| part(compiled, survival, pass, block)));
        }
        let starts = compiled.starts().map_or(LightStarts::Emitted, |_| starts);
        Self { survival, starts, ..Self::of(parts, compiled.film(), compiled.blocks(), left) }
    }

    fn of(parts: Vec<Part>, film: &Film, blocks: &Blocks, left: f64) -> Self {
        let all = Tiles::of(film, TILES);
        let tile = |pixel| all.at(pixel);
        let mut tiles: Vec<Tile> =
            all.pixels().into_iter().map(|pixels| Tile { pixels, ..Tile::default() }).collect();
        let mut pixels: BTreeMap<u32, u32> = BTreeMap::new();
        for (pixel, value) in parts.iter().flat_map(|part| &part.sums) {
            let tile = &mut tiles[tile(*pixel)];
            tile.samples += 1.0;
            tile.mean += value;
            *pixels.entry(*pixel).or_default() += 1;
        }
        tiles.iter_mut().for_each(|tile| tile.mean /= tile.samples.max(1.0));
        let place: BTreeMap<u32, u32> = pixels.keys().copied().zip(0..).collect();
        let works: [fn(&Part) -> &Works; 3] =
            [|part| &part.camera.work, |part| &part.light.work, |part| &part.light.emitted];
        let [camera, light, light_emitted]: [Works; 3] = works.map(|works| {
            std::array::from_fn(|i| parts.iter().fold(Work::default(), |sum, part| sum.and(&works(part)[i])))
        });
        // Light subpaths traced stand for those of a pass.
        let per_pass = blocks.walks_per_pass() as f64 / light[0].walks.max(1.0);
        let (mut found, mut samples) = (Vec::new(), 0);
        for part in parts {
            for one in part.camera.found {
                let index = tile(one.pixel);
                let square = left * one.square / tiles[index].samples;
                let (pixel, sample) = (place[&one.pixel], samples + one.sample);
                found.push((index as u32, Found { square, pixel, sample, ..one }));
            }
            samples += part.sums.len() as u32;
            for one in part.light.found {
                let index = tile(one.pixel);
                let scale = per_pass / tiles[index].pixels;
                tiles[index].mean += one.square.sqrt() * scale;
                found.push((index as u32, Found { square: one.square * scale, ..one }));
            }
        }
        found.retain(|(_, found)| found.square > 0.0);
        let levels = levels(&tiles, all.across(), &squares(&tiles, &found, [per_pass, left]));
        tiles.iter_mut().zip(levels).for_each(|(tile, level)| tile.level = level);
        let survival = Survival::default();
        let pixels = pixels.into_iter().map(|(pixel, samples)| (tile(pixel), f64::from(samples))).collect();
        Self { tiles, pixels, found, camera, light, light_emitted, starts: LightStarts::Emitted, survival }
    }

    /// The part of the light subpaths that the lens would see if they started as emitters emit; none without any. Where it
    /// is small, learnt starts may pay.
    pub(super) fn seen_subpaths(&self) -> Option<f64> {
        let [Work { reaching, walks, .. }, ..] = self.light_emitted;
        (walks > 0.0).then(|| reaching / walks)
    }

    /// How many there are.
    pub(super) fn samples(&self) -> f64 {
        self.camera[0].walks
    }

    /// Time of a pixel sample, in segments.
    pub(super) fn time(&self, choice: &Choice) -> f64 {
        let Choice { strategies, effort, .. } = choice;
        let camera = &self.camera[index(self.end(choice))];
        let light = self.light_work(effort);
        let mut camera_time = time::START * camera.walks + camera.segments;
        let dropped = (light.walks - light.begun).max(0.0);
        let mut light_time = time::START * light.begun + time::DROPPED * dropped + light.segments;
        let counts = choice.counts();
        for kind in StrategyKind::ALL.into_iter().filter(|kind| strategies.has(*kind)) {
            let factor = if kind == StrategyKind::Connection { counts[kind as usize] } else { 1.0 };
            camera_time += factor * time::TRY[kind as usize] * camera.tries[kind as usize];
            light_time += time::TRY[kind as usize] * light.tries[kind as usize];
        }
        let light_walks = if strategies.need_light_walks() { f64::from(effort.light_walks) } else { 0.0 };
        camera_time / camera.walks.max(1.0) + light_walks * light_time / light.walks.max(1.0)
    }

    /// Errors of these choices, in their order.
    pub(super) fn judge(&self, choices: &[Choice]) -> Vec<Error> {
        let weighed = WALKS_END.map(|end| {
            let is_asked = choices.iter().any(|choice| self.end(choice) == end);
            if is_asked { self.weighed(end) } else { Vec::new() }
        });
        choices.par_iter().map(|choice| self.error(choice, &weighed[index(self.end(choice))])).collect()
    }

    fn error(&self, choice: &Choice, weighed: &[Weighed]) -> Error {
        let mut errors = self.errors(choice, weighed);
        errors.sort_unstable_by(f64::total_cmp);
        if errors.last().is_some_and(|worst| worst.is_infinite()) {
            return Error { usual: f64::INFINITY, few: 0.0 };
        }
        let (usual, few) = errors.split_at(errors.len() - (FEW * errors.len() as f64) as usize);
        let pixels: f64 = self.seen().map(|(_, tile)| tile.pixels).sum();
        let [usual, few] = [usual, few].map(|errors| errors.iter().sum::<f64>() / pixels.max(1.0));
        Error { usual, few }
    }

    /// The same over the tiles in which light was seen: where few samples find any, the others look free of noise.
    /// Infinite where no light was seen.
    pub(super) fn error_where_lit(&self, choice: &Choice) -> f64 {
        let is_lit = |(_, tile): &(usize, &Tile)| tile.mean > 0.0;
        let pixels: f64 = self.seen().filter(is_lit).map(|(_, tile)| tile.pixels).sum();
        let errors = || self.errors(choice, &self.weighed(self.end(choice)));
        if pixels > 0.0 { errors().iter().sum::<f64>() / pixels } else { f64::INFINITY }
    }

    /// When walks of `choice` end: the estimator puts roulette off where camera subpaths are alone and that is worth it.
    pub(super) fn end(&self, choice: &Choice) -> End {
        let survival = choice.effort.survival;
        let is_alone = !choice.strategies.need_light_walks() && self.survival == Survival::FourthRoot;
        let segments = |end| self.camera[index(end)].segments / self.samples().max(1.0);
        let usual = segments(End::AtOnce(Survival::Albedo));
        let is_late = survival == Survival::FourthRoot || lengths::is_worth_it(segments(End::Late), usual);
        if is_alone && is_late { End::Late } else { End::AtOnce(survival) }
    }

    /// All contributions if walks ended so.
    fn weighed(&self, end: End) -> Vec<Weighed> {
        self.found.iter().map(|(tile, found)| Weighed::of(*tile, found, end, self.survival)).collect()
    }

    /// The squared relative errors of the pixels of each tile that was seen, added up.
    ///
    /// Let a path have the density p_k by strategy k, which runs n_k times. By the balance heuristic (Veach 1997, section 9.2.2)
    /// it brings y = f / (sum of n p), whichever strategy finds it. Under counts n' it brings y' = y (sum of n p) / (sum of n' p),
    /// and strategy k finds it n'_k / n_k times as often. Three sums over the contributions of the pilot follow:
    ///
    /// - Squares: all strategies together find the path (sum of n' p) / (sum of n p) times as often, so that the second moment
    ///   of its contribution is y^2 (sum of n p) / (sum of n' p).
    /// - Products of two contributions to one camera subpath. Given that subpath, its vertices are connected independently. So
    ///   each of the two becomes y' n'_k / n_k on average. If q_i is how much more often walks get as far as contribution
    ///   i under another roulette, both come q times as often for the longer path, and each is smaller by its own q. Of m
    ///   connections of one vertex there are m (m - 1) such products, so that m = 1 has none.
    /// - The squared mean, by pairs of different subpaths of a pixel: without bias.
    ///
    /// A connection through media has a random estimate t of the transmittance T, which the densities contain. A hit has none: its
    /// part of the density counts with t T, whose mean is T^2, in place of t^2.
    fn errors(&self, choice: &Choice, weighed: &[Weighed]) -> Vec<f64> {
        let counts = self.counts(choice);
        let mut moments = vec![0.0; self.tiles.len()];
        let mut subpaths = Subpaths::new(self.pixels.len());
        let connections = f64::from(choice.effort.connections);
        let apart = apart(connections) / apart(f64::from(CONNECTIONS));
        for ((_, found), one) in self.found.iter().zip(weighed) {
            let density = counts.density(one);
            let moment = &mut moments[one.tile as usize];
            *moment += density.square(one, found.expected);
            let own = counts.of(found.kind, one);
            if found.kind != StrategyKind::Lens && own != 0.0 {
                *moment += subpaths.add(found, one, one.value * own / density.all, apart);
            }
        }
        self.relative(&moments, &self.squared_means(&subpaths.finish()))
    }

    /// How often strategies run by `choice`.
    fn counts(&self, choice: &Choice) -> Counts {
        // Each vertex has the same number of connections, however many vertices light subpaths leave.
        let draws = self.light[index(End::AtOnce(self.survival))].kept.max(1.0)
            / self.light_work(&choice.effort).kept.max(1.0);
        let mut each = choice.counts().map(|count| count as f32);
        each[StrategyKind::Connection as usize] *= draws as f32;
        Counts {
            each,
            as_flown: choice.effort.starts == self.starts,
            with_sky: choice.effort.sky == Sky::NextEvent,
        }
    }

    /// Of each tile, where the pixels have these `sums`.
    fn squared_means(&self, sums: &[Sums]) -> Vec<f64> {
        let mut means = vec![0.0; self.tiles.len()];
        for ((tile, n), Sums { sum, square }) in self.pixels.iter().zip(sums) {
            means[*tile] += (sum * sum - square) / (n - 1.0).max(1.0);
        }
        means
    }

    /// Variances over squared levels of the tiles that were seen, times their pixels; infinite if none showed light.
    fn relative(&self, moments: &[f64], squared_means: &[f64]) -> Vec<f64> {
        let pixels: f64 = self.seen().map(|(_, tile)| tile.pixels).sum();
        let mean = self.seen().map(|(_, tile)| tile.pixels * tile.mean).sum::<f64>() / pixels.max(1.0);
        if mean == 0.0 {
            return self.seen().map(|_| f64::INFINITY).collect();
        }
        let floor = 0.01 * mean * mean;
        let relative = |(index, tile): (usize, &Tile)| {
            let variance = (moments[index] - squared_means[index]).max(LEAST_VARIANCE * moments[index]);
            tile.pixels * variance / (tile.level * tile.level + floor)
        };
        self.seen().map(relative).collect()
    }

    /// The work of light subpaths by `effort`.
    fn light_work(&self, effort: &Effort) -> &Work {
        let works = if effort.starts == self.starts { &self.light } else { &self.light_emitted };
        &works[index(End::AtOnce(effort.survival))]
    }

    fn seen(&self) -> impl Iterator<Item = (usize, &Tile)> {
        self.tiles.iter().enumerate().filter(|(_, tile)| tile.samples > 0.0)
    }
}

/// The squares of what contributions add to the mean of their tile, added up, of each of the `tiles`; see
/// [`Forecast::of`].
fn squares(tiles: &[Tile], found: &[(u32, Found)], [per_pass, left]: [f64; 2]) -> Vec<f64> {
    let mut squares = vec![0.0; tiles.len()];
    for (index, one) in found {
        let tile = &tiles[*index as usize];
        squares[*index as usize] += match one.kind {
            StrategyKind::Lens => one.square * per_pass / tile.pixels,
            _ => one.square / (left * tile.samples),
        };
    }
    squares
}

/// The levels of `tiles`, of which so many lie `across`.
pub(super) fn levels(tiles: &[Tile], across: usize, squares: &[f64]) -> Vec<f64> {
    let near = |at: usize, end: usize| at.saturating_sub(1)..(at + 2).min(end);
    let around = |index: usize| {
        let (rows, columns) = (near(index / across, tiles.len() / across), near(index % across, across));
        let seen =
            rows.flat_map(|row| &tiles[row * across..][columns.clone()]).filter(|tile| tile.samples > 0.0);
        let [light, pixels] = seen
            .fold([0.0; 2], |[light, pixels], tile| [light + tile.pixels * tile.mean, pixels + tile.pixels]);
        light / pixels.max(1.0)
    };
    let level = |(index, tile): (usize, &Tile)| {
        // Its contributions are as many as mean^2 / squares equal ones.
        let square = tile.mean * tile.mean;
        let own = if square > 0.0 { square / (square + AROUND * squares[index]) } else { 0.0 };
        own * tile.mean + (1.0 - own) * around(index)
    };
    tiles.iter().enumerate().map(level).collect()
}

/// Of all pairs of so many connections of a vertex, each with itself among them, the part of two different ones.
fn apart(connections: f64) -> f64 {
    (connections - 1.0) / connections
}

/// Of `end` among [`WALKS_END`].
fn index(end: End) -> usize {
    WALKS_END.iter().position(|one| *one == end).unwrap_or(0)
}
