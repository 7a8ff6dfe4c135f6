//! Adaptive quadtrees: a density over the unit square, learnt from weighted points (after Mueller et al. 2017,
//! Practical Path Guiding). Nodes with many points are divided, however small: a few thousand points find an opening of
//! a millionth of the square. Points are spread over the leaves around theirs: the next one may fall just beside them,
//! and would count for thousands if the density there were almost 0.

use crate::math::{Vec2, vec2};

/// Points, as [`effective`] counts them, that divide a node.
const TO_DIVIDE: f64 = 48.0;
/// Levels below the root: the smallest nodes are 1e-6 of the square.
const LEVELS: u32 = 10;
/// Prior: uniform points that every node has in addition to its own. Where few points fell, none is no proof.
const UNSEEN: f64 = 2.0;
/// Nodes with less of all the weight are not divided.
const LEAST_SHARE: f64 = 1e-3;
/// Levels of bins: there are 16 x 16.
const BINS: u32 = 4;
/// Bins across, and down.
const SIDE: usize = 1 << BINS;
/// Points that divide a node of [`Basis::Quadtree`]. With at least the bins, and half the points, path tracing in rooms
/// lit indirectly and in an attic has 0.8 of the error that it has with [`TO_DIVIDE`] alone.
const TO_DIVIDE_BINS: f64 = 24.0;
/// Parts into which a point is spread.
const PARTS: usize = 4;
/// How far parts are spread (sizes of the point's leaf) where samples follow the tree alone. In a room with a small
/// opening the relative error is 1.2 times as large with 1, and 1.7 times with 4. Without spreading it is 2 to 5 times
/// as large, most of it in a hundredth of the pixels.
const ALONE: f32 = 2.0;
/// The same where other densities are mixed with the tree's. With 1, path tracing in rooms lit indirectly or through a
/// door has 0.9 of the error that it has with 0; with 1.4 it has no less in the rooms than with 0.
const MIXED: f32 = 1.0;
/// Wavelet coefficients above this part of the weight are kept.
const DETAIL: f64 = 0.01;

/// A point of the unit square, and how much it counts.
#[derive(Clone, Copy, Debug)]
pub struct Deposit {
    /// In the unit square.
    pub at: Vec2,
    /// At least 0, finite.
    pub weight: f32,
}

/// Effective number of weights: (sum w)^2 / sum w^2 equal ones would say as much.
pub fn effective(weights: impl Iterator<Item = f32>) -> f64 {
    let (sum, squares) = weights.fold((0.0, 0.0), |(sum, squares), weight| {
        let weight = f64::from(weight);
        (sum + weight, squares + weight * weight)
    });
    if squares > 0.0 { sum * sum / squares } else { 0.0 }
}

/// Limits the weights of `all` to a part of their sum; the effective number of the weights that remain.
pub fn limit<T>(all: &mut [T], part: f64, weight: impl Fn(&mut T) -> &mut f32) -> f64 {
    // Each limit lowers the sum, and so the next limit.
    for _ in 0..4 {
        let sum: f64 = all.iter_mut().map(|one| f64::from(*weight(one))).sum();
        let most = (part * sum) as f32;
        all.iter_mut().map(&weight).for_each(|weight| *weight = weight.min(most));
    }
    effective(all.iter_mut().map(|one| *weight(one)))
}

/// How the square is divided: bases for what is known of a density.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Basis {
    /// Into bins, and further where many points fall.
    #[default]
    Quadtree,
    /// Into equal bins, as many everywhere: constant bases (P03T sec. 5.2.1).
    Bins,
    /// Where Haar wavelets over equal areas have great coefficients (P03T sec. A.1), however few points say so.
    Haar,
    /// Not by themselves, but by links of a first pass to where light comes from (P03T sec. 5.2.3).
    Links,
}

impl Basis {
    /// Each as typed.
    pub const NAMES: [(&'static str, Self); 4] =
        [("quadtree", Self::Quadtree), ("bins", Self::Bins), ("haar", Self::Haar), ("links", Self::Links)];

    /// As typed.
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize].0
    }
}

/// A density that is constant on every leaf.
#[derive(Clone, Debug)]
pub struct Quadtree {
    nodes: Vec<Node>,
    /// Row by row; they save the look-up of the levels above.
    bins: Vec<Bin>,
}

