//! Light in a plane, by way of a circle to a target. For a ball, one plane contains the ray, the normals that it meets,
//! the centre and the target; light over a tube is projected across its axis. The only unknown is the angle at which
//! the light sets out. The signed distance by which it then misses the target changes sign at each solution.

use super::{
    chain::{MOST, Target},
    search::Search,
};
use crate::math::DVec3;
use glam::DVec2;
use std::f64::consts::{FRAC_PI_2, PI};

/// Tangent of the angle by which a solution may miss: where the target is met and the light turns away, there is none.
const MISSED: f64 = 1e-6;
/// Least part of a right angle in which flights that begin close to the circle are looked at more closely.
const CLOSEST: f64 = 1e-4;

/// What the light does at the circle after it has set out.
#[derive(Clone, Copy, Debug)]
pub(super) struct Course {
    /// How often it meets the circle.
    pub(super) meetings: usize,
    /// Whether it comes to the first point from outside, and whether it leaves the last one to the outside.
    pub(super) outside: [bool; 2],
}

impl Course {
    /// All courses between two ends. For each end: whether light can be outside there, and whether it can be inside.
    /// `transmits` is true for a surface that refracts.
    pub(super) fn all([first, last]: [[bool; 2]; 2], transmits: bool) -> impl Iterator<Item = Self> {
        let sides = [[true, true], [true, false], [false, true], [false, false]];
        let can_be = move |[a, b]: &[bool; 2]| first[usize::from(!a)] && last[usize::from(!b)];
        let courses = |outside| (1..=MOST).map(move |meetings| Self { meetings, outside });
        let is_one = move |course: &Self| transmits || !course.is_refracted();
        sides.into_iter().filter(can_be).flat_map(courses).filter(is_one)
    }

    /// It is reflected at the only point, from outside.
    fn touches(&self) -> bool {
        self.meetings == 1 && self.outside == [true; 2]
    }

    /// It is refracted at the first point, inwards.
    fn enters(&self) -> bool {
        self.outside[0] && !self.touches()
    }

    /// It is refracted at the last point, outwards.
    fn leaves(&self) -> bool {
        self.outside[1] && !self.touches()
    }

    /// It is refracted somewhere.
    pub(super) fn is_refracted(&self) -> bool {
        self.enters() || self.leaves()
    }

    /// Index of refraction beyond over before at point `number`; none if light is not refracted there.
    pub(super) fn refracts(&self, number: usize, inside: f64) -> Option<f64> {
        match (number == 0 && self.enters(), number + 1 == self.meetings && self.leaves()) {
            (true, _) => Some(inside),
            (false, true) => Some(1.0 / inside),
            (false, false) => None,
        }
    }
}

/// A target in a plane.
enum End {
    Point(DVec2),
    Direction(DVec2),
}

/// A circle around the origin, and a course from a point of its plane to a target there.
pub(super) struct Round {
    radius: f64,
    /// Distance of the start from the centre.
    from: f64,
    /// Along the direction to the start, and across it.
    target: End,
    course: Course,
    /// Towards the start, and across it in the plane.
    axes: [DVec3; 2],
    /// How close to along the circle flights change fast with the angle at which they begin,
    width: f64,
    /// and the area sine of a right angle over this.
    range: f64,
}

/// A light path in the plane, as far as the circle. Angles are unit vectors here: to rotate by one adds it.
#[derive(Clone, Copy)]
pub(super) struct Flight {
    /// The angles at which it meets the circle.
    angles: [DVec2; MOST],
    /// The angle of incidence at the last of them: inside, unless it has never been there.
    incidence: DVec2,
    /// The index inside over that outside.
    ratio: f64,
}

/// The angle with this sine, at most a right one; none if there is no such angle.
fn by_sine(sine: f64) -> Option<DVec2> {
    let square = 1.0 - sine * sine;
    (square >= 0.0).then(|| DVec2::new(square.sqrt(), sine))
}

fn opposite(angle: DVec2) -> DVec2 {
    DVec2::new(angle.x, -angle.y)
}

impl Round {
    /// In the plane of the centre, the start and the target; positions are relative to the centre.
    pub(super) fn new(radius: f64, start: DVec3, target: Target, course: Course) -> Option<Self> {
        let along = start.try_normalize()?;
        let to = target.vector();
        let across = to - along * along.dot(to);
        let across = across.try_normalize().unwrap_or_else(|| along.any_orthonormal_vector());
        Some(Self::within([along, across], radius, start, target, course))
    }

    /// In the plane of these orthonormal vectors, with everything projected to it; the first points to the start.
    pub(super) fn within(
        axes: [DVec3; 2],
        radius: f64,
        start: DVec3,
        target: Target,
        course: Course,
    ) -> Self {
        let [x, y] = axes.map(|axis| axis.dot(target.vector()));
        let flat = DVec2::new(x, y);
        let target = match target {
            Target::Point(_) => End::Point(flat),
            Target::Direction(_) => End::Direction(flat.normalize_or_zero()),
        };
        let from = axes[0].dot(start);
        let width = (1.0 - (from / radius).powi(2)).abs().sqrt().max(CLOSEST);
        let range = (FRAC_PI_2 / width).asinh();
        Self { radius, from, target, course, axes, width, range }
    }

