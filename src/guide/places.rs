//! Places as keys of cells, independent of the units and the extent of the scene.

use crate::{math::Vec3, sampling::cells::Keyed};

/// Distance that opposite directions count for, over the extent of the scene: cells are divided by orientation before
/// they get small.
const OPPOSITE: f32 = 0.5;

/// What places are measured against.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Places {
    centre: Vec3,
    /// 1 over the greatest extent (1/m).
    scale: f32,
}

impl Places {
    /// The box around `positions`.
    pub(super) fn around(positions: impl Iterator<Item = Vec3>) -> Self {
        let nothing = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        let (low, high) = positions.fold(nothing, |(low, high), at| (low.min(at), high.max(at)));
        let scale = 1.0 / (high - low).max_element().max(f32::MIN_POSITIVE);
        Self { centre: 0.5 * (low + high), scale }
    }

    /// The greatest extent (m).
    pub(super) fn extent(&self) -> f32 {
        1.0 / self.scale
    }

    /// By position.
    #[inline]
    pub(super) fn at(&self, position: Vec3) -> [f32; 3] {
        ((position - self.centre) * self.scale).to_array()
    }

    /// By position, and by a direction of length 1 or less.
    #[inline]
    pub(super) fn facing(&self, position: Vec3, direction: Vec3) -> [f32; 6] {
        let ([x, y, z], [i, j, k]) = (self.at(position), (0.5 * OPPOSITE * direction).to_array());
        [x, y, z, i, j, k]
    }
}

/// An item, by its index: the key of its cell, and the value at whose changes cells end.
pub(super) struct Valued<const D: usize> {
    pub key: [f32; D],
    pub value: f32,
    pub index: u32,
}

impl<const D: usize> Keyed<D> for Valued<D> {
    fn key(&self) -> [f32; D] {
        self.key
    }
    fn weight(&self) -> f32 {
        1.0
    }
    fn value(&self) -> Option<f32> {
        Some(self.value)
    }
}
