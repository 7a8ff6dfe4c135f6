//! What a volume is like from afar: its range and its mean in every cell of a coarse lattice.

use super::{Volume, VolumeModel};
use crate::math::{Affine3A, RaySegment, Spectrum, Vec3, axes, cells::Cells, vec3};

use rayon::prelude::*;

pub use crate::math::cells::Crossing as Piece;

/// Cells along the longest side of a box.
const CELLS: f32 = 32.0;
/// Cells along any side: what is thin may vary across it.
const FEWEST: f32 = 8.0;
/// Points along each side of a cell whose average is taken for its mean.
const POINTS: u32 = 3;
/// What lies so little outside a lattice is taken for its border (cells).
const ROUNDING: f32 = 1e-3;

/// Something per cell of a lattice: of volumes a [`Summary`].
#[derive(Clone, Debug)]
pub struct Coarse<T = Summary> {
    /// From the world to cells: cell (i, j, k) is the unit cube at (i, j, k).
    to_cells: Affine3A,
    to_world: Affine3A,
    size: [u32; 3],
    /// x fastest.
    cells: Vec<T>,
}

/// A volume in one cell.
#[derive(Clone, Copy, Debug)]
pub struct Summary {
    /// No channel is less anywhere in it.
    pub least: f32,
    /// No channel is more.
    pub most: f32,
    /// The mean of every channel.
    pub mean: Spectrum,
}

impl Coarse {
    /// Looks at `volume` in the box from `low` to `high`; at a grid by its bricks.
    pub fn over(volume: &Volume, low: Vec3, high: Vec3) -> Self {
        if let Some(grid) = volume.grid() {
            return grid.coarse();
        }
        let range = |low, high| {
            let [least, most] = volume.range(low, high);
            [least.min_element(), most.max_element()]
        };
        Self::of(low, high, |p| volume.eval::<Spectrum>(p), range)
    }

    /// The same of any function `value` of position, whose channels lie in `range` within a box.
    pub fn of(
        low: Vec3,
        high: Vec3,
        value: impl Fn(Vec3) -> Spectrum + Sync,
        range: impl Fn(Vec3, Vec3) -> [f32; 2] + Sync,
    ) -> Self {
        let lattice = Coarse::lattice(low, high, CELLS);
        lattice.fill(|index| {
            let [least, most] =
                range(lattice.position(index, Vec3::ZERO), lattice.position(index, Vec3::ONE));
            let mean = || mean_of(|u| value(lattice.position(index, u)));
            let is_empty = least == 0.0 && most == 0.0;
            Summary { least, most, mean: if is_empty { Spectrum::ZERO } else { mean() } }
        })
    }
}

impl Coarse<()> {
    /// The cells of the box from `low` to `high`, about as long as wide, `most` of them along its longest side, with
    /// nothing in them.
    pub fn lattice(low: Vec3, high: Vec3, most: f32) -> Self {
        let extent = (high - low).max(Vec3::splat(f32::MIN_POSITIVE));
        let counts = (extent * (most / extent.max_element())).ceil().max(Vec3::splat(FEWEST));
        let size = counts.to_array().map(|count| count as u32);
        let to_world = Affine3A::from_scale_rotation_translation(extent / counts, glam::Quat::IDENTITY, low);
        let to_cells = Affine3A::from_scale(counts / extent) * Affine3A::from_translation(-low);
        Self { to_cells, to_world, size, cells: vec![(); size.iter().product::<u32>() as usize] }
    }
}

impl<T> Coarse<T> {
    /// From what is known of every cell, x fastest, of a lattice of the given size; `to_cells` maps from the world to it.
    pub fn from_cells(size: [u32; 3], to_cells: Affine3A, cells: Vec<T>) -> Self {
        Self { to_cells, to_world: to_cells.inverse(), size, cells }
    }

    /// What `change` makes of every cell.
    pub fn map<U: Send>(&self, change: impl Fn(&T) -> U + Sync) -> Coarse<U>
    where
        T: Sync,
    {
        self.fill(|index| change(self.cell(index)))
    }

    /// The same lattice, with what `value` gives for the number of every cell.
    pub fn fill<U: Send>(&self, value: impl Fn(u32) -> U + Sync) -> Coarse<U> {
        let Self { to_cells, to_world, size, .. } = *self;
        Coarse {
            to_cells,
            to_world,
            size,
            cells: (0..self.cells.len() as u32).into_par_iter().map(&value).collect(),
        }
    }

    /// All cells, x fastest.
    pub fn cells(&self) -> &[T] {
        &self.cells
    }

    /// One cell, by its number.
    #[inline]
    pub fn cell(&self, cell: u32) -> &T {
        &self.cells[cell as usize]
    }

    /// Volume of a cell (m^3); all are alike.
    pub fn cell_volume(&self) -> f64 {
        f64::from(self.to_world.matrix3.determinant().abs())
    }

    /// Mean squared distance of a cell's points from its centre (m^2).
    pub fn cell_variance(&self) -> f64 {
        let edges = self.to_world.matrix3;
        let squares = [edges.x_axis, edges.y_axis, edges.z_axis].map(|edge| edge.as_dvec3().length_squared());
        squares.iter().sum::<f64>() / 12.0
    }

    /// The world position of `u` in [0, 1)^3 of `cell`.
    pub fn position(&self, cell: u32, u: Vec3) -> Vec3 {
        let [x, y, z] = cell_of(cell, self.size);
        self.to_world.transform_point3(vec3(x as f32, y as f32, z as f32) + u)
    }

