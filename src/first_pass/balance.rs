//! How much light links should bring: lines from an element measure the part of its light that meets something.

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

/// Number of lines of an element.
const LINES: usize = 128;
/// Most relative noise with which the lines of a cluster are trusted. Chosen by hand, not derived.
const NOISE: f32 = 0.02;
/// Seed of the random numbers of lines.
const SEED: u64 = 0x6261_6c61_6e63_6500;

/// For each element, the part of the light sent into each bin that meets something.
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

/// Transmittance along a line of a `node` into a bin, up to where the line meets something; 0 if it meets nothing.
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

/// For each element, with all elements equally bright: the light due over the light `found`, both in the smallest
/// cluster around it whose lines have little noise. In a closed room, where all lines meet something, this is the
/// element itself.
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
