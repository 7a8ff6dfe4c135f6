//! Choice among the cells of a grid in proportion to given weights: rows first, then columns.

use super::{Discrete, Stream};
use crate::math::{Vec2, vec2};

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
    /// How far into it, along the columns and the rows: uniform.
    pub within: Vec2,
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

    /// A place in a cell, by two numbers; evenly spread points stay evenly spread within rows. Cells of weight 0 never
    /// come.
    #[inline]
    pub fn sample(&self, stream: &mut Stream) -> Cell {
        let (row, down) = self.rows.sample_within(stream.uniform_precisely());
        let (column, along) = self.columns[row].sample_within(stream.uniform_precisely());
        Cell { column, row, within: vec2(along, down) }
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
        let (mut counts, mut quarters) = ([0; 9], [0; 4]);
        for _ in 0..n {
            let cell = grid.sample(&mut stream);
            counts[cell.row * 3 + cell.column] += 1;
            let quarter = (2.0 * cell.within).floor();
            quarters[(2.0 * quarter.y + quarter.x) as usize] += 1;
        }
        let expected = weights.map(|w| w / grid.total() * f64::from(n));
        assert!(testing::chi_square(&quarters, &[f64::from(n) / 4.0; 4]) > testing::significance(1));
        assert!(testing::chi_square(&counts, &expected) > testing::significance(1));
        assert_eq!((grid.probability(0, 1), grid.probability(2, 0)), (0.0, (3.0 / grid.total()) as f32));
        assert!(Grid::new(2, &[0.0; 4]).is_empty());
    }
}
