//! Chains against solutions found by trying everything, and what they bring against the strategies that can do without them.

use super::{
    bodies::Body,
    chain::{Chain, Target, refracted},
    circle::{Course, Round},
    tube::Tube,
};
use crate::{
    math::DVec3,
    sampling::{Stream, stream::Purpose},
    scene::build::Setup,
    transport::tests::scenes,
};

fn point(stream: &mut Stream, reach: f64) -> DVec3 {
    DVec3::from_array([0; 3].map(|_| (2.0 * f64::from(stream.uniform()) - 1.0) * reach))
}

fn bodies(parts: &[&str]) -> (Setup, Vec<Body>) {
    let setup = scenes::build(&[&[scenes::OUTSIDE, scenes::POINT], parts].concat());
    let bodies = Body::all(&setup.scene);
    (setup, bodies)
}

const GLASS: &str =
    r#""ball": {"type": "sphere", "center": [0.1, 0, 0.2], "radius": 0.5, "bsdf": {"type": "dielectric"}}"#;
const BUBBLE: &str = r#""bubble": {"type": "sphere", "center": [0.1, 0, 0.2], "radius": 0.5, "flip_normals": true,
    "bsdf": {"type": "dielectric", "int_ior": 1.33}}"#;
const CHROME: &str = r#""ball": {"type": "sphere", "radius": 0.5, "bsdf": {"type": "conductor"}}"#;
const BLOCK: &str = r#""block": {"type": "cube", "bsdf": {"type": "dielectric"}, "to_world": [{"type": "scale", "value": [0.4, 0.3, 0.5]},
    {"type": "rotate", "axis": [1, 2, 0.5], "angle": 40}]}"#;
const POND: &str = r#""pond": {"type": "disk", "bsdf": {"type": "dielectric", "int_ior": 1.33}}"#;
const PIPE: &str = r#""pipe": {"type": "cylinder", "p0": [0.1, -0.6, 0.2], "p1": [-0.2, 0.7, 0.3], "radius": 0.6,
    "bsdf": {"type": "dielectric"}}"#;
const BORE: &str = r#""bore": {"type": "cylinder", "p0": [0.1, -0.6, 0.2], "p1": [-0.2, 0.7, 0.3], "radius": 0.6, "flip_normals": true,
    "bsdf": {"type": "dielectric", "int_ior": 1.33}}"#;
const ALL: [&str; 7] = [GLASS, BUBBLE, CHROME, BLOCK, POND, PIPE, BORE];

/// Every chain from points around and within to points and directions.
fn every(body: &Body, mut check: impl FnMut(DVec3, Target, &Chain, &mut Stream)) -> u32 {
    let mut stream = Stream::new(29, 0, 0, Purpose::Study);
    let mut count = 0;
    for number in 0..300 {
        let (from, to) = (point(&mut stream, 1.5), point(&mut stream, 1.5));
        let target = if number % 3 == 0 { Target::Direction(to.normalize()) } else { Target::Point(to) };
        let mut chains = Vec::new();
        body.chains(from, target, &mut |chain| chains.push(*chain));
        chains.iter().for_each(|chain| check(from, target, chain, &mut stream));
        count += chains.len() as u32;
    }
    count
}

/// Rays along chains keep to the laws of reflection and refraction.
#[test]
fn chains_keep_to_the_laws() {
    for part in ALL {
        let (_, bodies) = bodies(&[part]);
        let count = every(&bodies[0], |from, target, chain, _| {
            let mut before = from;
            for (number, link) in chain.links().iter().enumerate() {
                let next = chain.links().get(number + 1).map_or(target, |next| Target::Point(next.position));
                let incoming = (link.position - before).normalize();
                let outgoing = next.seen_from(link.position);
                let along = |direction: DVec3| direction - link.normal * direction.dot(link.normal);
                let off = along(outgoing) * link.ratio.unwrap_or(1.0) - along(incoming);
                assert!(off.length() < 1e-5, "{part}: {off} at {link:?} of {chain:?}");
                let crosses = incoming.dot(link.normal) * outgoing.dot(link.normal) > 0.0;
                assert_eq!(crosses, link.ratio.is_some(), "{part}: {chain:?}");
                before = link.position;
            }
        });
        assert!(count > 100, "{part}: {count}");
    }
}

/// The spread is how the first direction turns while the target moves.
#[test]
fn the_spread_is_that_of_neighbours() {
    const STEP: f64 = 1e-5;
    for part in ALL {
        let (_, bodies) = bodies(&[part]);
        let mut compared = 0;
        every(&bodies[0], |from, target, chain, _| {
            let last = chain.links()[chain.links().len() - 1].position;
            let (across, along) = target.seen_from(last).any_orthonormal_pair();
            let moved = |by: DVec3| match target {
                Target::Point(point) => Target::Point(point + by),
                Target::Direction(direction) => Target::Direction((direction + by).normalize()),
            };
            let toward = |chain: &Chain| (chain.links()[0].position - from).normalize();
            let near = |by: DVec3| {
                let mut nearest = None;
                bodies[0].chains(from, moved(by), &mut |other| {
                    let same = other.links().len() == chain.links().len()
                        && other.links().iter().zip(chain.links()).all(|(a, b)| a.primitive == b.primitive);
                    let far = toward(other).distance(toward(chain));
                    if same && nearest.is_none_or(|(least, _)| far < least) {
                        nearest = Some((far, toward(other)));
                    }
                });
                nearest.filter(|(far, _)| *far < 0.01).map(|(_, direction)| direction)
            };
            let ends = [across, -across, along, -along].map(|by| near(by * STEP));
            let ([Some(a), Some(b), Some(c), Some(d)], Some(spread)) = (ends, chain.spread(from, target))
            else {
                return;
            };
            let expected = (a - b).cross(c - d).length() / (4.0 * STEP * STEP);
            // Beside a caustic differences are no derivatives.
            if (1e-3..10.0).contains(&expected) {
                assert!(
                    (spread / expected - 1.0).abs() < 0.02,
                    "{part}: {spread}, not {expected}: {chain:?}"
                );
                compared += 1;
            }
        });
        assert!(compared > 80, "{part}: {compared}");
    }
}

