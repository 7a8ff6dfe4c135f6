//! Values on a lattice, kept in bricks of 8 x 8 x 8 cells. A brick holds the 9 x 9 x 9 corners of its cells, so that
//! no cell looks outside its brick; one whose corners are all equal, as in empty space, holds a single value.

use super::super::{Samples, Summary};
use super::voxel::{SIDE, VALUES, Voxel, corners, weights};
use crate::math::{Wrap, axes};

/// Cells along a side of a brick.
pub(super) const BRICK: usize = 8;

/// Interpolation between samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filter {
    /// Trilinear interpolation; the cells lie between sample centres.
    Trilinear,
    /// The nearest sample; every cell is one sample's.
    Nearest,
}

/// The part of the endless, wrapped lattice of samples that is kept.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    /// Index of the sample at the first corner, negative before the file's first sample.
    pub first: [i64; 3],
    /// Cells along x, y and z, each at least 1.
    pub cells: [usize; 3],
    /// The part of them that counts for means: its two corners, in cells.
    pub counted: [[f64; 3]; 2],
}

impl Extent {
    /// Bricks along x, y and z.
    pub(super) fn size(&self) -> [usize; 3] {
        self.cells.map(|cells| cells.div_ceil(BRICK))
    }
}

/// A cube of cells.
#[derive(Clone, Debug)]
pub(super) struct Brick<V> {
    /// Values at the corners, x fastest; none where all are equal.
    pub values: Option<Box<[V; VALUES]>>,
    /// The mean over what counts of the brick; the value of all of it where there are no `values`.
    pub mean: V,
    /// The least value at a corner.
    pub least: V,
    /// The greatest value at a corner.
    pub most: V,
}

/// The bricks.
#[derive(Clone)]
pub(super) struct Lattice<V> {
    /// Cells along x, y and z.
    pub cells: [usize; 3],
    /// Bricks along x, y and z.
    pub size: [usize; 3],
    /// Interpolation between samples.
    pub filter: Filter,
    /// All bricks, x fastest.
    pub bricks: Vec<Brick<V>>,
}

/// Millions of voxels are nothing to read.
impl<V> std::fmt::Debug for Lattice<V> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Lattice")
            .field("cells", &self.cells)
            .field("filter", &self.filter)
            .finish_non_exhaustive()
    }
}

impl<V: Voxel> Lattice<V> {
    /// The most bytes that [`Self::build`] may take: no brick of which the source knows that it is even needs values.
    pub(super) fn most_bytes<S: Samples<V> + ?Sized>(
        samples: &S,
        wrap: Wrap,
        filter: Filter,
        extent: &Extent,
    ) -> u64 {
        let size = extent.size();
        let reader = Reader { samples, wrap, filter, extent, scratch: Vec::new() };
        let all =
            (0..size[2]).flat_map(|z| (0..size[1]).flat_map(move |y| (0..size[0]).map(move |x| [x, y, z])));
        let bytes = |at| if reader.known(at).is_some() { 0 } else { size_of::<[V; VALUES]>() };
        all.map(|at| (size_of::<Brick<V>>() + bytes(at)) as u64).sum()
    }

    /// Copies `samples` within `extent` into bricks. Bricks for which `is_needed` is false (called with their
    /// number along each axis) stay empty.
    pub(super) fn build<S: Samples<V> + ?Sized>(
        samples: &S,
        wrap: Wrap,
        filter: Filter,
        extent: &Extent,
        is_needed: impl Fn([usize; 3]) -> bool,
    ) -> Self {
        let size = extent.size();
        let mut reader = Reader { samples, wrap, filter, extent, scratch: vec![V::splat(0.0); VALUES] };
        let mut bricks = Vec::with_capacity(size.iter().product());
        for z in 0..size[2] {
            for y in 0..size[1] {
                for x in 0..size[0] {
                    let at = [x, y, z];
                    bricks.push(if is_needed(at) { reader.brick(at) } else { Brick::of(V::splat(0.0)) });
                }
            }
        }
        Self { cells: extent.cells, size, filter, bricks }
    }

