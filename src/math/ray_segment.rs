//! A straight piece of a ray, as media see it.

use super::boxes;
use glam::{Affine3A, Vec3};

/// From `origin` along `direction` for `length`. The parameter t along it is in metres of the world whatever affine
/// map it was seen through: `direction` is a unit vector in the world only.
#[derive(Clone, Copy, Debug)]
pub struct RaySegment {
    /// Where t = 0.
    pub origin: Vec3,
    /// Change of position per metre.
    pub direction: Vec3,
    /// Largest t (m), may be infinite.
    pub length: f32,
}

impl RaySegment {
    /// The point at `t`.
    #[inline]
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + self.direction * t
    }

    /// The same piece in the coordinates of `map`.
    #[inline]
    pub fn mapped(&self, map: &Affine3A) -> Self {
        Self {
            origin: map.transform_point3(self.origin),
            direction: map.transform_vector3(self.direction),
            length: self.length,
        }
    }

    /// The same piece, `by` times as long in units of t that are so many times as short.
    #[inline]
    pub fn stretched(&self, by: f32) -> Self {
        Self { origin: self.origin, direction: self.direction / by, length: self.length * by }
    }

    /// The range of t within the box from `low` to `high`; none where that is empty.
    #[inline]
    pub fn within(&self, low: Vec3, high: Vec3) -> Option<[f32; 2]> {
        let bounds = [low.as_dvec3(), high.as_dvec3()];
        let (origin, direction) = (self.origin.as_dvec3(), self.direction.as_dvec3());
        let [first, last] = boxes::narrowed(origin, direction, bounds, [0.0, f64::from(self.length)]);
        let (first, last) = (first as f32, last as f32);
        (first < last).then_some([first, last])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::vec3;

    #[test]
    fn within_is_the_part_inside_whatever_the_direction() {
        let segment = |direction, length| RaySegment { origin: vec3(-1.0, 0.5, 0.0), direction, length };
        let inside = |segment: RaySegment| segment.within(Vec3::ZERO, Vec3::ONE);
        assert_eq!(inside(segment(Vec3::X, 9.0)), Some([1.0, 2.0]), "along a face");
        assert_eq!(inside(segment(Vec3::X, 1.5)), Some([1.0, 1.5]));
        assert_eq!(inside(segment(Vec3::X, f32::INFINITY)), Some([1.0, 2.0]));
        assert_eq!(inside(segment(Vec3::X, 1.0)), None);
        assert_eq!(inside(segment(Vec3::NEG_X, 9.0)), None);
        assert_eq!(inside(segment(Vec3::Y, 9.0)), None);
    }

    #[test]
    fn a_map_keeps_the_parameter() {
        let map = Affine3A::from_scale(vec3(2.0, 3.0, -1.0));
        let segment = RaySegment { origin: vec3(1.0, 2.0, 3.0), direction: Vec3::Z, length: 4.0 };
        let mapped = segment.mapped(&map);
        assert_eq!(mapped.at(4.0), map.transform_point3(segment.at(4.0)));
        assert_eq!(mapped.length, 4.0);
    }
}