    /// The cell around a world position; none outside the lattice.
    #[inline]
    pub fn cell_at(&self, position: Vec3) -> Option<u32> {
        let cell = self.to_cells.transform_point3(position).floor();
        let size = axes(|i| self.size[i] as f32);
        let inside = (0..3).all(|axis| cell[axis] >= 0.0 && cell[axis] < size[axis]);
        inside.then(|| index_of([cell.x as u32, cell.y as u32, cell.z as u32], self.size))
    }

    /// The cells that the box from `low` to `high` touches, of a lattice along the axes.
    pub fn cells_around(&self, low: Vec3, high: Vec3) -> impl Iterator<Item = u32> + use<T> {
        let [low, high] = [low, high].map(|corner| self.to_cells.transform_point3(corner).floor());
        let size = self.size;
        let along = |axis: usize| {
            let end = |floor: f32| floor.clamp(0.0, size[axis] as f32) as u32;
            end(low[axis])..end(high[axis] + 1.0)
        };
        let [x, y, z] = [along(0), along(1), along(2)];
        let rows = z.flat_map(move |k| y.clone().map(move |j| (j, k)));
        rows.flat_map(move |(j, k)| x.clone().map(move |i| index_of([i, j, k], size)))
    }

    /// The cells that share a face with `cell`.
    pub fn neighbours(&self, cell: u32) -> impl Iterator<Item = u32> + use<T> {
        let (at, size) = (cell_of(cell, self.size), self.size);
        (0..6).filter_map(move |side| {
            let (axis, mut beside) = (side / 2, at);
            beside[axis] = if side % 2 == 0 { at[axis].checked_sub(1)? } else { at[axis] + 1 };
            (beside[axis] < size[axis]).then(|| index_of(beside, size))
        })
    }

    /// The pieces of `segment` in the cells that it crosses, in order.
    #[inline]
    pub fn pieces(&self, segment: &RaySegment) -> Cells {
        self.pieces_within(segment, self.clip(segment))
    }

    /// The same of the part of `segment` from `first` to `last`, which lies within the lattice up to rounding.
    #[inline]
    pub fn pieces_within(&self, segment: &RaySegment, [first, last]: [f32; 2]) -> Cells {
        Cells::new(&segment.mapped(&self.to_cells), first, last, self.size)
    }

    /// From where to where `segment` is in the lattice.
    #[inline]
    pub fn clip(&self, segment: &RaySegment) -> [f32; 2] {
        let [x, y, z] = axes(|i| self.size[i] as f32);
        segment.mapped(&self.to_cells).within(Vec3::ZERO, vec3(x, y, z)).unwrap_or([0.0, 0.0])
    }

    /// True if the box from `low` to `high` lies within the lattice up to rounding.
    pub fn covers(&self, low: Vec3, high: Vec3) -> bool {
        let end = Vec3::from_array(axes(|i| self.size[i] as f32));
        (0..8).all(|corner| {
            let high_at = |axis: usize| corner >> axis & 1 == 1;
            let corner = Vec3::from_array(std::array::from_fn(|i| if high_at(i) { high[i] } else { low[i] }));
            let at = self.to_cells.transform_point3(corner);
            at.cmpge(Vec3::splat(-ROUNDING)).all() && at.cmple(end + ROUNDING).all()
        })
    }
}

fn cell_of(index: u32, [x, y, _]: [u32; 3]) -> [u32; 3] {
    [index % x, index / x % y, index / (x * y)]
}

fn index_of([i, j, k]: [u32; 3], [x, y, _]: [u32; 3]) -> u32 {
    i + x * (j + y * k)
}

/// The average over points of the unit cube.
fn mean_of(value: impl Fn(Vec3) -> Spectrum) -> Spectrum {
    let at = |index: u32| (index as f32 + 0.5) / POINTS as f32;
    let count = POINTS.pow(3);
    let sum: Spectrum = (0..count)
        .map(|i| {
            let [x, y, z] = cell_of(i, [POINTS; 3]);
            value(vec3(at(x), at(y), at(z)))
        })
        .sum();
    sum / count as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// x + 2 y + 4 z: its mean over a cell is its value at the centre.
    fn ramp() -> Coarse {
        let value = |p: Vec3| Spectrum::splat(p.dot(vec3(1.0, 2.0, 4.0)));
        let range = |low: Vec3, high: Vec3| [low, high].map(|p| p.dot(vec3(1.0, 2.0, 4.0)));
        Coarse::of(vec3(1.0, 0.0, -1.0), vec3(3.0, 1.0, 3.0), value, range)
    }

    #[test]
    fn cells_hold_range_and_mean() {
        let coarse = ramp();
        assert_eq!(coarse.size, [16, 8, 32]);
        let cell = coarse.cell_at(vec3(1.01, 0.01, -0.99)).unwrap();
        let Summary { least, most, mean } = coarse.cell(cell);
        assert!((mean.x - (1.0625 + 2.0 * 0.0625 + 4.0 * -0.9375)).abs() < 1e-5);
        assert!((most - (1.125 + 0.25 - 3.5)).abs() < 1e-5);
        assert!((least - (1.0 - 4.0)).abs() < 1e-5);
        assert!((coarse.cell_volume() - 0.125f64.powi(3)).abs() < 1e-9);
        assert!((coarse.cell_variance() - 0.125f64.powi(2) / 4.0).abs() < 1e-9);
        assert_eq!(coarse.cell_at(vec3(0.99, 0.5, 0.0)), None);
        let middle = coarse.position(cell, Vec3::splat(0.5));
        assert!((middle - vec3(1.0625, 0.0625, -0.9375)).abs().max_element() < 1e-5);
    }
}
