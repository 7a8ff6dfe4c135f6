//! The balance heuristic (LW96 eq. 14): plain sums.

use super::sums::MisSums;
use crate::{math::Channels, settings::heuristic::Heuristic, transport::strategy::StrategyKind};

/// Sum of n p over strategies.
#[derive(Clone, Copy, Debug)]
pub struct Balance<L>(L);

impl<L: Channels> MisSums for Balance<L> {
    type Channels = L;

    #[inline]
    fn none() -> Self {
        Self(L::splat(0.0))
    }
    #[inline]
    fn of(_: StrategyKind, strategy: L) -> Self {
        Self(strategy)
    }
    #[inline]
    fn and(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
    #[inline]
    fn times(self, channels: L) -> Self {
        Self(self.0 * channels)
    }
    #[inline]
    fn scaled(self, factor: f32) -> Self {
        Self(self.0.scaled(factor))
    }
    #[inline]
    fn weight(self, _: Heuristic, own: L) -> f32 {
        L::COUNT as f32 / (own + self.0).sum()
    }
}
