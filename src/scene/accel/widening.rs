//! The binary tree becomes a wide one: which nodes below a binary node become the children of the wide node that replaces it.
//! They are chosen for the least expected number of tests of a ray that hits the root, where the probability that it hits a
//! box is in proportion to the box's area (Ylitie et al. 2017, "Efficient incoherent ray traversal on GPUs through compressed
//! wide BVHs", section 3.1).

use super::{
    pack::FlatPack,
    tree::{FLATS, INNER, KIND, Label, Node, Tree, WIDTH},
};
use crate::shape::Primitive;
use obvhs::bvh2::{Bvh2, node::Bvh2Node};

/// Fills `tree` with the nodes and primitives of `binary`, whose leaves hold one primitive each.
pub(super) fn widen(binary: &Bvh2, primitives: &[(Label, Primitive)], tree: &mut Tree) {
    let mut widening =
        Widening { binary, primitives, plans: vec![Plan::default(); binary.nodes.len()], tree };
    widening.plan();
    widening.build();
}

/// What is best below a node of the binary tree.
#[derive(Clone, Copy, Default)]
struct Plan {
    /// How many primitives it holds, if these are all flat.
    flats: Option<u32>,
    /// Expected tests of all below as at most 1, 2, ... children of a wide node, times the root's area.
    cost: [f32; WIDTH],
    /// How many of so many children are below its first child; 0 if it is best as one of them itself.
    first: [u8; WIDTH],
}

/// The binary tree while it is turned into a wide one.
struct Widening<'a> {
    binary: &'a Bvh2,
    primitives: &'a [(Label, Primitive)],
    plans: Vec<Plan>,
    tree: &'a mut Tree,
}

impl Widening<'_> {
    /// Children first, without recursion: a hostile mesh can make the tree deep.
    fn plan(&mut self) {
        let mut stack = vec![(0, false)];
        while let Some((node, children_done)) = stack.pop() {
            let [left, right] = self.children(node);
            if children_done || self.binary.nodes[node].is_leaf() {
                self.plans[node] = self.plan_of(node);
            } else {
                stack.extend([(node, true), (left, false), (right, false)]);
            }
        }
    }

    fn plan_of(&self, node: usize) -> Plan {
        let (flats, area) = (self.flats(node), self.binary.nodes[node].aabb().half_area());
        if self.is_leaf(node, flats) {
            return Plan { flats, cost: [area; WIDTH], first: [0; WIDTH] };
        }
        let mut plan = Plan { flats, ..Plan::default() };
        for slots in 2..=WIDTH {
            (plan.cost[slots - 1], plan.first[slots - 1]) = self.split(node, slots);
        }
        // As a wide node it is tested itself; as soon as its parts are no dearer than that, they are better children.
        let own = area + plan.cost[WIDTH - 1];
        for slots in 1..=WIDTH {
            if slots == 1 || own < plan.cost[slots - 1] {
                (plan.cost[slots - 1], plan.first[slots - 1]) = (own, 0);
            }
        }
        plan
    }

    /// The best way to share `slots` between the two children of `node`: its cost, and how many the first one has.
    fn split(&self, node: usize, slots: usize) -> (f32, u8) {
        let [left, right] = self.children(node).map(|child| &self.plans[child].cost);
        let cost = |first: usize| (left[first - 1] + right[slots - first - 1], first as u8);
        (1..slots).map(cost).min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or_default()
    }

    fn children(&self, node: usize) -> [usize; 2] {
        let first = self.binary.nodes[node].first_index as usize;
        [first, first + 1]
    }

    /// How many primitives are below `node`, if these are all flat.
    fn flats(&self, node: usize) -> Option<u32> {
        if self.binary.nodes[node].is_leaf() {
            let is_flat = |number: u32| matches!(self.primitives[number as usize].1, Primitive::Flat(_));
            return leaf(self.binary, node).all(is_flat).then_some(self.binary.nodes[node].prim_count);
        }
        let [left, right] = self.children(node).map(|child| self.plans[child].flats);
        Some(left? + right?)
    }

    /// A leaf of its own: one pack or one round primitive.
    fn is_leaf(&self, node: usize, flats: Option<u32>) -> bool {
        self.binary.nodes[node].is_leaf() || flats.is_some_and(|count| count <= 4)
    }

    fn build(mut self) {
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
                    let [left, right] = self.children(node);
                    stack.extend([(right, slots - first), (left, first)]);
                }
            }
        }
        found
    }

    /// Makes room for what replaces `node`.
    fn reference(&mut self, node: usize) -> u32 {
        if !self.is_leaf(node, self.plans[node].flats) {
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
                true => numbers.extend(leaf(self.binary, node)),
                false => stack.extend(self.children(node)),
            }
        }
        numbers
    }
}

fn leaf(binary: &Bvh2, node: usize) -> impl Iterator<Item = u32> + '_ {
    let node: &Bvh2Node = &binary.nodes[node];
    let first = node.first_index as usize;
    binary.primitive_indices[first..first + node.prim_count as usize].iter().copied()
}
