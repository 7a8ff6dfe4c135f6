//! Exact integrals along a line, brick by brick and cell by cell, and where they reach a given value.
//!
//! Within a cell the trilinear interpolant is a cubic along the line: Gauss-Legendre's rule of two points integrates
//! it exactly. Each term is a mean of voxels with positive weights, so nothing cancels and nothing turns negative.
//! Positions and sums are in f64: a line of 1e4 m through cells of 1 mm still knows where in its cell it is.

use super::lattice::{BRICK, Brick, Filter, Lattice};
use super::voxel::{SIDE, VALUES, Voxel, corners, weights};
use crate::math::axes;

/// A line in the coordinates of a lattice, in cells.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    /// Where t = 0.
    pub origin: [f64; 3],
    /// Change of position per metre.
    pub direction: [f64; 3],
}

/// What a walk along a line found.
pub(super) struct Walk<V: Voxel> {
    /// The integral up to `stop`, or over all.
    pub sum: V::Sum,
    /// Where the target was reached, and the value there.
    pub stop: Option<(f64, V)>,
}

/// Until where a walk goes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Target {
    /// The channel that is watched.
    pub hero: usize,
    /// Its integral at the end; infinite for none.
    pub value: f64,
}

/// Abscissae of Gauss-Legendre's rule of two points on [-1, 1]: 1 / sqrt(3).
const GAUSS: f64 = 0.577_350_269_189_625_8;

/// Newton's steps, or halvings where they fail, at the end of a walk: enough to halve down to a double's last bit.
const MOST_STEPS: usize = 60;

impl<V: Voxel> Lattice<V> {
    /// The integral from `first` to `last`, which lie within the lattice but for rounding.
    pub(super) fn integral(&self, line: &Line, first: f64, last: f64) -> V::Sum {
        let target = Target { hero: 0, value: f64::INFINITY };
        match self.filter {
            Filter::Trilinear => self.walk::<Smooth, false>(line, first, last, target).sum,
            Filter::Nearest => self.walk::<Steps, false>(line, first, last, target).sum,
        }
    }

    /// The walk from `first` that ends where the target is reached, or else at `last`.
    pub(super) fn invert(&self, line: &Line, first: f64, last: f64, target: Target) -> Walk<V> {
        match self.filter {
            Filter::Trilinear => self.walk::<Smooth, true>(line, first, last, target),
            Filter::Nearest => self.walk::<Steps, true>(line, first, last, target),
        }
    }

    fn walk<K: Kernel<V>, const STOP: bool>(
        &self,
        line: &Line,
        first: f64,
        last: f64,
        target: Target,
    ) -> Walk<V> {
        let top = axes(|i| self.size[i] as i64 - 1);
        let mut at = Stepper::new(line, first, BRICK as f64, [0; 3], top);
        let mut walk = Walk { sum: V::ZERO, stop: None };
        let mut start = first;
        while let Some(brick) = self.brick(at.cell) {
            let end = at.end(start, last);
            match &brick.values {
                None => walk.even::<STOP>(brick.mean, start, end, target),
                Some(values) => walk.cells::<K, STOP>(values, line, at.cell, [start, end], target),
            }
            if end >= last || walk.stop.is_some() {
                break;
            }
            start = end;
            at.advance();
        }
        walk
    }

    #[inline]
    fn brick(&self, at: [i64; 3]) -> Option<&Brick<V>> {
        let is_inside = (0..3).all(|axis| (at[axis] as usize) < self.size[axis]);
        if is_inside { self.bricks.get(self.index(axes(|i| at[i] as usize))) } else { None }
    }
}

/// Walks along a line from cell to cell, or from brick to brick.
struct Stepper {
    /// The current one.
    cell: [i64; 3],
    /// t where the line leaves it along every axis.
    next: [f64; 3],
    /// t from one boundary to the next.
    delta: [f64; 3],
    step: [i64; 3],
}

