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
        for _ in 0..50 {
            let (a, b) = (position(&mut stream), position(&mut stream));
            let length = a.distance(b);
            let section = Section { origin: a, direction: (b - a) / length, length };
            let steps = 20_000;
            let sum: DVec3 = (0..steps)
                .map(|i| {
                    let t = (f64::from(i) + 0.5) / f64::from(steps) * f64::from(length);
                    let at = a.as_dvec3() + section.direction.as_dvec3() * t;
                    let at = at.as_vec3();
                    if volume.contains(at) { volume.eval::<Spectrum>(at).as_dvec3() } else { DVec3::ZERO }
                })
                .sum();
            let expected = sum * (f64::from(length) / f64::from(steps));
            let found = volume.integral::<Spectrum>(&section).as_dvec3();
            // The midpoint rule misses up to a step's worth at a jump.
            let [_, most] = volume.range(a.min(b), a.max(b));
            let slack =
                most.as_dvec3().abs() * f64::from(length) * (4.0 / f64::from(steps)) + expected * 1e-5;
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
