//! The cells of a lattice that a straight line crosses, in order (Amanatides & Woo 1987).

use super::{RaySegment, axes};
use glam::{Vec3A, Vec3Swizzles};

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
    /// t at the next boundary of every axis.
    next: Vec3A,
    /// The coordinate of that boundary.
    plane: Vec3A,
    /// From it to the one after.
    step: Vec3A,
    /// The border of the lattice, which has no boundary: cells there reach as far as the line does, for rounding may
    /// have put their end a little short.
    border: Vec3A,
    origin: Vec3A,
    /// 1 over the direction.
    inverse: Vec3A,
    /// How the cell's number changes where boundaries of the axes in the index's bits are passed.
    strides: [i32; 8],
    at: f32,
    last: f32,
    done: bool,
}

impl Cells {
    /// Starts at `first`; cells beyond the lattice are taken for those at its border.
    #[inline]
    pub fn new(segment: &RaySegment, first: f32, last: f32, size: [u32; 3]) -> Self {
        let (origin, direction) = (Vec3A::from(segment.origin), Vec3A::from(segment.direction));
        let end = Vec3A::from_array(axes(|i| size[i] as f32));
        let cell = (origin + direction * first).floor().clamp(Vec3A::ZERO, end - 1.0);
        let is_down = direction.cmplt(Vec3A::ZERO);
        let step = Vec3A::select(is_down, Vec3A::NEG_ONE, Vec3A::ONE);
        let border = Vec3A::select(is_down, Vec3A::ZERO, end);
        let plane = Vec3A::select(is_down, cell, cell + 1.0);
        let inverse = direction.recip();
        // A line that never meets a boundary has none but the border's.
        let plane = Vec3A::select(inverse.abs().cmpeq(Vec3A::INFINITY), border, plane);
        let widths = [1, size[0] as i32, (size[0] * size[1]) as i32];
        let [x, y, z] = axes(|i| if direction[i] < 0.0 { -widths[i] } else { widths[i] });
        let mut cells = Self {
            cell: (0..3).map(|i| cell[i] as i32 * widths[i]).sum(),
            next: Vec3A::INFINITY,
            plane,
            step,
            border,
            origin,
            inverse,
            strides: [0, x, y, x + y, z, x + z, y + z, x + y + z],
            at: first,
            last,
            done: first >= last,
        };
        cells.next = cells.boundaries();
        cells
    }

    /// t at every `plane`: from the coordinates themselves, so that it does not drift.
    #[inline(always)]
    fn boundaries(&self) -> Vec3A {
        let is_border = self.plane.cmpeq(self.border);
        Vec3A::select(is_border, Vec3A::INFINITY, (self.plane - self.origin) * self.inverse)
    }
}

impl Iterator for Cells {
    type Item = Crossing;

    #[inline(always)]
    fn next(&mut self) -> Option<Crossing> {
        if self.done {
            return None;
        }
        let (cell, first) = (self.cell as u32, self.at);
        let until = self.next.min_element();
        self.done = until >= self.last;
        // Not f32::min and f32::max, which check for NaN.
        let until = if until < self.last { until } else { self.last };
        let until = if until > first { until } else { first };
        self.at = until;
        // No branches: which axis comes next is unpredictable. Two at once go to the cell across the edge.
        let nearest = self.next.cmple(self.next.yzx()) & self.next.cmple(self.next.zxy());
        self.plane += Vec3A::select(nearest, self.step, Vec3A::ZERO);
        self.cell += self.strides[nearest.bitmask() as usize & 7];
        self.next = self.boundaries();
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
