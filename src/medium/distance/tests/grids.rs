//! Random estimates of transmittance through grids against the exact tracker: what is even, what is not, and what lies
//! between dense voxels.

use super::*;
use crate::{
    math::DAffine3,
    volume::grid::{Filter, Grid, Values, Wrap},
};

/// Voxels given by a function of their place.
struct Voxels<V> {
    size: usize,
    value: fn([usize; 3]) -> V,
}

impl<V> volume::Samples<V> for Voxels<V> {
    fn size(&self) -> [usize; 3] {
        [self.size; 3]
    }
    fn at(&self, index: [usize; 3]) -> V {
        (self.value)(index)
    }
    fn uniform(&self, _: [usize; 3], _: [usize; 3]) -> Option<V> {
        None
    }
}

/// `values` in the unit cube of `place`, times `scale`.
fn medium(values: Values, filter: Filter, place: DAffine3, scale: f32) -> Extinction {
    let path = std::path::Path::new("voxels");
    let grid = Grid::new(path, values, filter, Wrap::Clamp, place).unwrap_or_else(|error| panic!("{error}"));
    let [low, high] = grid.domain().expect("a grid ends somewhere");
    Extinction { volume: Volume::Grid(grid), scale, low, high }
}

fn grey(size: usize, value: fn([usize; 3]) -> f32) -> Values {
    Values::Grey(Box::new(Voxels { size, value }))
}

/// From 0 to 1, without pattern.
fn noise([x, y, z]: [usize; 3]) -> f32 {
    Stream::new(x as u64, y as u64, z as u64, Purpose::Study).uniform()
}

fn coloured(at: [usize; 3]) -> Spectrum {
    let value = noise(at);
    Spectrum::new(value, 0.3 * value * value, if at[0] > 9 { 0.8 } else { 0.1 })
}

fn even(_: [usize; 3]) -> f32 {
    0.7
}

fn checks([x, y, z]: [usize; 3]) -> f32 {
    ((x + y + z) % 2) as f32
}

/// A column of 2 x 2 voxels along x in which there is nothing; it lies in the middle of bricks.
fn bored([_, y, z]: [usize; 3]) -> f32 {
    let is_hole = |i: usize| i % 8 == 3 || i % 8 == 4;
    if is_hole(y) && is_hole(z) { 0.0 } else { 1.0 }
}

fn between(a: Vec3, b: Vec3) -> RaySegment {
    RaySegment { origin: a, direction: (b - a).normalize(), length: a.distance(b) }
}

/// A line that is askew to all axes.
fn askew() -> RaySegment {
    between(vec3(0.05, 0.1, 0.9), vec3(0.9, 0.75, 0.15))
}

/// A grid, its name, and what crosses it.
fn cases() -> Vec<(&'static str, Extinction, RaySegment)> {
    let here = DAffine3::IDENTITY;
    let turned = DAffine3::from_rotation_y(0.5)
        * DAffine3::from_rotation_x(1.1)
        * DAffine3::from_scale(DVec3::new(1.5, 0.3, 0.8));
    let smooth = |scale| medium(grey(20, noise), Filter::Trilinear, here, scale);
    let colours = || Values::Chromatic(Box::new(Voxels { size: 20, value: coloured }));
    let along_x = |y: f32| between(vec3(-0.5, y, y), vec3(2.0, y, y));
    let endless = RaySegment { length: f32::INFINITY, ..between(vec3(-1.0, 0.2, 2.0), Vec3::splat(0.5)) };
    vec![
        ("even", medium(grey(20, even), Filter::Trilinear, here, 2.0), askew()),
        ("even and thick", medium(grey(20, even), Filter::Trilinear, here, 1e5), askew()),
        ("checks", medium(grey(32, checks), Filter::Nearest, here, 3.0), askew()),
        ("smooth checks", medium(grey(32, checks), Filter::Trilinear, here, 3.0), askew()),
        ("noise", smooth(4.0), askew()),
        ("thin", smooth(1e-3), askew()),
        ("thick", smooth(1e3), between(vec3(0.4, 0.41, 0.42), vec3(0.402, 0.413, 0.4195))),
        (
            "turned",
            medium(grey(20, noise), Filter::Trilinear, turned, 3.0),
            between(Vec3::ZERO, vec3(0.6, 0.3, 0.2)),
        ),
        ("coloured", medium(colours(), Filter::Trilinear, here, 3.0), askew()),
        ("along the faces of bricks", medium(grey(32, noise), Filter::Nearest, here, 2.0), along_x(0.25)),
        ("from outside, without end", smooth(2.0), endless),
        ("through a hole", medium(grey(32, bored), Filter::Nearest, here, 40.0), along_x(0.125)),
        ("beside a hole", medium(grey(32, bored), Filter::Nearest, here, 1.0), along_x(0.2)),
    ]
}

const RANDOM: [DistanceMethod; 2] = [DistanceMethod::RatioTracking, DistanceMethod::ResidualRatioTracking];

/// Mean, and variance of `n` estimates of the transmittance.
fn moments(tracker: &DistanceSampler, medium: &Extinction, segment: &RaySegment, n: u64) -> [DVec3; 2] {
    let (mut sum, mut squares) = (DVec3::ZERO, DVec3::ZERO);
    for index in 0..n {
        let mut stream = Stream::new(8, index, 0, Purpose::Study);
        let found = tracker.attenuation::<Spectrum>(medium, segment, &mut stream);
        let value = found.map_or(DVec3::ZERO, |found| found.transmittance.as_dvec3());
        sum += value;
        squares += value * value;
    }
    let mean = sum / n as f64;
    [mean, (squares / n as f64 - mean * mean).max(DVec3::ZERO)]
}

