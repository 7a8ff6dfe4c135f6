//! The cutoff heuristic (Veach 1997, sec. 9.2): the balance heuristic without strategies that hardly ever make the path.

use super::sums::MisSums;
use crate::{math::Channels, settings::heuristic::Heuristic, transport::strategy::StrategyKind};

/// Number of strategies of the longest path, without the one at hand.
const CAPACITY: usize = Heuristic::CUTOFF_EDGES as usize;

/// n p of every strategy.
#[derive(Clone, Copy, Debug)]
pub struct Cutoff<L> {
    strategies: [L; CAPACITY],
    count: usize,
}

impl<L: Channels> Cutoff<L> {
    fn known(&self) -> &[L] {
        &self.strategies[..self.count]
    }

    #[inline]
    fn each(mut self, change: impl Fn(L) -> L) -> Self {
        self.strategies[..self.count].iter_mut().for_each(|strategy| *strategy = change(*strategy));
        self
    }
}

impl<L: Channels> MisSums for Cutoff<L> {
    type Channels = L;
    const MOST_EDGES: u32 = Heuristic::CUTOFF_EDGES;

    #[inline]
    fn none() -> Self {
        Self { strategies: [L::splat(0.0); CAPACITY], count: 0 }
    }
    #[inline]
    fn of(_: StrategyKind, strategy: L) -> Self {
        let mut all = Self::none();
        all.strategies[0] = strategy;
        all.count = usize::from(strategy.sum() > 0.0);
        all
    }
    #[inline]
    fn and(mut self, other: Self) -> Self {
        // Paths are no longer than MOST_EDGES: there is room.
        let room = self.strategies[self.count..].iter_mut();
        self.count += room.zip(other.known()).map(|(place, strategy)| *place = *strategy).count();
        self
    }
    #[inline]
    fn times(self, channels: L) -> Self {
        self.each(|strategy| strategy * channels)
    }
    #[inline]
    fn scaled(self, factor: f32) -> Self {
        self.each(|strategy| strategy.scaled(factor))
    }
    #[inline]
    fn weight(self, heuristic: Heuristic, own: L) -> f32 {
        let alpha = if let Heuristic::Cutoff { alpha } = heuristic { alpha } else { Heuristic::ALPHA };
        let all = || {
            let strategies = self.known().iter().chain(std::iter::once(&own));
            strategies.flat_map(|strategy| (0..L::COUNT).map(|c| strategy.hero(c)))
        };
        let least = alpha * all().fold(0.0, f32::max);
        if least > 1.0 { 0.0 } else { L::COUNT as f32 / all().filter(|q| *q >= least).sum::<f32>() }
    }
}
