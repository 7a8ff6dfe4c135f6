//! Light trees: probabilities sum to one, are those that leaves come with, and follow what leaves give.

use super::*;
use crate::{
    math::{DVec3, vec3},
    sampling::{Stream, stream::Purpose},
    testing::{chi_square, significance},
};

fn stream(index: u64) -> Stream {
    Stream::new(17, index, 0, Purpose::Study)
}

/// Where lamps are, and how strong.
type Layout = fn(u64, &mut Stream) -> (DVec3, f64);

fn within(stream: &mut Stream) -> DVec3 {
    vec3(stream.uniform(), stream.uniform(), stream.uniform()).as_dvec3() * 10.0
}

const LAYOUTS: [(&str, Layout); 7] = [
    ("equal", |_, stream| (within(stream), 1.0)),
    ("of any power", |_, stream| (within(stream), 10f64.powf(f64::from(stream.uniform()) * 12.0 - 6.0))),
    ("from nearly dark to blinding", |i, stream| (within(stream), 10f64.powi(i as i32 % 60 - 30))),
    ("at one place", |_, _| (DVec3::splat(3.0), 1.0)),
    ("in a row", |i, _| (DVec3::X * i as f64, 1.0)),
    ("ever further", |i, _| (DVec3::X * 2f64.powi(i as i32 % 60 - 30), 1.0)),
    ("two places", |i, _| (DVec3::Y * (i % 2) as f64 * 1e6, 1.0)),
];

const COUNTS: [u32; 8] = [2, 3, 4, 5, 6, 17, 64, 1000];

fn leaves(count: u32, layout: Layout, directed: bool) -> Vec<(u32, Moments)> {
    let mut stream = stream(u64::from(count));
    let leaf = |i: u32| {
        let (position, power) = layout(u64::from(i), &mut stream);
        let direction = if directed { (within(&mut stream) - 5.0).normalize() } else { DVec3::ZERO };
        (i, Moments::ray(power, position, direction))
    };
    (0..count).map(leaf).collect()
}

/// Every tree of the above, some with light from infinity.
fn trees() -> impl Iterator<Item = (String, LightTree, u32)> {
    let variants = LAYOUTS.into_iter().flat_map(|layout| COUNTS.map(|count| (layout, count)));
    variants.flat_map(|((name, layout), count)| {
        [0, 1, 2].map(|far: u32| {
            let near = leaves(count - far.min(count), layout, far == 1);
            let first = near.len() as u32;
            let sky = |i| (i, Moments::everywhere(0.1, DVec3::ZERO, 1e5));
            let far: Vec<_> = (first..count).map(sky).collect();
            let name = format!("{name}, {first} lamps, {} at infinity", far.len());
            (name, LightTree::new(far, near, count as usize, 1e-5).unwrap(), count)
        })
    })
}

/// Among the lamps, on one, far and very far away.
const REFERENCES: [Vec3; 7] = [
    Vec3::splat(5.0),
    Vec3::splat(3.0),
    Vec3::ZERO,
    vec3(1.0, 2.0, 3.0),
    vec3(0.0, 1e6, 0.0),
    vec3(-1e12, 3.0, 1e9),
    Vec3::splat(1e30),
];

#[test]
fn probabilities_sum_to_one() {
    for (name, tree, count) in trees() {
        for reference in REFERENCES {
            let sum: f64 = (0..count).map(|leaf| f64::from(tree.probability(leaf, reference))).sum();
            assert!((sum - 1.0).abs() < 1e-5, "{name} at {reference}: {sum}");
        }
    }
}

#[test]
fn a_leaf_is_as_likely_as_it_is_said_to_be_when_sampled() {
    for (name, tree, count) in trees() {
        for reference in REFERENCES {
            let at = |i: u32| f64::from(i) / 100.0;
            for u in (0..100).map(at).chain([1.0 - f64::EPSILON]) {
                let (leaf, probability) = tree.sample(reference, u);
                assert!(leaf < count && probability > 0.0, "{name} at {reference}: {leaf}, {probability}");
                assert_eq!(probability, tree.probability(leaf, reference), "{name} at {reference}: {leaf}");
            }
        }
    }
}

