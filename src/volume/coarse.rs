//! What a volume is like from afar: its maximum and its mean in every cell of a coarse lattice.

use super::{Volume, VolumeModel};
use crate::math::{Affine3A, Channels, RaySegment, Spectrum, Vec3, cells::Cells, vec3};

/// Cells along the longest side of a box.
const CELLS: f32 = 32.0;
/// Cells along any side: what is thin may vary across it.
const FEWEST: f32 = 8.0;
/// Points along each side of a cell whose average is taken for its mean.
const POINTS: u32 = 3;

/// Maximum and mean per cell: bounds for null-collision tracking, and a deterministic stand-in for the volume.
#[derive(Clone, Debug)]
pub struct Coarse {
    /// From the world to cells: cell (i, j, k) is the unit cube at (i, j, k).
    to_cells: Affine3A,
    to_world: Affine3A,
    size: [u32; 3],
    /// Largest value of any channel.
    most: Vec<f32>,
    mean: Vec<Spectrum>,
}

/// A piece of a segment within one cell.
#[derive(Clone, Copy, Debug)]
pub struct Piece {
    /// The cell.
    pub cell: u32,
    /// Where the segment enters it [m].
    pub first: f32,
    /// Where it leaves it [m].
    pub last: f32,
}

impl Coarse {
    /// Looks at `volume` in the box from `low` to `high`; at a grid by its bricks.
    pub fn over(volume: &Volume, low: Vec3, high: Vec3) -> Self {
        if let Some(grid) = volume.grid() {
            return grid.coarse();
        }
        let range = |low, high| volume.range(low, high)[1].max_element();
        Self::of(low, high, |p| volume.eval::<Spectrum>(p), range)
    }

    /// The same of any function `value` of position, whose channels do not exceed `most` within a box.
    pub fn of(
        low: Vec3,
        high: Vec3,
        value: impl Fn(Vec3) -> Spectrum,
        most: impl Fn(Vec3, Vec3) -> f32,
    ) -> Self {
        let extent = (high - low).max(Vec3::splat(f32::MIN_POSITIVE));
        let counts = (extent * (CELLS / extent.max_element())).ceil().max(Vec3::splat(FEWEST));
        let size = counts.to_array().map(|count| count as u32);
        let to_world = Affine3A::from_scale_rotation_translation(extent / counts, glam::Quat::IDENTITY, low);
        let to_cells = Affine3A::from_scale(counts / extent) * Affine3A::from_translation(-low);
        let corner = |index: u32| {
            let [x, y, z] = cell_of(index, size);
            vec3(x as f32, y as f32, z as f32)
        };
        let count = size.iter().product::<u32>();
        let bound = |index| {
            let corner = corner(index);
            most(to_world.transform_point3(corner), to_world.transform_point3(corner + 1.0))
        };
        let mean = |index| mean_of(|p| value(to_world.transform_point3(corner(index) + p)));
        Self {
            to_cells,
            to_world,
            size,
            most: (0..count).map(bound).collect(),
            mean: (0..count).map(mean).collect(),
        }
    }

    /// From what is known of every cell, x fastest: their lattice's size, the map from the world to it, the largest
    /// value of any channel and the mean of each.
    pub fn from_cells(size: [u32; 3], to_cells: Affine3A, most: Vec<f32>, mean: Vec<Spectrum>) -> Self {
        Self { to_cells, to_world: to_cells.inverse(), size, most, mean }
    }

    /// Number of cells.
    pub fn len(&self) -> usize {
        self.most.len()
    }

    /// True if there are no cells.
    pub fn is_empty(&self) -> bool {
        self.most.is_empty()
    }

    /// Largest value of any channel in `cell`.
    #[inline]
    pub fn most(&self, cell: u32) -> f32 {
        self.most[cell as usize]
    }

    /// Mean value of every channel in `cell`.
    #[inline]
    pub fn mean(&self, cell: u32) -> Spectrum {
        self.mean[cell as usize]
    }

    /// Volume of a cell [m^3]; all are alike.
    pub fn cell_volume(&self) -> f64 {
        f64::from(self.to_world.matrix3.determinant().abs())
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
        let size = self.size.map(|n| n as f32);
        let inside = (0..3).all(|axis| cell[axis] >= 0.0 && cell[axis] < size[axis]);
        inside.then(|| index_of([cell.x as u32, cell.y as u32, cell.z as u32], self.size))
    }

    /// The pieces of `segment` in the cells that it crosses, in order.
    #[inline]
    pub fn pieces(&self, segment: &RaySegment) -> impl Iterator<Item = Piece> + use<'_> {
        let mapped = segment.mapped(&self.to_cells);
        let [x, y, z] = self.size.map(|n| n as f32);
        let range = mapped.within(Vec3::ZERO, vec3(x, y, z));
        let [first, last] = range.unwrap_or([0.0, 0.0]);
        let piece = |crossing: crate::math::cells::Crossing| Piece {
            cell: index_of(crossing.cell, self.size),
            first: crossing.first,
            last: crossing.last,
        };
        Cells::new(&mapped, first, last, self.size).map(piece)
    }

    /// The integral along `segment` of the mean of the cells: the same from either end.
    #[inline]
    pub fn integral<L: Channels>(&self, segment: &RaySegment) -> L {
        let piece = |piece: Piece| L::from_spectrum(self.mean(piece.cell)).scaled(piece.last - piece.first);
        self.pieces(segment).map(piece).fold(L::splat(0.0), |sum, part| sum + part)
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
        Coarse::of(vec3(1.0, 0.0, -1.0), vec3(3.0, 1.0, 3.0), value, |_, high| high.dot(vec3(1.0, 2.0, 4.0)))
    }

    #[test]
    fn cells_hold_mean_and_maximum() {
        let coarse = ramp();
        assert_eq!(coarse.size, [16, 8, 32]);
        let cell = coarse.cell_at(vec3(1.01, 0.01, -0.99)).unwrap();
        assert!((coarse.mean(cell).x - (1.0625 + 2.0 * 0.0625 + 4.0 * -0.9375)).abs() < 1e-5);
        assert!((coarse.most(cell) - (1.125 + 0.25 - 3.5)).abs() < 1e-5);
        assert!((coarse.cell_volume() - 0.125f64.powi(3)).abs() < 1e-9);
        assert_eq!(coarse.cell_at(vec3(0.99, 0.5, 0.0)), None);
        let middle = coarse.position(cell, Vec3::splat(0.5));
        assert!((middle - vec3(1.0625, 0.0625, -0.9375)).abs().max_element() < 1e-5);
    }

    #[test]
    fn the_integral_is_symmetric_and_that_of_the_means() {
        let coarse = ramp();
        let (a, b) = (vec3(0.3, 0.1, 0.2), vec3(4.0, 0.9, 2.0));
        let way = |a: Vec3, b: Vec3| RaySegment {
            origin: a,
            direction: (b - a).normalize(),
            length: a.distance(b),
        };
        let (there, back): (f32, f32) = (coarse.integral(&way(a, b)), coarse.integral(&way(b, a)));
        assert!((there - back).abs() < 1e-5 * there);
        let segment = way(a, b);
        let n = 100_000;
        let step = segment.length / n as f32;
        let value = |i: i32| {
            let p = segment.at((i as f32 + 0.5) * step);
            coarse.cell_at(p).map_or(0.0, |cell| f64::from(coarse.mean(cell).x))
        };
        let expected = (0..n).map(value).sum::<f64>() * f64::from(step);
        assert!((f64::from(there) - expected).abs() < 1e-4 * expected, "{there} {expected}");
    }
}
