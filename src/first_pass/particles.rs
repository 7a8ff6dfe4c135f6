//! Hierarchical Monte Carlo radiosity (P03T sec. 4.3): particles carry the unsent power of elements along lines. Each
//! is deposited at the highest level of the hierarchy that suffices.

use super::{elements::Elements, lamps, oracle};
use crate::{
    bsdf::{BsdfModel as _, Transport},
    guide::{
        distribution::{Bins, Distribution},
        hierarchy::Node,
    },
    math::{Channels as _, Spectrum, Vec3},
    sampling::{Discrete, Stream, stream::Purpose},
    scene::Scene,
    shape::SurfacePoint,
    transport::{Interaction, Segment, profiles::Everything, sample_free_flight},
};
use rayon::prelude::*;

/// Lines for the power of lamps and emitting elements; later rounds have fewer lines as they have less power.
pub(super) const LINES: usize = 1 << 20;
/// Part of that power that is not worth sending.
const LEFT: f32 = 1e-3;
/// Most lines in all: white media hold light for thousands of rounds.
const MOST_LINES: usize = 1 << 23;
/// A round takes at most one in so many of the remaining lines, so that some are left for the last.
const AT_ONCE: usize = 8;
/// Part of all sent power that a line may misplace (see [`oracle::error`]).
const MISPLACED: f32 = 1e-8;
/// Most mirrors, panes and lenses that a particle passes.
const MOST_SPECULAR: u32 = 64;
/// Seed of the random numbers of lines.
const SEED: u64 = 0x6c69_6e65_7300;

/// The radiance that elements scatter.
pub(super) fn solve(
    scene: &Scene,
    elements: &Elements,
    most_bounces: u32,
    lines: usize,
) -> Vec<Distribution> {
    let scatter = |lit: Vec<Distribution>| -> Vec<Distribution> {
        lit.par_iter().zip(&elements.all).map(|(lit, element)| element.scatter(lit)).collect()
    };
    let dark = || elements.all.iter().map(|element| Distribution::dark(element.source.bins));
    let mut all: Vec<Distribution> = dark().collect();
    let mut unsent: Vec<_> = elements.all.iter().map(|element| element.source.clone()).collect();
    let mut first = 0.0;
    let mut direct = Some(lamps::light(scene, elements));
    let mut sent = 0;
    for round in 0..u64::from(most_bounces) {
        let power = elements.powers(&unsent);
        let total: f32 = power.iter().sum();
        first = f32::max(first, total);
        let number = (lines as f32 * (total / first.max(f32::MIN_POSITIVE))) as usize;
        let number = number.min((MOST_LINES - sent) / AT_ONCE).max(elements.all.len());
        sent = MOST_LINES.min(sent + number);
        let mut lit = deposit(scene, elements, &Sent { unsent, power }, number, round);
        for (lit, direct) in lit.iter_mut().zip(direct.take().into_iter().flatten()) {
            lit.add(&direct);
        }
        unsent = scatter(lit);
        all.iter_mut().zip(&unsent).for_each(|(all, more)| all.add(more));
        let left: f32 = elements.power(&unsent);
        first = f32::max(first, left);
        if left <= LEFT * first || sent >= MOST_LINES {
            break;
        }
    }
    all
}

/// What a round of lines carries.
struct Sent {
    unsent: Vec<Distribution>,
    /// The power of each element (W), as luminance.
    power: Vec<f32>,
}

/// Where a line ends.
struct Deposit {
    receiver: u32,
    /// The unit direction that it comes from.
    towards: Vec3,
    /// Power (W).
    power: Spectrum,
}