    /// The same lattice of values made by `change`, which keeps order.
    pub(super) fn map<W: Voxel>(self, change: impl Fn(V) -> W + Copy) -> Lattice<W> {
        let bricks = self.bricks.into_iter().map(|brick| brick.map(change)).collect();
        Lattice { cells: self.cells, size: self.size, filter: self.filter, bricks }
    }

    /// All values kept.
    pub(super) fn values(&self) -> impl Iterator<Item = V> {
        self.bricks.iter().flat_map(|brick| {
            let all: &[V] = brick.values.as_deref().map_or(std::slice::from_ref(&brick.mean), |v| v);
            all.iter().copied()
        })
    }

    /// Place of the brick `at` in `bricks`.
    #[inline]
    pub(super) fn index(&self, at: [usize; 3]) -> usize {
        at[0] + self.size[0] * (at[1] + self.size[1] * at[2])
    }

    /// The value at a point, in cells.
    #[inline]
    pub(super) fn eval(&self, at: [f64; 3]) -> V {
        let cell = axes(|i| (at[i] as usize).min(self.cells[i] - 1));
        let brick = &self.bricks[self.index(axes(|i| cell[i] / BRICK))];
        let Some(values) = &brick.values else { return brick.mean };
        let [x, y, z] = axes(|i| cell[i] % BRICK);
        let index = x + SIDE * (y + SIDE * z);
        if self.filter == Filter::Nearest {
            return values[index];
        }
        let [low, high] = weights(axes(|i| at[i] - cell[i] as f64));
        corners(values, index).map_or(brick.mean, |corners| V::weighted(corners, low, high))
    }

    /// The least and the greatest value at the corners of all bricks that the box between two points
    /// overlaps, in cells.
    pub(super) fn range(&self, low: [f64; 3], high: [f64; 3]) -> [V; 2] {
        let brick = |x: f64, i: usize| (x.max(0.0) as usize / BRICK).min(self.size[i] - 1);
        // A little wider than requested, as `eval` rounds its positions in its own way.
        let first = axes(|i| brick(low[i] - 1e-3, i));
        let last = axes(|i| brick(high[i] + 1e-3, i));
        let start = &self.bricks[self.index(first)];
        let mut range = [start.least, start.most];
        for z in first[2]..=last[2] {
            for y in first[1]..=last[1] {
                let row = self.index([first[0], y, z]);
                for brick in &self.bricks[row..=row + last[0] - first[0]] {
                    range = [range[0].least(brick.least), range[1].most(brick.most)];
                }
            }
        }
        range
    }
}

impl<V: Voxel> Brick<V> {
    /// The same value everywhere.
    fn of(value: V) -> Self {
        Self { values: None, mean: value, least: value, most: value }
    }

    /// What it is like from afar.
    pub(super) fn summary(&self) -> Summary {
        Summary {
            least: self.least.to_spectrum().min_element(),
            most: self.most.to_spectrum().max_element(),
            mean: self.mean.to_spectrum(),
        }
    }

    fn map<W: Voxel>(self, change: impl Fn(V) -> W) -> Brick<W> {
        let values = self.values.map(|values| boxed(values.iter().map(|value| change(*value))));
        let (mean, least, most) = (change(self.mean), change(self.least), change(self.most));
        Brick { values, mean, least, most }
    }
}

/// The values of a brick in a box of their own. There are always [`VALUES`] of them.
fn boxed<V: Voxel>(values: impl Iterator<Item = V>) -> Box<[V; VALUES]> {
    let mut all = Box::new([V::splat(0.0); VALUES]);
    all.iter_mut().zip(values).for_each(|(to, from)| *to = from);
    all
}

/// Copies samples brick by brick.
struct Reader<'a, V, S: ?Sized> {
    samples: &'a S,
    wrap: Wrap,
    filter: Filter,
    extent: &'a Extent,
    scratch: Vec<V>,
}

