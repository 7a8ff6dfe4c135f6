//! How much light links should bring where all elements are as bright. More than that would multiply for ever between neighbours in
//! thick media.

use super::elements::Elements;
use crate::{
    guide::{distribution::Bins, hierarchy::Hierarchy},
    math::{Channels as _, Frame, Spectrum, warp},
    sampling::{Stream, stream::Purpose},
    scene::Scene,
    transport::{profiles::Everything, sample_free_flight},
};

/// Lines that say what is around an element, on each side.
const SURROUNDED: u64 = 64;
/// What comes by links, over what should, from which on that is no noise of lines.
const TOO_MUCH: f32 = 1.25;
/// Levels above an element at which what comes by links is compared with what should: there are lines enough.
const AROUND: usize = 4;
/// What comes to a single element, over what should, at most.
const MOST: f32 = 2.0;
/// Of the random numbers of lines.
const SEED: u64 = 0x6c69_6e6b_7300;

/// What light that comes to each element is to be multiplied with, where so much `came` by links and so much was `due`.
pub(super) fn factors(hierarchy: &Hierarchy, came: &[Spectrum], due: &[Spectrum]) -> Vec<Spectrum> {
    let around = |node: u32| hierarchy.upwards(node).nth(AROUND).unwrap_or(node);
    let factor = |(element, node): (usize, &u32)| {
        let own = hierarchy.nodes[around(*node) as usize].elements.clone();
        let own = own.start as usize..own.end as usize;
        let sum = |of: &[Spectrum]| of[own.clone()].iter().copied().sum::<Spectrum>();
        within(sum(came), sum(due), TOO_MUCH, 1.0).min(within(came[element], due[element], 0.0, MOST))
    };
    hierarchy.elements.iter().enumerate().map(factor).collect()
}

/// What takes light that `came` to so many times what is `due`, if it is more than so many times that; else 1.
fn within(came: Spectrum, due: Spectrum, allowed: f32, to: f32) -> Spectrum {
    Spectrum::select(came.cmpgt(allowed * due), to * due / came, Spectrum::ONE)
}

/// What would come to an element if all had the radiance 1. Lines that leave it by the cosine, or evenly, say so.
pub(super) fn surrounded(scene: &Scene, elements: &Elements, node: u32, bins: Bins) -> Spectrum {
    let mut all = Spectrum::ZERO;
    let sides: &[f32] = if matches!(bins, Bins::Sides(_)) { &[1.0, -1.0] } else { &[1.0] };
    for side in sides {
        for line in 0..SURROUNDED {
            let mut stream = Stream::sobol(SEED, u64::from(node), line, Purpose::Pilot);
            let u = stream.square();
            let point = elements.pick(node, stream.uniform_precisely());
            let direction = match point.interaction.normal().filter(|_| sides.len() > 1) {
                Some(normal) => Frame::around(*side * normal).to_world(warp::to_cosine_hemisphere(u)),
                None => warp::to_sphere(u),
            };
            let ahead = point.ahead(scene, direction);
            let flight =
                sample_free_flight::<Everything>(ahead, line as usize % 3, &mut stream, &mut |_, _| ());
            if flight.interaction.is_some_and(|met| met.is_connectible(scene)) {
                all += flight.state.ratio.to_spectrum() * flight.state.tint;
            }
        }
    }
    all * (bins.angle() * bins.count() as f32 / (SURROUNDED as usize * sides.len()) as f32)
}
