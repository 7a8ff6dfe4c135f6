//! `equipotential`: fog that thickens around a thing, strength / (c + d r^2) (BMA02 3.2.3).
//!
//! `shape` says what the thing is, and what r (m of own coordinates) is with it:
//! - `point`: the distance to `center`;
//! - `line`: the distance to the endless line through `p0` and `p1`;
//! - `segment`: the distance to the nearest point between `p0` and `p1`;
//! - `sphere`: the length of the tangent to the sphere of `radius` around `center`, r^2 = |x - center|^2 - radius^2,
//!   and 0 within. BMA02 leaves this open; of the choices that are 0 on the sphere this is the one that integrates to
//!   an arctangent, as the others do.

use super::placed::{COMMON, Function, Line, Placed};
use crate::{
    description::{Params, Table, table},
    error::Result,
    math::DVec3,
};

/// Fog around a thing.
pub type Equipotential = Placed<Potential>;

/// The function itself.
#[derive(Clone, Debug)]
pub struct Potential {
    strength: f64,
    c: f64,
    d: f64,
    thing: Thing,
}

#[derive(Clone, Copy, Debug)]
enum Thing {
    Point(DVec3),
    /// A point and a unit vector.
    Line(DVec3, DVec3),
    /// A point, a unit vector and a length.
    Segment(DVec3, DVec3, f64),
    Sphere(DVec3, f64),
}

/// r^2 along a line: `nearest` + `rate` (t - `foot`)^2.
#[derive(Clone, Copy)]
struct Quadratic {
    nearest: f64,
    rate: f64,
    foot: f64,
}

impl Quadratic {
    /// The square of the length of `origin` + t `direction`. By the foot of the perpendicular, so that nothing cancels
    /// however far away t = 0 is.
    fn of(origin: DVec3, direction: DVec3) -> Self {
        let rate = direction.length_squared();
        if rate < 1e-200 {
            return Self { nearest: origin.length_squared(), rate: 0.0, foot: 0.0 };
        }
        let foot = -origin.dot(direction) / rate;
        Self { nearest: (origin + direction * foot).length_squared(), rate, foot }
    }
}

/// The integral of 1 / (m + n t^2) from t = `a` on for `length`, the divisor being > 0 all the way: the difference of two
/// arctangents (or, for m < 0, of inverse hyperbolic cotangents) as the one of their difference. `least` > 0 is what
/// the divisor never falls below.
fn reciprocal(m: f64, n: f64, [a, length]: [f64; 2], least: f64) -> f64 {
    let cross = m + n * a * (a + length);
    let root = (n * m.abs()).sqrt();
    let tangent = root * length;
    if m > 0.0 && tangent > 1e-8 * cross {
        return tangent.atan2(cross) / root;
    }
    let cross = cross.max(least);
    let x = (tangent / cross).min(1.0 - f64::EPSILON);
    let ratio = if x < 1e-8 { 1.0 } else { atanh(x) / x };
    length / cross * ratio
}

fn atanh(x: f64) -> f64 {
    0.5 * (2.0 * x / (1.0 - x)).ln_1p()
}

/// A vector without its part along the unit vector `axis`.
fn across(vector: DVec3, axis: DVec3) -> DVec3 {
    vector - axis * vector.dot(axis)
}

impl Thing {
    fn read(params: &Params<'_>) -> Result<Self> {
        let shapes = [("point", 0), ("line", 1), ("segment", 2), ("sphere", 3)];
        match params.choice("shape", &shapes)? {
            0 => Ok(Self::Point(params.optional_vector("center")?.unwrap_or_default())),
            3 => Ok(Self::Sphere(
                params.optional_vector("center")?.unwrap_or_default(),
                params.optional_float("radius")?.unwrap_or(1.0),
            )),
            shape => {
                let (p0, p1) = (params.vector("p0")?, params.vector("p1")?);
                let Some(axis) = (p1 - p0).try_normalize() else {
                    return Err(params.complain("p1", "a point other than \"p0\"", p1.to_string()));
                };
                Ok(if shape == 1 { Self::Line(p0, axis) } else { Self::Segment(p0, axis, p0.distance(p1)) })
            }
        }
    }

