//! The sums of several heuristics side by side. Heuristics that exist only for comparison share one compiled estimator:
//! the build takes less time, and the extra sums are little work beside the rest of the estimator.

use super::{maximum::Maximum, power::Power, sums::MisSums, uniform::Uniform};
use crate::{math::Channels, settings::heuristic::Heuristic, transport::strategy::StrategyKind};

/// Sums for the power, the maximum and the uniform heuristic.
#[derive(Clone, Copy, Debug)]
pub struct Compared<L>(Power<L>, Maximum<L>, Uniform<L>);

impl<L: Channels> MisSums for Compared<L> {
    type Channels = L;

    #[inline]
    fn none() -> Self {
        Self(Power::none(), Maximum::none(), Uniform::none())
    }
    #[inline]
    fn of(kind: StrategyKind, strategy: L) -> Self {
        Self(Power::of(kind, strategy), Maximum::of(kind, strategy), Uniform::of(kind, strategy))
    }
    #[inline]
    fn and(self, other: Self) -> Self {
        Self(self.0.and(other.0), self.1.and(other.1), self.2.and(other.2))
    }
    #[inline]
    fn times(self, channels: L) -> Self {
        Self(self.0.times(channels), self.1.times(channels), self.2.times(channels))
    }
    #[inline]
    fn scaled(self, factor: f32) -> Self {
        Self(self.0.scaled(factor), self.1.scaled(factor), self.2.scaled(factor))
    }
    #[inline]
    fn weight(self, heuristic: Heuristic, own: L) -> f32 {
        match heuristic {
            Heuristic::Maximum => self.1.weight(heuristic, own),
            Heuristic::Uniform => self.2.weight(heuristic, own),
            _ => self.0.weight(heuristic, own),
        }
    }
}