impl<V: Voxel, S: Samples<V> + ?Sized> Reader<'_, V, S> {
    fn brick(&mut self, at: [usize; 3]) -> Brick<V> {
        if let Some(value) = self.known(at) {
            return Brick::of(value);
        }
        self.copy(&std::array::from_fn(|axis| self.indices(axis, at[axis])));
        let first = self.scratch[0];
        if self.scratch.iter().all(|value| value.same(first)) {
            return Brick::of(first);
        }
        let fold = |change: fn(V, V) -> V| self.scratch.iter().copied().fold(first, change);
        let (least, most, mean) = (fold(V::least), fold(V::most), self.mean(at));
        Brick { values: Some(boxed(self.scratch.iter().copied())), mean, least, most }
    }

    /// The corners of a brick along an axis, as indices of the endless lattice. Corners that no cell reaches repeat the
    /// last one that a cell does, so that they make no brick less uniform and no bound wider.
    fn corners(&self, axis: usize, brick: usize) -> [i64; SIDE] {
        let last = match self.filter {
            Filter::Trilinear => self.extent.cells[axis],
            Filter::Nearest => (self.extent.cells[axis] - 1).min(brick * BRICK + BRICK - 1),
        };
        std::array::from_fn(|i| self.extent.first[axis] + (brick * BRICK + i).min(last) as i64)
    }

    fn indices(&self, axis: usize, brick: usize) -> [usize; SIDE] {
        let size = self.samples.size()[axis];
        self.corners(axis, brick).map(|index| self.wrap.index(index, size))
    }

    /// The value of the whole brick where the source knows it.
    fn known(&self, at: [usize; 3]) -> Option<V> {
        let size = self.samples.size();
        let ends: [[usize; 2]; 3] = std::array::from_fn(|axis| {
            let corners = self.corners(axis, at[axis]);
            self.wrap.indices([corners[0], corners[SIDE - 1]], size[axis])
        });
        self.samples.uniform(ends.map(|[low, _]| low), ends.map(|[_, high]| high))
    }

    fn copy(&mut self, [xs, ys, zs]: &[[usize; SIDE]; 3]) {
        let mut to = self.scratch.iter_mut();
        for z in zs {
            for y in ys {
                for (x, to) in xs.iter().zip(&mut to) {
                    *to = self.samples.at([*x, *y, *z]);
                }
            }
        }
    }

    /// The exact mean of the interpolant over what counts of the brick.
    fn mean(&self, at: [usize; 3]) -> V {
        let [xs, ys, zs]: [[f64; SIDE]; 3] = std::array::from_fn(|axis| self.shares(axis, at[axis]));
        let mut values = self.scratch.iter();
        let mut sum = V::ZERO;
        for z in zs {
            for y in ys {
                for (x, value) in xs.iter().zip(&mut values) {
                    sum += value.wide() * (x * y * z);
                }
            }
        }
        V::narrow(sum)
    }

    /// How much each corner along an axis counts for the mean: together 1.
    fn shares(&self, axis: usize, brick: usize) -> [f64; SIDE] {
        let [low, high] = self.extent.counted.map(|end| end[axis] - (brick * BRICK) as f64);
        let mut shares = [0.0; SIDE];
        for cell in 0..BRICK.min(self.extent.cells[axis] - brick * BRICK) {
            let (a, b) = ((low - cell as f64).clamp(0.0, 1.0), (high - cell as f64).clamp(0.0, 1.0));
            let far = match self.filter {
                Filter::Trilinear => 0.5 * (a + b),
                Filter::Nearest => 0.0,
            };
            shares[cell] += (b - a) * (1.0 - far);
            shares[cell + 1] += (b - a) * far;
        }
        let sum: f64 = shares.iter().sum();
        // A brick of which nothing counts has no mean; no ray stays in it for long.
        if sum > 0.0 { shares.map(|share| share / sum) } else { [1.0 / SIDE as f64; SIDE] }
    }
}
