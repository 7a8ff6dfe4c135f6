//! Pearson's chi-square test of counts.

use serde::Serialize;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// What the test found.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ChiSquare {
    /// Sum of (observed - expected)^2 / expected over the pooled cells.
    pub statistic: f64,
    /// Pooled cells less one.
    pub freedom: usize,
    /// Probability of a statistic no smaller where the counts are as expected; 1 where one cell is left.
    pub p_value: f64,
}

/// Counts that a cell must expect at least: fewer are not near enough to a normal distribution.
const FEWEST: f64 = 5.0;

/// Counts in impossible cells that are forgiven: the quadrature may have missed the corner of a cell.
const FORGIVEN: u64 = 3;

/// Tests `observed` counts against `expected` ones, whose totals are equal. Cells are pooled in order until each
/// expects at least 5. Counts where none are expected are a certain failure.
pub fn chi_square(observed: &[u64], expected: &[f64]) -> ChiSquare {
    let cells = pooled(observed, expected);
    let statistic = cells.iter().map(|(o, e)| (o - e).powi(2) / e).sum();
    let freedom = cells.len().saturating_sub(1);
    let impossible: u64 = observed.iter().zip(expected).filter(|(_, e)| **e < 1e-6).map(|(o, _)| o).sum();
    let p_value = if impossible > FORGIVEN { 0.0 } else { survival(statistic, freedom) };
    ChiSquare { statistic, freedom, p_value }
}

fn survival(statistic: f64, freedom: usize) -> f64 {
    // No distribution has no degrees of freedom: nothing was tested.
    ChiSquared::new(freedom as f64).map_or(1.0, |distribution| distribution.sf(statistic))
}

/// Cells that expect enough each; what is left over at the end is merged into the last.
fn pooled(observed: &[u64], expected: &[f64]) -> Vec<(f64, f64)> {
    let mut cells: Vec<(f64, f64)> = Vec::new();
    let mut open = (0.0, 0.0);
    for (o, e) in observed.iter().zip(expected) {
        open = (open.0 + *o as f64, open.1 + e);
        if open.1 >= FEWEST {
            cells.push(std::mem::take(&mut open));
        }
    }
    match cells.last_mut() {
        Some(last) => *last = (last.0 + open.0, last.1 + open.1),
        None => cells.push(open),
    }
    cells
}

#[cfg(test)]
mod tests {
    use super::*;

    /// For two degrees of freedom the survival function is exp(-x / 2).
    #[test]
    fn the_statistic_is_that_worked_out_by_hand() {
        let found = chi_square(&[12, 8, 10], &[10.0; 3]);
        assert_eq!((found.statistic, found.freedom), (0.8, 2));
        assert!((found.p_value - (-0.4f64).exp()).abs() < 1e-9);
    }

    #[test]
    fn small_cells_are_pooled_and_impossible_ones_fail() {
        let found = chi_square(&[3, 3, 6, 1], &[3.0, 3.0, 6.0, 1.0]);
        assert_eq!((found.statistic, found.freedom, found.p_value), (0.0, 1, 1.0));
        assert_eq!(chi_square(&[100, 4], &[104.0, 0.0]).p_value, 0.0);
        let nothing = chi_square(&[1], &[1.0]);
        assert_eq!((nothing.freedom, nothing.p_value), (0, 1.0));
        assert!(chi_square(&[], &[]).freedom == 0);
    }
}
