//! Chains over the side of a round cylinder. Let k be the axial component of light's unit direction times the index:
//! reflection and refraction do not change it. Across the axis light travels as if over a circle between media of
//! effective indices sqrt(n^2 - k^2). Light of a single direction has a known k; towards a point, each path across the
//! axis has the k that brings it to the height of the point.

use super::{
    chain::Target,
    circle::{Course, Flight, Round},
};
use crate::math::DVec3;
use glam::DVec2;
use std::cell::Cell;

/// Most steps to find the slope along the axis.
const STEPS: usize = 60;
/// Part of a height that is none.
const EXACT: f64 = 1e-14;

/// The side of a cylinder.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tube {
    /// Where the axis begins.
    pub(super) base: DVec3,
    /// Its unit direction.
    pub(super) axis: DVec3,
    pub(super) length: f64,
    pub(super) radius: f64,
}

impl Tube {
    /// The height above the base.
    fn height(&self, point: DVec3) -> f64 {
        self.axis.dot(point - self.base)
    }

    /// From the axis to a point, across it.
    fn out(&self, point: DVec3) -> DVec3 {
        point - self.base - self.axis * self.height(point)
    }

    /// The outward unit normal beside a point.
    pub(super) fn normal(&self, point: DVec3) -> DVec3 {
        self.out(point).normalize_or_zero()
    }

    /// False if light that rises or falls all the way from a height to a target is never at a height of the tube.
    fn reaches(&self, height: f64, target: Target) -> bool {
        let to = match target {
            Target::Point(point) => self.height(point),
            Target::Direction(direction) if direction.dot(self.axis) == 0.0 => height,
            Target::Direction(direction) => f64::INFINITY.copysign(direction.dot(self.axis)),
        };
        height.max(to) >= 0.0 && height.min(to) <= self.length
    }

    /// Whether light between `end` and the tube can be outside of it, and whether it can be inside: from around the tube it comes
    /// there by way of an open end.
    fn sides(&self, end: Target) -> [bool; 2] {
        let beyond = |height: f64| !(0.0..=self.length).contains(&height);
        match end {
            Target::Point(point) if self.out(point).length() < self.radius => [false, true],
            Target::Point(point) => [true, beyond(self.height(point))],
            Target::Direction(direction) => [true, direction.dot(self.axis) != 0.0],
        }
    }

    /// The points of every path `from` a point to a target. `index` is that inside over that outside; none for a
    /// mirror.
    pub(super) fn solve(
        &self,
        index: Option<f64>,
        from: DVec3,
        target: Target,
        found: &mut impl FnMut(&Course, &[DVec3]),
    ) {
        if !self.reaches(self.height(from), target) {
            return;
        }
        let sides = [Target::Point(from), target].map(|end| self.sides(end));
        for course in Course::all(sides, index.is_some()) {
            if let Some(climb) = Climb::new(self, index.unwrap_or(1.0), from, target, course) {
                climb.solve(&mut |points| found(&course, points));
            }
        }
    }
}

/// The slopes of light outside and inside (its distance along the axis over that across), and the effective index
/// inside over that outside.
#[derive(Clone, Copy)]
struct Slopes {
    slopes: [f64; 2],
    ratio: f64,
}

/// A course over a tube.
struct Climb<'a> {
    tube: &'a Tube,
    course: Course,
    round: Round,
    /// Indices outside and inside.
    indices: [f64; 2],
    /// Height of the start above the base.
    from: f64,
    end: End,
    /// The slope that was found last.
    guess: Cell<f64>,
}

/// Where it leads.
enum End {
    /// To a height above the start.
    Height(f64),
    /// Wherever these slopes lead.
    Anywhere(Slopes),
}

impl<'a> Climb<'a> {
    /// None where no light comes so.
    fn new(tube: &'a Tube, index: f64, from: DVec3, target: Target, course: Course) -> Option<Self> {
        let Tube { base, axis, radius, .. } = *tube;
        let out = tube.out(from);
        let along = out.try_normalize().unwrap_or_else(|| axis.any_orthonormal_vector());
        let axes = [along, axis.cross(along)];
        let round = Round::within(axes, radius, out, target.relative_to(base), course);
        // Light that is only reflected does not see the index.
        let indices = if course.is_refracted() { [1.0, index] } else { [1.0; 2] };
        let end = match target {
            Target::Point(point) => End::Height(axis.dot(point - from)),
            Target::Direction(direction) => {
                let beyond = indices[usize::from(!course.outside[1])];
                End::Anywhere(Slopes::along(beyond * axis.dot(direction), indices)?)
            }
        };
        Some(Self { tube, course, round, indices, from: tube.height(from), end, guess: Cell::new(1.0) })
    }

