//! How much light links should bring. Lines of an element tell what part of its light meets anything; as much is to arrive, and where all
//! elements are as bright, each is to get as much as its lines find around it.

use super::{elements::Elements, scattering::Element};
use crate::{
    guide::{
        distribution::{Bins, Distribution},
        hierarchy::Hierarchy,
    },
    math::{Channels as _, Spectrum, Vec3},
    sampling::{Stream, stream::Purpose},
    scene::Scene,
    transport::{profiles::Everything, sample_free_flight},
};
use rayon::prelude::*;

/// Lines by which an element looks around.
const LINES: usize = 128;
/// Levels above an element at which what comes by links is compared with what should: there are lines enough.
const AROUND: usize = 4;
/// What comes by links that are not between neighbours, over what should, from which on that is no noise of lines.
const TOO_MUCH: f32 = 1.25;
/// What light of neighbours is multiplied with, at most, as their lines are few. Chosen by hand on four rooms: 2 made dense fog much too
/// dark; without a limit nothing was worse.
const MOST_NEAR: f32 = 8.0;
/// What comes to a single element over what should, at most.
const MOST: f32 = 2.0;
/// Of the random numbers of lines.
const SEED: u64 = 0x6261_6c61_6e63_6500;

/// The part of the light of each element that meets something, of what it sends into each bin.
pub(super) fn meets(scene: &Scene, elements: &Elements) -> Vec<Distribution> {
    let of = |(node, element): (&u32, &Element)| {
        let mut part = Distribution::dark(element.source.bins);
        let each = LINES.div_ceil(part.values.len());
        for (bin, value) in part.values.iter_mut().enumerate() {
            let mut stream = Stream::new(SEED, u64::from(*node), bin as u64, Purpose::Pilot);
            let line = |line| met(scene, elements, *node, (element.source.bins, bin), line, &mut stream);
            *value = (0..each).map(line).sum::<Spectrum>() / each as f32;
        }
        part
    };
    elements.hierarchy.elements.par_iter().zip(&elements.all).map(of).collect()
}

/// What is left of 1 where it meets something, along a line of a `node` into a bin.
fn met(
    scene: &Scene,
    elements: &Elements,
    node: u32,
    (bins, bin): (Bins, usize),
    line: usize,
    stream: &mut Stream,
) -> Spectrum {
    let point = elements.pick(node, stream.uniform_precisely());
    let normal = point.interaction.normal().unwrap_or(Vec3::Z);
    let direction = bins.leave(bin, normal, stream.square());
    if !point.is_live(direction) {
        return Spectrum::ZERO;
    }
    let ahead = point.ahead(scene, direction);
    let flight = sample_free_flight::<Everything>(ahead, line % 3, stream, &mut |_, _| ());
    let arrives = flight.interaction.is_some_and(|met| elements.receives(scene, &met, -direction));
    if arrives { flight.state.ratio.to_spectrum() * flight.state.tint } else { Spectrum::ZERO }
}

/// What light that comes to an element is to be multiplied with.
#[derive(Clone, Copy, Debug)]
pub(super) struct Balance {
    /// By links between neighbours, whose lines say least.
    near: Spectrum,
    /// By all others.
    far: Spectrum,
}

impl Balance {
    /// Of a link.
    #[inline]
    pub(super) fn of(&self, is_near: bool) -> Spectrum {
        if is_near { self.near } else { self.far }
    }
}

/// Those of all elements, where so much comes by links between `[neighbours, others]` and so much is `due`: neighbours make up for what
/// is missing or too much.
pub(super) fn balances(
    hierarchy: &Hierarchy,
    [near, far]: [&[Spectrum]; 2],
    due: &[Spectrum],
) -> Vec<Balance> {
    let around = |node: u32| hierarchy.upwards(node).nth(AROUND).unwrap_or(node);
    let balance = |(element, node): (usize, &u32)| {
        let own = hierarchy.nodes[around(*node) as usize].elements.clone();
        let own = own.start as usize..own.end as usize;
        let [due_there, near_there, far_there]: [Spectrum; 3] =
            [due, near, far].map(|of| of[own.clone()].iter().copied().sum());
        let missing = (due_there - far_there).max(Spectrum::ZERO);
        let near_by = over(missing, near_there).min(Spectrum::splat(MOST_NEAR));
        let far_by =
            Spectrum::select(far_there.cmpgt(TOO_MUCH * due_there), due_there / far_there, Spectrum::ONE);
        let all = near[element] * near_by + far[element] * far_by;
        let within = (MOST * over(due[element], all)).min(Spectrum::ONE);
        Balance { near: near_by * within, far: far_by * within }
    };
    hierarchy.elements.iter().enumerate().map(balance).collect()
}

/// `a` over `b`; 1 where that is nothing.
pub(super) fn over(a: Spectrum, b: Spectrum) -> Spectrum {
    Spectrum::select(b.cmpgt(Spectrum::ZERO), a / b, Spectrum::ONE)
}
