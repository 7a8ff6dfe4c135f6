//! Radiance clustering (P03T sec. 4.2): links between elements and clusters, refined where much light goes, carry light until no more comes.

use super::{
    balance,
    elements::{Element, Elements},
    lamps,
    oracle::{self, Pair},
    point::Point,
};
use crate::{
    guide::{
        distribution::{Bins, Distribution},
        hierarchy::Node,
        links::{Aim, Aims},
    },
    math::{Spectrum, SpectrumExt, Vec3, measure},
    sampling::{Stream, stream::Purpose},
    scene::Scene,
};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Pairs of nodes that are linked.
pub(super) const NUMBER: usize = 1 << 19;
/// How often links are made: each time by the light that those before have carried, and four times as many.
const ROUNDS: u32 = 3;
/// Lines by which a link is measured.
const LINES: usize = 4;
/// Pairs of points that are tried for them.
const TRIES: usize = 16;
/// Links of an element that walks may follow.
const FOLLOWED: usize = 64;
/// Points of nodes that a line joins count as far apart as this part of both radii, at least.
const LEAST_APART: f32 = 0.1;
/// Part of all power that one more bounce brings, below which no more is to come.
const SETTLED: f32 = 1e-3;
/// How often light is carried, at most.
const MOST_BOUNCES: u32 = 64;
/// Of the random numbers of lines.
const SEED: u64 = 0x6c69_6e6b_7300;

/// What one of a link's lines carries.
#[derive(Clone, Copy, Debug)]
struct Link {
    /// The node that light comes from.
    sender: u32,
    /// The unit direction to it.
    towards: Vec3,
    /// |cos| at the point of the sender; 1 in a medium.
    cosine: f32,
    /// Transmittance over squared distance, over the number of lines (1/m^2).
    part: Spectrum,
    /// The point of the sender.
    from: Vec3,
    /// That distance (m).
    distance: f32,
}

/// Light that has come along a line.
struct Carried<'a> {
    link: &'a Link,
    /// Perpendicular irradiance where the line ends (W/m^2).
    irradiance: Spectrum,
}

impl Carried<'_> {
    /// From where it comes to a place in the cluster where the line ends, and what comes: the sender's point is seen from there.
    fn at(&self, place: Vec3) -> (Vec3, Spectrum) {
        let Link { from, distance, towards, .. } = *self.link;
        let Some((direction, _, squared)) = measure::between(place, from) else {
            return (towards, self.irradiance);
        };
        let squared = squared.max(0.25 * distance * distance);
        (direction, self.irradiance * (distance * distance / squared))
    }
}

/// All light there is.
struct State<'a> {
    elements: &'a Elements,
    /// What each element scatters of light that comes from lamps directly.
    direct: Vec<Distribution>,
    /// What each element scatters.
    values: Vec<Distribution>,
    /// 1, or 0 where what elements emit does not count.
    emits: f32,
    /// What each node sends: radiance on sides times area, else radiant intensity over directions (W/sr).
    sent: Vec<Distribution>,
    /// Power of each node (W), as luminance.
    power: Vec<f32>,
    /// What would come to each element if all had the radiance 1.
    surrounded: Vec<Spectrum>,
}

/// The radiance that elements scatter.
pub(super) fn solve(
    scene: &Scene,
    elements: &Elements,
    most_bounces: u32,
    number: usize,
) -> Vec<Distribution> {
    linked(scene, elements, most_bounces, number).0.values
}

/// Where each element gets the light that others scatter: the senders of its links and of those to clusters that it is in, as often as light comes from
/// each. A link whose lines fail to reach the sender is followed the less often (P03T eq. 5.5).
pub(super) fn aims(scene: &Scene, elements: &Elements, number: usize) -> Vec<Aims> {
    let (mut state, links) = linked(scene, elements, MOST_BOUNCES, number);
    state.emits = 0.0;
    state.pull();
    let boxes: Vec<Aim> =
        (0..elements.hierarchy.nodes.len()).into_par_iter().map(|node| elements.aim(node as u32)).collect();
    let aims = |(index, node): (usize, &u32)| {
        let mut chances = BTreeMap::new();
        for link in elements.hierarchy.upwards(*node).flat_map(|node| &links[node as usize]) {
            let cosine = elements.all[index].cosine(link.towards);
            *chances.entry(link.sender).or_insert(0.0) += state.carried(link).luminance() * cosine;
        }
        let aim = |(sender, chance): (u32, f32)| {
            (chance > 0.0).then(|| Aim { probability: chance, ..boxes[sender as usize] })
        };
        Aims::of(chances.into_iter().filter_map(aim).collect(), FOLLOWED)
    };
    elements.hierarchy.elements.par_iter().enumerate().map(aims).collect()
}