/// One of 16 x 16 equal parts of the square.
#[derive(Clone, Copy, Debug)]
struct Bin {
    /// Density of the node here, or of the leaf around.
    density: f32,
    /// Index of the node here; 0 where a leaf is.
    node: u32,
}

/// Four quarters: those of less y first, of them that of less x.
#[derive(Clone, Copy, Debug)]
struct Node {
    /// They sum to 1.
    probabilities: [f32; 4],
    /// Index of the quarter's own node; 0 where it is a leaf.
    children: [u32; 4],
}

/// See [`Quadtree::divided`].
struct Rule<F> {
    is_leaf: F,
    detail: f64,
    /// The weight of all points.
    weight: f64,
    /// Parts of each point.
    parts: usize,
}

impl Bin {
    /// The whole square.
    const ALL: Self = Self { density: 1.0, node: 0 };
}

impl<F> Rule<F> {
    /// The part of all weight; 0 of nothing.
    fn share(&self, weight: f64) -> f64 {
        if self.weight > 0.0 { weight / self.weight } else { 0.0 }
    }
}

impl Quadtree {
    /// The density of `deposits`, divided where many of them fall.
    pub fn learn(deposits: Vec<Deposit>) -> Self {
        Self::spread(&deposits, ALONE, |level, count, share| {
            level == LEVELS || count < TO_DIVIDE || share < LEAST_SHARE
        })
    }

    /// The same in a `basis`.
    pub fn by(basis: Basis, deposits: Vec<Deposit>) -> Self {
        match basis {
            Basis::Quadtree | Basis::Links => Self::spread(&deposits, MIXED, |level, count, share| {
                level == LEVELS || (level >= BINS && (count < TO_DIVIDE_BINS || share < LEAST_SHARE))
            }),
            Basis::Bins => Self::divided(deposits, |level, _, _| level == BINS, 0.0, 1),
            // No coefficient is greater than the weight of its node.
            Basis::Haar => {
                Self::divided(deposits, |level, _, share| level == LEVELS || share <= DETAIL, DETAIL, 1)
            }
        }
    }

    /// Divided twice: the first leaves determine how far `deposits` are spread.
    fn spread(deposits: &[Deposit], width: f32, is_leaf: impl Fn(u32, f64, f64) -> bool + Copy) -> Self {
        let tree = Self::divided(deposits.to_vec(), is_leaf, 0.0, 1);
        // Fractional parts of multiples of powers of the plastic number: their pairs are spread evenly (Roberts 2018).
        let even = |index: usize| {
            [0.754_877_666, 0.569_840_291].map(|step: f64| (0.5 + index as f64 * step).fract() as f32)
        };
        let parts = |(index, &Deposit { at, weight }): (usize, &Deposit)| {
            let reach = width * tree.size_of_leaf(at);
            let offset = move |part| reach * (2.0 * Vec2::from(even(PARTS * index + part)) - 1.0);
            let deposit =
                move |part| Deposit { at: inside(at + offset(part)), weight: weight / PARTS as f32 };
            (0..PARTS).map(deposit)
        };
        Self::divided(deposits.iter().enumerate().flat_map(parts).collect(), is_leaf, 0.0, PARTS)
    }

    /// `is_leaf` decides for a node by the levels above it, its points, and its share of the weight. It is a leaf also
    /// where no coefficient exceeds the share `detail`. Each point came in so many `parts`.
    fn divided(
        deposits: Vec<Deposit>,
        is_leaf: impl Fn(u32, f64, f64) -> bool,
        detail: f64,
        parts: usize,
    ) -> Self {
        let mut tree = Self { nodes: Vec::new(), bins: Vec::new() };
        let weight = total(&deposits);
        tree.grow(deposits, 0, &Rule { is_leaf, detail, weight, parts });
        let middle = |index: usize| (vec2((index % SIDE) as f32, (index / SIDE) as f32) + 0.5) / SIDE as f32;
        tree.bins = (0..SIDE * SIDE).map(|index| tree.descend(middle(index), Bin::ALL, BINS)).collect();
        tree
    }

