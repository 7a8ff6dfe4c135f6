//! The kinds of values that grids hold, and the arithmetic that their interpolation needs.

use super::super::Channels;
use crate::math::{DVec3, Spectrum, axes};
use glam::Vec4;

/// Values along x, y and z of a brick: 8 cells have 9 corners.
pub(super) const SIDE: usize = 9;
/// Values of a brick.
pub(super) const VALUES: usize = SIDE * SIDE * SIDE;
/// From the first corner of a cell to its last, both counted.
pub(super) const SPAN: usize = 1 + SIDE + SIDE * SIDE + 1;

/// What a grid can hold at a point: a number or a colour.
pub(super) trait Voxel: Channels {
    /// Sums of many values, wide enough that none is lost.
    type Sum: Copy
        + std::ops::Add<Output = Self::Sum>
        + std::ops::AddAssign
        + std::ops::Mul<f64, Output = Self::Sum>;
    /// Nothing yet.
    const ZERO: Self::Sum;
    /// The value, ready to be summed.
    fn wide(self) -> Self::Sum;
    /// A sum as a value.
    fn narrow(sum: Self::Sum) -> Self;
    /// The channel by which distances are sampled.
    fn channel(sum: Self::Sum, hero: usize) -> f64;
    /// The lesser of two, per channel.
    fn least(self, other: Self) -> Self;
    /// The greater of two, per channel.
    fn most(self, other: Self) -> Self;
    /// True if both are the same in every channel.
    fn same(self, other: Self) -> bool;
    /// The sum of a cell's eight corners, each times its weight: in `low` those of smaller z, in order of x, then y.
    fn weighted(corners: &[Self; SPAN], low: Vec4, high: Vec4) -> Self;
}

impl Voxel for f32 {
    type Sum = f64;
    const ZERO: f64 = 0.0;
    #[inline]
    fn wide(self) -> f64 {
        f64::from(self)
    }
    #[inline]
    fn narrow(sum: f64) -> Self {
        sum as Self
    }
    #[inline]
    fn channel(sum: f64, _: usize) -> f64 {
        sum
    }
    #[inline]
    fn least(self, other: Self) -> Self {
        self.min(other)
    }
    #[inline]
    fn most(self, other: Self) -> Self {
        self.max(other)
    }
    fn same(self, other: Self) -> bool {
        self == other
    }
    #[inline]
    fn weighted(corners: &[Self; SPAN], low: Vec4, high: Vec4) -> Self {
        let near = Vec4::new(corners[0], corners[1], corners[9], corners[10]);
        let far = Vec4::new(corners[81], corners[82], corners[90], corners[91]);
        (near * low + far * high).element_sum()
    }
}

impl Voxel for Spectrum {
    type Sum = DVec3;
    const ZERO: DVec3 = DVec3::ZERO;
    #[inline]
    fn wide(self) -> DVec3 {
        self.as_dvec3()
    }
    #[inline]
    fn narrow(sum: DVec3) -> Self {
        sum.as_vec3()
    }
    #[inline]
    fn channel(sum: DVec3, hero: usize) -> f64 {
        sum[hero]
    }
    #[inline]
    fn least(self, other: Self) -> Self {
        self.min(other)
    }
    #[inline]
    fn most(self, other: Self) -> Self {
        self.max(other)
    }
    fn same(self, other: Self) -> bool {
        self == other
    }
    #[inline]
    fn weighted(corners: &[Self; SPAN], low: Vec4, high: Vec4) -> Self {
        corners[0] * low.x
            + corners[1] * low.y
            + corners[9] * low.z
            + corners[10] * low.w
            + corners[81] * high.x
            + corners[82] * high.y
            + corners[90] * high.z
            + corners[91] * high.w
    }
}

/// How much every corner of a cell counts at a point of it, in the order of [`Voxel::weighted`]. The coordinates are
/// those within the cell; a little beyond it counts as its border, so that no weight is negative. Each weight is as
/// exact as an f32 can be, the small ones too: a voxel may be a million times its neighbour.
#[inline]
pub(super) fn weights(at: [f64; 3]) -> [Vec4; 2] {
    let positive = |x: f64| (if x > 0.0 { x } else { 0.0 }) as f32;
    let [[x0, x1], [y0, y1], [z0, z1]] = axes(|i| [positive(1.0 - at[i]), positive(at[i])]);
    let plane = Vec4::new(x0, x1, x0, x1) * Vec4::new(y0, y0, y1, y1);
    [plane * z0, plane * z1]
}

/// The corners of the cell whose first corner is `values(index)`.
#[inline]
pub(super) fn corners<V>(values: &[V; VALUES], index: usize) -> Option<&[V; SPAN]> {
    values.get(index..)?.first_chunk()
}
