//! Trackers against quadrature and against each other: the density of their collisions, their transmittances, and that
//! both directions of a segment are worth the same.

mod grids;

use super::*;
use crate::{
    description::{Library, Object, Value},
    math::{DVec3, Vec3, vec3},
    sampling::stream::Purpose,
    testing::{chi_square, object, significance},
    volume::{self, Place},
};

const HERE: Place = Place::new(DVec3::ZERO, 0.0);

/// The volume of `plugin`, times `factor` of its own.
fn volume(description: &Object) -> Volume {
    volume::build(description, &Library::default(), &HERE).unwrap_or_else(|error| panic!("{error}"))
}

/// Height fog, thick below and thin above.
fn fog() -> Extinction {
    let height = object("exponential", &[("scale_height", Value::Float(0.7))]);
    Extinction { volume: volume(&height), scale: 4.0, low: vec3(-1.0, -1.0, -1.0), high: vec3(2.0, 2.0, 2.0) }
}

fn segment() -> RaySegment {
    let (a, b) = (vec3(-1.5, -1.2, 1.7), vec3(1.7, 2.4, -0.8));
    RaySegment { origin: a, direction: (b - a).normalize(), length: a.distance(b) }
}

fn reversed(segment: &RaySegment) -> RaySegment {
    RaySegment { origin: segment.at(segment.length), direction: -segment.direction, length: segment.length }
}

fn trackers(medium: &Extinction) -> Vec<DistanceSampler> {
    DistanceMethod::NAMES
        .iter()
        .filter(|(_, choice)| choice.applies_to(&medium.volume) && *choice != DistanceMethod::Auto)
        .map(|(_, choice)| choose(medium, *choice, None, 1e-3))
        .collect()
}

/// An estimate of the transmittance of `segment`.
fn crossed(tracker: &DistanceSampler, medium: &Extinction, segment: &RaySegment, stream: &mut Stream) -> f64 {
    let found = tracker.attenuation::<f32>(medium, segment, stream);
    found.map_or(0.0, |found| f64::from(found.transmittance))
}

/// Optical depth up to `t` by the midpoint rule.
fn depth_by_quadrature(medium: &Extinction, segment: &RaySegment, t: f32) -> f64 {
    let n = 20_000;
    let step = f64::from(t) / f64::from(n);
    let value = |i| f64::from(medium.at::<f32>(segment.at(((f64::from(i) + 0.5) * step) as f32)));
    (0..n).map(value).sum::<f64>() * step
}

#[test]
fn collisions_come_as_their_density_says() {
    let (medium, segment, n, cells) = (fog(), segment(), 40_000u64, 24usize);
    let all = trackers(&medium);
    for tracker in &all {
        let mut counts = vec![0u64; cells + 1];
        for index in 0..n {
            let mut stream = Stream::new(3, index, 0, Purpose::Study);
            let remaining = stream.exponential();
            let sample: DistanceSample<f32> =
                tracker.sample_distance(&medium, &segment, 0, remaining, &mut stream);
            let cell = sample.collision.map_or(cells, |t| (t / segment.length * cells as f32) as usize);
            counts[cell.min(cells)] += 1;
        }
        let survival = |i: usize| {
            (-depth_by_quadrature(&medium, &segment, segment.length * i as f32 / cells as f32)).exp()
        };
        let mut expected: Vec<f64> = (0..cells).map(|i| n as f64 * (survival(i) - survival(i + 1))).collect();
        expected.push(n as f64 * survival(cells));
        let p = chi_square(&counts, &expected);
        assert!(p > significance(all.len()), "{}: p = {p}", tracker.choice().name());
    }
}

#[test]
fn transmittance_is_unbiased_and_depth_symmetric() {
    let (medium, segment) = (fog(), segment());
    let truth = (-depth_by_quadrature(&medium, &segment, segment.length)).exp();
    for tracker in trackers(&medium) {
        let name = tracker.choice().name();
        let depth: f32 = tracker.depth(&medium, &segment);
        let back: f32 = tracker.depth(&medium, &reversed(&segment));
        assert!((depth - back).abs() < 1e-5 * depth, "{name}: {depth} {back}");
        let n = 20_000;
        let draw = |index| {
            let mut stream = Stream::new(4, index, 0, Purpose::Study);
            crossed(&tracker, &medium, &segment, &mut stream)
        };
        let values: Vec<f64> = (0..n).map(draw).collect();
        let mean = values.iter().sum::<f64>() / n as f64;
        let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n as f64;
        let error = (variance / n as f64).sqrt();
        // Positions are rounded: the depth of a segment is known to some 3e-6 of itself.
        let slack = if name == "march" { 1e-3 } else { 3e-6 * f64::from(depth) * truth };
        assert!((mean - truth).abs() < 4.0 * error + slack, "{name}: {mean} {truth} +- {error}");
    }
}

