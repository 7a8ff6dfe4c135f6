//! Building a light tree, from the root down: the cluster with the greatest spread is split until there are four.

use super::{BITS, DEEPEST, LEAF, LightTree, Moments, Node, WIDTH, moments::SOFTNESS};
use crate::math::DVec3;
use glam::Vec4;
use std::ops::Range;

/// Levels that are split at the best place; those below are split in the middle, so that paths fit in 64 bits.
const FREE_LEVELS: u32 = DEEPEST / 2;

/// The least power of a child, as a part of all, and the least squared distance (m^2): their ratio is finite in f32.
const LEAST: f64 = 1e-30;

struct Leaf {
    number: u32,
    moments: Moments,
}

struct Builder {
    leaves: Vec<Leaf>,
    nodes: Vec<Node>,
    paths: Vec<u64>,
    /// Of all leaves.
    power: f64,
    /// The least softening (m^2).
    least: f64,
}

/// A cluster: a range of the leaves and their sum.
#[derive(Clone)]
struct Cluster {
    range: Range<usize>,
    moments: Moments,
}

impl LightTree {
    /// A tree over emitting leaves, numbered below `count`: those `far` away, which are one cluster at the root, and
    /// those `near`. None for fewer than two leaves. Distances below `least` (m) make no difference.
    pub(crate) fn new(
        far: Vec<(u32, Moments)>,
        near: Vec<(u32, Moments)>,
        count: usize,
        least: f64,
    ) -> Option<Self> {
        let apart = far.len();
        let leaves: Vec<Leaf> =
            far.into_iter().chain(near).map(|(number, moments)| Leaf { number, moments }).collect();
        if leaves.len() < 2 {
            return None;
        }
        let power = sum(&leaves).power;
        let paths = vec![0; count];
        let mut builder = Builder { leaves, nodes: Vec::new(), paths, power, least: least * least };
        let all = 0..builder.leaves.len();
        let first = [0..apart, apart..all.end].into_iter().filter(|range| !range.is_empty());
        let first = first.map(|range| builder.cluster(range)).collect();
        builder.node(first, 0, 0);
        Some(Self { nodes: builder.nodes, paths: builder.paths })
    }
}

impl Builder {
    fn cluster(&self, range: Range<usize>) -> Cluster {
        Cluster { moments: sum(&self.leaves[range.clone()]), range }
    }

    /// The node over `clusters`, split further; its number.
    fn node(&mut self, clusters: Vec<Cluster>, level: u32, path: u64) -> u32 {
        let number = self.nodes.len() as u32;
        let clusters = self.divide(clusters, level);
        self.nodes.push(self.summarise(&clusters));
        for (lane, cluster) in clusters.into_iter().enumerate() {
            let path = path | (lane as u64) << (BITS * level);
            let child = match cluster.range.len() {
                1 => self.leaf(cluster.range.start, path),
                _ => self.node(vec![cluster], level + 1, path),
            };
            self.nodes[number as usize].children[lane] = child;
        }
        number
    }

    fn leaf(&mut self, index: usize, path: u64) -> u32 {
        let number = self.leaves[index].number;
        self.paths[number as usize] = path;
        number | LEAF
    }

    /// Splits until there are four, or nothing is left to split.
    fn divide(&mut self, mut clusters: Vec<Cluster>, level: u32) -> Vec<Cluster> {
        while clusters.len() < WIDTH {
            let cost = |cluster: &Cluster| if level < FREE_LEVELS { cluster.moments.spread() } else { 0.0 };
            let order = |a: &(usize, &Cluster), b: &(usize, &Cluster)| {
                cost(a.1).total_cmp(&cost(b.1)).then(a.1.range.len().cmp(&b.1.range.len()))
            };
            let several = clusters.iter().enumerate().filter(|(_, cluster)| cluster.range.len() > 1);
            let Some((worst, _)) = several.max_by(order) else { break };
            let range = clusters[worst].range.clone();
            let middle = self.split(range.clone(), level);
            let halves = [range.start..middle, middle..range.end].map(|range| self.cluster(range));
            clusters.splice(worst..=worst, halves);
        }
        clusters
    }

    /// Sorts the leaves of `range` along the axis on which they vary most; where to divide them.
    fn split(&mut self, range: Range<usize>, level: u32) -> usize {
        let leaves = &mut self.leaves[range.clone()];
        let axis = longest_axis(leaves);
        let at = |leaf: &Leaf| leaf.moments.centre()[axis];
        leaves.sort_by(|a, b| at(a).total_cmp(&at(b)));
        let middle = leaves.len() / 2;
        range.start + if level < FREE_LEVELS { least_spread(leaves).unwrap_or(middle) } else { middle }
    }

    fn summarise(&self, clusters: &[Cluster]) -> Node {
        let lanes = |value: &dyn Fn(&Moments) -> f64| {
            let of = |lane: usize| clusters.get(lane).map_or(0.0, |cluster| value(&cluster.moments) as f32);
            Vec4::from_array([0, 1, 2, 3].map(of))
        };
        let shape = |moments: &Moments| 1.0 - moments.lobe().length_squared();
        // An empty lane has a softening too: nothing is divided by 0.
        let softening = lanes(&|moments| SOFTNESS * moments.variance());
        Node {
            centre: [0, 1, 2].map(|axis| lanes(&|moments| moments.centre()[axis])),
            lobe: [0, 1, 2].map(|axis| lanes(&|moments| moments.lobe()[axis])),
            softening: softening + Vec4::splat(self.least.max(LEAST) as f32),
            peak: lanes(&|moments| (moments.power / self.power * shape(moments)).max(LEAST)),
            children: [LEAF; WIDTH],
        }
    }
}

fn sum(leaves: &[Leaf]) -> Moments {
    leaves.iter().fold(Moments::default(), |sum, leaf| sum + leaf.moments)
}

/// The axis on which the centres of `leaves` vary most.
fn longest_axis(leaves: &[Leaf]) -> usize {
    let centres = || leaves.iter().map(|leaf| leaf.moments.centre());
    let mean = centres().sum::<DVec3>() / leaves.len() as f64;
    let variance: DVec3 = centres().map(|centre| (centre - mean).powf(2.0)).sum();
    variance.max_position()
}

/// How many of the sorted `leaves` to split off so that the spread of both parts is least; none if all splits are
/// equal.
fn least_spread(leaves: &[Leaf]) -> Option<usize> {
    let mut after = vec![0.0; leaves.len()];
    let mut sum = Moments::default();
    for (spread, leaf) in after.iter_mut().zip(leaves).rev() {
        sum = sum + leaf.moments;
        *spread = sum.spread();
    }
    let (mut before, mut least, mut best) = (Moments::default(), f64::INFINITY, None);
    let mut most = 0.0f64;
    for (index, leaf) in leaves.iter().enumerate().take(leaves.len() - 1) {
        before = before + leaf.moments;
        let cost = before.spread() + after[index + 1];
        most = most.max(cost);
        if cost < least {
            (least, best) = (cost, Some(index + 1));
        }
    }
    best.filter(|_| least < most)
}
