//! Chains over a ball. A ray, the normals of the ball that it meets and its centre lie in one plane, and so does the target:
//! where on a circle the light first meets the ball is the only unknown. The sine of the angle by which the light then misses
//! the target changes its sign at each solution.

use super::chain::Target;
use crate::math::DVec3;
use std::f64::consts::{FRAC_PI_2, PI};

/// Where the circle is looked at first. Between two neighbours there are two solutions at most: up to four are known of balls of
/// glass.
const STEPS: usize = 32;
/// Steps to a solution, or to an end of what light reaches: 12 are common to the one.
const HALVINGS: usize = 60;
/// Sine of an angle that is none.
const EXACT: f64 = 1e-12;
/// Sine of the angle by which a solution may miss: where the target is met and the light turns away, there is none.
const MISSED: f64 = 1e-6;
/// Cuts of an interval that may hold two solutions.
const CUTS: usize = 24;
/// Part of an interval that such a cut leaves.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// What the light does at the ball after it has set out.
#[derive(Clone, Copy, Debug)]
pub(super) struct Course {
    /// How often it meets the ball.
    pub(super) meetings: usize,
    /// It enters it at the first of them,
    pub(super) enters: bool,
    /// and leaves it at the last.
    pub(super) leaves: bool,
}

/// A circle around the origin, and a course from a point of its plane to a target there.
pub(super) struct Round {
    radius: f64,
    /// Distance of the start from the centre.
    from: f64,
    /// In the plane: along the direction to the start, across it, 0.
    target: Target,
    /// Index inside over that outside.
    ratio: f64,
    course: Course,
    /// Towards the start, and across it in the plane.
    axes: [DVec3; 2],
    center: DVec3,
}

/// True if a function of these values, one after the other, comes closest to 0 between the first and the last without a
/// change of sign.
fn turns_back([a, b, c]: [f64; 3]) -> bool {
    a * b > 0.0 && b * c > 0.0 && b.abs() <= a.abs().min(c.abs())
}

/// A light path in the plane.
struct Flight {
    /// The angles at which it meets the circle.
    angles: [f64; super::chain::MOST],
    /// Sine and cosine of the angle by which it misses the target.
    missed: [f64; 2],
}

impl Round {
    /// From `from` to a `target` by way of a ball.
    pub(super) fn new(
        (center, radius, ratio): (DVec3, f64, f64),
        from: DVec3,
        target: Target,
        course: Course,
    ) -> Option<Self> {
        let start = from - center;
        let (distance, along) = (start.length(), start.try_normalize()?);
        let to = match target {
            Target::Point(point) => point - center,
            Target::Direction(direction) => direction,
        };
        let across = to - along * along.dot(to);
        let across = across.try_normalize().unwrap_or_else(|| along.any_orthonormal_vector());
        let flat = DVec3::new(along.dot(to), across.dot(to), 0.0);
        let target = match target {
            Target::Point(_) => Target::Point(flat),
            Target::Direction(_) => Target::Direction(flat),
        };
        Some(Self { radius, from: distance, target, ratio, course, axes: [along, across], center })
    }

    /// The points where the light meets the ball on each of its ways.
    pub(super) fn solve(&self, found: &mut impl FnMut(&[DVec3])) {
        let at = |step: usize| {
            let place = 2.0 * step as f64 / STEPS as f64 - 1.0;
            (place, self.missed(place))
        };
        let mut ends: Vec<(f64, Option<f64>)> = (0..=STEPS).map(at).collect();
        self.refine(&mut ends);
        for pair in ends.windows(2) {
            if let [(low, Some(below)), (high, Some(above))] = *pair
                && (below < 0.0) != (above < 0.0)
            {
                self.report(self.root((low, below), (high, above)), found);
            }
        }
    }

    /// Adds the ends of what light reaches, then places between two solutions.
    fn refine(&self, places: &mut Vec<(f64, Option<f64>)>) {
        let ends = places.windows(2).filter_map(|pair| match *pair {
            [(low, Some(_)), (high, None)] => Some(self.end(low, high)),
            [(low, None), (high, Some(_))] => Some(self.end(high, low)),
            _ => None,
        });
        Self::add(places, ends.collect());
        let between = places.windows(3).filter_map(|triple| match *triple {
            [(low, Some(a)), (_, Some(b)), (high, Some(c))] if turns_back([a, b, c]) => {
                Some(self.nearest(low, high, b.signum()))
            }
            _ => None,
        });
        Self::add(places, between.collect());
    }

    fn add(places: &mut Vec<(f64, Option<f64>)>, more: Vec<(f64, Option<f64>)>) {
        places.extend(more);
        places.sort_by(|a, b| a.0.total_cmp(&b.0));
    }

    /// The last place that light reaches between `inside`, which it does, and `outside`.
    fn end(&self, mut inside: f64, mut outside: f64) -> (f64, Option<f64>) {
        for _ in 0..HALVINGS {
            let middle = 0.5 * (inside + outside);
            *if self.missed(middle).is_some() { &mut inside } else { &mut outside } = middle;
        }
        (inside, self.missed(inside))
    }

