//! The power heuristic with exponent 2 (Veach 1997, sec. 9.2).

use super::sums::MisSums;
use crate::{math::Channels, settings::heuristic::Heuristic, transport::strategy::StrategyKind};

/// Root of the sum of (n p)^2 over strategies. With the root it scales like n p: it overflows only where the balance
/// heuristic does too.
#[derive(Clone, Copy, Debug)]
pub(super) struct Power<L>(L);

impl<L: Channels> MisSums for Power<L> {
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
        Self(L::from_fn(|c| self.0.hero(c).hypot(other.0.hero(c))))
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
        L::COUNT as f32 / (own * own + self.0 * self.0).sum()
    }
}
