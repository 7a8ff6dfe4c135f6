//! Flights through flakes that vary, against a quadrature over the numbers of their file.

use super::scenes::{CHROMATIC_FELT, FELT_MATRICES, HALF_FELT, INSIDE, OUTSIDE, SHELL, WAVES_OF_FELT, build};
use crate::{
    math::{DVec3, RaySegment, Spectrum, vec3},
    medium::{Medium, MediumInterval},
    sampling::{Stream, stream::Purpose},
    scene::build::Setup,
    testing::{chi_square, significance},
    transport::profiles::Everything,
};

const SAMPLES: u32 = 200_000;
const BINS: usize = 20;

/// A medium, and a way through most of what is felt, neither along an axis nor in a plane of two.
struct Case {
    name: &'static str,
    setup: Setup,
    interval: MediumInterval,
}

fn cases() -> [Case; 2] {
    let felt: [(_, &[&str]); 2] =
        [("felt", &[CHROMATIC_FELT, INSIDE, SHELL]), ("waves of felt", &[OUTSIDE, WAVES_OF_FELT])];
    felt.map(|(name, parts)| {
        let setup = build(parts);
        let origin = (DVec3::new(-0.7, -0.4, -0.5) - setup.scene.recentre).as_vec3();
        let segment = RaySegment { origin, direction: vec3(0.8, 0.36, 0.48), length: 1.6 };
        Case { name, setup, interval: MediumInterval::of(segment) }
    })
}

/// Area by the numbers of the file.
fn area(position: DVec3, direction: DVec3) -> f64 {
    let at = ((position.x + 1.0) * 1.5 - 0.5).clamp(0.0, 1.999_999);
    let pair = [FELT_MATRICES[at as usize], FELT_MATRICES[at as usize + 1]];
    let [first, second] = pair.map(|matrix| matrix.map(f64::from));
    let [xx, yy, zz, xy, xz, yz]: [f64; 6] =
        std::array::from_fn(|i| first[i] * (1.0 - at.fract()) + second[i] * at.fract());
    let DVec3 { x, y, z } = direction;
    (xx * x * x + yy * y * y + zz * z * z + 2.0 * (xy * x * y + xz * x * z + yz * y * z)).sqrt()
}

impl Case {
    fn medium(&self) -> &Medium {
        &self.setup.scene.media[1]
    }

    /// Shares of what collides in every bin and, last, of what passes, of a channel.
    fn shares(&self, channel: usize) -> Vec<f64> {
        let RaySegment { direction, length, .. } = self.interval.segment;
        let (fine, mut depth, mut shares, mut left) = (500, 0.0, vec![], 1.0);
        let step = f64::from(length) / (BINS * fine) as f64;
        for i in 0..BINS * fine {
            let position = self.interval.segment.at(((i as f64 + 0.5) * step) as f32);
            let sigma_t = self.medium().properties_at::<Everything>(0, position).sigma_t[channel];
            let place = position.as_dvec3() + self.setup.scene.recentre;
            depth += step * f64::from(sigma_t) * area(place, direction.as_dvec3().normalize());
            if i % fine == fine - 1 {
                let passed = (-depth).exp();
                shares.push(left - passed);
                left = passed;
            }
        }
        shares.push(left);
        shares
    }
}

/// The bin of a collision; the last where there is none.
fn bin(collision: Option<f32>) -> usize {
    collision.map_or(BINS, |t| ((t / 1.6 * BINS as f32) as usize).min(BINS - 1))
}

/// The mean of `estimates` must be `truth`.
fn check(what: &str, estimates: &[f64], truth: f64) {
    let count = estimates.len() as f64;
    let mean = estimates.iter().sum::<f64>() / count;
    let variance = estimates.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (count - 1.0);
    let error = (variance / count).sqrt();
    // Sums of many estimates are normal; the quadrature is exact to six digits.
    let deviation = (mean - truth).abs() / (error + 1e-6 * truth);
    assert!(deviation < 4.5, "{what}: {mean} for {truth}, {deviation} standard errors of {error}");
}

#[test]
fn flights_collide_where_flakes_are() {
    for case in cases() {
        let Case { name, interval, .. } = &case;
        let (medium, mut stream) = (case.medium(), Stream::new(7, 0, 0, Purpose::Study));
        let shares = case.shares(0);
        let mut counts = vec![0; BINS + 1];
        for _ in 0..SAMPLES {
            let remaining = stream.exponential();
            let sample = medium.sample_distance::<Everything>(interval, 0, remaining, &mut stream);
            counts[bin(sample.collision)] += 1;
        }
        let expected: Vec<f64> = shares.iter().map(|share| share * f64::from(SAMPLES)).collect();
        let p = chi_square(&counts, &expected);
        assert!(p > significance(2), "{name}: p-value {p}");
    }
}

