//! The cells of a lattice that a straight line crosses, in order (Amanatides & Woo 1987).

use super::RaySegment;

/// A cell that is crossed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Its number, x fastest.
    pub cell: u32,
    /// t where the line enters it.
    pub first: f32,
    /// t where it leaves, >= `first`.
    pub last: f32,
}

/// Iterates over the unit cells of the lattice 0..size that `segment` crosses from `first` to `last`. Each
/// crossing begins where the one before it ended: nothing is left out and nothing counted twice, whatever the
/// rounding.
#[derive(Clone, Debug)]
pub struct Cells {
    cell: i32,
    axes: [Axis; 3],
    at: f32,
    last: f32,
    done: bool,
}

/// Progress along an axis.
#[derive(Clone, Copy, Debug)]
struct Axis {
    /// t at the next boundary.
    next: f32,
    /// Its coordinate.
    plane: f32,
    /// From it to the one after.
    step: f32,
    /// From a cell's number to that of the one behind the boundary.
    stride: i32,
    /// The border of the lattice. The cells there reach as far as the line does: rounding may have put their end a
    /// little short.
    border: f32,
    origin: f32,
    /// 1 over the direction.
    inverse: f32,
}

impl Axis {
    /// In cell `cell` of `size`, whose neighbours' numbers differ by `stride`.
    #[inline]
    fn new(origin: f32, direction: f32, cell: i32, size: u32, stride: i32) -> Self {
        let (step, border) = if direction < 0.0 { (-1, 0) } else { (1, size as i32) };
        // A line that never meets a boundary has none but the border's.
        let plane = if direction == 0.0 { border } else { cell + i32::from(step > 0) };
        let mut axis = Self {
            next: f32::INFINITY,
            plane: plane as f32,
            step: step as f32,
            stride: stride * step,
            border: border as f32,
            origin,
            inverse: 1.0 / direction,
        };
        axis.next = axis.boundary();
        axis
    }

    /// t at `plane`: from the coordinate itself, so that it does not drift.
    #[inline(always)]
    fn boundary(&self) -> f32 {
        if self.plane == self.border { f32::INFINITY } else { (self.plane - self.origin) * self.inverse }
    }

    /// Passes the boundary; the change of the cell's number.
    #[inline(always)]
    fn advance(&mut self) -> i32 {
        self.plane += self.step;
        self.next = self.boundary();
        self.stride
    }
}

impl Cells {
    /// Starts at `first`; cells beyond the lattice are taken for those at its border.
    #[inline]
    pub fn new(segment: &RaySegment, first: f32, last: f32, size: [u32; 3]) -> Self {
        let (start, direction) = (segment.at(first), segment.direction);
        let at: [i32; 3] = std::array::from_fn(|i| (start[i].floor() as i32).clamp(0, size[i] as i32 - 1));
        let strides = [1, size[0] as i32, (size[0] * size[1]) as i32];
        let axes =
            std::array::from_fn(|i| Axis::new(segment.origin[i], direction[i], at[i], size[i], strides[i]));
        let cell = (0..3).map(|i| at[i] * strides[i]).sum();
        Self { cell, axes, at: first, last, done: first >= last }
    }
}

impl Iterator for Cells {
    type Item = Crossing;

    #[inline(always)]
    fn next(&mut self) -> Option<Crossing> {
        if self.done {
            return None;
        }
        let [x, y, z] = &mut self.axes;
        let (cell, first) = (self.cell as u32, self.at);
        let nearest = if x.next <= y.next && x.next <= z.next {
            x
        } else if y.next <= z.next {
            y
        } else {
            z
        };
        let until = nearest.next;
        self.done = until >= self.last;
        // Not f32::min and f32::max, which check for NaN.
        let until = if until < self.last { until } else { self.last };
        let until = if until > first { until } else { first };
        self.cell += nearest.advance();
        self.at = until;
        Some(Crossing { cell, first, last: until })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        math::{Vec3, vec3},
        sampling::{Stream, stream::Purpose},
    };

    #[test]
    fn crossings_join_and_hold_their_midpoints() {
        let size = [5, 7, 3];
        let (low, high) = (Vec3::ZERO, vec3(5.0, 7.0, 3.0));
        let mut crossed = 0;
        for index in 0..2_000 {
            let mut stream = Stream::new(1, index, 0, Purpose::Study);
            let mut vector = || vec3(stream.uniform(), stream.uniform(), stream.uniform());
            let (a, b) = (vector() * 12.0 - 2.0, vector() * 12.0 - 2.0);
            // Some along an axis, some exactly between cells.
            let a = if index % 3 == 0 { a.round() } else { a };
            let b = if index % 5 == 0 { vec3(b.x, a.y, a.z) } else { b };
            let segment =
                RaySegment { origin: a, direction: (b - a).normalize_or_zero(), length: (b - a).length() };
            let Some([first, last]) = segment.within(low, high) else { continue };
            let mut at = first;
            for Crossing { cell, first, last } in Cells::new(&segment, first, last, size) {
                assert_eq!(first, at);
                assert!(last >= first);
                at = last;
                let inside = segment.at(0.5 * (first + last));
                let along = [cell % size[0], cell / size[0] % size[1], cell / (size[0] * size[1])];
                let corner = Vec3::from_array(along.map(|i| i as f32));
                let off = (inside - corner - 0.5).abs().max_element();
                assert!(last - first < 1e-4 || off <= 0.5 + 1e-4, "{off}");
                crossed += 1;
            }
            assert_eq!(at, last);
        }
        assert!(crossed > 1_000);
    }
}
