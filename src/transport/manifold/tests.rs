//! Chains against solutions found by trying everything, and what they bring against the strategies that can do without them.

use super::{
    ball::{Course, Round},
    bodies::Body,
    chain::{Chain, Target},
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
    for part in [GLASS, BUBBLE, CHROME, BLOCK, POND] {
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
    for part in [GLASS, BUBBLE, CHROME, BLOCK, POND] {
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
        let inside = [from, to].map(|place| place.length() < 1.0);
        let ratio = [1.5, 1.0 / 1.33, 2.4][number % 3];
        for meetings in 1..=3 {
            let course = Course { meetings, enters: !inside[0], leaves: !inside[1] };
            if course.enters && course.leaves && meetings == 1 {
                continue;
            }
            let round = Round::new((DVec3::ZERO, 1.0, ratio), from, Target::Point(to), course).unwrap();
            let mut found = 0;
            round.solve(&mut |_| found += 1);
            // Where light hardly leaves the ball, a way may lie beyond the last of so many places.
            let all = round.count(20_000);
            ways += all;
            missed += all.saturating_sub(found);
        }
    }
    assert!(ways > 1000 && missed * 500 <= ways, "{missed} of {ways}");
}