/// The light that comes to each element by so many lines.
fn deposit(scene: &Scene, elements: &Elements, sent: &Sent, number: usize, round: u64) -> Vec<Distribution> {
    let dark = elements.all.iter().map(|element| Distribution::dark(element.source.bins));
    let mut all: Vec<Distribution> = dark.collect();
    let chances = Discrete::new(sent.power.iter().map(|power| f64::from(*power)));
    if chances.is_empty() {
        return all;
    }
    let misplaced = MISPLACED * sent.power.iter().sum::<f32>();
    let lines: Vec<Vec<Deposit>> = (0..number)
        .into_par_iter()
        .map(|line| {
            let mut stream = Stream::new(SEED, line as u64, round, Purpose::Study);
            // Each element sends its share of lines, to within one.
            let (element, probability) =
                chances.sample_precisely((line as f64 + stream.uniform_precisely()) / number as f64);
            let start = Start { element, over: (probability * number as f64).recip() as f32, hero: line % 3 };
            fly(scene, elements, sent, misplaced, &start, &mut stream)
        })
        .collect();
    for Deposit { receiver, towards, power } in lines.into_iter().flatten() {
        let node = &elements.hierarchy.nodes[receiver as usize];
        let own = || node.elements.clone().map(|element| element as usize);
        let facing = |element: usize| {
            elements.hierarchy.node(element as u32).measure * elements.all[element].cosine(towards)
        };
        let measure: Spectrum = own().map(facing).sum();
        let irradiance = Spectrum::select(measure.cmpgt(Spectrum::ZERO), power / measure, Spectrum::ZERO);
        own().for_each(|element| all[element].receive(towards, irradiance));
    }
    all
}

/// How a line begins.
struct Start {
    element: usize,
    /// 1 over the lines that are expected of the element.
    over: f32,
    /// The channel that samples distances.
    hero: usize,
}

/// Follows one line, on beyond mirrors and glass; where it ends, and the mirrors that scatter too.
fn fly(
    scene: &Scene,
    elements: &Elements,
    sent: &Sent,
    misplaced: f32,
    start: &Start,
    stream: &mut Stream,
) -> Vec<Deposit> {
    let mut deposits = Vec::new();
    let node = elements.hierarchy.elements[start.element];
    let point = elements.pick(node, stream.uniform_precisely());
    let unsent = &sent.unsent[start.element];
    let normal = point.interaction.normal().unwrap_or(Vec3::Z);
    let Some((direction, over)) = unsent.sample(normal, stream) else { return deposits };
    let sender = &elements.hierarchy.nodes[node as usize];
    // What is even on both sides is sent by the cosine.
    let cosine = if matches!(unsent.bins, Bins::Sides(_)) { 1.0 } else { point.cosine(direction) };
    let mut power = unsent.at(direction) * sender.measure * (over * start.over * cosine);
    let mut segment = point.ahead(scene, direction);
    for _ in 0..MOST_SPECULAR {
        let before = segment;
        let flight = sample_free_flight::<Everything>(segment, start.hero, stream, &mut |_, _| ());
        power *= flight.state.ratio.to_spectrum() * flight.state.tint;
        let Some(interaction) = flight.interaction else { break };
        let towards = -before.ray().direction;
        if interaction.is_connectible(scene) {
            let receiver = receiver(elements, misplaced, sender, sent.power[start.element], &interaction);
            deposits.extend(receiver.map(|receiver| Deposit { receiver, towards, power }));
        }
        let Interaction::Surface(surface) = interaction else { break };
        let Some((onward, weight)) = specular(scene, &surface, towards, stream) else { break };
        power *= weight;
        let medium = scene.medium_towards(&surface, towards, onward, flight.medium);
        segment = Segment::along(scene, surface.leaving(onward), medium, false);
    }
    deposits
}

/// The highest node around the place that may receive the light as a whole.
fn receiver(
    elements: &Elements,
    misplaced: f32,
    sender: &Node,
    power: f32,
    place: &Interaction,
) -> Option<u32> {
    let hierarchy = &elements.hierarchy;
    let own = hierarchy.elements[elements.at(place)? as usize];
    let admits = |node: &u32| oracle::error(sender, &hierarchy.nodes[*node as usize], power) <= misplaced;
    Some(hierarchy.upwards(own).take_while(admits).last().unwrap_or(own))
}

/// Where a mirror or glass sends what comes from unit `towards`, and how much of it; none if it does not.
fn specular(
    scene: &Scene,
    point: &SurfacePoint,
    towards: Vec3,
    stream: &mut Stream,
) -> Option<(Vec3, Spectrum)> {
    let bsdf = scene.bsdf(point.shape);
    if !bsdf.has_dirac() {
        return None;
    }
    let wi = point.shading.to_local(towards);
    let sample = scene.at(point, |bsdf, uv| bsdf.sample(uv, wi, Transport::Importance, stream))?;
    sample.dirac.then(|| (point.shading.to_world(sample.wo), sample.weight))
}
