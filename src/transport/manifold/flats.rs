//! Chains over planes. Light that crosses planes, or is reflected by one, takes the points of least optical length
//! (Fermat). This length is a convex function of the points: there is at most one such path, and Newton's method finds
//! it.

use super::chain::{Target, refracted};
use crate::math::{DMat3, DMat4, DVec3};
use glam::DVec4;

/// Most steps of Newton's method; six are common.
const STEPS: usize = 50;
/// Distance of two points, over that of the first from the start, below which they meet.
const MEETING: f64 = 1e-3;
/// Most times that a step is halved.
const HALVINGS: i32 = 20;
/// Least part of the predicted decrease that a step must achieve.
const ENOUGH: f64 = 1e-4;
/// Sine of the angle by which the law of refraction may be missed.
const MISSED: f64 = 1e-11;

/// A plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    /// A point of it,
    pub(super) origin: DVec3,
    /// and its unit normal.
    pub(super) normal: DVec3,
    /// Orthonormal directions in it.
    axes: [DVec3; 2],
}

impl Plane {
    pub(super) fn new(origin: DVec3, normal: DVec3) -> Self {
        let (across, along) = normal.any_orthonormal_pair();
        Self { origin, normal, axes: [across, along] }
    }

    /// The signed distance of a point.
    pub(super) fn height(&self, point: DVec3) -> f64 {
        (point - self.origin).dot(self.normal)
    }
}

/// Most planes of a way.
const MOST: usize = 2;

/// The points where light crosses two planes, coming `from` a point and leaving in unit `direction`. Normals point away
/// from what lies between the planes; `ratio` is the index there over that around. Refraction backwards from
/// `direction` is unique.
pub(super) fn between(
    from: DVec3,
    [first, last]: [Plane; 2],
    ratio: f64,
    direction: DVec3,
) -> Option<[DVec3; 2]> {
    let back = refracted(-direction, last.normal, ratio)?;
    let towards = -refracted(back, first.normal, 1.0 / ratio)?;
    let reach = |origin: DVec3, direction: DVec3, plane: &Plane| {
        let distance = -plane.height(origin) / direction.dot(plane.normal);
        (distance > 0.0).then(|| origin + direction * distance)
    };
    let entry = reach(from, towards, &first)?;
    Some([entry, reach(entry, -back, &last)?])
}

/// A way from a point over one or two planes to a target.
pub(super) struct Way<'a> {
    pub(super) from: DVec3,
    /// Normals of two planes point away from what lies between them. Where two planes meet, some paths are not found if
    /// the index between them is close to that around, see the tests.
    pub(super) planes: &'a [Plane],
    /// Of the media before each plane, and behind the last.
    pub(super) indices: &'a [f64],
    pub(super) target: Target,
}

/// A straight part of a way.
#[derive(Clone, Copy, Default)]
struct Part {
    /// Its optical length; for a target at infinity, how far it lies ahead.
    length: f64,
    /// Gradient of the length by its end.
    gradient: DVec3,
    /// Hessian of the length by its end.
    hessian: DMat3,
}

impl Part {
    /// The way from `from` to `to` where the index is `index`; none if it has no length.
    fn between(from: DVec3, to: DVec3, index: f64) -> Option<Self> {
        let (distance, direction) = (from.distance(to), (to - from).try_normalize()?);
        let along =
            DMat3::from_cols(direction * direction.x, direction * direction.y, direction * direction.z);
        let hessian = (DMat3::IDENTITY - along) * (index / distance);
        Some(Self { length: index * distance, gradient: direction * index, hessian })
    }

    /// The last one.
    fn last(from: DVec3, target: Target, index: f64) -> Option<Self> {
        match target {
            Target::Point(to) => Self::between(from, to, index),
            Target::Direction(direction) => {
                let length = -index * direction.dot(from);
                Some(Self { length, gradient: direction * index, hessian: DMat3::ZERO })
            }
        }
    }
}

/// The parts of a way through given points.
struct Path {
    points: [DVec3; MOST],
    length: f64,
    /// By the coordinates of the points in their planes.
    gradient: DVec4,
    hessian: DMat4,
}

