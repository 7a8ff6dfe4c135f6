//! The binary tree becomes a wide one: which nodes below a binary node become the children of the wide node that replaces it.
//! They are chosen for the least expected number of tests of a ray that hits the root, where the probability that it hits a
//! box is in proportion to the box's area (Ylitie et al. 2017, "Efficient incoherent ray traversal on GPUs through compressed
//! wide BVHs", section 3.1).

use super::{
    pack::FlatPack,
    tree::{FLATS, INNER, KIND, Label, Node, Tree, WIDTH},
};
use crate::shape::Primitive;
use obvhs::bvh2::Bvh2;

/// Fills `tree` with the nodes and primitives of `binary`, whose leaves hold one primitive each.
pub(super) fn widen(binary: &Bvh2, primitives: &[(Label, Primitive)], tree: &mut Tree) {
    let plans = Planning { binary, primitives, plans: vec![Default::default(); binary.nodes.len()] }.run();
    Widening { binary, primitives, plans, tree }.run();
}

/// What is best below a node of the binary tree.
#[derive(Clone, Copy, Default)]
struct Plan {
    /// It is a leaf of its own: one pack or one round primitive.
    is_leaf: bool,
    /// Where it may become n children of a wide node, the number `first[n - 1]` of these are below its first child; 0 if it
    /// had best be a child itself.
    first: [u8; WIDTH],
}

/// What planning needs to know of the nodes below.
#[derive(Clone, Copy, Default)]
struct Below {
    /// How many primitives there are, if all are flat.
    flats: Option<u32>,
    /// Expected tests of all below as at most 1, 2, ... children of a wide node, times the root's area.
    cost: [f32; WIDTH],
}

/// Plans node by node, children first.
struct Planning<'a> {
    binary: &'a Bvh2,
    primitives: &'a [(Label, Primitive)],
    plans: Vec<(Plan, Below)>,
}

impl Planning<'_> {
    /// Without recursion: a hostile mesh can make the tree deep.
    fn run(mut self) -> Vec<Plan> {
        let mut stack = vec![(0, false)];
        while let Some((node, children_done)) = stack.pop() {
            if children_done || self.binary.nodes[node].is_leaf() {
                self.plans[node] = self.plan(node);
            } else {
                let [left, right] = children(self.binary, node);
                stack.extend([(node, true), (left, false), (right, false)]);
            }
        }
        self.plans.iter().map(|(plan, _)| *plan).collect()
    }

    fn plan(&self, node: usize) -> (Plan, Below) {
        let (flats, area) = (self.flats(node), self.binary.nodes[node].aabb().half_area());
        if self.binary.nodes[node].is_leaf() || flats.is_some_and(|count| count <= 4) {
            return (Plan { is_leaf: true, ..Plan::default() }, Below { flats, cost: [area; WIDTH] });
        }
        let (mut plan, mut cost) = (Plan::default(), [f32::INFINITY; WIDTH]);
        for slots in 2..=WIDTH {
            (cost[slots - 1], plan.first[slots - 1]) = self.split(node, slots);
        }
        // As a wide node it is tested itself; as soon as its parts are no dearer than that, they are better children.
        let own = area + cost[WIDTH - 1];
        for slots in 1..=WIDTH {
            if own < cost[slots - 1] {
                (cost[slots - 1], plan.first[slots - 1]) = (own, 0);
            }
        }
        (plan, Below { flats, cost })
    }

    /// The best way to share `slots` between the two children of `node`: its cost, and how many the first one has.
    fn split(&self, node: usize, slots: usize) -> (f32, u8) {
        let [left, right] = children(self.binary, node).map(|child| &self.plans[child].1.cost);
        let cost = |first: usize| (left[first - 1] + right[slots - first - 1], first as u8);
        (1..slots).map(cost).min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or_default()
    }

    /// How many primitives are below `node`, if these are all flat.
    fn flats(&self, node: usize) -> Option<u32> {
        if self.binary.nodes[node].is_leaf() {
            let (_, primitive) = &self.primitives[leaf(self.binary, node) as usize];
            return matches!(primitive, Primitive::Flat(_)).then_some(1);
        }
        let [left, right] = children(self.binary, node).map(|child| self.plans[child].1.flats);
        Some(left? + right?)
    }
}

/// The binary tree while it is turned into a wide one.
struct Widening<'a> {
    binary: &'a Bvh2,
    primitives: &'a [(Label, Primitive)],
    plans: Vec<Plan>,
    tree: &'a mut Tree,
}

impl Widening<'_> {
    fn run(mut self) {
        // Binary node, wide node that replaces it.
        let mut open = vec![(0, 0)];
        self.tree.nodes.push(Node::EMPTY);
        while let Some((binary, wide)) = open.pop() {
            for (slot, child) in self.descendants(binary).into_iter().enumerate() {
                let reference = self.reference(child);
                if reference & KIND == INNER {
                    open.push((child, reference as usize));
                }
                self.tree.nodes[wide].set(slot, self.binary.nodes[child].aabb(), reference);
            }
        }
    }

    /// The nodes that become the children of the wide node that replaces `root`: the root itself if it is a leaf.
    fn descendants(&self, root: usize) -> Vec<usize> {
        let (mut found, mut stack) = (Vec::with_capacity(WIDTH), vec![(root, WIDTH)]);
        while let Some((node, slots)) = stack.pop() {
            match self.plans[node].first[slots - 1] as usize {
                0 => found.push(node),
                first => {
                    let [left, right] = children(self.binary, node);
                    stack.extend([(right, slots - first), (left, first)]);
                }
            }
        }
        found
    }

    /// Makes room for what replaces `node`.
    fn reference(&mut self, node: usize) -> u32 {
        if !self.plans[node].is_leaf {
            self.tree.nodes.push(Node::EMPTY);
            return INNER | (self.tree.nodes.len() - 1) as u32;
        }
        let mut flats = Vec::new();
        // A leaf that is not a pack holds one primitive.
        for number in self.below(node) {
            if let Some(reference) = self.tree.add(&self.primitives[number as usize], &mut flats) {
                return reference;
            }
        }
        self.tree.packs.push(FlatPack::new(&flats));
        FLATS | (self.tree.packs.len() - 1) as u32
    }

    /// The primitives below `node`.
    fn below(&self, node: usize) -> Vec<u32> {
        let (mut numbers, mut stack) = (Vec::new(), vec![node]);
        while let Some(node) = stack.pop() {
            match self.binary.nodes[node].is_leaf() {
                true => numbers.push(leaf(self.binary, node)),
                false => stack.extend(children(self.binary, node)),
            }
        }
        numbers
    }
}

fn children(binary: &Bvh2, node: usize) -> [usize; 2] {
    let first = binary.nodes[node].first_index as usize;
    [first, first + 1]
}

/// The primitive of a leaf.
fn leaf(binary: &Bvh2, node: usize) -> u32 {
    binary.primitive_indices[binary.nodes[node].first_index as usize]
}
