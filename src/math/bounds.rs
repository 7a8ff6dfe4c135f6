//! Boxes along the axes, as what is in a scene has them.

use glam::Vec3;

/// A box along the axes. Corners may be infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Its least corner.
    pub low: Vec3,
    /// Its greatest corner.
    pub high: Vec3,
}

impl Bounds {
    /// Around nothing.
    pub const EMPTY: Self = Self { low: Vec3::INFINITY, high: Vec3::NEG_INFINITY };
    /// Around everything.
    pub const ENDLESS: Self = Self { low: Vec3::NEG_INFINITY, high: Vec3::INFINITY };

    /// Around one point.
    pub fn of(point: Vec3) -> Self {
        Self { low: point, high: point }
    }

    /// Around both.
    pub fn union(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// What both have in common; none where that is nothing, not even a point.
    pub fn common(self, other: Self) -> Option<Self> {
        let (low, high) = (self.low.max(other.low), self.high.min(other.high));
        low.cmple(high).all().then_some(Self { low, high })
    }

    /// True if `other` lies within.
    pub fn contains(self, other: Self) -> bool {
        other.low.cmpge(self.low).all() && other.high.cmple(self.high).all()
    }

    /// With every side further out (m).
    pub fn grown(self, by: Vec3) -> Self {
        Self { low: self.low - by, high: self.high + by }
    }

    /// Its length along each axis (m).
    pub fn size(self) -> Vec3 {
        self.high - self.low
    }

    /// True if it ends on every side.
    pub fn is_finite(self) -> bool {
        self.low.is_finite() && self.high.is_finite()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_that_touch_have_points_in_common() {
        let cube = |at: f32| Bounds::of(Vec3::splat(at)).grown(Vec3::ONE);
        assert_eq!(cube(0.0).common(cube(2.0)), Some(Bounds::of(Vec3::ONE)));
        assert_eq!(cube(0.0).common(cube(2.1)), None);
        assert_eq!(cube(0.0).union(Bounds::EMPTY), cube(0.0));
        assert!(Bounds::ENDLESS.contains(cube(0.0)) && cube(0.0).contains(Bounds::of(Vec3::ONE)));
        assert!(!cube(0.0).contains(cube(0.1)) && !Bounds::EMPTY.is_finite());
    }
}
