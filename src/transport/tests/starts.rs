//! Learnt starts: they come as often as their densities say, which are densities.

use super::scenes::*;
use crate::{
    math::{SpectrumExt, Vec3},
    sampling::{Stream, stream::Purpose},
    scene::{
        build::Setup,
        lights::{Densities, EmissionSample, Start, Starts},
    },
    testing,
};
use std::sync::Arc;

/// Learnt starts that have little to do with what reaches the image: those above a plane count for a hundred times as much,
/// and of the second emitter nothing is known.
pub(super) fn lessons(setup: &Setup) -> Arc<Starts> {
    let lights = &setup.scene.lights;
    let mut stream = Stream::new(9, 0, 0, Purpose::Study);
    let starts = (0..20_000).filter_map(|_| {
        let sample = lights.sample_emission(&setup.scene.geometry, None, &mut stream)?;
        let start = sample.start();
        let above = start.direction.x + 0.3 * start.position.y + 0.1 * start.position.z > 0.2;
        (start.light != 1).then_some((start, if above { 1.0 } else { 0.01 }))
    });
    Arc::new(Starts::learn(lights, starts.collect()).unwrap())
}

/// A number below [`CELLS`] for the emitter and the octants that position and direction lie in.
fn cell(start: &Start) -> usize {
    let octant = |v: Vec3| v.to_array().iter().fold(0, |bits, x| bits * 2 + usize::from(*x > 0.1));
    (start.light as usize * 8 + octant(start.position)) * 8 + octant(start.direction)
}

const CELLS: usize = 8 * 8 * 8;

/// Sums of values and of their squares, cell by cell.
fn tally(values: impl Iterator<Item = (Start, f64)>) -> Vec<(f64, f64)> {
    let mut sums = vec![(0.0, 0.0); CELLS];
    for (start, value) in values {
        let (sum, squares) = &mut sums[cell(&start)];
        *sum += value;
        *squares += value * value;
    }
    sums
}

/// Largest difference of two tallies of as many samples, in standard deviations; cells of few samples are left out.
fn worst(a: &[(f64, f64)], b: &[(f64, f64)]) -> f64 {
    let z = |((x, xx), (y, yy)): (&(f64, f64), &(f64, f64))| (x - y).abs() / (xx + yy).sqrt();
    let many = |((x, xx), (y, yy)): &(&(f64, f64), &(f64, f64))| x * x > 50.0 * xx && y * y > 50.0 * yy;
    let compared: Vec<f64> = a.iter().zip(b).filter(many).map(z).collect();
    assert!(compared.len() >= 5, "{} cells", compared.len());
    compared.into_iter().fold(0.0, f64::max)
}

/// Starts as they were learnt, against those of the emitters counted as often as the densities say; and what both emit.
#[test]
fn starts_come_as_often_as_their_densities_say() {
    let scenes = [
        ("open", build(&[OUTSIDE, SMOKE, GROUND, SKY, SUN, POINT, SPOT, LAMP, BULB])),
        ("room", build(&[FOG, INSIDE, ROOM, BALL, LUMINAIRE, BEAM, PROFILED_POINT, SPOT, BULB])),
        ("sky image", build(&[OUTSIDE, SMOKE, GROUND, SKY_IMAGE])),
        ("fire", build(&[OUTSIDE, CHROMATIC_FIRE, GROUND, SUN, BULB])),
        ("beam", build(&[OUTSIDE, SMOKE, GROUND, BULB, POINT, SEARCHLIGHT])),
    ];
    // 400 cells each at most, twice.
    let most = -statrs_z(testing::significance(scenes.len() * 800) / 2.0);
    for (name, setup) in scenes {
        let (lights, geometry) = (&setup.scene.lights, &setup.scene.geometry);
        let learnt = lessons(&setup);
        let sample = |starts: Option<&Starts>, seed: u64| -> Vec<EmissionSample> {
            let mut stream = Stream::new(seed, 0, 0, Purpose::Study);
            let samples = (0..400_000).filter_map(|_| lights.sample_emission(geometry, starts, &mut stream));
            samples.filter(|sample| sample.throughput.max_element() > 0.0).collect()
        };
        let (by_learnt, by_emitters) = (sample(Some(&learnt), 1), sample(None, 2));
        let ratio = |sample: &EmissionSample| {
            let densities = learnt.densities(lights, &sample.start(), sample.unlearnt);
            f64::from(densities.both()) / f64::from(sample.unlearnt.both())
        };
        let came = tally(by_learnt.iter().map(|sample| (sample.start(), 1.0)));
        let due = tally(by_emitters.iter().map(|sample| (sample.start(), ratio(sample))));
        let z = worst(&came, &due);
        assert!(z < most, "{name}: {z}");
        let emitted = |samples: &[EmissionSample]| {
            tally(samples.iter().map(|one| (one.start(), f64::from(one.throughput.luminance()))))
        };
        let z = worst(&emitted(&by_learnt), &emitted(&by_emitters));
        assert!(z < most, "{name}, emitted: {z}");
        let bound = |sample: &EmissionSample| sample.pdf * sample.pdf_direction / sample.unlearnt.both();
        assert!(by_learnt.iter().all(|sample| bound(sample) > 0.2499), "{name}");
        assert!(by_learnt.iter().any(|sample| bound(sample) > 1.5), "{name}: nothing was learnt");
        let denser = |sample: &EmissionSample| sample.pdf > 1.2 * sample.unlearnt.point;
        assert!(by_learnt.iter().any(denser), "{name}: no point, nor direction to infinity, was learnt");
        let sample = by_learnt[0];
        let densities = learnt.densities(lights, &sample.start(), sample.unlearnt);
        assert_eq!(densities, Densities { point: sample.pdf, direction: sample.pdf_direction });
    }
}

/// z below which a standard normal number falls with probability `p`.
fn statrs_z(p: f64) -> f64 {
    use statrs::distribution::{ContinuousCDF, Normal};
    Normal::standard().inverse_cdf(p)
}

#[test]
fn nothing_is_learnt_from_too_little() {
    let setup = build(&[FOG, INSIDE, ROOM, BULB]);
    let lights = &setup.scene.lights;
    let start = Start { light: 0, position: Vec3::ZERO, direction: Vec3::Z };
    for (count, weight) in [(0, 1.0), (3, 1.0), (100, 0.0)] {
        assert!(Starts::learn(lights, vec![(start, weight); count]).is_none());
    }
    // An outlier does not hide the others.
    let outlier = Start { direction: Vec3::X, ..start };
    assert!(Starts::learn(lights, [vec![(start, 1.0); 1000], vec![(outlier, 1e6)]].concat()).is_some());
    // Equal positions cannot be told apart, and need not be.
    assert!(Starts::learn(lights, vec![(start, 1.0); 10_000]).is_some());
    // Of an emitter without power.
    let setup = build(&[FOG, INSIDE, ROOM, BULB, r#""dark": {"type": "point", "intensity": 0}"#]);
    let lights = &setup.scene.lights;
    let dark = lights.all.iter().position(|light| light.emitter.name == "point").unwrap();
    let start = Start { light: dark as u32, ..start };
    assert!(Starts::learn(lights, vec![(start, 1.0); 1000]).is_none());
}
