//! A tree over everything that emits, by which next-event estimation finds what lights a point (after Estevez and
//! Kulla 2018, without their splitting).
//!
//! The walk down from the root chooses one of up to four children, in proportion to the irradiance that each is
//! estimated to give the reference. The estimate knows the reference's position only, not its normal: light subpaths
//! must find the same probabilities at the same point. A node counts as a point that emits as its leaves do on average,
//! see [`Moments`]. Nothing is bounded, so the estimate may be far too low, and callers must at times choose without
//! the tree.

mod build;
mod moments;
#[cfg(test)]
mod tests;

pub(super) use moments::Moments;

use crate::math::{Vec3, axes};
use glam::Vec4;

/// Children of an inner node.
const WIDTH: usize = 4;
/// Bits that say which of them.
const BITS: u32 = 2;
/// Levels that a path in 64 bits can have.
const DEEPEST: u32 = u64::BITS / BITS;
/// Marks a child that is a leaf, beside the leaf's number.
const LEAF: u32 = 1 << 31;

/// A distribution over leaves 0 .. n-1 that depends on a reference point.
#[derive(Clone, Debug)]
pub(super) struct LightTree {
    /// The root first.
    nodes: Vec<Node>,
    /// Per leaf: which child to take at every level, the root's in the lowest bits.
    paths: Vec<u64>,
}

/// The children of an inner node, a lane each; what is not there has a peak of 0.
#[derive(Clone, Debug)]
struct Node {
    centre: [Vec4; 3],
    /// Where the light goes, on average: the mean of its unit directions.
    lobe: [Vec4; 3],
    /// Added to the squared distance (m^2): from within a cluster, its centre is not near.
    softening: Vec4,
    /// Power as a part of all, times 1 - |lobe|^2.
    peak: Vec4,
    children: [u32; WIDTH],
}

impl Node {
    /// The estimated contribution of each child to `reference`, up to a factor, and their sum; by power alone where
    /// that is beyond f32.
    ///
    /// With v the way from the centre, r^2 = v^2 + softening and e the lobe, that is power (1 - e^2) / (r - e.v)^2: the
    /// intensity falls from where the lobe points to as (1 - e cos)^-2, which integrates to the power.
    #[inline]
    fn estimate(&self, reference: Vec3) -> (Vec4, f32) {
        let [x, y, z] = axes(|axis| Vec4::splat(reference[axis]) - self.centre[axis]);
        let distance = (x * x + y * y + z * z + self.softening).sqrt();
        let reduced = distance - (x * self.lobe[0] + y * self.lobe[1] + z * self.lobe[2]);
        let estimate = self.peak / (reduced * reduced);
        let sum = estimate.element_sum();
        if sum > 0.0 && sum < f32::INFINITY {
            return (estimate, sum);
        }
        (self.peak, self.peak.element_sum())
    }
}

impl LightTree {
    /// The leaf that `u` in [0, 1) falls on for `reference`, and its probability.
    #[inline]
    pub(super) fn sample(&self, reference: Vec3, mut u: f64) -> (u32, f32) {
        let (mut node, mut probability) = (0, 1.0);
        loop {
            let here = &self.nodes[node as usize];
            let (estimate, sum) = here.estimate(reference);
            let (lane, before) = section(estimate, u * f64::from(sum));
            u = ((u * f64::from(sum) - f64::from(before)) / f64::from(estimate[lane])).clamp(0.0, BELOW_ONE);
            probability *= estimate[lane] / sum;
            node = here.children[lane];
            if node & LEAF != 0 {
                return (node & !LEAF, probability);
            }
        }
    }

    /// Probability of `leaf` for `reference`.
    #[inline]
    pub(super) fn probability(&self, leaf: u32, reference: Vec3) -> f32 {
        let (mut node, mut probability) = (0, 1.0);
        let mut path = self.paths[leaf as usize];
        while node & LEAF == 0 {
            let here = &self.nodes[node as usize];
            let (estimate, sum) = here.estimate(reference);
            let lane = path as usize % WIDTH;
            probability *= estimate[lane] / sum;
            node = here.children[lane];
            path >>= BITS;
        }
        probability
    }
}

/// Which of the `parts` of a line holds `at`, and where that begins. Parts of length 0 hold nothing.
#[inline]
fn section(parts: Vec4, at: f64) -> (usize, f32) {
    let [a, b, c, d] = parts.to_array();
    let ends = Vec4::new(a, a + b, a + b + c, a + b + c + d);
    // Rounding may have put it at the end, where there may be nothing.
    let at = (at as f32).min(ends.w.next_down());
    let lane = Vec4::splat(at).cmpge(ends).bitmask().trailing_ones() as usize;
    (lane, if lane == 0 { 0.0 } else { ends[lane - 1] })
}

const BELOW_ONE: f64 = 1.0 - f64::EPSILON;
