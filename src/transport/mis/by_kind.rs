//! The balance heuristic with its sum split by kinds of strategies: from the samples of one set of counts, pilots tell how
//! any other would do.

use super::MisSums;
use crate::{math::Channels, settings::heuristic::Heuristic, transport::observer::StrategyKind};

/// Sum of n p over the strategies of each kind.
#[derive(Clone, Copy, Debug)]
pub struct ByKind<L>([L; StrategyKind::ALL.len()]);

impl<L: Channels> MisSums for ByKind<L> {
    type Channels = L;

    #[inline]
    fn none() -> Self {
        Self([L::splat(0.0); StrategyKind::ALL.len()])
    }
    #[inline]
    fn of(kind: StrategyKind, strategy: L) -> Self {
        let mut all = Self::none();
        all.0[kind as usize] = strategy;
        all
    }
    #[inline]
    fn and(self, other: Self) -> Self {
        Self(std::array::from_fn(|kind| self.0[kind] + other.0[kind]))
    }
    #[inline]
    fn times(self, channels: L) -> Self {
        Self(self.0.map(|sum| sum * channels))
    }
    #[inline]
    fn scaled(self, factor: f32) -> Self {
        Self(self.0.map(|sum| sum.scaled(factor)))
    }
    #[inline]
    fn weight(self, _: Heuristic, own: L) -> f32 {
        L::COUNT as f32 / (own.sum() + self.0.iter().map(|sum| sum.sum()).sum::<f32>())
    }
    #[inline]
    fn shares(self, kind: StrategyKind, own: L) -> [f32; StrategyKind::ALL.len()] {
        let Self(sums) = self.and(Self::of(kind, own));
        let all: f32 = sums.iter().map(|sum| sum.sum()).sum();
        sums.map(|sum| sum.sum() / all)
    }
}
