//! The cells of a lattice that a straight line crosses, in order (Amanatides & Woo 1987).

use super::{RaySegment, Vec3};

/// A cell that is crossed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Its indices.
    pub cell: [u32; 3],
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
    cell: [i32; 3],
    size: [u32; 3],
    step: [i32; 3],
    /// t at the next boundary of every axis.
    next: [f32; 3],
    origin: Vec3,
    direction: Vec3,
    at: f32,
    last: f32,
    done: bool,
}

impl Cells {
    /// Starts at `first`; cells beyond the lattice are taken for those at its border.
    #[inline]
    pub fn new(segment: &RaySegment, first: f32, last: f32, size: [u32; 3]) -> Self {
        let (start, direction) = (segment.at(first), segment.direction);
        let cell = std::array::from_fn(|i| (start[i].floor() as i32).clamp(0, size[i] as i32 - 1));
        let step = std::array::from_fn(|i| if direction[i] < 0.0 { -1 } else { 1 });
        let (origin, next) = (segment.origin, [0.0; 3]);
        let mut cells =
            Self { cell, size, step, next, origin, direction, at: first, last, done: first >= last };
        (0..3).for_each(|axis| cells.next[axis] = cells.boundary(axis));
        cells
    }

    /// t at the boundary where `axis` leaves the current cell: from the index itself, so that it does not drift.
    #[inline]
    fn boundary(&self, axis: usize) -> f32 {
        if self.direction[axis] == 0.0 {
            return f32::INFINITY;
        }
        let plane = self.cell[axis] + i32::from(self.step[axis] > 0);
        (plane as f32 - self.origin[axis]) / self.direction[axis]
    }
}

impl Iterator for Cells {
    type Item = Crossing;

    #[inline]
    fn next(&mut self) -> Option<Crossing> {
        if self.done {
            return None;
        }
        let [x, y, z] = self.next;
        let axis = if x <= y && x <= z { 0 } else { usize::from(y > z) + 1 };
        let cell = self.cell.map(|index| index as u32);
        let (first, until) = (self.at, self.next[axis].max(self.at));
        self.cell[axis] += self.step[axis];
        let outside = self.cell[axis] < 0 || self.cell[axis] >= self.size[axis] as i32;
        // The border cell reaches as far as the line does: rounding may have put its end a little short.
        self.done = outside || until >= self.last;
        let last = if self.done { self.last } else { until };
        self.next[axis] = self.boundary(axis);
        self.at = last;
        Some(Crossing { cell, first, last })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        math::vec3,
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
                let corner = vec3(cell[0] as f32, cell[1] as f32, cell[2] as f32);
                let off = (inside - corner - 0.5).abs().max_element();
                assert!(last - first < 1e-4 || off <= 0.5 + 1e-4, "{off}");
                crossed += 1;
            }
            assert_eq!(at, last);
        }
        assert!(crossed > 1_000);
    }
}
