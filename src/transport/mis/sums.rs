//! The sum over the strategies that connect elsewhere along a path, for each heuristic.

use crate::{math::Channels, settings::heuristic::Heuristic, transport::strategy::StrategyKind};
use std::fmt::Debug;

/// n_j p_j^c of some strategies j and all channels c, as far as one heuristic needs them, in units of the density of
/// the walk that carries them. Walks and connections only multiply all of them by the factors that the next vertex
/// completes, and add others. A summary that supports both operations is updated in O(1) per vertex.
///
/// The type is chosen once: the balance heuristic contains nothing of the others.
pub trait MisSums: Copy + Send + Sync + Debug + 'static {
    /// Extinction per channel.
    type Channels: Channels;
    /// Most segments of a path.
    const MOST_EDGES: u32 = u32::MAX;

    /// No strategy.
    fn none() -> Self;
    /// One strategy of `kind`: n p per channel. It does not count where that is 0.
    fn of(kind: StrategyKind, strategy: Self::Channels) -> Self;
    /// These and those.
    fn and(self, other: Self) -> Self;
    /// All of them times `channels`.
    fn times(self, channels: Self::Channels) -> Self;
    /// All of them times `factor` >= 0.
    fn scaled(self, factor: f32) -> Self;
    /// The weight of the strategy at hand, by its hero, times the number of channels; these sums are all other
    /// strategies. All is in units of its own n p^h: `own` is its n p^c, so 1 for the hero. `heuristic` is the one of
    /// these sums, with its parameters.
    fn weight(self, heuristic: Heuristic, own: Self::Channels) -> f32;
    /// The share of each kind of strategy in the sum of n p over all, where the strategy at hand is of `kind`. For
    /// pilots; zeros where shares are unknown.
    #[inline]
    fn shares(self, _kind: StrategyKind, _own: Self::Channels) -> [f32; StrategyKind::ALL.len()] {
        [0.0; StrategyKind::ALL.len()]
    }
}
