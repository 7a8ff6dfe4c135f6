//! Which medium a point lies in, where nothing states it: the camera, emitters, infinity.
//!
//! The medium is known at the sides of boundaries, and at a camera or emitters that state theirs. From a point, rays
//! are aimed at these, and go on from walls that say nothing: all points connected by unblocked segments lie in one
//! medium. Where no unblocked segment leads to evidence, the answer is a guess, and the caller must warn about it.

mod known;

pub use known::*;

use super::boundary::{self, DIRECTIONS, Met};
use crate::{
    math::{Bounds, Frame, Vec3, measure, offset, warp},
    medium::MediumIndex,
    sampling::{Stream, stream::Purpose},
    scene::{accel::Geometry, surface::Surface},
    shape::{Ray, SurfacePoint},
};

/// Rays of a survey from the boundaries of a scene, all together.
const SURVEY_RAYS: usize = 32_768;
/// More of them, as long as none has left the scene.
const LOOKS: u64 = 8_192;
/// Rays of a survey from one side of a boundary, and from a point whose medium is stated.
const RAYS_PER_SIDE: usize = 64;
/// Segments of a chain of evidence from wall to wall.
const LONGEST_CHAIN: u32 = 8;
/// Chains that are tried around a point.
const CHAINS: usize = 128;
/// Pieces of evidence that settle the medium of a point if all agree; if not, so many that one counts less than a slip.
const ENOUGH: u32 = 8;
const ENOUGH_OF_DOUBT: u32 = 512;
/// Shares of evidence below this are attributed to rays that slipped through an edge: of those aimed at boxes, three in a
/// million.
const SLIPS: f32 = 0.01;

/// How many pieces of evidence name each medium, and a shape that does.
#[derive(Debug, Default)]
struct Votes(Vec<(MediumIndex, u32, Option<u32>)>);

impl Votes {
    fn add(&mut self, medium: MediumIndex, witness: Option<u32>) {
        match self.0.iter_mut().find(|(voted, ..)| *voted == medium) {
            Some((_, count, first)) => {
                *count += 1;
                *first = first.or(witness);
            }
            None => self.0.push((medium, 1, witness)),
        }
    }

    fn total(&self) -> u32 {
        self.0.iter().map(|(_, count, _)| count).sum()
    }

    fn disagree(&self) -> bool {
        self.0.len() > 1
    }

    /// The medium of most votes, and the shapes of those and of the runner-up where they disagree.
    fn settled(mut self) -> Option<(MediumIndex, Option<[Option<u32>; 2]>)> {
        let total = self.total();
        self.0.sort_by_key(|(_, count, _)| std::cmp::Reverse(*count));
        self.0.retain(|(_, count, _)| *count as f32 > SLIPS * total as f32);
        match self.0.as_slice() {
            [] => None,
            [(medium, ..)] => Some((*medium, None)),
            [(medium, _, a), (_, _, b), ..] => Some((*medium, Some([*a, *b]))),
        }
    }
}

/// How well the medium of a point is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Certainty {
    /// All evidence along unblocked segments agrees.
    Seen,
    /// It does not; a shape that speaks for the medium, and one against it.
    Contradicted([Option<u32>; 2]),
    /// It is the vacuum that Mitsuba takes for what a wall around leaves unstated.
    Unstated,
    /// It was seen through opaque surfaces only.
    ThroughWalls,
    /// There is no evidence.
    Assumed,
}

/// The medium of a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Located {
    /// Which.
    pub medium: MediumIndex,
    /// How well it is known.
    pub certainty: Certainty,
}

/// Locates points among the shapes of a scene.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Locator<'a> {
    /// All shapes.
    pub geometry: &'a Geometry,
    /// Their properties.
    pub surfaces: &'a [Surface],
    /// What is known.
    pub known: &'a Known,
}

/// The one medium that is stated, a vacuum left unstated included; none where there are several.
fn only_medium(
    surfaces: &[Surface],
    points: &[(Vec3, MediumIndex)],
    otherwise: MediumIndex,
) -> Option<MediumIndex> {
    let sides = surfaces.iter().flat_map(|Surface { boundary, .. }| {
        let unstated = boundary.is_half_known().then_some(MediumIndex::VACUUM);
        [boundary.interior, boundary.exterior, unstated]
    });
    let mut stated = sides.flatten().chain(points.iter().map(|(_, medium)| *medium));
    let first = stated.next().unwrap_or(otherwise);
    stated.all(|medium| medium == first).then_some(first)
}