/// As many solutions as sign changes at two hundred times as many places.
#[test]
fn every_way_over_a_ball_is_found() {
    let mut stream = Stream::new(31, 0, 0, Purpose::Study);
    let (mut ways, mut missed) = (0, 0);
    for number in 0..1500 {
        let (from, to) = (point(&mut stream, 2.5), point(&mut stream, 2.5));
        let outside = [from, to].map(|place| place.length() > 1.0);
        let ratio = [1.5, 1.0 / 1.33, 2.4][number % 3];
        for meetings in 1..=3 {
            let course = Course { meetings, outside };
            let round = Round::new(1.0, from, Target::Point(to), course).unwrap();
            let mut found = 0;
            round.ways(|place| round.fly(round.begin(place), ratio), &mut |_, _| found += 1);
            // Where light hardly leaves the ball, a way may lie beyond the last of so many places.
            let all = round.count(ratio, 20_000);
            ways += all;
            missed += all.saturating_sub(found);
        }
    }
    assert!(ways > 1000 && missed * 500 <= ways, "{missed} of {ways}");
}

/// A tube, and light that is sent over it.
struct Sent<'a> {
    tube: &'a Tube,
    index: Option<f64>,
    origin: DVec3,
    direction: DVec3,
    points: Vec<DVec3>,
}

impl Sent<'_> {
    /// How far it is to the tube.
    fn free(&self) -> Option<f64> {
        let Tube { base, axis, length, radius } = *self.tube;
        let across = |vector: DVec3| vector - axis * vector.dot(axis);
        let (from, along) = (across(self.origin - base), across(self.direction));
        let (a, b, c) = (along.length_squared(), from.dot(along), from.length_squared() - radius * radius);
        let root = (b * b - a * c).sqrt();
        [(-b - root) / a, (-b + root) / a].into_iter().find(|distance| {
            let height = (self.origin + self.direction * *distance - base).dot(axis);
            *distance > 1e-7 && (0.0..=length).contains(&height)
        })
    }

    /// To the next point, and beyond as `number` says; none where it is lost.
    fn advance(&mut self, number: f64) -> Option<()> {
        self.origin += self.direction * self.free()?;
        self.points.push(self.origin);
        let normal = self.tube.normal(self.origin);
        let cosine = self.direction.dot(normal);
        self.direction = match self.index.filter(|_| number < 0.6) {
            Some(index) => refracted(self.direction, normal, if cosine > 0.0 { 1.0 / index } else { index })?,
            None => self.direction - normal * (2.0 * cosine),
        };
        Some(())
    }
}

/// Light that is sent over a tube in all ways comes to targets that are then to be reached: how many are not, of how many.
fn lost(index: Option<f64>, length: f64, is_parallel: bool) -> [usize; 2] {
    let axis = DVec3::new(0.3, -0.5, 0.8).normalize();
    let tube = Tube { base: DVec3::new(0.1, -0.2, 0.3), axis, length, radius: 0.7 };
    let middle = tube.base + axis * (0.5 * length);
    let mut stream = Stream::new(43, 0, 0, Purpose::Study);
    let (mut lost, mut all) = (0, 0);
    for turn in 0..4000 {
        let from = middle + point(&mut stream, if turn % 2 == 0 { 0.8 } else { 2.5 });
        let direction = (middle + point(&mut stream, 1.2) - from).normalize();
        let mut sent = Sent { tube: &tube, index, origin: from, direction, points: Vec::new() };
        let is_sent = (0..=turn / 2 % 3).all(|_| sent.advance(f64::from(stream.uniform())).is_some());
        let part = f64::from(stream.uniform()).max(0.02);
        let target = match (is_parallel, sent.free()) {
            (true, Some(_)) => continue,
            (true, None) => Target::Direction(sent.direction),
            (false, free) => Target::Point(sent.origin + sent.direction * free.unwrap_or(3.0) * part),
        };
        if is_sent {
            let is_same = |points: &[DVec3]| {
                let mut pairs = points.iter().zip(&sent.points);
                points.len() == sent.points.len() && pairs.all(|(a, b)| a.distance(*b) < 1e-6)
            };
            let mut found = 0;
            tube.solve(index, from, target, &mut |_, points| found += usize::from(is_same(points)));
            (lost, all) = (lost + usize::from(found != 1), all + 1);
        }
    }
    [lost, all]
}

/// From around the tube, from within, through its walls and its ends.
#[test]
fn every_way_over_a_tube_is_found() {
    let indices = [None, Some(1.0 / 2.4), Some(0.75), Some(1.1), Some(1.5), Some(2.4)];
    let tubes = indices.iter().flat_map(|index| [1.5, 5.0].map(|length| (*index, length)));
    let counts = tubes.flat_map(|(index, length)| [false, true].map(|sun| lost(index, length, sun)));
    let [missed, ways] = counts.fold([0, 0], |sum, [lost, all]| [sum[0] + lost, sum[1] + all]);
    assert!(ways > 20_000 && missed * 2000 <= ways, "{missed} of {ways}");
}
