//! The hierarchy: obvhs builds it (PLOC and reinsertion), here it becomes four wide, because four boxes and
//! four flat primitives are tested in the time of one.

use super::pack::{Ball, FlatPack};
use crate::{
    math::Bounds,
    shape::{Curved, Flat, Primitive},
};
use glam::Vec4;
use obvhs::{
    BvhBuildParams,
    aabb::Aabb,
    bvh2::{Bvh2, builder::build_bvh2, node::Bvh2Node},
};
use std::time::Duration;

/// Scenes that need at most this many tests (four flat primitives or one round one each) are a plain list: up to
/// here it is faster than any hierarchy (measured: see the timing test).
const LIST_LIMIT: usize = 12;

/// What a child reference points to, in its top two bits; the index is below them.
pub(super) const INNER: u32 = 0;
/// A `FlatPack`.
pub(super) const FLATS: u32 = 1 << 30;
/// A `Ball`; or, with [`BEYOND`], a `Curved`. No kind of its own: scenes without these rare ones should not
/// pay for the test.
pub(super) const ROUND: u32 = 2 << 30;
/// Marks the index of a `Curved`.
pub(super) const BEYOND: u32 = 1 << 29;
/// The bits of the kind.
pub(super) const KIND: u32 = 3 << 30;

/// Added to the depth where there are curved primitives. Deeper than any tree, so that the rare ones are
/// tested last.
pub(super) const RARE: usize = usize::MAX / 8;

/// Four boxes and what is in them. Empty slots have empty boxes. Most time goes into waiting for them: a node is two whole
/// cache lines, not parts of three.
#[derive(Clone, Copy, Debug)]
#[repr(align(128))]
pub(super) struct Node {
    /// Least x, y, z of the boxes, and greatest.
    pub planes: [[Vec4; 3]; 2],
    /// Kind and index of each child.
    pub child: [u32; 4],
}

/// Primitives and the hierarchy over them; no nodes where a plain list is faster.
#[derive(Clone, Debug)]
pub(super) struct Tree {
    pub(super) nodes: Vec<Node>,
    pub(super) packs: Vec<FlatPack>,
    pub(super) balls: Vec<Ball>,
    /// With their numbers.
    pub(super) curved: Vec<(Curved, u32)>,
    /// Inner nodes on the longest way down, 0 for a list; and [`RARE`].
    pub(super) depth: usize,
    bounds: Aabb,
}

impl Tree {
    /// Primitives are numbered by their place in the slice.
    pub(super) fn build(primitives: &[Primitive]) -> Self {
        if primitives.len() <= LIST_LIMIT {
            Self::build_list(primitives)
        } else {
            Self::build_nodes(primitives)
        }
    }

    pub(super) fn build_list(primitives: &[Primitive]) -> Self {
        let boxes: Vec<Aabb> = primitives.iter().map(bound).collect();
        let mut tree = Self::empty(&boxes);
        tree.fill_list(primitives);
        tree.marked()
    }

    pub(super) fn build_nodes(primitives: &[Primitive]) -> Self {
        let boxes: Vec<Aabb> = primitives.iter().map(bound).collect();
        let mut tree = Self::empty(&boxes);
        tree.fill_nodes(primitives, &boxes);
        tree.marked()
    }

    fn marked(mut self) -> Self {
        if !self.curved.is_empty() {
            self.depth += RARE;
        }
        self
    }

    fn empty(boxes: &[Aabb]) -> Self {
        let bounds = boxes.iter().copied().reduce(|all, one| all.union(&one)).unwrap_or_default();
        Self { nodes: vec![], packs: vec![], balls: vec![], curved: vec![], depth: 0, bounds }
    }

    /// The box around all.
    pub(super) fn bounds(&self) -> Bounds {
        Bounds { low: self.bounds.min.into(), high: self.bounds.max.into() }
    }

    fn fill_list(&mut self, primitives: &[Primitive]) {
        let mut flats = Vec::new();
        for (number, primitive) in (0..).zip(primitives) {
            self.add(number, primitive, &mut flats);
        }
        self.packs = flats.chunks(4).map(FlatPack::new).collect();
    }

    /// Adds a primitive and returns its reference. Flat ones go to `flats` instead, to be packed.
    fn add(&mut self, number: u32, primitive: &Primitive, flats: &mut Vec<(u32, Flat)>) -> Option<u32> {
        match primitive {
            Primitive::Flat(flat) => {
                flats.push((number, *flat));
                None
            }
            Primitive::Ball { center, radius } => {
                self.balls.push(Ball { center: *center, radius: *radius, primitive: number });
                Some(ROUND | (self.balls.len() - 1) as u32)
            }
            Primitive::Curved(curved) => {
                self.curved.push((curved.clone(), number));
                Some(ROUND | BEYOND | (self.curved.len() - 1) as u32)
            }
        }
    }

    fn fill_nodes(&mut self, primitives: &[Primitive], boxes: &[Aabb]) {
        let params = BvhBuildParams { max_prims_per_leaf: 1, ..BvhBuildParams::medium_build() };
        let bvh = build_bvh2(boxes, params, &mut Duration::default());
        let flats = FlatCounts::new(&bvh, primitives);
        Widening { bvh: &bvh, primitives, flats, tree: self }.run();
    }
}