impl Locator<'_> {
    fn survey(&self, survey: &mut Survey) {
        let boundaries = &self.known.boundaries;
        let every = (2 * 4 * boundaries.len()).div_ceil(SURVEY_RAYS).max(1);
        let rays = (SURVEY_RAYS / (2 * boundaries.len()).max(1)).clamp(4, RAYS_PER_SIDE);
        for &shape in boundaries.iter().step_by(every) {
            let mut stream = Stream::new(1, u64::from(shape), 0, Purpose::Pilot);
            for _ in 0..rays {
                self.survey_sides(shape, survey, &mut stream);
            }
        }
        for (index, &(position, medium)) in (0..).zip(&self.known.points) {
            let mut stream = Stream::new(2, index, 0, Purpose::Pilot);
            survey.extend(medium, Bounds::of(position));
            for _ in 0..RAYS_PER_SIDE {
                let direction = warp::to_sphere(stream.square());
                self.follow(position, direction, medium, None, survey, &mut stream);
            }
        }
        self.look_for_openings(survey);
    }

    /// Few rays find a small opening: as long as nothing has left the scene, more look for one.
    fn look_for_openings(&self, survey: &mut Survey) {
        let boundaries = &self.known.boundaries;
        for index in 0..LOOKS {
            if boundaries.is_empty() || !survey.escapes.is_empty() {
                return;
            }
            let mut stream = Stream::new(10, index, 0, Purpose::Pilot);
            let shape = boundaries[stream.below(boundaries.len())];
            self.survey_sides(shape, survey, &mut stream);
        }
    }

    /// A ray from a point of `shape` on each side whose medium is known.
    fn survey_sides(&self, shape: u32, survey: &mut Survey, stream: &mut Stream) {
        let point = self.geometry.sample_area(shape, stream);
        let Surface { boundary, .. } = self.surfaces[shape as usize];
        for normal in [point.normal, -point.normal] {
            let direction = diffuse(normal, stream);
            if let Some(medium) = boundary.side(point.normal.dot(normal)) {
                let origin = point.leaving(direction).origin;
                self.follow(origin, direction, medium, Some(shape), survey, stream);
            }
        }
    }

    /// Follows a ray in `medium` and on from walls, until it hits a boundary or nothing.
    fn follow(
        &self,
        mut origin: Vec3,
        mut direction: Vec3,
        medium: MediumIndex,
        from: Option<u32>,
        survey: &mut Survey,
        stream: &mut Stream,
    ) {
        for _ in 0..LONGEST_CHAIN {
            let ray = Ray { origin, direction, t_max: f32::INFINITY };
            match boundary::first(self.geometry, self.surfaces, ray, false) {
                Met::Side(side) => {
                    survey.extend(medium, Bounds::of(side.position));
                    if side.medium != medium {
                        survey.contradictions.push(Contradiction { from, medium, at: side });
                    }
                    return;
                }
                Met::Wall { point, .. } => {
                    survey.extend(medium, Bounds::of(point.position));
                    (origin, direction) = bounce(&point, direction, stream);
                }
                Met::Nothing => {
                    survey.extend(medium, Bounds::ENDLESS);
                    survey.escapes.push((direction, medium));
                    return self.look_back(&ray, medium, from, survey, stream);
                }
            }
        }
    }

    /// Looks back at a boundary from a place on a `ray` in `medium` that meets nothing. Where the boundary is open, as
    /// a cylinder is at its ends, one place sees both of its sides.
    fn look_back(
        &self,
        ray: &Ray,
        medium: MediumIndex,
        from: Option<u32>,
        survey: &mut Survey,
        stream: &mut Stream,
    ) {
        if self.known.boundaries.is_empty() {
            return;
        }
        let Bounds { low, high } = self.geometry.bounds();
        let origin = ray.origin + ray.direction * ((high - low).length() * stream.uniform());
        let shape = self.known.boundaries[stream.below(self.known.boundaries.len())];
        let target = self.geometry.sample_area(shape, stream).position;
        let Some((direction, ..)) = measure::between(origin, target) else { return };
        let back = Ray { origin, direction, t_max: f32::INFINITY };
        if let Met::Side(at) = boundary::first(self.geometry, self.surfaces, back, false)
            && at.medium != medium
        {
            survey.contradictions.push(Contradiction { from, medium, at });
        }
    }

    /// The medium around `point`, which lies on no surface.
    pub(crate) fn locate(&self, point: Vec3, stream: &mut Stream) -> Option<Located> {
        if let Some(medium) = self.known.only {
            return Some(Located { medium, certainty: Certainty::Seen });
        }
        let (mut votes, unstated) = self.evidence(point, ENOUGH, stream);
        if votes.disagree() {
            votes = self.evidence(point, ENOUGH_OF_DOUBT, stream).0;
        }
        match votes.settled() {
            Some((medium, None)) => Some(Located { medium, certainty: Certainty::Seen }),
            Some((medium, Some(shapes))) => {
                Some(Located { medium, certainty: Certainty::Contradicted(shapes) })
            }
            None if unstated => Some(Located { medium: MediumIndex::VACUUM, certainty: Certainty::Unstated }),
            None => self.through_walls(point),
        }
    }

    /// The medium of a ray that leaves `origin` in `direction`; always the same for the same ray.
    pub(crate) fn along(&self, origin: Vec3, direction: Vec3) -> Option<MediumIndex> {
        if let Some(medium) = self.known.only {
            return Some(medium);
        }
        let ray = Ray { origin, direction, t_max: f32::INFINITY };
        if let Met::Side(side) = boundary::first(self.geometry, self.surfaces, ray, false) {
            return Some(side.medium);
        }
        let bits = |a: f32, b: f32| u64::from(a.to_bits()) << 32 | u64::from(b.to_bits());
        let mut stream =
            Stream::new(bits(origin.x, origin.y), bits(origin.z, direction.x), 0, Purpose::Pilot);
        let (votes, unstated) = self.evidence(origin, 1, &mut stream);
        match votes.settled() {
            Some((medium, _)) => Some(medium),
            None if unstated => Some(MediumIndex::VACUUM),
            None => self.through_walls(origin).map(|located| located.medium),
        }
    }

    /// The medium in which light from infinity starts at `origin` in `direction`.
    pub(crate) fn at_infinity(&self, origin: Vec3, direction: Vec3) -> MediumIndex {
        let ray = Ray { origin, direction, t_max: f32::INFINITY };
        match boundary::first(self.geometry, self.surfaces, ray, false) {
            Met::Side(side) => side.medium,
            Met::Wall { .. } | Met::Nothing => self.known.infinity.towards(-direction),
        }
    }

    /// Up to `enough` pieces of evidence around `point`, and whether a wall was seen that leaves this side unstated.
    fn evidence(&self, point: Vec3, enough: u32, stream: &mut Stream) -> (Votes, bool) {
        let (mut votes, mut unstated) = (Votes::default(), false);
        let targets = self.known.boundaries.len() + self.known.points.len();
        for _ in 0..CHAINS.max(4 * targets).min(64 * CHAINS).max(2 * enough as usize) {
            if votes.total() >= enough {
                break;
            }
            if let Some((medium, witness)) = self.chain(point, &mut unstated, stream) {
                votes.add(medium, witness);
            }
        }
        (votes, unstated)
    }

    /// One chain of unblocked segments from `point` to something that knows its medium.
    fn chain(
        &self,
        point: Vec3,
        unstated: &mut bool,
        stream: &mut Stream,
    ) -> Option<(MediumIndex, Option<u32>)> {
        let mut origin = point;
        let mut leaving = None;
        for _ in 0..LONGEST_CHAIN {
            let (ray, target) = self.aim(origin, leaving, stream);
            match boundary::first(self.geometry, self.surfaces, ray, false) {
                Met::Side(side) => {
                    return Some((side.medium, Some(side.shape)));
                }
                Met::Wall { point, half_known } => {
                    *unstated |= half_known;
                    let (from, direction) = bounce(&point, ray.direction, stream);
                    (origin, leaving) = (from, Some(direction));
                }
                Met::Nothing => {
                    let seen = target.or_else(|| self.known.infinity.seen_towards(ray.direction));
                    return seen.map(|medium| (medium, None));
                }
            }
        }
        None
    }

    /// A ray from `origin`. Half of these rays go in a random direction, or `leaving`. Half are aimed at a boundary,
    /// or at a point of known medium, where they end.
    fn aim(&self, origin: Vec3, leaving: Option<Vec3>, stream: &mut Stream) -> (Ray, Option<MediumIndex>) {
        let Known { boundaries, points, .. } = self.known;
        if stream.uniform() < 0.5 {
            let index = stream.below(boundaries.len() + points.len());
            let (target, medium) = match boundaries.get(index) {
                Some(shape) => (self.geometry.sample_area(*shape, stream).position, None),
                None => (points[index - boundaries.len()].0, Some(points[index - boundaries.len()].1)),
            };
            if let Some((direction, distance, _)) = measure::between(origin, target) {
                let t_max = if medium.is_some() { distance } else { f32::INFINITY };
                return (Ray { origin, direction, t_max }, medium);
            }
        }
        let direction = leaving.unwrap_or_else(|| warp::to_sphere(stream.square()));
        (Ray { origin, direction, t_max: f32::INFINITY }, None)
    }

    /// What is seen from `point` through walls.
    fn through_walls(&self, point: Vec3) -> Option<Located> {
        let mut votes = Votes::default();
        for direction in (0..DIRECTIONS).map(boundary::direction) {
            let ray = Ray { origin: point, direction, t_max: f32::INFINITY };
            if let Met::Side(side) = boundary::first(self.geometry, self.surfaces, ray, true) {
                votes.add(side.medium, Some(side.shape));
            }
        }
        let (medium, _) = votes.settled()?;
        Some(Located { medium, certainty: Certainty::ThroughWalls })
    }
}

/// A cosine-distributed direction from a wall with this unit normal.
fn diffuse(normal: Vec3, stream: &mut Stream) -> Vec3 {
    Frame::around(normal).to_world(warp::to_cosine_hemisphere(stream.square())).normalize()
}

/// Where a ray that came in `direction` goes on from a wall.
fn bounce(point: &SurfacePoint, direction: Vec3, stream: &mut Stream) -> (Vec3, Vec3) {
    let away = diffuse(offset::side_of(point.normal, -direction), stream);
    (point.leaving(away).origin, away)
}