    /// All ways to the target among the flights that begin at places in [-1, 1].
    pub(super) fn ways(&self, flight: impl Fn(f64) -> Option<Flight>, found: &mut impl FnMut(f64, &Flight)) {
        let missed = |place: f64| self.missed(&flight(place)?).map(|[across, _]| across);
        Search { function: missed, is_periodic: self.is_inside() }.roots(&mut |place| {
            // Skips flights that lead away from the target.
            if let Some(flight) = flight(place)
                && let Some([across, along]) = self.missed(&flight)
                && along > 0.0
                && across.abs() < MISSED * along
            {
                found(place, &flight);
            }
        });
    }

    /// How many ways there are, by changes of sign at so many places.
    #[cfg(test)]
    pub(super) fn count(&self, ratio: f64, places: u32) -> usize {
        let place = |i: u32| 2.0 * f64::from(i) / f64::from(places) - 1.0;
        let flight = |i: u32| self.fly(self.begin(place(i)), ratio);
        let missed: Vec<_> = (0..=places).map(|i| self.missed(&flight(i)?)).collect();
        let crosses = |pair: &&[Option<[f64; 2]>]| match pair {
            [Some(a), Some(b)] => a[0] * b[0] < 0.0 && a[1] > 0.0 && b[1] > 0.0,
            _ => false,
        };
        missed.windows(2).filter(crosses).count()
    }

    /// The angle at which a flight begins at `place` in [-1, 1]. From inside it is the angle of its direction. From
    /// outside it is the angle in the medium of lesser index: then the other medium always has one too. Close to the
    /// circle, directions almost along it are sampled more finely.
    pub(super) fn begin(&self, place: f64) -> DVec2 {
        let Self { width, range, .. } = *self;
        let angle = if self.is_inside() {
            let quarter = place.round();
            FRAC_PI_2 + PI * quarter + width * (2.0 * range * (place - quarter)).sinh()
        } else {
            (FRAC_PI_2 - width * (range * (1.0 - place.abs())).sinh()).copysign(place)
        };
        DVec2::from_angle(angle)
    }

    fn is_inside(&self) -> bool {
        self.from <= self.radius
    }

    /// The flight that begins with an angle.
    pub(super) fn fly(&self, begin: DVec2, ratio: f64) -> Option<Flight> {
        let (mut angle, incidence) = if self.is_inside() {
            let incidence = by_sine(self.from / self.radius * begin.y)?;
            (opposite(incidence).rotate(begin), incidence)
        } else {
            self.start_outside(begin, if self.course.enters() { ratio } else { 1.0 })?
        };
        let mut angles = [angle; MOST];
        let turn = -opposite(incidence.rotate(incidence));
        for next in &mut angles[1..self.course.meetings] {
            angle = angle.rotate(turn);
            *next = angle;
        }
        Some(Flight { angles, incidence, ratio })
    }

    /// The angle of the first point, and the angle of incidence there: the refracted one if the light enters with this
    /// `ratio`.
    fn start_outside(&self, begin: DVec2, ratio: f64) -> Option<(DVec2, DVec2)> {
        let (before, after) =
            if ratio < 1.0 { (by_sine(begin.y * ratio)?, begin) } else { (begin, by_sine(begin.y / ratio)?) };
        let seen = by_sine(self.radius / self.from * before.y)?;
        let passes = !self.course.outside[0];
        let from_seen = if passes { -opposite(before) } else { before };
        Some((opposite(seen).rotate(from_seen), after))
    }

    /// How far the line on which light leaves the circle passes beside the target, and how far ahead the target is,
    /// both over its distance; none if light does not leave.
    fn missed(&self, flight: &Flight) -> Option<[f64; 2]> {
        let Flight { angles, incidence, ratio } = *flight;
        let angle = angles[self.course.meetings - 1];
        let ahead = if self.course.leaves() {
            angle.rotate(by_sine(incidence.y * ratio)?)
        } else if self.course.touches() {
            angle.rotate(incidence)
        } else {
            -angle.rotate(opposite(incidence))
        };
        let to = match self.target {
            End::Point(point) => (point - angle * self.radius) / (self.radius + point.length()),
            End::Direction(direction) => direction,
        };
        Some([ahead.perp_dot(to), ahead.dot(to)])
    }

    /// Where a flight meets the circle.
    pub(super) fn points(&self, flight: &Flight) -> [DVec3; MOST] {
        flight.angles.map(|angle| (self.axes[0] * angle.x + self.axes[1] * angle.y) * self.radius)
    }

    /// The lengths of its parts: to the first point, from one point to the next, from the last to a target that is a point.
    pub(super) fn lengths(&self, flight: &Flight) -> [f64; 3] {
        let Self { radius, from, .. } = *self;
        let first = (flight.angles[0] * radius).distance(DVec2::X * from);
        let last = flight.angles[self.course.meetings - 1] * radius;
        let to = match self.target {
            End::Point(to) => to.distance(last),
            End::Direction(_) => 0.0,
        };
        [first, 2.0 * radius * flight.incidence.x, to]
    }
}