    fn squared_distance(&self, position: DVec3) -> f64 {
        match *self {
            Self::Point(point) => position.distance_squared(point),
            Self::Line(point, axis) => across(position - point, axis).length_squared(),
            Self::Segment(point, axis, length) => {
                let from = position - point;
                (from - axis * from.dot(axis).clamp(0.0, length)).length_squared()
            }
            Self::Sphere(center, radius) => {
                let distance = position.distance(center);
                ((distance - radius) * (distance + radius)).max(0.0)
            }
        }
    }

    /// Bounds of r^2 in a box: no distance changes faster than the way to its thing.
    fn squared_distances(&self, low: DVec3, high: DVec3) -> [f64; 2] {
        let (center, reach) = (0.5 * (low + high), 0.5 * (high - low).length());
        match *self {
            Self::Point(point) => to_box(point, low, high),
            Self::Sphere(middle, radius) => to_box(middle, low, high).map(|s| (s - radius * radius).max(0.0)),
            Self::Line(..) | Self::Segment(..) => {
                let distance = self.squared_distance(center).sqrt();
                [(distance - reach).max(0.0), distance + reach].map(|r| r * r)
            }
        }
    }

    /// Where along `line` r^2 changes its form.
    fn changes(&self, line: &Line) -> [f64; 2] {
        match *self {
            Self::Point(_) | Self::Line(..) => [f64::INFINITY; 2],
            Self::Segment(point, axis, length) => {
                let (from, rate) = ((line.origin - point).dot(axis), line.direction.dot(axis));
                [-from / rate, (length - from) / rate]
            }
            Self::Sphere(center, radius) => {
                let Quadratic { nearest, rate, foot } = Quadratic::of(line.origin - center, line.direction);
                let half = ((radius * radius - nearest) / rate).sqrt();
                [foot - half, foot + half]
            }
        }
    }

    /// r^2 along `line` around `t`; none where it is 0.
    fn quadratic(&self, line: &Line, t: f64) -> Option<Quadratic> {
        let to = |point: DVec3| Quadratic::of(line.origin - point, line.direction);
        let to_line =
            |point, axis| Quadratic::of(across(line.origin - point, axis), across(line.direction, axis));
        Some(match *self {
            Self::Point(point) => to(point),
            Self::Line(point, axis) => to_line(point, axis),
            Self::Segment(point, axis, length) => match (line.at(t) - point).dot(axis) {
                u if u < 0.0 => to(point),
                u if u > length => to(point + axis * length),
                _ => to_line(point, axis),
            },
            Self::Sphere(center, radius) => {
                let whole = to(center);
                let nearest = whole.nearest - radius * radius;
                let here = nearest + whole.rate * (t - whole.foot) * (t - whole.foot);
                return (here > 0.0).then_some(Quadratic { nearest, ..whole });
            }
        })
    }
}

/// Squares of the least and the greatest distance from `point` to a point of a box.
fn to_box(point: DVec3, low: DVec3, high: DVec3) -> [f64; 2] {
    let nearest = point.clamp(low, high);
    let farthest = (point - low).abs().max((point - high).abs());
    [point.distance_squared(nearest), farthest.length_squared()]
}

impl Potential {
    fn value(&self, squared: f64) -> f64 {
        self.strength / (self.c + self.d * squared)
    }

    /// The integral where r^2 keeps its form.
    fn piece(&self, line: &Line, first: f64, last: f64) -> f64 {
        let squared = self.thing.quadratic(line, 0.5 * (first + last));
        let Some(Quadratic { nearest, rate, foot }) = squared else {
            return (last - first) / self.c;
        };
        reciprocal(self.c + self.d * nearest, self.d * rate, [first - foot, last - first], self.c)
    }
}

impl Function for Potential {
    const TABLE: Table = table! {
        "Fog densest near a point, line, segment or sphere: strength / (c + d r^2) at a distance r (BMA02 3.2.3).";
        choice("shape", &["point", "line", "segment", "sphere"], "point",
            "What the fog gathers around. For a sphere, r is the length of the tangent to it, 0 inside."),
        vector("center", "", Said("the origin"), "Centre of the point or sphere."),
        vector("p0", "", Said("required for line and segment"), "A point on the line, or the start of the segment."),
        vector("p1", "", Said("required for line and segment"), "Another point on the line, or the end of the segment."),
        number("radius", "", above(0.0, f64::MAX), Said("1"), "Radius of the sphere."),
        number("strength", "", ANY, Is(1.0), "The numerator; negative values subtract in a sum."),
        number("c", "", above(0.0, f64::MAX), Is(1.0), "strength / c is the value at r = 0."),
        number("d", "", within(0.0, f64::MAX), Is(1.0), "Falloff: greater values thin sooner.");
        COMMON
    };