#[test]
fn marching_keeps_the_error_that_it_is_given() {
    let medium = fog();
    let mut steps = Vec::new();
    for error in [1e-1, 1e-2, 1e-3, 1e-4] {
        let DistanceSampler::RayMarching(march) = choose(&medium, DistanceMethod::RayMarching, None, error)
        else {
            panic!()
        };
        steps.push(march.step);
        let mut worst = 0.0f64;
        for index in 0..2_000 {
            let mut stream = Stream::new(5, index, 0, Purpose::Study);
            let mut point = || {
                medium.low
                    + vec3(stream.uniform(), stream.uniform(), stream.uniform()) * (medium.high - medium.low)
            };
            let (a, b) = (point(), point());
            let segment = RaySegment { origin: a, direction: (b - a).normalize(), length: a.distance(b) };
            let marched: f32 = march.depth(&medium, &segment);
            let exact: f32 = closed_form::depth(&medium, &segment);
            worst = worst.max(f64::from(((-marched).exp() - (-exact).exp()).abs()));
        }
        // Chosen from 128 sections; these are others.
        assert!(worst <= 2.0 * error, "{error}: {worst}");
        assert!(worst >= 0.01 * error, "{error}: {worst}, far better than asked for");
    }
    assert!(steps.windows(2).all(|pair| pair[1] < pair[0]), "{steps:?}");
}

#[test]
fn the_ratio_of_lanes_is_that_of_their_transmittances() {
    let grey = fog();
    let red = object("constvolume", &[("value", Value::Rgb([1.0, 0.5, 0.1]))]);
    let children = [
        ("a", Value::Object(red)),
        ("b", Value::Object(object("exponential", &[("scale_height", Value::Float(0.7))]))),
    ];
    let medium = Extinction { volume: volume(&object("product", &children)), ..grey };
    let segment = segment();
    let depth = depth_by_quadrature(&fog(), &segment, segment.length);
    for tracker in trackers(&medium) {
        let hero = 1;
        let n = 40_000;
        // Contributions of what passes, per channel: its own transmittance.
        let mut sums = [DVec3::ZERO; 2];
        for index in 0..n {
            let mut stream = Stream::new(6, index, 0, Purpose::Study);
            let remaining = stream.exponential();
            let sample: DistanceSample<Spectrum> =
                tracker.sample_distance(&medium, &segment, hero, remaining, &mut stream);
            if sample.collision.is_none() {
                let ratio = sample.ratio.as_dvec3();
                sums[0] += ratio;
                sums[1] += ratio * ratio;
            }
        }
        let mean = sums[0] / n as f64;
        let error = ((sums[1] / n as f64 - mean * mean) / n as f64).map(f64::sqrt);
        let truth = DVec3::new(-depth, -0.5 * depth, -0.1 * depth).exp();
        let slack = if tracker.choice() == DistanceMethod::RayMarching { 2e-3 } else { 1e-6 };
        let off = (mean - truth).abs();
        assert!(off.cmple(error * 4.5 + slack).all(), "{}: {mean} {truth} {error}", tracker.choice().name());
    }
}

#[test]
fn nothing_is_met_where_there_is_nothing() {
    let medium = fog();
    let beside = RaySegment { origin: Vec3::splat(5.0), direction: Vec3::X, length: f32::INFINITY };
    for tracker in trackers(&medium) {
        let mut stream = Stream::new(7, 0, 0, Purpose::Study);
        let sample: DistanceSample<f32> = tracker.sample_distance(&medium, &beside, 0, 1e-7, &mut stream);
        assert_eq!((sample.collision, sample.depth, sample.spent), (None, 0.0, 0.0));
        assert_eq!(tracker.depth::<f32>(&medium, &beside), 0.0);
        assert_eq!(crossed(&tracker, &medium, &beside, &mut stream), 1.0);
    }
}

/// Voxels of which one in seven is `contrast` times as dense as the least of the others; some are empty.
struct Contrast(f32);

impl volume::Samples<f32> for Contrast {
    fn size(&self) -> [usize; 3] {
        [4; 3]
    }
    fn at(&self, [x, y, z]: [usize; 3]) -> f32 {
        let index = x + 4 * (y + 4 * z);
        if index.is_multiple_of(7) { self.0 } else { (index % 3) as f32 }
    }
    fn uniform(&self, _: [usize; 3], _: [usize; 3]) -> Option<f32> {
        None
    }
}

/// A choice must not take as long as what it advises against: tracking through the light parts of a cell whose bound
/// is 1e12 / m.
#[test]
fn the_choice_is_quick_where_tracking_is_slow() {
    use crate::volume::grid::{Filter, Grid, Values, Wrap};
    for contrast in [1e6, 1e12] {
        let path = std::path::Path::new("contrast");
        let values = Values::Grey(Box::new(Contrast(contrast)));
        let grid = Grid::new(path, values, Filter::Trilinear, Wrap::Clamp, crate::math::DAffine3::IDENTITY);
        let volume = Volume::Grid(grid.unwrap());
        let medium = Extinction { volume, scale: 1.0, low: Vec3::ZERO, high: Vec3::ONE };
        let start = std::time::Instant::now();
        assert_eq!(
            choose(&medium, DistanceMethod::Auto, None, 1e-3).choice(),
            DistanceMethod::RegularTracking
        );
        assert!(start.elapsed().as_secs_f64() < 2.0, "{contrast:e}: {:?}", start.elapsed());
    }
}
