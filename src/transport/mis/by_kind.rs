//! The balance heuristic with its sum split by kind of strategy: from samples with one set of counts, pilots forecast
//! the others.

use super::sums::MisSums;
use crate::{math::Channels, settings::heuristic::Heuristic, transport::strategy::StrategyKind};

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
        Self(StrategyKind::each(|kind| self.0[kind as usize] + other.0[kind as usize]))
    }
    #[inline]
    fn times(self, channels: L) -> Self {
        Self(StrategyKind::each(|kind| self.0[kind as usize] * channels))
    }
    #[inline]
    fn scaled(self, factor: f32) -> Self {
        Self(StrategyKind::each(|kind| self.0[kind as usize].scaled(factor)))
    }
    #[inline]
    fn weight(self, _: Heuristic, own: L) -> f32 {
        L::COUNT as f32 / (own.sum() + total(self.sums()))
    }
    #[inline]
    fn shares(self, kind: StrategyKind, own: L) -> [f32; StrategyKind::ALL.len()] {
        let sums = self.and(Self::of(kind, own)).sums();
        let all = total(sums);
        StrategyKind::each(|kind| sums[kind as usize] / all)
    }
}

impl<L: Channels> ByKind<L> {
    /// Over all channels.
    #[inline]
    fn sums(self) -> [f32; StrategyKind::ALL.len()] {
        StrategyKind::each(|kind| self.0[kind as usize].sum())
    }
}

#[inline]
fn total([hit, next_event, connection, lens, equiangular]: [f32; StrategyKind::ALL.len()]) -> f32 {
    hit + next_event + connection + lens + equiangular
}