#[test]
fn leaves_come_as_often_as_they_should() {
    const DRAWS: usize = 20_000;
    let level = significance(trees().count() * REFERENCES.len());
    for (index, (name, tree, count)) in trees().enumerate() {
        let mut stream = stream(index as u64);
        for reference in REFERENCES {
            let mut observed = vec![0; count as usize];
            (0..DRAWS)
                .for_each(|_| observed[tree.sample(reference, stream.uniform_precisely()).0 as usize] += 1);
            let expected: Vec<f64> =
                (0..count).map(|leaf| f64::from(tree.probability(leaf, reference)) * DRAWS as f64).collect();
            let p = chi_square(&observed, &expected);
            assert!(p > level, "{name} at {reference}: p = {p:.1e}");
        }
    }
}

/// The second moment of the light of one lamp over its probability, with 10 000 equal lamps around: at least 1, and
/// far less than by equal probabilities.
#[test]
fn choices_follow_what_lamps_give() {
    let lamps = leaves(10_000, LAYOUTS[0].1, false);
    let tree = LightTree::new(Vec::new(), lamps.clone(), lamps.len(), 1e-5).unwrap();
    let (mut stream, mut moments) = (stream(1), [0.0, 0.0]);
    for _ in 0..50 {
        let reference = within(&mut stream);
        let gives = |(_, lamp): &(u32, Moments)| 1.0 / (lamp.centre() - reference).length_squared();
        let all: f64 = lamps.iter().map(gives).sum();
        for lamp in &lamps {
            let share = gives(lamp) / all;
            moments[0] += share * share / f64::from(tree.probability(lamp.0, reference.as_vec3()));
            moments[1] += share * share * lamps.len() as f64;
        }
    }
    assert!(moments[0] < 0.25 * moments[1], "{moments:?} over 50 references");
}

#[test]
fn light_from_infinity_has_the_share_of_its_irradiance() {
    let lamp = |x: f64| Moments::ray(4.0 * std::f64::consts::PI, DVec3::X * x, DVec3::ZERO);
    let sky = Moments::everywhere(0.5, DVec3::ZERO, 1e5);
    let tree = LightTree::new(vec![(0, sky)], vec![(1, lamp(0.0))], 2, 1e-5).unwrap();
    for (distance, share) in [(0.5, 1.0 / 9.0), (1.0, 1.0 / 3.0), (2.0, 2.0 / 3.0), (100.0, 0.9998)] {
        let probability = tree.probability(0, vec3(distance, 0.0, 0.0));
        assert!((probability - share).abs() < 1e-3, "at {distance} m: {probability}, expected {share}");
    }
}

#[test]
fn light_is_found_where_it_goes() {
    let lamp = |x: f64, direction: DVec3| Moments::ray(1.0, DVec3::X * x, direction * (2.0 / 3.0));
    let lamps = vec![(0, lamp(-1.0, DVec3::Y)), (1, lamp(1.0, DVec3::NEG_Y))];
    let tree = LightTree::new(Vec::new(), lamps, 2, 1e-5).unwrap();
    assert!(tree.probability(0, vec3(0.0, 5.0, 0.0)) > 0.9);
    assert!(tree.probability(0, vec3(0.0, -5.0, 0.0)) < 0.1);
    assert!((tree.probability(0, vec3(0.0, 0.0, 5.0)) - 0.5).abs() < 1e-6);
}

#[test]
fn a_tree_needs_two_leaves() {
    assert!(LightTree::new(Vec::new(), leaves(1, LAYOUTS[0].1, false), 1, 1e-5).is_none());
    assert!(LightTree::new(Vec::new(), Vec::new(), 0, 1e-5).is_none());
}
