//! Choice among the cells of a grid in proportion to given weights: rows first, then columns.

use super::{Discrete, Stream};

/// A discrete distribution over rows x columns.
#[derive(Clone, Debug)]
pub struct Grid {
    rows: Discrete,
    columns: Vec<Discrete>,
}

/// A cell of a grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// From 0.
    pub column: usize,
    /// From 0.
    pub row: usize,
    /// Its probability.
    pub probability: f32,
}

impl Grid {
    /// `weights` row by row, `columns` in each; finite and >= 0.
    pub fn new(columns: usize, weights: &[f64]) -> Self {
        let columns: Vec<_> = weights.chunks(columns).map(|row| Discrete::new(row.iter().copied())).collect();
        Self { rows: Discrete::new(columns.iter().map(Discrete::total)), columns }
    }

    /// True where there is nothing to sample.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Sum of the weights as given.
    pub fn total(&self) -> f64 {
        self.rows.total()
    }

    /// A cell; those of weight 0 never come.
    #[inline]
    pub fn sample(&self, stream: &mut Stream) -> Cell {
        let (row, of_row) = self.rows.sample_precisely(stream.uniform_precisely());
        let (column, of_column) = self.columns[row].sample_precisely(stream.uniform_precisely());
        Cell { column, row, probability: (of_row * of_column) as f32 }
    }

    /// Probability of a cell.
    #[inline]
    pub fn probability(&self, column: usize, row: usize) -> f32 {
        let of_row = self.rows.probability_precisely(row);
        if of_row > 0.0 { (of_row * self.columns[row].probability_precisely(column)) as f32 } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{sampling::stream::Purpose, testing};

    #[test]
    fn cells_come_as_often_as_their_weights_say() {
        let weights = [0.0, 1.0, 3.0, 0.0, 0.0, 0.0, 2.0, 1e-3, 5.0];
        let grid = Grid::new(3, &weights);
        let mut stream = Stream::new(5, 0, 0, Purpose::Study);
        let n = 200_000;
        let mut counts = [0; 9];
        for _ in 0..n {
            let cell = grid.sample(&mut stream);
            counts[cell.row * 3 + cell.column] += 1;
            assert_eq!(cell.probability, grid.probability(cell.column, cell.row));
        }
        let expected = weights.map(|w| w / grid.total() * f64::from(n));
        assert!(testing::chi_square(&counts, &expected) > testing::significance(1));
        assert_eq!(grid.probability(0, 1), 0.0);
        assert!(Grid::new(2, &[0.0; 4]).is_empty());
    }
}