impl Way<'_> {
    /// The points on the planes; none where light cannot go this way. Entries after the last plane's are meaningless.
    pub(super) fn solve(&self) -> Option<[DVec3; MOST]> {
        let mut at = DVec4::ZERO;
        let mut path = self.path(at)?;
        for _ in 0..STEPS {
            if path.gradient.length() <= MISSED {
                return Some(path.points);
            }
            let step = -(path.hessian.inverse() * path.gradient);
            (at, path) = self.shorter(at, &path, step)?;
            if self.is_over_edge(&path.points) {
                return None;
            }
        }
        None
    }

    /// True where two points nearly meet outside the body between the planes. Where no light goes from one plane to the
    /// other, the shortest path crosses the line in which they meet: the length has an edge there, and Newton's method
    /// gets stuck.
    fn is_over_edge(&self, [p, q]: &[DVec3; MOST]) -> bool {
        let [first, last] = self.planes else { return false };
        p.distance(*q) < MEETING * p.distance(self.from) && (last.height(*p) > 0.0 || first.height(*q) > 0.0)
    }

    /// A point along `step` where the path is enough shorter. Near the minimum, lengths differ by less than their
    /// rounding error, but gradients do not.
    fn shorter(&self, at: DVec4, path: &Path, step: DVec4) -> Option<(DVec4, Path)> {
        let promised = path.gradient.dot(step);
        (0..HALVINGS).find_map(|halvings| {
            let part = 0.5f64.powi(halvings);
            let found = self.path(at + step * part)?;
            let is_shorter = found.length <= path.length + ENOUGH * part * promised;
            let is_straighter = found.gradient.length() < 0.5 * path.gradient.length();
            (is_shorter || is_straighter).then_some((at + step * part, found))
        })
    }

    /// The way whose points have the coordinates `at`, two in each plane.
    fn path(&self, at: DVec4) -> Option<Path> {
        let (at, count) = (at.to_array(), self.planes.len());
        let (mut points, mut parts) = ([self.from; MOST], [Part::default(); MOST + 1]);
        for (i, plane) in self.planes.iter().enumerate() {
            points[i] = self.start(plane) + plane.axes[0] * at[2 * i] + plane.axes[1] * at[2 * i + 1];
            let before = if i == 0 { self.from } else { points[i - 1] };
            parts[i] = Part::between(before, points[i], self.indices[i])?;
        }
        parts[count] = Part::last(points[count - 1], self.target, self.indices[count])?;
        let length = parts.iter().map(|part| part.length).sum();
        Some(Path { points, length, gradient: self.gradient(&parts), hessian: self.hessian(&parts) })
    }

    /// The direction in a plane that coordinate `number` of all is along, and the number of that plane.
    fn axis(&self, number: usize) -> Option<(usize, DVec3)> {
        Some((number / 2, self.planes.get(number / 2)?.axes[number % 2]))
    }

    fn gradient(&self, parts: &[Part; MOST + 1]) -> DVec4 {
        DVec4::from_array(std::array::from_fn(|number| {
            let along = |(i, axis): (usize, DVec3)| axis.dot(parts[i].gradient - parts[i + 1].gradient);
            self.axis(number).map_or(0.0, along)
        }))
    }

    /// The diagonal is 1 for unused coordinates, so that the matrix can be inverted.
    fn hessian(&self, parts: &[Part; MOST + 1]) -> DMat4 {
        let entry = |a: usize, b: usize| {
            let (Some((i, one)), Some((j, other))) = (self.axis(a), self.axis(b)) else {
                return f64::from(u8::from(a == b));
            };
            let between =
                if i == j { parts[i].hessian + parts[i + 1].hessian } else { -parts[i.max(j)].hessian };
            one.dot(between * other)
        };
        DMat4::from_cols_array_2d(&std::array::from_fn(|a| std::array::from_fn(|b| entry(a, b))))
    }

    /// Where the straight way to the target crosses a plane, or would if it came from the other side.
    fn start(&self, plane: &Plane) -> DVec3 {
        let foot = |point: DVec3| point - plane.normal * plane.height(point);
        match self.target {
            Target::Direction(_) => foot(self.from),
            Target::Point(to) => {
                let (near, far) = (plane.height(self.from).abs(), plane.height(to).abs());
                foot(self.from).lerp(foot(to), near / (near + far).max(f64::MIN_POSITIVE))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{Stream, stream::Purpose};

    /// The sines of the angles on both sides of a plane, times the indices.
    fn sines(before: DVec3, at: DVec3, after: DVec3, plane: &Plane, indices: [f64; 2]) -> [DVec3; 2] {
        let along = |direction: DVec3| direction - plane.normal * direction.dot(plane.normal);
        [along((at - before).normalize()) * indices[0], along((after - at).normalize()) * indices[1]]
    }

    fn check(planes: &[Plane; 2], [from, p, q, to]: [DVec3; 4]) {
        for [a, b] in [sines(from, p, q, &planes[0], [1.0, 1.5]), sines(p, q, to, &planes[1], [1.5, 1.0])] {
            assert!(a.distance(b) < 1e-9, "{a} {b} to {to}");
        }
    }

    /// Snell's law at both faces of a pane, steep and grazing.
    #[test]
    fn light_is_refracted_as_snell_says() {
        let planes = [Plane::new(DVec3::ZERO, DVec3::NEG_Z), Plane::new(DVec3::Z * 0.3, DVec3::Z)];
        for to in [DVec3::new(0.2, 0.4, 2.0), DVec3::new(-3.0, -5.0, 2.0), DVec3::new(-3e3, 1.0, 9e2)] {
            let from = DVec3::new(0.1, -0.2, -1.0);
            let way = Way { from, planes: &planes, indices: &[1.0, 1.5, 1.0], target: Target::Point(to) };
            let [p, q] = way.solve().unwrap();
            check(&planes, [from, p, q, to]);
        }
    }

    /// And of a prism, where light leaves in parallel.
    #[test]
    fn prisms_refract_as_snell_says() {
        let slant = DVec3::new(0.3, 0.1, 1.0).normalize();
        let planes = [Plane::new(DVec3::ZERO, DVec3::NEG_Z), Plane::new(DVec3::Z * 0.5, slant)];
        let from = DVec3::new(0.1, -0.2, -1.0);
        for direction in
            [DVec3::Z, DVec3::new(0.2, 0.4, 2.0).normalize(), DVec3::new(-0.5, 0.3, 1.0).normalize()]
        {
            let [p, q] = between(from, planes, 1.5, direction).unwrap();
            check(&planes, [from, p, q, q + direction]);
        }
    }

    /// A mirror shows what is before it as far behind it.
    #[test]
    fn mirrors_reflect() {
        let (from, to) = (DVec3::new(0.0, 1.0, 0.0), DVec3::new(3.0, 2.0, 0.0));
        let planes = [Plane::new(DVec3::X * 7.0, DVec3::Y)];
        let way = Way { from, planes: &planes, indices: &[1.0, 1.0], target: Target::Point(to) };
        assert!(way.solve().unwrap()[0].distance(DVec3::X) < 1e-9);
        let direction = DVec3::new(1.0, 1.0, 0.0).normalize();
        let way = Way { target: Target::Direction(direction), ..way };
        assert!(way.solve().unwrap()[0].distance(DVec3::X) < 1e-9);
    }

    /// Light from the sun under water comes within a cone: from beyond there is no way.
    #[test]
    fn nothing_comes_from_beyond_the_critical_angle() {
        let planes = [Plane::new(DVec3::ZERO, DVec3::Z)];
        let way = |x: f64, indices: &'static [f64]| {
            let target = Target::Direction(DVec3::new(x, 0.0, 1.0).normalize());
            Way { from: -DVec3::Z, planes: &planes, indices, target }.solve()
        };
        assert!(way(100.0, &[1.5, 1.0]).is_some());
        assert!(way(0.5, &[1.0, 1.5]).is_some());
        assert!(way(100.0, &[1.0, 1.5]).is_none());
    }

    /// Light sent through two faces of a cube that meet comes to points that are then to be reached; how many are not, of how
    /// many. Index within over that around it.
    fn lost(ratio: f64) -> [usize; 2] {
        let axes = [DVec3::X, DVec3::Y, DVec3::Z].into_iter().flat_map(|axis| [axis, -axis]);
        let planes: Vec<Plane> = axes.map(|axis| Plane::new(axis, axis)).collect();
        let mut stream = Stream::new(37, 0, 0, Purpose::Study);
        let mut number = || 2.0 * f64::from(stream.uniform()) - 1.0;
        let (mut lost, mut all) = (0, 0);
        for turn in 0..20_000 {
            let entry = planes[turn % 6];
            let [from, on] = [0; 2].map(|_| DVec3::new(number(), number(), number()));
            let (from, on) = (from * 3.0, on - entry.normal * entry.height(on));
            if entry.height(from) <= 0.0 {
                continue;
            }
            let within = refracted((on - from).normalize(), entry.normal, ratio);
            for exit in planes.iter().filter(|exit| exit.normal.dot(entry.normal) == 0.0) {
                let leaves = |within: DVec3| {
                    let out = on - within * (exit.height(on) / within.dot(exit.normal));
                    let is_first = within.dot(exit.normal) > 0.0 && out.abs().max_element() < 1.0 + 1e-9;
                    is_first.then_some(out).zip(refracted(within, exit.normal, 1.0 / ratio))
                };
                let Some((out, direction)) = within.and_then(leaves) else { continue };
                let target = Target::Point(out + direction * (1.0 + 3.0 * number().abs()));
                let way = Way { from, planes: &[entry, *exit], indices: &[1.0, ratio, 1.0], target };
                all += 1;
                lost += usize::from(way.solve().is_none_or(|[p, q]| p.distance(on) + q.distance(out) > 1e-6));
            }
        }
        [lost, all]
    }

    /// As the manual has it.
    #[test]
    fn few_ways_through_faces_that_meet_are_lost() {
        let [lost, all] = lost(1.1);
        assert!(all > 1000 && lost * 25 < all, "{lost} of {all}");
        // Light that enters by one face does not leave by the other.
        assert_eq!(self::lost(1.5)[1], 0);
    }
}
