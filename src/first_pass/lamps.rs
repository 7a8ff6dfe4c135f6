//! Direct light at the elements from lamps without a surface: points, beams and skies, which are no elements.

use super::{elements::Elements, point::Point};
use crate::{
    emitter::Kind,
    guide::distribution::Distribution,
    sampling::{Stream, stream::Purpose},
    scene::{
        Scene,
        lights::{Aim, Light},
    },
};
use rayon::prelude::*;

/// Samples of each point of an element.
const SAMPLES: u64 = 4;
/// Seed of their random numbers.
const SEED: u64 = 0x6c61_6d70_7300;

fn is_lamp(light: &Light) -> bool {
    !matches!(light.emitter.kind, Kind::Surface(_) | Kind::Medium(_))
}

/// The direct light that comes to each element.
pub(super) fn light(scene: &Scene, elements: &Elements) -> Vec<Distribution> {
    let has_lamps = scene.lights.all.iter().any(is_lamp);
    let lit = |(element, node): (usize, &u32)| {
        let mut all = Distribution::dark(elements.all[element].source.bins);
        let points = elements.points(*node);
        for (index, point) in points.iter().enumerate().filter(|_| has_lamps) {
            let first = elements.hierarchy.nodes[*node as usize].points.start as u64 + index as u64;
            (0..SAMPLES).for_each(|sample| {
                let mut stream = Stream::new(SEED, first, sample, Purpose::Study);
                receive(scene, point, &mut all, (SAMPLES as usize * points.len()) as f32, &mut stream);
            });
        }
        all
    };
    elements.hierarchy.elements.par_iter().enumerate().map(lit).collect()
}

/// Adds what one of `of` samples finds.
fn receive(scene: &Scene, point: &Point, all: &mut Distribution, of: f32, stream: &mut Stream) {
    let position = point.interaction.position();
    let found = scene.lights.sample_emitter(&scene.geometry, position, Aim::default(), stream);
    let Some(sample) = found.filter(|sample| is_lamp(&scene.lights.all[sample.light as usize])) else {
        return;
    };
    if let Some((towards, part)) = point.line_to_light(scene, &sample.point, stream) {
        all.receive(towards, sample.value * part / (sample.pdf * of));
    }
}