    fn read(params: &Params<'_>) -> Result<Self> {
        let (strength, c) = (params.float("strength")?, params.float("c")?);
        let d = params.float("d")?;
        if (strength / c).abs() > 1e30 {
            return Err(params.complain("c", "a number that keeps strength / c within 1e30", c.to_string()));
        }
        Ok(Self { strength, c, d, thing: Thing::read(params)? })
    }

    #[inline]
    fn eval(&self, position: DVec3) -> f64 {
        self.value(self.thing.squared_distance(position))
    }

    fn range(&self, low: DVec3, high: DVec3) -> [f64; 2] {
        let [near, far] = self.thing.squared_distances(low, high);
        let (a, b) = (self.value(near * (1.0 - 1e-12)), self.value(far * (1.0 + 1e-12)));
        let slack = 1e-12 * self.strength.abs() / self.c;
        [a.min(b) - slack, a.max(b) + slack]
    }

    #[inline]
    fn integral(&self, line: &Line, first: f64, last: f64) -> f64 {
        let mut ends = [first, first, first, last];
        // Beside the segment, or nowhere: NaN from a line that never reaches the change.
        let [a, b] = self.thing.changes(line).map(|t| if t.is_nan() { first } else { t.clamp(first, last) });
        (ends[1], ends[2]) = (a.min(b), a.max(b));
        let pieces = ends.windows(2).filter(|pair| pair[0] < pair[1]);
        self.strength * pieces.map(|pair| self.piece(line, pair[0], pair[1])).sum::<f64>()
    }

    #[cfg(test)]
    fn examples() -> Vec<Self> {
        let make = |strength, c, d, thing| Self { strength, c, d, thing };
        let axis = DVec3::new(1.0, 2.0, -2.0) / 3.0;
        vec![
            make(1.0, 1.0, 1.0, Thing::Point(DVec3::ZERO)),
            make(-0.7, 0.01, 3.0, Thing::Point(DVec3::new(0.3, 0.5, -0.2))),
            make(2.0, 0.5, 0.0, Thing::Point(DVec3::ZERO)),
            make(1.0, 0.1, 1.0, Thing::Line(DVec3::new(0.1, 0.2, 0.3), axis)),
            make(1.0, 0.1, 1.0, Thing::Segment(DVec3::new(-0.1, 0.2, 0.3), axis, 1.5)),
            make(0.3, 0.2, 4.0, Thing::Sphere(DVec3::new(0.2, 0.0, 0.1), 1.3)),
            make(0.3, 1e-3, 1.0, Thing::Sphere(DVec3::ZERO, 0.5)),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The divisor integrated in closed form against quadrature that is fine where it is small.
    #[test]
    fn reciprocals_of_quadratics_at_their_ends() {
        let third = std::f64::consts::FRAC_PI_3;
        let root = 3f64.sqrt();
        let cases = [
            // (m, n, a, b), the integral
            ((1.0, 1.0, -root, root), 2.0 * third),
            ((1.0, 0.0, 5.0, 7.0), 2.0),
            ((4.0, 0.0, -1e30, 1e30), 5e29),
            ((1e-12, 1.0, -1.0, 1.0), 2e6 * (1e6f64).atan()),
            ((1e-300, 1.0, -1.0, 1.0), std::f64::consts::PI * 1e150),
            ((0.0, 1.0, 1.0, 3.0), 2.0 / 3.0),
            ((-1.0, 1.0, 2.0, 3.0), 0.5 * 1.5f64.ln()),
            ((-1.0, 1.0, -3.0, -2.0), 0.5 * 1.5f64.ln()),
            ((1.0, 1.0, 1e8, 1e8 + 1.0), 1.0 / (1e8 * (1e8 + 1.0))),
            ((1.0, 1.0, -1e38, 1e38), std::f64::consts::PI),
            ((1.0, 1e-40, -1.0, 1.0), 2.0),
            ((1.0, 1.0, 0.5, 0.5 + 1e-9), 0.8e-9),
        ];
        for ((m, n, a, b), expected) in cases {
            let found = reciprocal(m, n, [a, b - a], 1e-320);
            assert!((found - expected).abs() <= 1e-7 * expected, "{m} {n} {a} {b}: {found} {expected}");
        }
    }
}