    /// The node of `deposits`, so many levels below the root; none where it remains a leaf. Coordinates are those
    /// within the node.
    fn grow(
        &mut self,
        deposits: Vec<Deposit>,
        level: u32,
        rule: &Rule<impl Fn(u32, f64, f64) -> bool>,
    ) -> Option<u32> {
        let count = effective(deposits.iter().map(|deposit| deposit.weight)) / rule.parts as f64;
        if level > 0 && (rule.is_leaf)(level, count, rule.share(total(&deposits))) {
            return None;
        }
        let index = self.nodes.len();
        self.nodes.push(Node { probabilities: [0.25; 4], children: [0; 4] });
        let quarters = divide(deposits);
        let totals = quarters.each_ref().map(|quarter| total(quarter));
        let all: f64 = totals.iter().sum();
        if all > 0.0 {
            let even = UNSEEN / (count + UNSEEN);
            self.nodes[index].probabilities =
                totals.map(|sum| ((1.0 - even) * sum / all + 0.25 * even) as f32);
        }
        for (quarter, deposits) in quarters.into_iter().enumerate() {
            self.nodes[index].children[quarter] = self.grow(deposits, level + 1, rule).unwrap_or(0);
        }
        let is_kept = level == 0 || rule.detail == 0.0 || rule.share(detail(totals)) > rule.detail;
        if is_kept || self.nodes[index].children != [0; 4] {
            return Some(index as u32);
        }
        self.nodes.truncate(index);
        None
    }

    /// Length of a side of the leaf around `at`.
    fn size_of_leaf(&self, mut at: Vec2) -> f32 {
        let (mut size, mut index) = (1.0, 0);
        loop {
            size *= 0.5;
            index = self.nodes[index].children[quarter_of(&mut at)] as usize;
            if index == 0 {
                return size;
            }
        }
    }

    /// Memory that it takes (bytes).
    pub fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..]) + size_of_val(&self.bins[..])
    }

    /// A point distributed by the density, from one of the unit square: near ones stay near.
    #[inline]
    pub fn sample(&self, mut u: Vec2) -> Vec2 {
        let (mut corner, mut size, mut index) = (Vec2::ZERO, 1.0, 0);
        loop {
            let Node { probabilities: [a, b, c, d], children } = self.nodes[index];
            size *= 0.5;
            let upper = choose(&mut u.y, a + b, c + d);
            let right = if upper { choose(&mut u.x, c, d) } else { choose(&mut u.x, a, b) };
            corner += size * vec2(f32::from(right), f32::from(upper));
            index = children[2 * usize::from(upper) + usize::from(right)] as usize;
            if index == 0 {
                return corner + size * u;
            }
        }
    }

    /// Density at a point of the unit square, relative to a uniform one; never 0.
    #[inline]
    pub fn density(&self, at: Vec2) -> f32 {
        let scaled = SIDE as f32 * at;
        let [x, y] = scaled.to_array().map(|x| (x as usize).min(SIDE - 1));
        let bin = self.bins[SIDE * y + x];
        if bin.node == 0 {
            return bin.density;
        }
        self.descend(scaled - vec2(x as f32, y as f32), bin, LEVELS).density
    }

    /// Descends so many levels below `from`; `at` is in the coordinates of `from`.
    #[inline]
    fn descend(&self, mut at: Vec2, from: Bin, levels: u32) -> Bin {
        let mut below = from;
        for _ in 0..levels {
            let node = &self.nodes[below.node as usize];
            let quarter = quarter_of(&mut at);
            below = Bin {
                density: below.density * 4.0 * node.probabilities[quarter],
                node: node.children[quarter],
            };
            if below.node == 0 {
                break;
            }
        }
        below
    }
}

/// The greatest of the three coefficients by which quarters of these weights differ.
fn detail([a, b, c, d]: [f64; 4]) -> f64 {
    [a + b - c - d, a + c - b - d, a + d - b - c].into_iter().fold(0.0, |most, detail| detail.abs().max(most))
}

fn total(deposits: &[Deposit]) -> f64 {
    deposits.iter().map(|deposit| f64::from(deposit.weight)).sum()
}