#[test]
fn what_flights_carry_and_connections_let_through_is_right_in_the_mean() {
    for case in cases() {
        let Case { name, interval, .. } = &case;
        let (medium, mut stream) = (case.medium(), Stream::new(8, 0, 0, Purpose::Study));
        let truths: Vec<_> = (0..3).map(|channel| case.shares(channel)).collect();
        let (mut flights, mut passed) = (vec![], vec![]);
        for _ in 0..SAMPLES {
            let through = medium.attenuation::<Everything>(interval, &mut stream);
            passed.push(through.map_or(Spectrum::ZERO, |through| through.transmittance));
            let remaining = stream.exponential();
            let sample = medium.sample_distance::<Everything>(interval, 0, remaining, &mut stream);
            flights.push((bin(sample.collision), sample.ratio));
        }
        for (channel, truth) in truths.iter().enumerate() {
            let estimates: Vec<_> = passed.iter().map(|through| through[channel].into()).collect();
            check(&format!("{name}, transmittance"), &estimates, truth[BINS]);
            let through =
                |(bin, ratio): &(usize, Spectrum)| if *bin == BINS { ratio[channel].into() } else { 0.0 };
            let estimates: Vec<_> = flights.iter().map(through).collect();
            check(&format!("{name}, flights"), &estimates, truth[BINS]);
        }
    }
}

#[test]
fn forced_collisions_are_right_in_the_mean() {
    for case in cases() {
        let Case { name, interval, .. } = &case;
        let (medium, mut stream) = (case.medium(), Stream::new(9, 0, 0, Purpose::Study));
        let truth = case.shares(0);
        let depth = medium.optical_depth::<Everything>(interval);
        let mut estimates = vec![vec![]; BINS + 1];
        for _ in 0..SAMPLES {
            let unforced = medium.unforced::<Everything>(interval, depth, 0, &mut stream);
            let caught = -(-unforced.depth).exp_m1();
            let remaining = -(-stream.uniform() * caught).ln_1p();
            let sample = medium.force_collision::<Everything>(interval, 0, remaining, &mut stream);
            let found = sample.map(|sample| (bin(sample.collision), f64::from(sample.ratio[0] * caught)));
            estimates.iter_mut().enumerate().for_each(|(bin, all)| {
                all.push(found.filter(|(at, _)| *at == bin).map_or(0.0, |(_, value)| value));
            });
            *estimates[BINS].last_mut().unwrap() = unforced.transmittance[0].into();
        }
        estimates.iter().zip(truth).for_each(|(all, truth)| check(name, all, truth));
    }
}

/// The mean of all flakes is opaque where there are none: no estimate may rest on it.
#[test]
fn light_passes_where_there_are_no_flakes() {
    let setup = build(&[HALF_FELT, INSIDE, SHELL]);
    let (medium, mut stream) = (&setup.scene.media[1], Stream::new(10, 0, 0, Purpose::Study));
    let origin = (DVec3::new(-0.7, -0.4, -0.5) - setup.scene.recentre).as_vec3();
    // As far as x = 0.02.
    let interval =
        MediumInterval::of(RaySegment { origin, direction: vec3(0.8, 0.36, 0.48), length: 0.72 / 0.8 });
    let truth = [40.0, 60.0, 50.0].map(|sigma_t: f64| (-sigma_t * 0.02 / 0.8).exp());
    let (mut passed, mut flights, mut forced) = (vec![], vec![], vec![]);
    for _ in 0..SAMPLES / 10 {
        let through = medium.attenuation::<Everything>(&interval, &mut stream);
        passed.push(through.map_or(Spectrum::ZERO, |through| through.transmittance));
        let remaining = stream.exponential();
        let sample = medium.sample_distance::<Everything>(&interval, 0, remaining, &mut stream);
        flights.push(if sample.collision.is_none() { sample.ratio } else { Spectrum::ZERO });
        let depth = medium.optical_depth::<Everything>(&interval);
        let unforced = medium.unforced::<Everything>(&interval, depth, 0, &mut stream);
        let caught = -(-unforced.depth).exp_m1();
        let remaining = -(-stream.uniform() * caught).ln_1p();
        let sample = medium.force_collision::<Everything>(&interval, 0, remaining, &mut stream);
        forced.push(sample.map_or(0.0, |sample| f64::from(sample.ratio[0] * caught)));
    }
    for (channel, truth) in truth.into_iter().enumerate() {
        let of = |all: &[Spectrum]| all.iter().map(|value| f64::from(value[channel])).collect::<Vec<_>>();
        check("transmittance", &of(&passed), truth);
        check("flights", &of(&flights), truth);
    }
    check("forced collisions", &forced, 1.0 - truth[0]);
}
