//! What holds for every volume: bounds that hold, integrals that are those of the values.

use super::*;
use crate::{
    math::vec3,
    sampling::{Stream, stream::Purpose},
};

fn position(stream: &mut Stream) -> Vec3 {
    vec3(stream.uniform(), stream.uniform(), stream.uniform()) * 6.0 - 2.5
}

#[test]
fn values_lie_within_the_range_of_every_box_around_them() {
    for (index, volume) in examples().iter().enumerate() {
        let mut stream = Stream::new(1, index as u64, 0, Purpose::Study);
        for _ in 0..300 {
            let (a, b) = (position(&mut stream), position(&mut stream));
            let (low, high) = (a.min(b), a.max(b));
            let [least, most] = volume.range(low, high);
            for _ in 0..30 {
                let u = vec3(stream.uniform(), stream.uniform(), stream.uniform());
                let value: Spectrum = volume.eval(low + u * (high - low));
                let slack = 1e-5 * most.abs().max(least.abs());
                assert!(value.cmpge(least - slack).all() && value.cmple(most + slack).all(), "{volume:?}");
            }
        }
    }
}

#[test]
fn integrals_are_those_of_the_values() {
    for (index, volume) in examples().iter().enumerate().filter(|(_, volume)| volume.has_integral()) {
        let mut stream = Stream::new(2, index as u64, 0, Purpose::Study);
        for _ in 0..20 {
            let (a, b) = (position(&mut stream), position(&mut stream));
            let length = a.distance(b);
            let segment = RaySegment { origin: a, direction: (b - a) / length, length };
            let steps = 10_000;
            let sum: DVec3 = (0..steps)
                .map(|i| {
                    let t = (f64::from(i) + 0.5) / f64::from(steps) * f64::from(length);
                    let at = a.as_dvec3() + segment.direction.as_dvec3() * t;
                    let at = at.as_vec3();
                    if volume.contains(at) { volume.eval::<Spectrum>(at).as_dvec3() } else { DVec3::ZERO }
                })
                .sum();
            let expected = sum * (f64::from(length) / f64::from(steps));
            let found = volume.integral::<Spectrum>(&segment).as_dvec3();
            // The midpoint rule misses up to a step's worth at a jump.
            let [least, most] = volume.range(a.min(b), a.max(b)).map(|bound| bound.as_dvec3().abs());
            let slack = least.max(most) * f64::from(length) * (8.0 / f64::from(steps) + 1e-6);
            assert!((found - expected).abs().cmple(slack).all(), "{found} {expected} {volume:?}");
        }
    }
}

#[test]
fn grey_volumes_are_grey() {
    for (index, volume) in examples().iter().enumerate() {
        let mut stream = Stream::new(3, index as u64, 0, Purpose::Study);
        let colours = (0..300).map(|_| volume.eval::<Spectrum>(position(&mut stream)));
        let coloured = colours.into_iter().any(|c| c.x != c.y || c.y != c.z);
        assert_eq!(coloured, !volume.is_grey(), "{volume:?}");
    }
}

/// Sections of all lengths, in all directions, some along an axis, some through the origin or along a plane through it.
fn sections(index: u64, count: u64) -> impl Iterator<Item = RaySegment> {
    (0..count).map(move |number| {
        let mut stream = Stream::new(4, index, number, Purpose::Study);
        let (a, b) = (position(&mut stream), position(&mut stream));
        let length = 10f32.powf(stream.uniform() * 12.0 - 7.0);
        let (origin, direction) = match number % 6 {
            0 => (a, Vec3::AXES[number as usize / 6 % 3]),
            1 => (a, -a.normalize()),
            2 => (a * vec3(1.0, 0.0, 1.0), (b * vec3(1.0, 0.0, 1.0)).normalize()),
            3 => (a, vec3(1.0, 1e-7 * b.y, -1e-30).normalize()),
            4 => (a * 1e3, -(a - b * 1e-3).normalize()),
            _ => (a, b.normalize()),
        };
        RaySegment { origin, direction, length }
    })
}

