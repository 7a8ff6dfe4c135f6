//! Radiance clustering (P03T sec. 4.2): links between elements and clusters carry light until it settles. They are
//! refined where they carry much.

use super::{
    balance,
    elements::Elements,
    lamps,
    oracle::{self, Pair},
    point::Point,
    scattering::Element,
};
use crate::{
    guide::{
        distribution::{self, Bins, Distribution},
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
/// Rounds of making links: each uses the light that the links before have carried, and makes four times as many.
const ROUNDS: u32 = 3;
/// Lines that measure a link.
const LINES: usize = 4;
/// Pairs of points tried for these lines.
const TRIES: usize = 16;
/// Links of an element that walks may follow.
const FOLLOWED: usize = 64;
/// Least distance between the ends of a line, over the sum of both nodes' radii.
const LEAST_APART: f32 = 0.1;
/// Light has settled when one more bounce brings at most this part of all power.
const SETTLED: f32 = 1e-3;
/// Most bounces of light.
const MOST_BOUNCES: u32 = 64;
/// Seed of the random numbers of lines.
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

impl Link {
    /// |cos| at the sender, if the light that it sends does not contain it: for sides.
    fn cosine_for(&self, sent: Bins) -> f32 {
        if matches!(sent, Bins::Sides(_)) { self.cosine } else { 1.0 }
    }

    /// The unit direction to the sender from a place in the receiving cluster, and the irradiance there over that at
    /// the line's end.
    fn seen_from(&self, place: Vec3) -> (Vec3, f32) {
        let Some((towards, _, squared)) = measure::between(place, self.from) else {
            return (self.towards, 1.0);
        };
        let own = self.distance * self.distance;
        (towards, own / squared.max(0.25 * own))
    }
}

/// What one line brings to one element: the same for every bounce.
struct Arrival {
    /// The node that light comes from.
    sender: u32,
    /// The bin of what the sender sends.
    leaves: u16,
    /// The bin of what the element receives.
    arrives: u16,
    /// What is received there (W/m^2), over what is sent.
    part: Spectrum,
}

/// All light there is.
struct State<'a> {
    elements: &'a Elements,
    /// The direct light of lamps that each element scatters.
    direct: Vec<Distribution>,
    /// What each element scatters.
    values: Vec<Distribution>,
    /// 1, or 0 where what elements emit does not count.
    emits: f32,
    /// What each node sends: radiance on sides times area, else radiant intensity over directions (W/sr).
    sent: Vec<Distribution>,
    /// Power of each node (W), as luminance.
    power: Vec<f32>,
    /// The part of what each element sends that meets something.
    meets: Vec<Distribution>,
    /// What each element sends is multiplied with this: see [`State::balance`].
    leaving: Vec<Distribution>,
    /// What comes to each element is multiplied with this.
    coming: Vec<Spectrum>,
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

/// Where each element gets scattered light from: the senders of links to it and to clusters around it, each with a
/// probability in proportion to its light. A link whose lines miss the sender is followed less often (P03T eq. 5.5).
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

/// The light that links have carried, and these links.
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
        let meets = balance::meets(scene, elements);
        let leaving = meets.iter().map(|meets| Distribution::even(meets.bins)).collect();
        let coming = vec![Spectrum::ONE; direct.len()];
        let mut state = Self { elements, direct, values, emits: 1.0, sent, power, meets, leaving, coming };
        state.pull();
        state
    }

    /// What an element sends: radiance on sides times area, else radiant intensity over directions (W/sr).
    fn sent(&self, index: usize) -> Distribution {
        let (own, element) = (&self.values[index], &self.elements.all[index]);
        let measure = self.elements.hierarchy.node(index as u32).measure;
        let sum = |bin| {
            let radiance = own.values[bin] + self.emits * element.source.values[bin];
            radiance * measure * element.cosine_of(bin)
        };
        Distribution { bins: own.bins, values: (0..own.values.len()).map(sum).collect() }
    }

    /// The light of clusters is that of their parts, as balanced.
    fn pull(&mut self) {
        let nodes = &self.elements.hierarchy.nodes;
        let mut all: Vec<Distribution> = vec![Distribution::dark(Bins::Equal(1)); nodes.len()];
        for (index, node) in nodes.iter().enumerate().rev() {
            all[index] = match node.parts {
                None => {
                    let element = node.elements.start as usize;
                    self.sent(element).times(&self.leaving[element])
                }
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

    /// Perpendicular irradiance (W/m^2) at the end of a line.
    fn carried(&self, link: &Link) -> Spectrum {
        let sent = &self.sent[link.sender as usize];
        sent.at(-link.towards) * link.part * link.cosine_for(sent.bins)
    }

    /// Carries light until it settles or has scattered `most` times.
    fn settle(&mut self, links: &[Vec<Link>], most: u32) {
        let arrivals = self.arrivals(links);
        self.balance(&arrivals);
        let mut all: Vec<_> = self.direct.iter().map(|direct| Distribution::dark(direct.bins)).collect();
        self.values.clone_from(&all);
        for bounce in 0..most.min(MOST_BOUNCES) {
            self.pull();
            let mut more = self.carry(&arrivals);
            if bounce == 0 {
                // The light of emitting elements and that of lamps arrive for the first time.
                more.iter_mut().zip(&self.direct).for_each(|(more, direct)| more.add(direct));
                self.emits = 0.0;
            }
            all.iter_mut().zip(&more).for_each(|(all, more)| all.add(more));
            self.values = more;
            if self.elements.power(&self.values) <= SETTLED * self.elements.power(&all) {
                break;
            }
        }
        (self.values, self.emits) = (all, 1.0);
        self.pull();
    }

    /// What `links` bring to each element. Light to a cluster is pushed down to its elements.
    fn arrivals(&self, links: &[Vec<Link>]) -> Vec<Vec<Arrival>> {
        let hierarchy = &self.elements.hierarchy;
        let of = |(index, node): (usize, &u32)| {
            let lines = hierarchy.upwards(*node).flat_map(|above| {
                links[above as usize].iter().map(move |link| (link, self.pushed(link, above, *node)))
            });
            let mut own: Vec<_> =
                lines.map(|(link, (towards, more))| self.arrival(index, link, towards, more)).collect();
            // There are millions.
            own.shrink_to_fit();
            own
        };
        hierarchy.elements.par_iter().enumerate().map(of).collect()
    }

    /// What comes to an element by one line from unit `towards`, `more` times as much as at the line's end.
    fn arrival(&self, element: usize, link: &Link, towards: Vec3, more: f32) -> Arrival {
        let [sent, own] = [self.elements.bins[link.sender as usize], self.elements.all[element].source.bins];
        Arrival {
            sender: link.sender,
            leaves: sent.of(-towards) as u16,
            arrives: own.of(towards) as u16,
            part: link.part * (link.cosine_for(sent) * own.cosine(towards) * more),
        }
    }

    /// The unit direction from which a link to the cluster `above` lights its part `node`, and the irradiance there
    /// over that at the line's end. Each part has its own direction to the sender: collimated light must not be turned.
    fn pushed(&self, link: &Link, above: u32, node: u32) -> (Vec3, f32) {
        if above == node {
            return (link.towards, 1.0);
        }
        link.seen_from(self.elements.hierarchy.nodes[node as usize].centre())
    }

    /// What comes to each element.
    fn incoming(&self, arrivals: &[Vec<Arrival>]) -> Vec<Distribution> {
        let receive = |(index, own): (usize, &Vec<Arrival>)| {
            let mut incoming = Distribution::dark(self.elements.all[index].source.bins);
            for Arrival { sender, leaves, arrives, part } in own {
                let sent = self.sent[*sender as usize].values[usize::from(*leaves)];
                incoming.values[usize::from(*arrives)] += sent * *part;
            }
            incoming.scaled(self.coming[index])
        };
        arrivals.par_iter().enumerate().map(receive).collect()
    }

    /// Corrects links that have too few lines in some directions and too many in others. The part of an element's light
    /// that arrives is, for each bin, the one that the element's own lines measure: a direction that brought more would
    /// keep its light in thick media for ever. If all elements are equally bright, an element receives what its own
    /// lines measure. [`State::carry`] makes up for bins that no link serves.
    fn balance(&mut self, arrivals: &[Vec<Arrival>]) {
        self.coming.fill(Spectrum::ONE);
        self.leaving = self.leaving(arrivals);
        self.coming = self.coming(arrivals);
        self.leaving = self.leaving(arrivals);
    }

    /// For each bin of each element: the light due to arrive elsewhere over the light that links bring there.
    fn leaving(&self, arrivals: &[Vec<Arrival>]) -> Vec<Distribution> {
        let (delivered, hierarchy) = (self.delivered(arrivals), &self.elements.hierarchy);
        let over = |(node, meets): (&u32, &Distribution)| {
            let mut brought = Distribution::dark(meets.bins);
            hierarchy.upwards(*node).for_each(|node| brought.part_of(&delivered[node as usize]));
            let due = meets.clone().scaled(Spectrum::splat(meets.bins.angle()));
            due.over(&brought)
        };
        hierarchy.elements.par_iter().zip(&self.meets).map(over).collect()
    }

    /// For each element, with all elements equally bright: the light due over the light that links bring.
    fn coming(&mut self, arrivals: &[Vec<Arrival>]) -> Vec<Spectrum> {
        let even = self.meets.iter().map(|meets| Distribution::even(meets.bins)).collect();
        let (values, emits) = (std::mem::replace(&mut self.values, even), std::mem::take(&mut self.emits));
        self.pull();
        let incoming = self.incoming(arrivals);
        (self.values, self.emits) = (values, emits);
        let found: Vec<Spectrum> = incoming.iter().map(Distribution::sum).collect();
        balance::coming(&self.elements.hierarchy, &self.meets, &found)
    }

    /// The power (W) that arrives per unit that each node sends into each bin.
    fn delivered(&self, arrivals: &[Vec<Arrival>]) -> Vec<Distribution> {
        let mut all: Vec<_> = self.elements.bins.iter().map(|bins| Distribution::dark(*bins)).collect();
        for (index, own) in arrivals.iter().enumerate() {
            let measure = self.elements.hierarchy.node(index as u32).measure * self.coming[index];
            for Arrival { sender, leaves, arrives, part } in own {
                let received = *part * self.elements.all[index].cosine_of(usize::from(*arrives));
                all[*sender as usize].values[usize::from(*leaves)] += measure * received;
            }
        }
        all
    }

    /// The light that elements scatter after links carried it, scaled so that all light that meets something arrives.
    fn carry(&self, arrivals: &[Vec<Arrival>]) -> Vec<Distribution> {
        let incoming = self.incoming(arrivals);
        let scale = distribution::over(self.arriving(), self.arrived(&incoming));
        let scatter =
            |(element, incoming): (&Element, Distribution)| element.scatter(&incoming.scaled(scale));
        self.elements.all.par_iter().zip(incoming).map(scatter).collect()
    }

    /// The power that elements send to others (W).
    fn arriving(&self) -> Spectrum {
        let part = |(element, meets): (usize, &Distribution)| {
            self.sent(element).times(meets).sum() * meets.bins.angle()
        };
        self.meets.iter().enumerate().map(part).sum()
    }

    /// The power that comes to elements (W).
    fn arrived(&self, incoming: &[Distribution]) -> Spectrum {
        let hierarchy = &self.elements.hierarchy;
        let received = |(index, incoming): (usize, &Distribution)| {
            hierarchy.node(index as u32).measure * self.elements.all[index].received(incoming)
        };
        incoming.iter().enumerate().map(received).sum()
    }

    /// About `number` links, by their receiving nodes.
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
