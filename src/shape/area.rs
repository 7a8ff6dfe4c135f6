//! Choice of a primitive in proportion to its area.

use crate::sampling::Stream;

/// Cumulative areas of a shape's primitives.
#[derive(Clone, Debug)]
pub(super) struct AreaTable(Vec<f64>);

impl AreaTable {
    /// From the primitives' areas (m^2).
    pub(super) fn new(areas: impl Iterator<Item = f64>) -> Self {
        let sums = areas.scan(0.0, |sum, area| {
            *sum += area;
            Some(*sum)
        });
        Self(sums.collect())
    }

    /// All areas together (m^2).
    pub(super) fn total(&self) -> f64 {
        self.0.last().copied().unwrap_or(0.0)
    }

    /// A primitive, as likely as it is large. Drawn from 53 bits: the 24 of a float would favour some of a
    /// million triangles over others.
    pub(super) fn sample(&self, stream: &mut Stream) -> usize {
        const STEPS: usize = 1 << 53;
        let at = stream.below(STEPS) as f64 / STEPS as f64 * self.total();
        self.0.partition_point(|sum| *sum <= at).min(self.0.len().saturating_sub(1))
    }
}
