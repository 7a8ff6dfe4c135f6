//! Faces that touch: whether two primitives lie in one surface, and how far apart they are there.

use super::flat::Flat;
use crate::math::DVec3;

/// A primitive in f64, as far as touching depends on it. Its normal points where [`Flat::normal`] does, or away from the
/// centre or axis.
#[derive(Clone, Debug)]
pub enum Patch {
    /// A convex part of a plane; of a disk, the square around it.
    Flat(Polygon),
    /// A sphere.
    Ball {
        /// Its centre.
        center: DVec3,
        /// Its radius (m).
        radius: f64,
    },
    /// The side of a round cylinder.
    Tube {
        /// The ends of its axis.
        ends: [DVec3; 2],
        /// Its radius (m).
        radius: f64,
    },
}

/// A convex polygon: a triangle or a parallelogram.
#[derive(Clone, Debug)]
pub struct Polygon {
    /// A triangle lacks the last one. Millions of them are looked at where meshes lie in each other: no heap.
    four: [DVec3; 4],
    is_triangle: bool,
    normal: DVec3,
}

impl Patch {
    /// Of a flat primitive.
    pub(super) fn flat(flat: &Flat) -> Self {
        Self::Flat(Polygon::of(flat))
    }

    /// The unit normal of a flat patch.
    pub fn plane_normal(&self) -> Option<DVec3> {
        if let Self::Flat(polygon) = self { Some(polygon.normal) } else { None }
    }

    /// What the rounding of a point of it is in proportion to, along the normal (m): nothing for a rectangle along the axes.
    pub fn skew(&self) -> f64 {
        match self {
            Self::Flat(polygon) => {
                let (corners, normal) = (polygon.corners(), polygon.normal);
                let [along_u, along_v] =
                    [corners[1], corners[corners.len() - 1]].map(|corner| corner - corners[0]);
                normal.abs().dot(along_u.abs() + along_v.abs())
            }
            Self::Ball { center, radius } => center.length() + radius,
            Self::Tube { ends: [a, b], radius } => a.length().max(b.length()) + radius,
        }
    }

    /// A point of it and the normal there.
    pub fn sample(&self) -> (DVec3, DVec3) {
        match self {
            Self::Flat(polygon) => (polygon.centre(), polygon.normal),
            Self::Ball { center, radius } => (center + DVec3::X * *radius, DVec3::X),
            Self::Tube { ends: [a, b], radius } => {
                let out = (b - a).any_orthonormal_vector();
                (0.5 * (a + b) + out * *radius, out)
            }
        }
    }

    /// How far `other` lies from here along the normal (m), if both lie in one surface up to `reach` metres and have more
    /// than an edge in common.
    pub fn height_of(&self, other: &Self, reach: f64) -> Option<f64> {
        match (self, other) {
            (Self::Flat(a), Self::Flat(b)) => a.height_of(b, reach),
            (Self::Ball { center: c, radius: r }, Self::Ball { center, radius }) => {
                (c.distance(*center) + (r - radius).abs() <= reach).then_some(radius - r)
            }
            (Self::Tube { ends: a, radius: r }, Self::Tube { ends: b, radius }) => {
                ((r - radius).abs() <= reach && are_along(*a, *b, reach)).then_some(radius - r)
            }
            _ => None,
        }
    }
}

/// True if the segment `b` lies on the line of `a` up to `reach`, and beside it.
fn are_along(a: [DVec3; 2], b: [DVec3; 2], reach: f64) -> bool {
    let along = a[1] - a[0];
    let (axis, length) = (along.normalize(), along.length());
    let heights = b.map(|end| axis.dot(end - a[0]));
    let is_near = |end: DVec3, height: f64| (end - a[0] - axis * height).length() <= reach;
    let [low, high] = [heights[0].min(heights[1]), heights[0].max(heights[1])];
    is_near(b[0], heights[0]) && is_near(b[1], heights[1]) && low < length - reach && high > reach
}

impl Polygon {
    fn of(flat: &Flat) -> Self {
        let [corner, u, v] = [flat.corner, flat.edge_u, flat.edge_v].map(|p| p.as_dvec3());
        let four = if flat.triangle {
            [corner, corner + u, corner + v, corner]
        } else {
            [corner, corner + u, corner + u + v, corner + v]
        };
        Self { four, is_triangle: flat.triangle, normal: flat.normal.as_dvec3().normalize() }
    }

    fn corners(&self) -> &[DVec3] {
        &self.four[..if self.is_triangle { 3 } else { 4 }]
    }

