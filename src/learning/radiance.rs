//! Radiance, learnt for the preview `gather`: path tracing finds what lights places directly, and which places light each other.
//!
//! The radiance that a vertex scatters to the one before has three parts: next-event estimation there, emitters that
//! the walk hits next, and the part of the next vertex's radiance that the walk carries on. Mirrors, glass and glossy
//! surfaces are no places: what is seen in them belongs to the vertex before.

use crate::{
    film::Film,
    guide::{Learnt, Look, Radiance, Seen},
    math::Spectrum,
    passes::{
        Settings,
        blocks::{CameraStart, PIXELS_PER_BLOCK, blocks_for},
        compiled::{self, Compiled},
        observe::BlockObserver,
    },
    scene::Scene,
    transport::{
        Arrival, Contribution, Event, Leg, Options, Strategies,
        needs::Needs,
        observer::{Meeting, Observer},
        strategy::StrategyKind,
    },
};
use rayon::prelude::*;
use std::ops::Range;

/// Camera subpaths between two checks of the limits.
const STEP: usize = 16_384;
/// Limit of looks.
const LOOKS: usize = 1 << 20;
/// Limit of segments.
const SEGMENTS: f64 = 3e6;
/// Limit of camera subpaths: many may see nothing.
const SUBPATHS: usize = 1 << 20;
/// Most bounces of light where images have no limit: later ones bring little.
const DEEPEST: u32 = 1024;
/// Most segments of a walk.
const LONGEST: u32 = 32;
/// Segments to the last vertex whose radiance is complete: beyond, not all walks go on to another place.
const WHOLE: u32 = 24;

/// The radiance of `scene` by light of at most so many bounces from one place to another (no more than `DEEPEST`),
/// found by walks that follow what was `learnt`.
pub(super) fn learn(
    scene: &Scene,
    film: &Film,
    settings: &Settings,
    learnt: &Learnt,
    most_bounces: u32,
) -> Radiance {
    let options = Options { strategies: Strategies::PT, max_depth: Some(LONGEST), ..settings.options };
    let settings = Settings { options, ..*settings };
    let compiled = compiled::by_kind(scene, film, &settings, learnt.clone(), PIXELS_PER_BLOCK);
    let (mut all, mut done, mut subpaths) = (Looks::default(), 0, 0);
    while all.looks.len() < LOOKS && all.segments < SEGMENTS && subpaths < SUBPATHS {
        let tasks = done..done + blocks_for(film.len(), STEP);
        done = tasks.end;
        subpaths += STEP;
        all.add(look(&*compiled, tasks));
    }
    Radiance::learn(&all.looks, most_bounces.min(DEEPEST))
}

/// What was seen, and what it took.
#[derive(Default)]
struct Looks {
    looks: Vec<Look>,
    segments: f64,
}

impl Looks {
    fn add(&mut self, more: Self) {
        let first = self.looks.len() as u32;
        let after = |look: Look| Look { onward: look.onward.map(|(to, part)| (first + to, part)), ..look };
        self.looks.extend(more.looks.into_iter().map(after));
        self.segments += more.segments;
    }
}

/// Blocks of passes, numbered over all of them.
fn look(compiled: &dyn Compiled, tasks: Range<usize>) -> Looks {
    let blocks = compiled.blocks().count();
    let parts: Vec<Looks> =
        tasks.into_par_iter().map(|task| part(compiled, [task / blocks, task % blocks])).collect();
    parts.into_iter().fold(Looks::default(), |mut all, part| {
        all.add(part);
        all
    })
}

fn part(compiled: &dyn Compiled, [pass, block]: [usize; 2]) -> Looks {
    let scene = compiled.scene();
    let is_chromatic = Needs::of(scene, false).chromatic;
    let (channels, walk, looks) = (Spectrum::ONE, Vec::new(), Looks::default());
    let mut paths = CameraPaths { scene, is_chromatic, channels, walk, looks };
    compiled.observe(pass, block, &|_| true, &mut paths);
    paths.looks
}

/// A vertex of the camera subpath at hand.
struct Reached {
    seen: Seen,
    /// Of the subpath up to it.
    throughput: Spectrum,
    edges: u32,
    /// It is a place: walks may end in it.
    is_dull: bool,
}

/// Follows camera subpaths.
struct CameraPaths<'a> {
    scene: &'a Scene,
    is_chromatic: bool,
    /// 1 for those that the camera subpath at hand samples distances by, else 0.
    channels: Spectrum,
    walk: Vec<Reached>,
    looks: Looks,
}

impl CameraPaths<'_> {
    /// The camera subpath at hand has ended.
    fn close(&mut self) {
        let mut weights = self.channels;
        let mut places = self.walk.drain(..).filter(|reached| reached.is_dull).peekable();
        while let Some(Reached { seen, throughput, edges, .. }) = places.next() {
            let next = self.looks.looks.len() as u32 + 1;
            let is_whole = edges <= WHOLE;
            let after = places.peek().filter(|_| is_whole);
            let onward = after.map(|place| (next, ratio(place.throughput, throughput)));
            self.looks.looks.push(Look { seen, onward, weights, is_whole });
            weights = self.channels * onward.map_or(0.0, |(_, part)| (self.channels * part).max_element());
            if !is_whole {
                break;
            }
        }
    }

    /// Adds light that arrives at the last of so many `vertices` of the walk to the last place among these.
    fn light(&mut self, vertices: usize, value: Spectrum) {
        if let Some(place) = self.walk[..vertices].iter_mut().rev().find(|reached| reached.is_dull) {
            place.seen.radiance += ratio(value, place.throughput);
        }
    }
}

/// The quotient, 0 where there is none.
fn ratio(value: Spectrum, throughput: Spectrum) -> Spectrum {
    let ratio = value / throughput;
    Spectrum::select(ratio.is_finite_mask(), ratio, Spectrum::ZERO)
}

impl BlockObserver for CameraPaths<'_> {
    fn light(&mut self, _: u64) -> &mut dyn Observer {
        self
    }

    fn camera(&mut self, _: usize, start: &CameraStart) -> &mut dyn Observer {
        if self.is_chromatic {
            self.channels = Spectrum::AXES[start.hero];
        }
        self
    }

    fn ended(&mut self, _: usize) {
        self.close();
    }
}

impl Observer for CameraPaths<'_> {
    fn depart(&mut self, leg: &Leg) {
        self.looks.segments += 1.0;
        if leg.edges == 0 {
            self.walk.clear();
        }
    }

    fn arrive(&mut self, event: Event<'_>) {
        let (seen, is_dull) = (event.place(self.scene).seen(), event.is_dull(self.scene));
        let Arrival { throughput, edges, .. } = event.arrival;
        self.walk.push(Reached { seen, throughput, edges, is_dull });
    }

    fn contribute(&mut self, s: u32, t: u32, _: Meeting<'_>, contribution: Option<&Contribution>) {
        let Some(Contribution { alone, weight_alone, shares, .. }) = contribution else { return };
        let [hit, next_event] =
            [StrategyKind::EmitterHit, StrategyKind::NextEvent].map(|kind| shares[kind as usize]);
        // Emitters that a walk hits are those that the vertex before may have picked.
        let (vertices, part) = match s {
            0 => (t.saturating_sub(2), hit / (hit + next_event)),
            _ => (t - 1, next_event / (hit + next_event)),
        };
        // By the hero channel alone: how the others share a path is known of whole ones only.
        self.light(vertices as usize, *alone * (part / weight_alone));
    }
}