impl Stepper {
    /// Starts in the cell (of `side` lattice cells) of the point at t = `first`, kept from `low` to `high`.
    #[inline]
    fn new(line: &Line, first: f64, side: f64, low: [i64; 3], high: [i64; 3]) -> Self {
        let mut stepper =
            Self { cell: low, next: [f64::INFINITY; 3], delta: [f64::INFINITY; 3], step: [1; 3] };
        for axis in 0..3 {
            let (origin, direction) = (line.origin[axis], line.direction[axis]);
            // Positive up to rounding: to cut off the fraction is to round down.
            let at = (origin + direction * first) / side;
            let cell = (at as i64).clamp(low[axis], high[axis]);
            stepper.cell[axis] = cell;
            if direction.abs() > 1e-200 {
                let is_up = direction > 0.0;
                stepper.step[axis] = if is_up { 1 } else { -1 };
                let plane = (cell + i64::from(is_up)) as f64 * side;
                let inverse = 1.0 / direction;
                stepper.next[axis] = (plane - origin) * inverse;
                stepper.delta[axis] = side * inverse.abs();
            }
        }
        stepper
    }

    /// t where the line leaves the cell, kept from `start` to `last`.
    #[inline]
    fn end(&self, start: f64, last: f64) -> f64 {
        // Not f64::min and f64::max, which check for NaN.
        let lesser = |x: f64, y: f64| if x < y { x } else { y };
        let [x, y, z] = self.next;
        let end = lesser(lesser(x, y), lesser(z, last));
        if end > start { end } else { start }
    }

    /// Goes on to the next cell; true for the axis along which. No branches: which axis comes next is unpredictable.
    #[inline]
    fn advance(&mut self) -> [bool; 3] {
        let [x, y, z] = self.next;
        let is_x = (x < y) & (x < z);
        let is_y = !is_x & (y < z);
        let next = [is_x, is_y, !(is_x | is_y)];
        for (axis, is_next) in next.into_iter().enumerate() {
            self.next[axis] += if is_next { self.delta[axis] } else { 0.0 };
            self.cell[axis] += if is_next { self.step[axis] } else { 0 };
        }
        next
    }
}

impl<V: Voxel> Walk<V> {
    /// Passes through one value from `start` to `end`.
    #[inline]
    fn even<const STOP: bool>(&mut self, value: V, start: f64, end: f64, target: Target) {
        let gain = value.wide() * (end - start);
        if STOP && V::channel(self.sum + gain, target.hero) > target.value {
            let missing = target.value - V::channel(self.sum, target.hero);
            let t = (start + missing / V::channel(value.wide(), target.hero)).clamp(start, end);
            self.sum += value.wide() * (t - start);
            self.stop = Some((t, value));
            return;
        }
        self.sum += gain;
    }

    /// Passes through the cells of a brick.
    #[inline]
    fn cells<K: Kernel<V>, const STOP: bool>(
        &mut self,
        values: &[V; VALUES],
        line: &Line,
        brick: [i64; 3],
        [first, last]: [f64; 2],
        target: Target,
    ) {
        let corner = axes(|i| brick[i] * BRICK as i64);
        let mut at = Stepper::new(line, first, 1.0, corner, axes(|i| corner[i] + BRICK as i64 - 1));
        let local: [i64; 3] = axes(|i| at.cell[i] - corner[i]);
        let mut index = local[0] + SIDE as i64 * (local[1] + SIDE as i64 * local[2]);
        let strides: [i64; 3] = axes(|i| at.step[i] * [1, SIDE as i64, (SIDE * SIDE) as i64][i]);
        let mut base: [f64; 3] = axes(|i| line.origin[i] - at.cell[i] as f64);
        let backs = axes(|i| at.step[i] as f64);
        let mut start = first;
        loop {
            let end = at.end(start, last);
            let cell = Cell { index: index as usize, line: Line { origin: base, direction: line.direction } };
            let Some(gain) = K::integral(values, &cell, start, end) else { return };
            if STOP && V::channel(self.sum + gain, target.hero) > target.value {
                return self.halt::<K>(values, &cell, [start, end], target);
            }
            self.sum += gain;
            if end >= last {
                return;
            }
            start = end;
            for (axis, is_next) in at.advance().into_iter().enumerate() {
                index += if is_next { strides[axis] } else { 0 };
                base[axis] -= if is_next { backs[axis] } else { 0.0 };
            }
        }
    }

    /// Ends within the cell that exceeds the target.
    #[cold]
    fn halt<K: Kernel<V>>(&mut self, values: &[V; VALUES], cell: &Cell, ends: [f64; 2], target: Target) {
        let missing = target.value - V::channel(self.sum, target.hero);
        let t = K::reach(values, cell, ends, missing, target.hero);
        self.sum += K::integral(values, cell, ends[0], t).unwrap_or(V::ZERO);
        self.stop = Some((t, K::value(values, cell, t)));
    }
}

