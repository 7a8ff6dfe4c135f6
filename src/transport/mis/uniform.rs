//! The uniform heuristic: every strategy that can make a path gets the same weight, however unlikely it is to
//! sample the path. For comparison only: where connections are short its variance has no bound.
//!
//! Channels are not strategies: the share of a strategy is divided among the heroes in proportion to their
//! densities. A hero that is very unlikely to sample a path could not compensate for an equal share of it.

use super::sums::MisSums;
use crate::{math::Channels, settings::heuristic::Heuristic, transport::strategy::StrategyKind};
use std::marker::PhantomData;

/// How many strategies can make a path.
#[derive(Clone, Copy, Debug)]
pub(super) struct Uniform<L> {
    strategies: f32,
    channels: PhantomData<L>,
}

impl<L: Channels> Uniform<L> {
    #[inline]
    fn count(strategies: f32) -> Self {
        Self { strategies, channels: PhantomData }
    }
}

impl<L: Channels> MisSums for Uniform<L> {
    type Channels = L;

    #[inline]
    fn none() -> Self {
        Self::count(0.0)
    }
    #[inline]
    fn of(_: StrategyKind, strategy: L) -> Self {
        Self::count(if strategy.sum() > 0.0 { 1.0 } else { 0.0 })
    }
    #[inline]
    fn and(self, other: Self) -> Self {
        Self::count(self.strategies + other.strategies)
    }
    /// No flight is impossible for every channel: some hero sampled the path.
    #[inline]
    fn times(self, _: L) -> Self {
        self
    }
    #[inline]
    fn scaled(self, factor: f32) -> Self {
        if factor > 0.0 { self } else { Self::none() }
    }
    #[inline]
    fn weight(self, _: Heuristic, own: L) -> f32 {
        L::COUNT as f32 / (own.sum() * (1.0 + self.strategies))
    }
}