    /// The points of each way.
    fn solve(&self, found: &mut impl FnMut(&[DVec3])) {
        let flight = |place: f64| {
            let begin = self.round.begin(place);
            self.round.fly(begin, self.slopes(begin)?.ratio)
        };
        self.round.ways(flight, &mut |place, flight| {
            if let Some(slopes) = self.slopes(self.round.begin(place)) {
                self.report(flight, slopes, found);
            }
        });
    }

    /// Reports a path, unless it misses the tube beyond its ends.
    fn report(&self, flight: &Flight, Slopes { slopes, .. }: Slopes, found: &mut impl FnMut(&[DVec3])) {
        let [first, next, _] = self.round.lengths(flight);
        let mut height = self.from + first * slopes[usize::from(!self.course.outside[0])];
        let Tube { base, axis, length, .. } = *self.tube;
        let mut points = self.round.points(flight);
        let points = &mut points[..self.course.meetings];
        for point in &mut *points {
            if !(0.0..=length).contains(&height) {
                return;
            }
            *point += base + axis * height;
            height += next * slopes[1];
        }
        found(points);
    }

    /// The slopes of the flight that begins with an angle.
    fn slopes(&self, begin: DVec2) -> Option<Slopes> {
        match self.end {
            End::Anywhere(slopes) => Some(slopes),
            End::Height(height) if self.course.is_refracted() => self.rising(begin, height),
            End::Height(height) => {
                let total: f64 = self.across(&self.round.fly(begin, 1.0)?).iter().sum();
                Some(Slopes { slopes: [height / total; 2], ratio: 1.0 })
            }
        }
    }

    /// How far a flight goes across the axis outside and inside.
    fn across(&self, flight: &Flight) -> [f64; 2] {
        let [first, next, last] = self.round.lengths(flight);
        let mut across = [0.0, next * (self.course.meetings - 1) as f64];
        let [from, to] = self.course.outside.map(|outside| usize::from(!outside));
        across[from] += first;
        across[to] += last;
        across
    }

    /// Those by which it rises by `height`.
    fn rising(&self, begin: DVec2, height: f64) -> Option<Slopes> {
        let across = |ratio: f64| Some(self.across(&self.round.fly(begin, ratio)?));
        // From inside, the distance across does not depend on the slope.
        let known = if self.course.outside[0] { None } else { across(1.0) };
        let rise = |slope: f64| {
            let Slopes { slopes, ratio } = Slopes::of(slope, self.indices);
            let across = known.or_else(|| across(ratio))?;
            Some(slopes[0] * across[0] + slopes[1] * across[1])
        };
        let slope = if height == 0.0 { 0.0 } else { steep(rise, height.abs(), self.guess.get())? };
        if slope > 0.0 {
            self.guess.set(slope);
        }
        Some(Slopes::of(slope.copysign(height), self.indices))
    }
}

/// The slope at which light rises by `height`, near a `guess`: by secants between slopes known to be too flat and too
/// steep.
fn steep(rise: impl Fn(f64) -> Option<f64>, height: f64, guess: f64) -> Option<f64> {
    let (mut low, mut high) = (0.0, f64::INFINITY);
    let (mut before, mut slope) = ((0.0, -height), guess);
    for _ in 0..STEPS {
        let excess = rise(slope)? - height;
        *if excess < 0.0 { &mut low } else { &mut high } = slope;
        let secant = slope - excess * (slope - before.0) / (excess - before.1);
        let next = match (low < secant && secant < high, high.is_finite()) {
            (true, _) => secant,
            (false, true) => 0.5 * (low + high),
            (false, false) => 2.0 * slope,
        };
        if excess.abs() <= EXACT * height || (next - slope).abs() <= EXACT * slope {
            return Some(slope);
        }
        (before, slope) = ((slope, excess), next);
    }
    None
}

impl Slopes {
    /// Where light is as steep as `slope` in the medium of the lesser index.
    fn of(slope: f64, indices: [f64; 2]) -> Self {
        let least = indices[0].min(indices[1]);
        let across = least / (1.0 + slope * slope).sqrt();
        let along = across * slope;
        let [outside, inside] =
            indices.map(|index| if index > least { (index * index - along * along).sqrt() } else { across });
        Self { slopes: [along / outside, along / inside], ratio: inside / outside }
    }

    /// Slopes for this component `along` the axis; none if it is too great for one of the media.
    fn along(along: f64, indices: [f64; 2]) -> Option<Self> {
        let [outside, inside] = indices.map(|index| (index * index - along * along).max(0.0).sqrt());
        let is_there = outside > 0.0 && inside > 0.0;
        is_there.then_some(Self { slopes: [along / outside, along / inside], ratio: inside / outside })
    }
}
