//! What contributions of a pilot would add to second moments under other counts and ends; see [`super::forecast`].

use super::{
    End,
    record::{Found, Route, passed_one},
};
use crate::{settings::options::Survival, transport::strategy::StrategyKind};

/// A contribution under one survival: its tile, its second moment, and the parts of strategies in its density.
pub(super) struct Weighed {
    pub tile: u32,
    pub unlearnt: f32,
    pub unaimed: f32,
    pub without_sky: f32,
    pub moment: f64,
    pub shares: [f32; StrategyKind::ALL.len()],
    /// The contribution itself.
    pub value: f32,
    /// Probability that walks get this far, over that in the pilot.
    pub passed: f32,
    /// The same for the walks of the strategy that found it.
    pub passed_own: f32,
    /// The same for the light subpath of a connection, up to the vertex that is connected.
    pub passed_light: f32,
}

impl Weighed {
    /// `found` in `tile`, if walks ended by `end` rather than by `before`.
    pub(super) fn of(tile: u32, found: &Found, end: End, before: Survival) -> Self {
        let Route { all, light, outermost, connected: [camera_last, light_last] } = found.route;
        let passed = all.passed(end, before);
        let one = |albedo| passed_one(albedo, end, before);
        let [at_sensor, at_emitter] = outermost.map(one);
        // Of all vertices between, the walks survived all but one if connected to an emitter or the lens, and all but
        // two, which might be any, if connected to each other.
        let any = one(all.of_one());
        let [hits, next_event, connections, lens, equiangular] = found.shares;
        let shares =
            [hits, next_event / at_emitter, connections / (any * any), lens / at_sensor, equiangular / any];
        Self {
            tile,
            unlearnt: found.unlearnt,
            unaimed: found.unaimed,
            without_sky: found.without_sky,
            moment: found.square / f64::from(passed),
            shares,
            value: found.square.sqrt() as f32,
            passed,
            passed_own: match found.kind {
                StrategyKind::Connection => 1.0 / one(camera_last + light_last),
                kind => shares[kind as usize] / found.shares[kind as usize],
            },
            passed_light: light.passed(end, before) / one(light_last),
        }
    }
}

/// How often strategies run, by kind.
pub(super) struct Counts {
    pub each: [f32; StrategyKind::ALL.len()],
    /// Light subpaths begin as those of the pilot did, and next-event estimation aims at the same portals; else as
    /// emitters emit.
    pub as_flown: bool,
    /// Next-event estimation connects to the environment too.
    pub with_sky: bool,
}

/// n' p over all strategies of a path, in units of the n p that the pilot had.
pub(super) struct Density {
    pub all: f32,
    /// The part of hit emitters.
    hit: f32,
}

impl Counts {
    /// Samples of the strategy `kind` that can find a contribution.
    #[inline(always)]
    pub(super) fn of(&self, kind: StrategyKind, one: &Weighed) -> f32 {
        let count = self.each[kind as usize];
        match kind {
            StrategyKind::NextEvent => count * self.joined(one),
            StrategyKind::Connection | StrategyKind::Lens if !self.as_flown => count * one.unlearnt,
            _ => count,
        }
    }

    /// How often next-event estimation finds a contribution, over how often it did in the pilot.
    #[inline(always)]
    fn joined(&self, one: &Weighed) -> f32 {
        let aimed = if self.as_flown { 1.0 } else { one.unaimed };
        if self.with_sky { aimed } else { aimed * one.without_sky }
    }

    /// Written out for speed: all choices go through all contributions.
    #[inline(always)]
    pub(super) fn density(&self, one: &Weighed) -> Density {
        let [hits, next_event, connections, lens, equiangular] = self.each;
        let begun = if self.as_flown { 1.0 } else { one.unlearnt };
        let hit = one.shares[0] * hits;
        let camera = hit + one.shares[1] * next_event * self.joined(one) + one.shares[4] * equiangular;
        let light = one.shares[2] * connections + one.shares[3] * lens;
        Density { all: camera + begun * light, hit }
    }
}

impl Density {
    /// The second moment of `one`. The expected transmittance of its connection is `expected` times the one found.
    #[inline(always)]
    pub(super) fn square(&self, one: &Weighed, expected: f32) -> f64 {
        let hit = self.hit / self.all.max(f32::MIN_POSITIVE);
        one.moment / f64::from(self.all) * f64::from(1.0 + (expected - 1.0) * hit)
    }
}

/// Contributions of the camera subpaths of a pixel.
#[derive(Clone, Copy, Default)]
pub(super) struct Sums {
    pub sum: f64,
    pub square: f64,
}

/// Contributions of camera subpaths, one subpath after the other.
pub(super) struct Subpaths {
    pixels: Vec<Sums>,
    /// The last one: its number, and its pixel among those that have samples.
    sample: u32,
    pixel: u32,
    sum: f64,
    /// The same given that the camera subpath gets that far.
    before: f64,
    /// The vertex of the last contribution, if it was a connection, and the part of those from there in `before`.
    vertex: u32,
    here: f64,
}

impl Subpaths {
    /// None yet, of so many `pixels`.
    pub(super) fn new(pixels: usize) -> Self {
        let none = u32::MAX;
        let pixels = vec![Sums::default(); pixels];
        Self { pixels, sample: none, pixel: none, sum: 0.0, before: 0.0, vertex: 0, here: 0.0 }
    }

    /// Adds a contribution, which is `value` if walks survive as in the pilot. Those of one subpath come in order of
    /// path length. Returns what the products with those before add to the second moment. Products of two connections
    /// from one vertex count `apart` times.
    #[inline(always)]
    pub(super) fn add(&mut self, found: &Found, one: &Weighed, value: f32, apart: f64) -> f64 {
        if self.sample != found.sample {
            self.close();
            (self.sample, self.pixel, self.sum, self.before) = (found.sample, found.pixel, 0.0, 0.0);
            (self.vertex, self.here) = (0, 0.0);
        }
        if self.vertex != found.vertex {
            (self.vertex, self.here) = (found.vertex, 0.0);
        }
        let arriving = f64::from(value * one.passed_own);
        let products = 2.0 * arriving * (self.before + (apart - 1.0) * self.here);
        let before = f64::from(value / one.passed * one.passed_light);
        self.sum += arriving;
        self.before += before;
        if found.vertex != 0 {
            self.here += before;
        }
        products
    }

    /// Those of each pixel.
    pub(super) fn finish(mut self) -> Vec<Sums> {
        self.close();
        self.pixels
    }

    fn close(&mut self) {
        if let Some(sums) = self.pixels.get_mut(self.pixel as usize) {
            (sums.sum, sums.square) = (sums.sum + self.sum, sums.square + self.sum * self.sum);
        }
    }
}
