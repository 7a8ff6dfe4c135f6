//! Radiance, learnt for the preview `gather`: places that camera subpaths come to are lit by the light subpaths of their block.
//!
//! What a vertex scatters to the one before is what next-event estimation and connections at it bring, each as if it ran alone,
//! and emitters that the walk hits next: neither takes the noise of a longer walk. Mirrors and glass cannot be connected to:
//! what is seen in them belongs to the vertex before.

use super::{
    Settings,
    block::PIXELS_PER_BLOCK,
    compiled::{self, Ready},
};
use crate::{
    film::Film,
    guide::{Learnt, Radiance, Seen},
    math::{Spectrum, Vec2},
    scene::Scene,
    transport::{
        Contribution, Departure, MisSums, Options, Strategies, Vertex,
        observer::{Meeting, Observer, StrategyKind},
        profile::Profile,
    },
};
use rayon::prelude::*;
use std::ops::Range;

/// Camera subpaths between two decisions whether it is enough.
const STEP: usize = 16_384;
/// Looks that are enough.
const LOOKS: usize = 1 << 20;
/// Segments that are.
const SEGMENTS: f64 = 3e6;
/// Camera subpaths that are: many may see nothing.
const SUBPATHS: usize = 1 << 18;
/// Segments of a path, at most: what comes later would be most of the time and little of the light.
const DEEPEST: u32 = 256;
/// Segments of a path that is looked at, at least: most places should be come to by several segments.
const LEAST: u32 = 32;

/// Most segments of the paths that are looked at, where images have such of `max_depth`.
pub(super) fn deepest(max_depth: Option<u32>) -> u32 {
    max_depth.map_or(DEEPEST, |depth| depth.min(DEEPEST))
}

/// What is seen of `scene`, by light subpaths that begin as was `learnt`.
pub(super) fn learn(scene: &Scene, film: &Film, settings: &Settings, learnt: &Learnt) -> Radiance {
    // Of a path, a segment leads to the camera's first vertex and one to the second, at least.
    let most_edges = deepest(settings.options.max_depth).saturating_sub(2);
    let strategies = Strategies { lens: false, ..Strategies::BDPT };
    let options = Options { strategies, max_depth: Some(longest(most_edges)), ..settings.options };
    let settings = Settings { options, ..*settings };
    let (mut all, mut done, mut subpaths) = (Looks::default(), 0, 0);
    while all.seen.len() < LOOKS && all.segments < SEGMENTS && subpaths < SUBPATHS {
        let tasks = done..done + STEP.div_ceil(film.len().min(PIXELS_PER_BLOCK));
        done = tasks.end;
        subpaths += STEP;
        let more = compiled::look(scene, film, &settings, learnt.clone(), tasks, most_edges);
        all.seen.extend(more.seen);
        all.segments += more.segments;
    }
    Radiance::learn(&all.seen)
}

/// Most segments of the paths that are looked at, where light comes to places by so many: half of them, at least, lead to places.
fn longest(most_edges: u32) -> u32 {
    (2 * most_edges).max(LEAST)
}

/// What was seen, and what it took.
#[derive(Default)]
pub(super) struct Looks {
    seen: Vec<Seen>,
    segments: f64,
}

/// Blocks of passes, numbered over all of them.
pub(super) fn look<P: Profile>(ready: &Ready<'_, P>, tasks: Range<usize>, most_edges: u32) -> Looks {
    let blocks = ready.blocks.count();
    let part = |task| part(ready, [task / blocks, task % blocks], most_edges);
    let parts: Vec<Looks> = tasks.into_par_iter().map(part).collect();
    parts.into_iter().fold(Looks::default(), |mut all, part| {
        all.seen.extend(part.seen);
        Looks { segments: all.segments + part.segments, ..all }
    })
}

fn part<P: Profile>(ready: &Ready<'_, P>, [pass, block]: [usize; 2], most_edges: u32) -> Looks {
    let Ready { estimator, blocks, scene, film, seed } = ready;
    let mut eye = Eye { scene, most_edges, walk: Vec::new(), looks: Looks::default() };
    let mut observer: &mut dyn Observer<P::MisSums> = &mut eye;
    let cache = blocks.trace_light(estimator, *seed, pass, block, &mut observer);
    for pixel in blocks.pixels(block) {
        let start = blocks.camera_start(scene, film, *seed, pass, pixel);
        let observer: &mut dyn Observer<P::MisSums> = &mut eye;
        start.trace(estimator, &cache, observer);
        eye.close();
    }
    eye.looks
}

/// A vertex of the camera subpath at hand.
struct Reached {
    seen: Seen,
    /// Of the subpath up to it.
    throughput: Spectrum,
    is_connectible: bool,
    /// Walks may end in it.
    is_dull: bool,
}

/// Follows camera subpaths.
struct Eye<'a> {
    scene: &'a Scene,
    most_edges: u32,
    walk: Vec<Reached>,
    looks: Looks,
}

impl Eye<'_> {
    /// The camera subpath at hand has ended.
    fn close(&mut self) {
        // Where the walk has to end, not all light comes.
        let whole = self.walk.drain(..).take((longest(self.most_edges) - self.most_edges) as usize);
        let ends = whole.filter(|reached| reached.is_dull);
        self.looks.seen.extend(ends.map(|reached| reached.seen));
    }

    /// Light comes to the last of so many `vertices` of the walk, and from there to those before that it could not be connected
    /// to, `edges` segments from its emitter.
    fn light(&mut self, vertices: usize, mut edges: u32, value: Spectrum) {
        let mut follows_connectible = false;
        for reached in self.walk[..vertices].iter_mut().rev() {
            if (reached.is_connectible && follows_connectible) || edges > self.most_edges {
                return;
            }
            if reached.is_connectible {
                let part = value / reached.throughput;
                reached.seen.radiance += Spectrum::select(part.is_finite_mask(), part, Spectrum::ZERO);
            }
            follows_connectible = reached.is_connectible;
            edges += 1;
        }
    }
}

impl<S: MisSums> Observer<S> for Eye<'_> {
    fn covers(&self, _: Vec2) -> bool {
        false
    }

    fn depart(&mut self, departure: &Departure<S>) {
        self.looks.segments += 1.0;
        if departure.edges == 0 {
            self.walk.clear();
        }
    }

    fn arrive(&mut self, vertex: &Vertex<S>) {
        let seen = vertex.seen(self.scene);
        let (is_connectible, is_dull) = (vertex.is_connectible(self.scene), vertex.is_dull(self.scene));
        self.walk.push(Reached { seen, throughput: vertex.subpath.throughput, is_connectible, is_dull });
    }

    fn contribute(&mut self, s: u32, t: u32, _: Meeting<'_, S>, contribution: Option<&Contribution>) {
        let Some(Contribution { alone, weight_alone, shares, .. }) = contribution else { return };
        let [hit, next_event] =
            [StrategyKind::EmitterHit, StrategyKind::NextEvent].map(|kind| shares[kind as usize]);
        // Emitters that a walk hits are those that the vertex before may have picked.
        let (vertices, part) = match s {
            0 => (t.saturating_sub(2), hit / (hit + next_event)),
            1 => (t - 1, next_event / (hit + next_event)),
            _ => (t - 1, 1.0),
        };
        // By the hero channel alone: how the others share a path is known of whole ones only.
        self.light(vertices as usize, s.max(1), *alone * (part / weight_alone));
    }
}
