//! The first pass: a coarse solution of the scene, in elements (P03T ch. 4). Either links between elements and clusters
//! carry light ([`mod@links`], sec. 4.2), or particles do ([`particles`], sec. 4.3). The elements, their direct light
//! and their scattering are the same.

mod balance;
mod elements;
mod lamps;
mod links;
mod oracle;
mod particles;
mod point;
mod scattering;
#[cfg(test)]
mod tests;

use crate::{
    guide::{links::Links, solution::Solution},
    scene::Scene,
    settings::options::FirstPass,
};
use elements::Elements;

/// Elements of surfaces, and of media.
const ELEMENTS: usize = 2048;
/// Pairs of nodes whose links guide walks. There are fewer, for the density of a direction is a sum over all links of
/// an element.
const GUIDING: usize = 1 << 16;

/// The radiance scattered everywhere in `scene` by light that scatters at most `most_bounces` times; found by links or
/// by particles.
pub fn solve(scene: &Scene, method: FirstPass, most_bounces: u32) -> Solution {
    let elements = Elements::of(scene, ELEMENTS);
    let values = match method {
        FirstPass::Links => links::solve(scene, &elements, most_bounces, links::NUMBER),
        _ => particles::solve(scene, &elements, most_bounces, particles::LINES),
    };
    Solution { hierarchy: elements.hierarchy, values }
}

/// The links that bring scattered light to each element of `scene`, for walks that follow them.
pub fn links(scene: &Scene) -> Links {
    let elements = Elements::of(scene, ELEMENTS);
    let aims = links::aims(scene, &elements, GUIDING);
    Links { hierarchy: elements.hierarchy, aims }
}