/// A cell of a brick and the line seen from its first corner.
struct Cell {
    index: usize,
    line: Line,
}

impl Cell {
    #[inline]
    fn at(&self, t: f64) -> [f64; 3] {
        axes(|i| self.line.origin[i] + self.line.direction[i] * t)
    }
}

/// What differs between filters.
trait Kernel<V: Voxel> {
    /// The integral over a part of a cell; none beyond the brick, where rounding may lead for an instant.
    fn integral(values: &[V; VALUES], cell: &Cell, start: f64, end: f64) -> Option<V::Sum>;
    /// The value at t.
    fn value(values: &[V; VALUES], cell: &Cell, t: f64) -> V;
    /// t between the ends where the integral of the hero's channel from the first is `missing`.
    fn reach(values: &[V; VALUES], cell: &Cell, ends: [f64; 2], missing: f64, hero: usize) -> f64;
}

/// The nearest sample.
struct Steps;

impl<V: Voxel> Kernel<V> for Steps {
    #[inline]
    fn integral(values: &[V; VALUES], cell: &Cell, start: f64, end: f64) -> Option<V::Sum> {
        Some(values.get(cell.index)?.wide() * (end - start))
    }

    fn value(values: &[V; VALUES], cell: &Cell, _: f64) -> V {
        values[cell.index]
    }

    fn reach(values: &[V; VALUES], cell: &Cell, [start, end]: [f64; 2], missing: f64, hero: usize) -> f64 {
        (start + missing / V::channel(values[cell.index].wide(), hero)).clamp(start, end)
    }
}

/// Trilinear interpolation.
struct Smooth;

impl<V: Voxel> Kernel<V> for Smooth {
    #[inline]
    fn integral(values: &[V; VALUES], cell: &Cell, start: f64, end: f64) -> Option<V::Sum> {
        let corners = corners(values, cell.index)?;
        let (half, middle) = (0.5 * (end - start), 0.5 * (end + start));
        let [low_a, high_a] = weights(cell.at(middle - GAUSS * half));
        let [low_b, high_b] = weights(cell.at(middle + GAUSS * half));
        Some(V::weighted(corners, low_a + low_b, high_a + high_b).wide() * half)
    }

    fn value(values: &[V; VALUES], cell: &Cell, t: f64) -> V {
        let [low, high] = weights(cell.at(t));
        corners(values, cell.index).map_or(V::splat(0.0), |corners| V::weighted(corners, low, high))
    }

    fn reach(values: &[V; VALUES], cell: &Cell, [start, end]: [f64; 2], missing: f64, hero: usize) -> f64 {
        let Some(corners) = corners(values, cell.index) else { return start };
        let of = |i: usize| V::channel(corners[i].wide(), hero);
        let corners = [of(0), of(1), of(9), of(10), of(81), of(82), of(90), of(91)];
        let value = |t: f64| interpolate(&corners, cell.at(t));
        let integral = |t: f64| {
            let (half, middle) = (0.5 * (t - start), 0.5 * (t + start));
            half * (value(middle - GAUSS * half) + value(middle + GAUSS * half))
        };
        let (mut low, mut high) = (start, end);
        let mut t = start + (end - start) * (missing / integral(end)).clamp(0.0, 1.0);
        for _ in 0..MOST_STEPS {
            let excess = integral(t) - missing;
            if excess > 0.0 {
                high = t
            } else {
                low = t
            }
            let newton = t - excess / value(t);
            let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
            if (next - t).abs() <= 1e-12 * (end - start) {
                return next;
            }
            t = next;
        }
        t
    }
}

/// The trilinear interpolant between the corners of a cell, x fastest.
fn interpolate(corners: &[f64; 8], at: [f64; 3]) -> f64 {
    let [x, y, z] = axes(|i| at[i].clamp(0.0, 1.0));
    let along = |i: usize| corners[i] * (1.0 - x) + corners[i + 1] * x;
    let plane = |i: usize| along(i) * (1.0 - y) + along(i + 2) * y;
    plane(0) * (1.0 - z) + plane(4) * z
}
