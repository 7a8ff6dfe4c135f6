//! How much light links should bring: lines of an element tell what part of its light meets anything.

use super::{elements::Elements, scattering::Element};
use crate::{
    guide::{
        distribution::{self, Bins, Distribution},
        hierarchy::Hierarchy,
    },
    math::{Channels as _, Spectrum, SpectrumExt as _, Vec3},
    sampling::{Stream, stream::Purpose},
    scene::Scene,
    transport::{profiles::Everything, sample_free_flight},
};
use rayon::prelude::*;

/// Lines by which an element looks around.
const LINES: usize = 128;
/// Relative noise up to which the lines of a cluster are believed. Chosen by hand, not derived.
const NOISE: f32 = 0.02;
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

/// What is to come to each element if all are as bright, over what was `found` to come, in the smallest cluster around it whose lines
/// have little noise: in a closed room, where all of them meet something, that is the element.
pub(super) fn coming(hierarchy: &Hierarchy, meets: &[Distribution], found: &[Spectrum]) -> Vec<Spectrum> {
    let due: Vec<Spectrum> = meets.iter().map(|meets| meets.sum() * meets.bins.angle()).collect();
    let parts: Vec<f32> =
        meets.iter().map(|meets| meets.sum().luminance() / meets.values.len() as f32).collect();
    let is_known = |node: &u32| {
        let own = &parts[hierarchy.nodes[*node as usize].within()];
        let variance = own.iter().map(|part| part * (1.0 - part).max(0.0)).sum::<f32>() / LINES as f32;
        variance < (NOISE * own.iter().sum::<f32>()).powi(2)
    };
    let over = |node: &u32| {
        let around = hierarchy.upwards(*node).take_while(|node| !is_known(node)).last();
        let around = around.map_or(*node, |node| hierarchy.nodes[node as usize].parent.unwrap_or(node));
        let own = hierarchy.nodes[around as usize].within();
        let [due, found]: [Spectrum; 2] = [&due[..], found].map(|of| of[own.clone()].iter().copied().sum());
        distribution::over(due, found)
    };
    hierarchy.elements.par_iter().map(over).collect()
}
