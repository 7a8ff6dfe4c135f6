//! Decides where light goes from one node to another as a whole, for links and for particles.

use crate::guide::hierarchy::{Hierarchy, Node};
use std::{cmp::Ordering, collections::BinaryHeap};

/// The power (W) that may be misplaced if a `sender` of this `power` lights `receiver` as if both were points: the
/// power that arrives, times the variation of distance and direction over both.
pub(super) fn error(sender: &Node, receiver: &Node, power: f32) -> f32 {
    let [a, b] = [sender.radius(), receiver.radius()];
    let distance = sender.centre().distance(receiver.centre()).max(a + b).max(f32::MIN_POSITIVE);
    power * (b / distance).powi(2) * ((a + b) / distance)
}

/// Two nodes, and what a link between them may misplace.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pair {
    error: f32,
    /// Where light comes from.
    pub sender: u32,
    /// Where it goes.
    pub receiver: u32,
}

impl Eq for Pair {}

impl PartialOrd for Pair {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Pair {
    fn cmp(&self, other: &Self) -> Ordering {
        let rest = (other.sender, other.receiver).cmp(&(self.sender, self.receiver));
        self.error.total_cmp(&other.error).then(rest)
    }
}

/// About `number` pairs between all nodes that send `power`. The pairs that may misplace most are divided first.
pub(super) fn refine(hierarchy: &Hierarchy, power: &[f32], number: usize) -> Vec<Pair> {
    let pair = |sender: u32, receiver: u32| {
        let [a, b] = [sender, receiver].map(|node| &hierarchy.nodes[node as usize]);
        let power = power[sender as usize];
        (power > 0.0).then(|| Pair { error: error(a, b, power), sender, receiver })
    };
    let roots = hierarchy.roots().flat_map(|a| hierarchy.roots().map(move |b| (a, b)));
    let mut waiting: BinaryHeap<Pair> = roots.filter_map(|(a, b)| pair(a, b)).collect();
    let mut whole = Vec::new();
    while waiting.len() + whole.len() < number {
        let Some(worst) = waiting.pop() else { break };
        let Pair { sender, receiver, .. } = worst;
        let [a, b] = [sender, receiver].map(|node| &hierarchy.nodes[node as usize]);
        match (a.parts, b.parts) {
            (None, None) => whole.push(worst),
            (Some(parts), _) if b.parts.is_none() || a.radius() >= b.radius() => {
                waiting.extend(parts.into_iter().filter_map(|part| pair(part, receiver)));
            }
            (_, parts) => {
                waiting.extend(parts.into_iter().flatten().filter_map(|part| pair(sender, part)));
            }
        }
    }
    whole.extend(waiting.into_sorted_vec());
    whole
}