/// Around all hits.
pub(super) fn bound(primitive: &Primitive) -> Aabb {
    let Bounds { low, high } = primitive.hit_bounds();
    Aabb::new(low.into(), high.into())
}

/// For each node of the binary tree: how many primitives are below it if these are all flat.
struct FlatCounts(Vec<Option<u32>>);

impl FlatCounts {
    fn new(bvh: &Bvh2, primitives: &[Primitive]) -> Self {
        let mut counts = vec![None; bvh.nodes.len()];
        // Children first, without recursion: a hostile mesh can make the tree deep.
        let mut stack = vec![(0, false)];
        while let Some((index, children_done)) = stack.pop() {
            let node = &bvh.nodes[index];
            let (left, right) = (node.first_index as usize, node.first_index as usize + 1);
            if node.is_leaf() {
                let all_flat = leaf(bvh, node).all(|p| matches!(primitives[p as usize], Primitive::Flat(_)));
                counts[index] = all_flat.then_some(node.prim_count);
            } else if children_done {
                counts[index] = counts[left].zip(counts[right]).map(|(l, r)| l + r);
            } else {
                stack.extend([(index, true), (left, false), (right, false)]);
            }
        }
        Self(counts)
    }

    /// Fits one pack.
    fn is_pack(&self, node: usize) -> bool {
        self.0[node].is_some_and(|count| count <= 4)
    }
}

fn leaf<'a>(bvh: &'a Bvh2, node: &Bvh2Node) -> impl Iterator<Item = u32> + 'a {
    let first = node.first_index as usize;
    bvh.primitive_indices[first..first + node.prim_count as usize].iter().copied()
}

/// The binary tree while it is turned into a wide one.
struct Widening<'a> {
    bvh: &'a Bvh2,
    primitives: &'a [Primitive],
    flats: FlatCounts,
    tree: &'a mut Tree,
}

impl Widening<'_> {
    fn run(mut self) {
        // Binary node, wide node that replaces it, depth.
        let mut open = vec![(0, 0, 1)];
        self.tree.nodes.push(EMPTY);
        while let Some((binary, wide, depth)) = open.pop() {
            self.tree.depth = self.tree.depth.max(depth);
            for (slot, child) in self.descendants(binary).into_iter().enumerate() {
                let reference = self.reference(child);
                if reference & KIND == INNER {
                    open.push((child, reference as usize, depth + 1));
                }
                self.tree.nodes[wide].set(slot, self.bvh.nodes[child].aabb(), reference);
            }
        }
    }

    /// A leaf of its own: one pack or one round primitive.
    fn is_leaf(&self, node: usize) -> bool {
        self.bvh.nodes[node].is_leaf() || self.flats.is_pack(node)
    }

    /// Up to four nodes that together hold all of `root`: the largest is opened as long as there is room.
    fn descendants(&self, root: usize) -> Vec<usize> {
        let mut found = vec![root];
        while found.len() < 4 {
            let area = |node: usize| self.bvh.nodes[node].aabb().half_area();
            let inner = (0..found.len()).filter(|i| !self.is_leaf(found[*i]));
            let Some(largest) = inner.max_by(|a, b| area(found[*a]).total_cmp(&area(found[*b]))) else {
                break;
            };
            let first = self.bvh.nodes[found[largest]].first_index as usize;
            found[largest] = first;
            found.push(first + 1);
        }
        found
    }

    /// Makes room for what replaces `node`.
    fn reference(&mut self, node: usize) -> u32 {
        if !self.is_leaf(node) {
            self.tree.nodes.push(EMPTY);
            return INNER | (self.tree.nodes.len() - 1) as u32;
        }
        let numbers = self.below(node);
        let tree = &mut *self.tree;
        let mut flats = Vec::new();
        // A leaf that is not a pack holds one primitive.
        for number in numbers {
            if let Some(reference) = tree.add(number, &self.primitives[number as usize], &mut flats) {
                return reference;
            }
        }
        tree.packs.push(FlatPack::new(&flats));
        FLATS | (tree.packs.len() - 1) as u32
    }

    /// The primitives below `node`.
    fn below(&self, node: usize) -> Vec<u32> {
        let (mut numbers, mut stack) = (Vec::new(), vec![node]);
        while let Some(index) = stack.pop() {
            let node = &self.bvh.nodes[index];
            if node.is_leaf() {
                numbers.extend(leaf(self.bvh, node));
            } else {
                stack.extend([node.first_index as usize, node.first_index as usize + 1]);
            }
        }
        numbers
    }
}

/// No ray hits a box from infinity to -infinity.
const EMPTY: Node = Node { planes: [[Vec4::INFINITY; 3], [Vec4::NEG_INFINITY; 3]], child: [0; 4] };

impl Node {
    fn set(&mut self, slot: usize, bounds: &Aabb, reference: u32) {
        for axis in 0..3 {
            self.planes[0][axis][slot] = bounds.min[axis];
            self.planes[1][axis][slot] = bounds.max[axis];
        }
        self.child[slot] = reference;
    }
}