    fn centre(&self) -> DVec3 {
        self.corners().iter().sum::<DVec3>() / self.corners().len() as f64
    }

    fn size(&self) -> f64 {
        let centre = self.centre();
        self.corners().iter().map(|corner| corner.distance_squared(centre)).fold(0.0, f64::max)
    }

    /// See [`Patch::height_of`]. The plane of the larger one is known better.
    fn height_of(&self, other: &Self, reach: f64) -> Option<f64> {
        let facing = self.normal.dot(other.normal);
        // Most pairs end here.
        if facing.abs() < 0.5 {
            return None;
        }
        let (large, small, sign) =
            if self.size() >= other.size() { (self, other, 1.0) } else { (other, self, -facing.signum()) };
        let height = |corner: &DVec3| large.normal.dot(corner - large.four[0]);
        if small.corners().iter().any(|corner| height(corner).abs() > reach) || !large.overlaps(small, reach)
        {
            return None;
        }
        Some(sign * small.corners().iter().map(height).sum::<f64>() / small.corners().len() as f64)
    }

    /// True if both have an area in common, seen along the normal and wider than `margin` metres: no edge separates them.
    fn overlaps(&self, other: &Self, margin: f64) -> bool {
        self.edges().chain(other.edges()).all(|edge| {
            let across = self.normal.cross(edge).normalize_or_zero();
            let [a, b] = [self, other].map(|polygon| polygon.extent(across));
            a[1].min(b[1]) - a[0].max(b[0]) > margin
        })
    }

    fn edges(&self) -> impl Iterator<Item = DVec3> + '_ {
        let next = self.corners().iter().cycle().skip(1);
        self.corners().iter().zip(next).map(|(a, b)| b - a)
    }

    /// Least and greatest coordinate along `axis`.
    fn extent(&self, axis: DVec3) -> [f64; 2] {
        let along = self.corners().iter().map(|corner| axis.dot(*corner));
        along.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Vec3, vec3};

    fn flat(corner: Vec3, edge_u: Vec3, edge_v: Vec3) -> Patch {
        let normal = edge_u.cross(edge_v).normalize();
        Patch::flat(&Flat { corner, edge_u, edge_v, normal, triangle: false })
    }

    #[test]
    fn what_touches_has_an_area_in_common() {
        let floor = flat(Vec3::ZERO, Vec3::X * 10.0, Vec3::Y * 10.0);
        for (name, other, expected) in [
            ("above", flat(vec3(1.0, 1.0, 1e-6), Vec3::X, Vec3::Y), Some(1e-6)),
            ("below, upside down", flat(vec3(1.0, 1.0, -1e-6), Vec3::Y, Vec3::X), Some(-1e-6)),
            ("too high", flat(vec3(1.0, 1.0, 1e-3), Vec3::X, Vec3::Y), None),
            ("beside", flat(vec3(10.0, 0.0, 0.0), Vec3::X, Vec3::Y), None),
            ("across", flat(vec3(1.0, 1.0, 0.0), Vec3::X, Vec3::Z), None),
            (
                "turned beyond a corner",
                flat(vec3(10.6, 10.0, 0.0), vec3(-1.0, 1.0, 0.0), vec3(1.0, 1.0, 0.0)),
                None,
            ),
        ] {
            for (a, b, sign) in [(&floor, &other, 1.0), (&other, &floor, -1.0)] {
                let turned = a.plane_normal().map_or(1.0, |n| n.z.signum());
                let height = a.height_of(b, 1e-5).map(|h| h * sign * turned);
                assert!(
                    height.zip(expected).map_or(height == expected, |(a, b)| (a - b).abs() < 1e-9),
                    "{name}: {height:?}"
                );
            }
        }
    }

    #[test]
    fn round_things_touch_where_they_are_one_in_the_other() {
        let ball = |x: f64, radius: f64| Patch::Ball { center: DVec3::X * x, radius };
        assert_eq!(ball(0.0, 1.0).height_of(&ball(0.0, 1.0), 1e-5), Some(0.0));
        assert_eq!(ball(0.0, 1.0).height_of(&ball(2.0, 1.0), 1e-5), None);
        let tube = |from: f64, to: f64| Patch::Tube { ends: [DVec3::Z * from, DVec3::Z * to], radius: 1.0 };
        assert_eq!(tube(0.0, 1.0).height_of(&tube(2.0, 0.5), 1e-5), Some(0.0));
        assert_eq!(tube(0.0, 1.0).height_of(&tube(1.0, 2.0), 1e-5), None);
    }
}