/// Light as links have carried it, and those.
fn linked<'a>(
    scene: &Scene,
    elements: &'a Elements,
    most_bounces: u32,
    number: usize,
) -> (State<'a>, Vec<Vec<Link>>) {
    let mut state = State::new(scene, elements);
    let mut links = Vec::new();
    for round in (0..ROUNDS).rev() {
        links = state.links(scene, number >> (2 * round));
        state.settle(&links, most_bounces);
    }
    (state, links)
}

impl<'a> State<'a> {
    fn new(scene: &Scene, elements: &'a Elements) -> Self {
        let lit = lamps::light(scene, elements);
        let direct: Vec<_> =
            lit.iter().zip(&elements.all).map(|(lit, element)| element.scatter(lit)).collect();
        let (values, sent, power) = (direct.clone(), Vec::new(), Vec::new());
        let around = |(node, element): (&u32, &Element)| {
            balance::surrounded(scene, elements, *node, element.source.bins)
        };
        let surrounded = elements.hierarchy.elements.par_iter().zip(&elements.all).map(around).collect();
        let mut state = Self { elements, direct, values, emits: 1.0, sent, power, surrounded };
        state.pull();
        state
    }

    /// What an element sends: radiance on sides times area, else radiant intensity over directions (W/sr).
    fn sent(&self, node: &Node) -> Distribution {
        let element = node.elements.start as usize;
        let (own, source) = (&self.values[element], &self.elements.all[element].source);
        let sum = |(own, source): (&Spectrum, &Spectrum)| (*own + self.emits * *source) * node.measure;
        Distribution { bins: own.bins, values: own.values.iter().zip(&source.values).map(sum).collect() }
    }

    /// The light of clusters is that of their parts.
    fn pull(&mut self) {
        let nodes = &self.elements.hierarchy.nodes;
        let mut all: Vec<Distribution> = vec![Distribution::dark(Bins::Equal(1)); nodes.len()];
        for (index, node) in nodes.iter().enumerate().rev() {
            all[index] = match node.parts {
                None => self.sent(node),
                Some(parts) => {
                    let mut sum = Distribution::dark(self.elements.bins[index]);
                    parts.iter().for_each(|part| sum.gather(&all[*part as usize]));
                    sum
                }
            };
        }
        self.power = all.iter().map(|sent| sent.sum().luminance() * sent.bins.angle()).collect();
        self.sent = all;
    }

    /// What comes by a link (W/m^2), from where.
    #[inline]
    fn carried(&self, link: &Link) -> Spectrum {
        let sent = &self.sent[link.sender as usize];
        let cosine = if matches!(sent.bins, Bins::Sides(_)) { link.cosine } else { 1.0 };
        sent.at(-link.towards) * link.part * cosine
    }

    /// Carries light until no more comes, or it is scattered `most` times.
    fn settle(&mut self, links: &[Vec<Link>], most: u32) {
        let balance = self.balance(links);
        let mut all: Vec<_> = self.direct.iter().map(|direct| Distribution::dark(direct.bins)).collect();
        self.values.clone_from(&all);
        let mut before = f32::INFINITY;
        for bounce in 0..most.min(MOST_BOUNCES) {
            self.pull();
            let mut more = self.carry(links, &balance);
            if bounce == 0 {
                // The light of emitting elements and that of lamps arrive for the first time.
                more.iter_mut().zip(&self.direct).for_each(|(more, direct)| more.add(direct));
                self.emits = 0.0;
            }
            let mut power = self.elements.power(&more);
            // Light does not grow; where links multiply it, they are too few for how it is scattered.
            if power > before {
                let back = before / power;
                more.iter_mut().flat_map(|more| &mut more.values).for_each(|value| *value *= back);
                power = before;
            }
            all.iter_mut().zip(&more).for_each(|(all, more)| all.add(more));
            self.values = more;
            before = power;
            if power <= SETTLED * self.elements.power(&all) {
                break;
            }
        }
        (self.values, self.emits) = (all, 1.0);
        self.pull();
    }