/// The box around a segment, f32's rounding of its ends included.
fn around(segment: &RaySegment) -> [Vec3; 2] {
    let (a, b) = (segment.origin, segment.at(segment.length.min(1e30)));
    let slack = 1e-7 * a.abs().max(b.abs());
    [a.min(b) - slack, a.max(b) + slack]
}

#[test]
fn the_mean_along_any_section_is_within_the_range_of_the_box_around_it() {
    for (index, volume) in examples().iter().enumerate().filter(|(_, volume)| volume.has_integral()) {
        for segment in sections(index as u64, 600) {
            for length in [segment.length, segment.length * 1e25] {
                let segment = RaySegment { length, ..segment };
                let [low, high] = around(&segment);
                let [least, most] = volume.range_inside(low, high);
                if !(most * length).is_finite() {
                    continue;
                }
                let mean = volume.integral::<Spectrum>(&segment) / length;
                // Integrals below f32's normal numbers are coarse.
                let slack = 1e-5 * most.abs().max(least.abs()) + f32::MIN_POSITIVE / length;
                let holds = mean.cmpge(least - slack).all() && mean.cmple(most + slack).all();
                assert!(holds, "{least} {mean} {most} {segment:?} {volume:?}");
            }
        }
    }
}

#[test]
fn integrals_add_up_and_are_the_same_both_ways() {
    for (index, volume) in examples().iter().enumerate().filter(|(_, volume)| volume.has_integral()) {
        for segment in sections(index as u64, 600).filter(|segment| segment.length < 1e3) {
            let half = 0.375 * segment.length;
            let whole = volume.integral::<Spectrum>(&segment);
            let first = volume.integral::<Spectrum>(&RaySegment { length: half, ..segment });
            let rest = RaySegment { origin: segment.at(half), length: segment.length - half, ..segment };
            let parts = first + volume.integral::<Spectrum>(&rest);
            let back = RaySegment {
                origin: segment.at(segment.length),
                direction: -segment.direction,
                length: segment.length,
            };
            let back = volume.integral::<Spectrum>(&back);
            // As much as the values near its rounded ends change.
            let [low, high] = around(&segment);
            let reach = 1e-6 * (low.abs().max(high.abs()).max_element() + segment.length);
            let [least, most] = volume.range(low, high);
            let slack = least.abs().max(most.abs()) * (1e-5 * segment.length + steepness(volume) * reach);
            for other in [parts, back] {
                let difference = (whole - other).abs();
                assert!(difference.cmple(slack).all(), "{whole} {other} {segment:?} {volume:?}");
            }
        }
    }
}

/// Change over lengths at which functions of the examples change much: those of 1/40 m by a multiple of their value.
fn steepness(volume: &Volume) -> f32 {
    let Some([low, high]) = volume.domain() else { return 40.0 };
    40.0 + 1.0 / (high - low).min_element()
}

#[test]
fn outside_of_its_domain_a_volume_is_0() {
    let mut bounded = 0;
    for (index, volume) in examples().iter().enumerate() {
        let Some([low, high]) = volume.domain() else { continue };
        bounded += 1;
        let mut stream = Stream::new(6, index as u64, 0, Purpose::Study);
        for _ in 0..1_000 {
            let at = position(&mut stream) * 2.0;
            if !(at.cmpge(low).all() && at.cmple(high).all()) {
                assert_eq!(volume.inside::<Spectrum>(at), Spectrum::ZERO, "{at} {volume:?}");
                if volume.grid().is_none() {
                    assert_eq!(volume.range(at, at), [Spectrum::ZERO; 2]);
                }
            }
        }
        let beyond =
            RaySegment { origin: high + 1.0, direction: Vec3::ONE.normalize(), length: f32::INFINITY };
        if volume.has_integral() {
            assert_eq!(volume.integral::<f32>(&beyond), 0.0, "{volume:?}");
        }
    }
    assert!(bounded > 10);
}

mod described;