/// The deposits of the four quarters, in the coordinates of each.
fn divide(deposits: Vec<Deposit>) -> [Vec<Deposit>; 4] {
    let mut quarters: [Vec<Deposit>; 4] = Default::default();
    for Deposit { mut at, weight } in deposits {
        let quarter = quarter_of(&mut at);
        quarters[quarter].push(Deposit { at, weight });
    }
    quarters
}

/// Maps a point beside the unit square (at most two away) into it. The square is a sphere's: x ends at the poles, and y
/// goes around.
fn inside(at: Vec2) -> Vec2 {
    let x = at.x.abs();
    vec2(x.min(2.0 - x), at.y.rem_euclid(1.0)).clamp(Vec2::ZERO, Vec2::splat(1.0 - f32::EPSILON))
}

/// The quarter that `at` lies in; from then on its coordinates are those within the quarter.
#[inline]
fn quarter_of(at: &mut Vec2) -> usize {
    let (right, upper) = (at.x >= 0.5, at.y >= 0.5);
    *at = 2.0 * *at - vec2(f32::from(right), f32::from(upper));
    2 * usize::from(upper) + usize::from(right)
}

/// True if `u`, in [0, 1), falls into the second of two parts; `u` becomes its position within its part.
#[inline]
fn choose(u: &mut f32, first: f32, second: f32) -> bool {
    let share = first / (first + second);
    let is_second = *u >= share;
    let within = if is_second { (*u - share) / (1.0 - share) } else { *u / share };
    *u = within.min(1.0 - f32::EPSILON);
    is_second
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        sampling::{Stream, stream::Purpose},
        testing,
    };

    /// Most of the weight on a patch of 1e-4 of the square, some of it everywhere, some cells without any.
    fn patch(stream: &mut Stream) -> Vec<Deposit> {
        let one = |index: usize, at: Vec2| match index % 4 {
            0 => Deposit { at: at * vec2(1.0, 0.5), weight: 0.1 },
            _ => Deposit { at: vec2(0.37, 0.61) + 0.01 * at, weight: 1.0 + at.x },
        };
        (0..4000).map(|index| one(index, stream.square())).collect()
    }

    #[test]
    fn samples_follow_the_density() {
        let mut stream = Stream::new(3, 0, 0, Purpose::Study);
        let known = patch(&mut stream);
        let bases = Basis::NAMES.map(|(_, basis)| basis);
        let trees = bases.map(|basis| [known.clone(), Vec::new()].map(|known| Quadtree::by(basis, known)));
        for tree in trees.into_iter().flatten() {
            let (side, n) = (16, 400_000);
            let fine = 64;
            let mut counts = vec![0; side * side];
            let mut expected = vec![0.0; side * side];
            let cell = |at: Vec2| {
                let [x, y] = (at * side as f32).to_array().map(|x| (x as usize).min(side - 1));
                y * side + x
            };
            (0..n).for_each(|_| counts[cell(tree.sample(stream.square()))] += 1);
            let all = side * fine;
            for index in 0..all * all {
                let at = (vec2((index % all) as f32, (index / all) as f32) + 0.5) / all as f32;
                expected[cell(at)] += f64::from(tree.density(at));
            }
            let sum: f64 = expected.iter().sum();
            // One midpoint in each of the smallest leaves.
            assert!((sum / (all * all) as f64 - 1.0).abs() < 1e-4, "{sum}");
            expected.iter_mut().for_each(|e| *e *= f64::from(n) / sum);
            let close = counts.iter().zip(&expected).all(|(count, expected): (&u64, &f64)| {
                (*count as f64 - expected).abs() < 5.0 * expected.sqrt() + 0.02 * expected
            });
            assert!(close);
        }
    }

    /// Leaves of any size: how often samples fall where the density is about so great, against that density's share.
    #[test]
    fn samples_fall_on_small_leaves_as_often_as_on_large_ones() {
        let mut stream = Stream::new(4, 0, 0, Purpose::Study);
        let tree = Quadtree::learn(patch(&mut stream));
        let n = 200_000;
        let level = |density: f32| ((density.log2() + 8.0).clamp(0.0, 31.0)) as usize;
        let (mut counts, mut expected) = ([0u64; 32], [0.0; 32]);
        for _ in 0..n {
            counts[level(tree.density(tree.sample(stream.square())))] += 1;
        }
        leaves(&tree, 0, 1.0, 1.0, &mut |density, probability| expected[level(density)] += probability);
        let expected = expected.map(|share| share * f64::from(n));
        assert!(testing::chi_square(&counts, &expected) > testing::significance(1));
        // 3/4 of the points, at a weight of 1.5 and more, lie on 1e-4 of the square.
        assert!(tree.density(vec2(0.375, 0.615)) > 3000.0);
        assert!(tree.density(vec2(0.9, 0.9)) > 0.0 && tree.density(vec2(0.9, 0.9)) < 0.05);
    }

    /// All fell to the left of the line that divides the square; the next may fall just to the right of it, or on the other side of
    /// the seam of the sphere.
    #[test]
    fn beside_known_points_others_are_likely() {
        let mut stream = Stream::new(6, 0, 0, Purpose::Study);
        let patch = (0..4000).map(|_| vec2(0.4, 0.0) + 0.1 * stream.square());
        let deposits: Vec<Deposit> = patch.map(|at| Deposit { at, weight: 1.0 }).collect();
        for tree in [Quadtree::learn(deposits.clone()), Quadtree::by(Basis::Quadtree, deposits)] {
            let within = tree.density(vec2(0.45, 0.05));
            for beside in [vec2(0.501, 0.05), vec2(0.45, 0.999)] {
                let density = tree.density(beside);
                assert!((0.02 * within..0.6 * within).contains(&density), "{beside}: {density} of {within}");
            }
        }
    }

    fn leaves(tree: &Quadtree, index: usize, area: f64, share: f64, see: &mut impl FnMut(f32, f64)) {
        let Node { probabilities, children } = tree.nodes[index];
        for (probability, child) in probabilities.into_iter().zip(children) {
            let (area, share) = (0.25 * area, share * f64::from(probability));
            match child {
                0 => see((share / area) as f32, share),
                child => leaves(tree, child as usize, area, share, see),
            }
        }
    }

    #[test]
    fn without_anything_to_learn_all_is_even() {
        for tree in [
            Quadtree::learn(Vec::new()),
            Quadtree::learn(vec![Deposit { at: Vec2::ONE, weight: 0.0 }]),
            Quadtree::learn(vec![Deposit { at: vec2(0.2, 0.9), weight: 0.0 }; 100]),
        ] {
            assert_eq!(tree.density(vec2(0.3, 0.8)), 1.0);
            assert_eq!(tree.sample(vec2(0.3, 0.8)), vec2(0.3, 0.8));
        }
    }

    #[test]
    fn one_great_weight_divides_nothing() {
        let mut deposits = vec![Deposit { at: vec2(0.2, 0.2), weight: 1e-3 }; 100];
        deposits.push(Deposit { at: vec2(0.7, 0.7), weight: 1e30 });
        let tree = Quadtree::learn(deposits);
        assert_eq!(tree.nodes.len(), 1);
        assert!(tree.density(vec2(0.2, 0.2)) > 0.3);
    }

    /// Bins are as large everywhere; wavelets find a small patch, and divide nothing where all is even.
    #[test]
    fn bases_divide_as_they_say() {
        let mut stream = Stream::new(5, 0, 0, Purpose::Study);
        let known = patch(&mut stream);
        let densities = [Basis::Bins, Basis::Haar].map(|basis| {
            let tree = Quadtree::by(basis, known.clone());
            let mut areas = Vec::new();
            leaves(&tree, 0, 1.0, 1.0, &mut |density, share| areas.push(share / f64::from(density)));
            if basis == Basis::Bins {
                assert!(areas.len() == 256 && areas.iter().all(|area| (area * 256.0 - 1.0).abs() < 1e-5));
            }
            tree.density(vec2(0.375, 0.615))
        });
        assert!(densities[0] < 256.0 && densities[1] > 3000.0, "{densities:?}");
        let grid = (0..4096).map(|i| vec2((i % 64) as f32 + 0.5, (i / 64) as f32 + 0.5) / 64.0);
        let even = grid.map(|at| Deposit { at, weight: 1.0 }).collect();
        assert_eq!(Quadtree::by(Basis::Haar, even).nodes.len(), 1);
    }
}