    /// Where the target is missed least between two places, on the side of `sign`: golden sections.
    fn nearest(&self, mut low: f64, mut high: f64, sign: f64) -> (f64, Option<f64>) {
        let value = |place: f64| self.missed(place).map_or(f64::INFINITY, |missed| missed * sign);
        for _ in 0..CUTS {
            let (left, right) = (high - GOLDEN * (high - low), low + GOLDEN * (high - low));
            let (a, b) = (value(left), value(right));
            if a.min(b) < 0.0 {
                let place = if a < b { left } else { right };
                return (place, self.missed(place));
            }
            *if a < b { &mut high } else { &mut low } = if a < b { right } else { left };
        }
        let middle = 0.5 * (low + high);
        (middle, self.missed(middle))
    }

    /// The solution between two places: regula falsi, which halves the weight of an end that stays (Illinois).
    fn root(&self, mut low: (f64, f64), mut high: (f64, f64)) -> f64 {
        let mut place = low.0;
        for _ in 0..HALVINGS {
            place = (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1);
            let Some(missed) = self.missed(place).filter(|missed| missed.abs() > EXACT) else { break };
            if (missed < 0.0) == (low.1 < 0.0) {
                (low, high.1) = ((place, missed), 0.5 * high.1);
            } else {
                (high, low.1) = ((place, missed), 0.5 * low.1);
            }
        }
        place
    }

    /// A way that was found, unless it leads away from the target.
    fn report(&self, place: f64, found: &mut impl FnMut(&[DVec3])) {
        let Some(Flight { angles, missed: [sine, cosine] }) = self.fly(place) else { return };
        if cosine > 0.0 && sine.abs() < MISSED {
            let point = |angle: f64| {
                self.center + (self.axes[0] * angle.cos() + self.axes[1] * angle.sin()) * self.radius
            };
            let points = angles.map(point);
            found(&points[..self.course.meetings]);
        }
    }

    /// How many ways there are, by changes of sign at so many places.
    #[cfg(test)]
    pub(super) fn count(&self, places: u32) -> usize {
        let flights = (0..=places).map(|i| self.fly(2.0 * f64::from(i) / f64::from(places) - 1.0));
        let flights: Vec<Option<Flight>> = flights.collect();
        let crosses = |pair: &&[Option<Flight>]| match pair {
            [Some(a), Some(b)] => a.missed[0] * b.missed[0] < 0.0 && a.missed[1] > 0.0 && b.missed[1] > 0.0,
            _ => false,
        };
        flights.windows(2).filter(crosses).count()
    }

    fn missed(&self, place: f64) -> Option<f64> {
        self.fly(place).map(|flight| flight.missed[0])
    }

    /// The flight that begins at `place` in [-1, 1]: from outside by the angle of incidence, from inside by the
    /// direction.
    fn fly(&self, place: f64) -> Option<Flight> {
        let Course { meetings, enters, leaves } = self.course;
        let is_outside = self.from > self.radius;
        let (mut angle, mut incidence) =
            if is_outside { self.start_outside(place) } else { self.start_inside(place) };
        let mut angles = [angle; super::chain::MOST];
        let refracted = |incidence: f64, ratio: f64| {
            let sine = incidence.sin() / ratio;
            (sine.abs() <= 1.0).then(|| sine.asin())
        };
        // How the light goes on: by its angle to the outward normal.
        if enters {
            incidence = refracted(incidence, self.ratio)?;
        }
        for next in &mut angles[1..meetings] {
            angle += PI - 2.0 * incidence;
            *next = angle;
        }
        let ahead = match (is_outside, enters, leaves) {
            (_, _, true) => angle + refracted(incidence, 1.0 / self.ratio)?,
            (true, false, false) => angle + incidence,
            _ => angle + PI - incidence,
        };
        Some(Flight { angles, missed: self.missed_by(angle, ahead) })
    }

    fn start_outside(&self, place: f64) -> (f64, f64) {
        let incidence = place * FRAC_PI_2;
        (incidence - (self.radius * incidence.sin() / self.from).asin(), incidence)
    }

    fn start_inside(&self, place: f64) -> (f64, f64) {
        let ahead = place * PI;
        let incidence = (self.from * ahead.sin() / self.radius).asin();
        (ahead - incidence, incidence)
    }

    /// Sine and cosine of the angle between the direction `ahead`, in which light leaves the circle, and that to the target.
    fn missed_by(&self, angle: f64, ahead: f64) -> [f64; 2] {
        let at = |angle: f64| DVec3::new(angle.cos(), angle.sin(), 0.0);
        let (to, ahead) = (self.target.seen_from(at(angle) * self.radius), at(ahead));
        [ahead.cross(to).z, ahead.dot(to)]
    }
}
