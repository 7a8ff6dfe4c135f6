//! The hierarchy: obvhs builds it (PLOC and reinsertion), [`super::widening`] makes it eight wide, because eight boxes and
//! four flat primitives are tested in the time of one.

use super::{
    pack::{Ball, FlatPack},
    widening,
};
use crate::{
    math::Bounds,
    shape::{Curved, Flat, Primitive},
};
use obvhs::{BvhBuildParams, aabb::Aabb, bvh2::builder::build_bvh2};
use std::time::Duration;
use wide::f32x8;

/// At most so many primitives are a plain list: up to here it is faster than any hierarchy (`cargo bench` times lists
/// and trees).
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

/// Children of a node.
pub(super) const WIDTH: usize = 8;

/// Eight boxes and what is in them. Empty slots have empty boxes. Most time goes into waiting for them: a node is four whole
/// cache lines, not parts of five.
#[derive(Clone, Copy, Debug)]
#[repr(align(128))]
pub(super) struct Node {
    /// Least x, y, z of the boxes, and greatest.
    pub planes: [[f32x8; 3]; 2],
    /// Kind and index of each child.
    pub child: [u32; WIDTH],
}

/// How rays go through a tree.
#[derive(Clone, Copy, Debug)]
pub(super) enum Form {
    /// From primitive to primitive: there are no nodes.
    List,
    /// From node to node.
    Nodes,
    /// [`Self::List`], some of it curved: these are rare, and others should not pay for the test.
    CurvedList,
    /// [`Self::Nodes`], some of it curved.
    CurvedNodes,
}

/// The number of a shape, and that of one of its primitives.
pub(super) type Label = [u32; 2];

/// Primitives and the hierarchy over them; no nodes where a plain list is faster.
#[derive(Clone, Debug)]
pub(super) struct Tree {
    pub(super) nodes: Vec<Node>,
    pub(super) packs: Vec<FlatPack>,
    pub(super) balls: Vec<Ball>,
    pub(super) curved: Vec<(Curved, Label)>,
    pub(super) form: Form,
    bounds: Aabb,
}

impl Tree {
    pub(super) fn build(primitives: &[(Label, Primitive)]) -> Self {
        if primitives.len() <= LIST_LIMIT {
            Self::build_list(primitives)
        } else {
            Self::build_nodes(primitives)
        }
    }

    pub(super) fn build_list(primitives: &[(Label, Primitive)]) -> Self {
        let boxes: Vec<Aabb> = primitives.iter().map(|(_, primitive)| bound(primitive)).collect();
        let mut tree = Self::empty(&boxes);
        tree.fill_list(primitives);
        tree.formed()
    }

    pub(super) fn build_nodes(primitives: &[(Label, Primitive)]) -> Self {
        let boxes: Vec<Aabb> = primitives.iter().map(|(_, primitive)| bound(primitive)).collect();
        let params = BvhBuildParams { max_prims_per_leaf: 1, ..BvhBuildParams::medium_build() };
        let binary = build_bvh2(&boxes, params, &mut Duration::default());
        let mut tree = Self::empty(&boxes);
        widening::widen(&binary, primitives, &mut tree);
        tree.formed()
    }

    fn formed(mut self) -> Self {
        self.form = match (self.nodes.is_empty(), self.curved.is_empty()) {
            (true, true) => Form::List,
            (true, false) => Form::CurvedList,
            (false, true) => Form::Nodes,
            (false, false) => Form::CurvedNodes,
        };
        self
    }

    fn empty(boxes: &[Aabb]) -> Self {
        let bounds = boxes.iter().copied().reduce(|all, one| all.union(&one)).unwrap_or_default();
        Self { nodes: vec![], packs: vec![], balls: vec![], curved: vec![], form: Form::List, bounds }
    }

    /// The box around all.
    pub(super) fn bounds(&self) -> Bounds {
        Bounds { low: self.bounds.min.into(), high: self.bounds.max.into() }
    }

    fn fill_list(&mut self, primitives: &[(Label, Primitive)]) {
        let mut flats = Vec::new();
        for primitive in primitives {
            self.add(primitive, &mut flats);
        }
        self.packs = flats.chunks(4).map(FlatPack::new).collect();
    }

    /// Adds a primitive and returns its reference. Flat ones go to `flats` instead, to be packed.
    pub(super) fn add(
        &mut self,
        (label, primitive): &(Label, Primitive),
        flats: &mut Vec<(Label, Flat)>,
    ) -> Option<u32> {
        match primitive {
            Primitive::Flat(flat) => {
                flats.push((*label, *flat));
                None
            }
            Primitive::Ball { center, radius } => {
                self.balls.push(Ball { center: *center, radius: *radius, label: *label });
                Some(ROUND | (self.balls.len() - 1) as u32)
            }
            Primitive::Curved(curved) => {
                self.curved.push((curved.clone(), *label));
                Some(ROUND | BEYOND | (self.curved.len() - 1) as u32)
            }
        }
    }
}

/// Around all hits.
pub(super) fn bound(primitive: &Primitive) -> Aabb {
    let Bounds { low, high } = primitive.hit_bounds();
    Aabb::new(low.into(), high.into())
}

impl Node {
    /// No ray hits a box from infinity to -infinity.
    pub(super) const EMPTY: Self = Self {
        planes: [[f32x8::new([f32::INFINITY; WIDTH]); 3], [f32x8::new([f32::NEG_INFINITY; WIDTH]); 3]],
        child: [0; WIDTH],
    };

    pub(super) fn set(&mut self, slot: usize, bounds: &Aabb, reference: u32) {
        for axis in 0..3 {
            self.planes[0][axis].as_mut_array()[slot] = bounds.min[axis];
            self.planes[1][axis].as_mut_array()[slot] = bounds.max[axis];
        }
        self.child[slot] = reference;
    }
}