#[test]
fn estimates_are_unbiased_on_grids() {
    let n = 40_000;
    for (name, medium, segment) in cases() {
        let depth = DistanceSampler::RegularTracking.depth::<Spectrum>(&medium, &segment).as_dvec3();
        let truth = (-depth).exp();
        for method in RANDOM {
            let tracker = choose(&medium, method, None, 1e-3);
            let [mean, variance] = moments(&tracker, &medium, &segment, n);
            // Ends of pieces are rounded: depths are known to some 3e-6 of themselves.
            let slack = 4.5 * (variance / n as f64).map(f64::sqrt) + 3e-6 * depth * truth + 1e-7;
            let off = (mean - truth).abs();
            assert!(off.cmple(slack).all(), "{name}, {}: {mean}, not {truth} +- {slack}", method.name());
        }
    }
}

#[test]
fn the_stand_in_is_that_of_both_directions_and_of_flights() {
    for (name, medium, mut segment) in cases() {
        segment.length = segment.length.min(4.0);
        let tracker = choose(&medium, DistanceMethod::ResidualRatioTracking, None, 1e-3);
        let depth: f32 = tracker.depth(&medium, &segment);
        let back: f32 = tracker.depth(&medium, &reversed(&segment));
        assert!((depth - back).abs() <= 2e-5 * depth, "{name}: {depth} {back}");
        for index in 0..50 {
            let mut stream = Stream::new(9, index, 0, Purpose::Study);
            let flight: DistanceSample<f32> = tracker.sample_distance(&medium, &segment, 0, 0.0, &mut stream);
            let flown = RaySegment { length: flight.collision.unwrap_or(segment.length), ..segment };
            let depth: f32 = tracker.depth(&medium, &flown);
            assert!((depth - flight.depth).abs() <= 1e-6 * depth, "{name}: {depth} {}", flight.depth);
        }
    }
}

/// A ball that does not reach the border.
fn ball(at: [usize; 3]) -> f32 {
    let off = at.map(|i| (i as f32 - 9.5).powi(2));
    if off.iter().sum::<f32>() < 60.0 { 1.0 } else { 0.0 }
}

/// The box around a turned grid has corners that its bricks do not reach.
#[test]
fn nothing_is_met_beside_a_turned_grid() {
    let turned = DAffine3::from_rotation_z(std::f64::consts::FRAC_PI_4);
    let medium = medium(grey(20, ball), Filter::Trilinear, turned, 3.0);
    let corner = between(vec3(-0.69, 0.2, 0.5), vec3(-0.2, 0.05, 0.45));
    for method in RANDOM {
        let tracker = choose(&medium, method, None, 1e-3);
        assert_eq!(tracker.depth::<f32>(&medium, &corner), 0.0, "{}", method.name());
        assert_eq!(moments(&tracker, &medium, &corner, 10), [DVec3::ONE, DVec3::ZERO]);
    }
}

/// What does not vary within a brick is not estimated, and nothing is no work.
#[test]
fn an_even_grid_has_no_noise() {
    let medium = medium(grey(20, even), Filter::Trilinear, DAffine3::IDENTITY, 2.0);
    let tracker = choose(&medium, DistanceMethod::ResidualRatioTracking, None, 1e-3);
    let truth = DistanceSampler::RegularTracking.depth::<f32>(&medium, &askew()).exp_neg();
    let [mean, variance] = moments(&tracker, &medium, &askew(), 100);
    assert!(variance.x < 1e-14 && (mean.x - f64::from(truth)).abs() < 1e-6, "{mean} {variance} {truth}");
    let none = RaySegment { length: 0.0, ..askew() };
    assert_eq!(moments(&tracker, &medium, &none, 2), [DVec3::ONE, DVec3::ZERO]);
}

/// By the bricks' means the depth is 37; the line meets nothing.
#[test]
fn a_gap_in_dense_matter_is_not_left_to_rare_huge_estimates() {
    let all = cases();
    let (_, medium, segment) = all.iter().find(|(name, ..)| *name == "through a hole").expect("it is there");
    let tracker = choose(medium, DistanceMethod::ResidualRatioTracking, None, 1e-3);
    let [_, variance] = moments(&tracker, medium, segment, 10_000);
    assert!(variance.x < 3.0, "{variance}");
}

/// Less noise than ratio tracking where matter is thin enough to be seen through, from no more collisions.
#[test]
fn a_control_saves_noise_and_collisions() {
    for (name, medium, segment) in cases() {
        if !["noise", "turned", "coloured", "smooth checks", "from outside, without end"].contains(&name) {
            continue;
        }
        let of = |method| {
            let tracker = choose(&medium, method, None, 1e-3);
            let DistanceSampler::NullCollision(tracking) = &tracker else { panic!("{name}") };
            (moments(&tracker, &medium, &segment, 4_000)[1].x, tracking.work(&medium, &segment)[1])
        };
        let ((ratio, lookups), (residual, fewer)) = (of(RANDOM[0]), of(RANDOM[1]));
        assert!(residual < 0.5 * ratio && fewer < lookups, "{name}: {residual} {ratio}, {fewer} {lookups}");
    }
}