    /// What comes to each element by `links`.
    fn incoming(&self, links: &[Vec<Link>]) -> Vec<Distribution> {
        let hierarchy = &self.elements.hierarchy;
        let carried = |link| Carried { link, irradiance: self.carried(link) };
        let carried: Vec<Vec<Carried<'_>>> =
            links.par_iter().map(|links| links.iter().map(carried).collect()).collect();
        let receive = |(index, node): (usize, &u32)| {
            let mut incoming = Distribution::dark(self.values[index].bins);
            for came in &carried[*node as usize] {
                incoming.receive(came.link.towards, came.irradiance);
            }
            // What comes to a cluster is pushed down at once.
            let place = hierarchy.nodes[*node as usize].centre();
            for came in hierarchy.upwards(*node).skip(1).flat_map(|node| &carried[node as usize]) {
                let (towards, irradiance) = came.at(place);
                incoming.receive(towards, irradiance);
            }
            incoming
        };
        hierarchy.elements.par_iter().enumerate().map(receive).collect()
    }

    /// What light that comes to each element by `links` is to be multiplied with. If all elements had the same radiance, no more should
    /// come than lines from each find around it: that would multiply for ever between neighbours in thick media.
    fn balance(&mut self, links: &[Vec<Link>]) -> Vec<Spectrum> {
        let (values, emits) = (self.values.clone(), std::mem::take(&mut self.emits));
        self.values.iter_mut().for_each(|value| value.values.fill(Spectrum::ONE));
        self.pull();
        let came: Vec<Spectrum> = self.incoming(links).iter().map(Distribution::sum).collect();
        (self.values, self.emits) = (values, emits);
        balance::factors(&self.elements.hierarchy, &came, &self.surrounded)
    }

    /// What elements scatter of what links carry.
    fn carry(&self, links: &[Vec<Link>], balance: &[Spectrum]) -> Vec<Distribution> {
        let incoming = self.incoming(links);
        let scatter = |(index, mut incoming): (usize, Distribution)| {
            incoming.values.iter_mut().for_each(|value| *value *= balance[index]);
            self.elements.all[index].scatter(&incoming)
        };
        incoming.into_par_iter().enumerate().map(scatter).collect()
    }

    /// About so many, by the nodes that they lead to.
    fn links(&self, scene: &Scene, number: usize) -> Vec<Vec<Link>> {
        let hierarchy = &self.elements.hierarchy;
        let pairs = oracle::refine(hierarchy, &self.power, number);
        let measured: Vec<_> = pairs.par_iter().map(|pair| self.measure(scene, pair)).collect();
        let mut links = vec![Vec::new(); hierarchy.nodes.len()];
        for (pair, measured) in pairs.iter().zip(measured) {
            links[pair.receiver as usize].extend(measured);
        }
        links
    }

    /// The lines of a link between points of both nodes that see each other.
    fn measure(&self, scene: &Scene, &Pair { sender, receiver, .. }: &Pair) -> Vec<Link> {
        let [a, b] = [sender, receiver].map(|node| &self.elements.hierarchy.nodes[node as usize]);
        let is_flat = a.parts.is_none() || matches!(self.elements.bins[sender as usize], Bins::Sides(_));
        let least = LEAST_APART * (a.radius() + b.radius());
        let mut stream = Stream::new(SEED, u64::from(sender), u64::from(receiver), Purpose::Study);
        let mut pair = |_| {
            let [from, to] =
                [sender, receiver].map(|node| self.elements.pick(node, stream.uniform_precisely()));
            let (towards, ..) = measure::between(to.interaction.position(), from.interaction.position())?;
            (from.is_live(-towards) && to.is_live(towards)).then_some((from, to))
        };
        // A cluster is not in its own way: what faces the other counts.
        let facing: Vec<_> = (0..TRIES).filter_map(&mut pair).take(LINES).collect();
        let line = |&(from, to): &(&Point, &Point)| {
            let (towards, transmittance) = to.line_to(scene, from, &mut stream)?;
            // A cluster that is seen from around counts as if all of its light came from its middle.
            let at = if is_flat { from.interaction.position() } else { a.centre() };
            let distance = at.distance(to.interaction.position()).max(least);
            let part = transmittance / (distance * distance * facing.len() as f32);
            Some(Link { sender, towards, cosine: from.cosine(towards), part, from: at, distance })
        };
        facing.iter().filter_map(line).collect()
    }
}
