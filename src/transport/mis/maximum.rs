//! The maximum heuristic (Veach 1997, sec. 9.2): a path belongs to the strategy that makes it most often.

use super::sums::MisSums;
use crate::{math::Channels, settings::heuristic::Heuristic, transport::strategy::StrategyKind};

/// Strategies whose n p lie this close together, relative, share a path equally. Which one is greater must
/// not depend on rounding: each strategy rounds differently, so both could claim the path, or neither. Ties
/// do happen: channels of equal extinction have equal densities, and so have all connections within a hollow
/// diffuse sphere.
pub(in crate::transport) const TIE: f32 = 1e-3;

/// The greatest n p of some strategies, and how many have it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Maximum<L> {
    most: L,
    tied: L,
}

/// The greater of two (greatest value, how many have it).
#[inline]
fn greater((a, of_a): (f32, f32), (b, of_b): (f32, f32)) -> (f32, f32) {
    if a > b * (1.0 + TIE) {
        (a, of_a)
    } else if b > a * (1.0 + TIE) {
        (b, of_b)
    } else {
        (a.max(b), of_a + of_b)
    }
}

impl<L: Channels> Maximum<L> {
    #[inline]
    fn channel(&self, c: usize) -> (f32, f32) {
        (self.most.hero(c), self.tied.hero(c))
    }
}

impl<L: Channels> MisSums for Maximum<L> {
    type Channels = L;

    #[inline]
    fn none() -> Self {
        Self { most: L::splat(0.0), tied: L::splat(0.0) }
    }
    #[inline]
    fn of(_: StrategyKind, strategy: L) -> Self {
        Self { most: strategy, tied: L::splat(1.0) }
    }
    #[inline]
    fn and(self, other: Self) -> Self {
        let channel = |c| greater(self.channel(c), other.channel(c));
        Self { most: L::from_fn(|c| channel(c).0), tied: L::from_fn(|c| channel(c).1) }
    }
    #[inline]
    fn times(self, channels: L) -> Self {
        Self { most: self.most * channels, ..self }
    }
    #[inline]
    fn scaled(self, factor: f32) -> Self {
        Self { most: self.most.scaled(factor), ..self }
    }
    #[inline]
    fn weight(self, _: Heuristic, own: L) -> f32 {
        let channel = |c| greater((own.hero(c), 1.0), self.channel(c));
        let (most, tied) = (0..L::COUNT).map(channel).fold((0.0, 0.0), greater);
        if most > 1.0 + TIE { 0.0 } else { L::COUNT as f32 / tied }
    }
}
