//! Learnt starts: they come as often as their densities say, which are densities.

use super::scenes::*;
use crate::{
    math::{SpectrumExt, Vec3, vec3},
    sampling::{Stream, stream::Purpose},
    scene::{
        build::Setup,
        lights::{Aim, Densities, EmissionSample, EmitterPoint, EmitterSample, Light, Start, Starts},
    },
    testing,
};
use std::sync::Arc;

/// Learnt starts that have little to do with what reaches the image: those above a plane count for ten times as much,
/// those through a hole for a hundred times, and of the second emitter nothing is known.
pub(super) fn lessons(setup: &Setup) -> Arc<Starts> {
    let lights = &setup.scene.lights;
    let mut stream = Stream::new(9, 0, 0, Purpose::Study);
    let starts = (0..20_000).filter_map(|_| {
        let sample = lights.sample_emission(&setup.scene.geometry, None, &mut stream)?;
        let start = sample.start();
        let above = start.direction.x + 0.3 * start.position.y + 0.1 * start.position.z > 0.2;
        let weight = if above { 1.0 } else { 0.1 };
        (start.light != 1).then_some((start, if is_through(setup, &start) { 100.0 * weight } else { weight }))
    });
    let starts: Vec<(Start, f32)> = starts.collect();
    let arriving =
        starts.iter().map(|(start, weight)| arrived(setup, start, *weight, stream.uniform())).collect();
    Arc::new(Starts::learn(lights, starts, arriving).unwrap())
}

/// Light that arrives at a part of its way through the scene. What goes through the hole arrives beyond and below it, and
/// counts for 20 times as much there.
fn arrived(setup: &Setup, start: &Start, weight: f32, part: f32) -> (Start, f32) {
    let (to_hole, is_through) = (hole(setup).0 - start.position, is_through(setup, start));
    let distance = if is_through { to_hole.dot(start.direction) } else { 0.0 };
    let along = distance + part * setup.scene.geometry.bounds().size().length();
    let position = start.position + along * start.direction;
    let factor = match is_through {
        true if position.y < hole(setup).0.y => 20.0,
        true => 0.0,
        false => 1.0,
    };
    (Start { position, ..*start }, factor * weight)
}

/// Centre and radius of the hole (m).
fn hole(setup: &Setup) -> (Vec3, f32) {
    let bounds = setup.scene.geometry.bounds();
    let radius = bounds.size().max_element() / 24.0;
    (0.5 * (bounds.low + bounds.high) + radius * vec3(1.0, -1.0, 0.5), radius)
}

/// What a dozen starts of each emitter teach, all of which go through the hole: too few for tables.
fn lessons_of_few(setup: &Setup) -> Arc<Starts> {
    let lights = &setup.scene.lights;
    let mut stream = Stream::new(10, 0, 0, Purpose::Study);
    let mut known = vec![0; lights.all.len()];
    let mut starts = Vec::new();
    for _ in 0..400_000 {
        let Some(sample) = lights.sample_emission(&setup.scene.geometry, None, &mut stream) else { continue };
        let (start, count) = (sample.start(), &mut known[sample.light as usize]);
        if *count < 12 && is_through(setup, &start) {
            *count += 1;
            starts.push((start, 1.0));
        }
    }
    Arc::new(Starts::learn(lights, starts, Vec::new()).unwrap())
}

/// True if light passes through a hole, a twelfth of the scene wide.
fn is_through(setup: &Setup, start: &Start) -> bool {
    let (centre, radius) = hole(setup);
    let to = centre - start.position;
    let along = to.dot(start.direction);
    along > 0.0 && (to - along * start.direction).length_squared() < radius * radius
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

/// Largest difference of two tallies of as many samples, in standard deviations. Cells of few samples are left out: the
/// greatest ratios of densities are rare, and with 100 samples 5 standard deviations were seen.
fn worst(a: &[(f64, f64)], b: &[(f64, f64)]) -> f64 {
    let z = |((x, xx), (y, yy)): (&(f64, f64), &(f64, f64))| (x - y).abs() / (xx + yy).sqrt();
    let many = |((x, xx), (y, yy)): &(&(f64, f64), &(f64, f64))| x * x > 400.0 * xx && y * y > 400.0 * yy;
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
    let most = -statrs_z(testing::significance(2 * scenes.len() * 800) / 2.0);
    for (name, setup) in scenes {
        for (amount, learnt) in [("many", lessons(&setup)), ("few", lessons_of_few(&setup))] {
            let name = format!("{name}, {amount}");
            let by_learnt = follow_their_densities(&name, &setup, &learnt, most);
            let denser = |sample: &EmissionSample| sample.pdf > 1.2 * sample.unlearnt.point;
            let is_learnt = amount == "few" || by_learnt.iter().any(denser);
            assert!(is_learnt, "{name}: no point, nor direction to infinity, was learnt");
            let lights = &setup.scene.lights;
            let surrounds = |light: &Light| light.emitter.environment().is_some();
            let is_aimed = |light: &Light| match amount {
                "many" => surrounds(light),
                _ => light.emitter.is_parallel(),
            };
            for (index, light) in lights.all.iter().enumerate().filter(|(_, light)| is_aimed(light)) {
                let count = learnt.portals(index).count();
                assert!(count > 0, "{name}: the hole was not found for {}", light.emitter.name);
            }
        }
    }
}

/// The same of starts that aim at balls of glass and at smoke.
#[test]
fn aimed_starts_come_as_often_as_their_densities_say() {
    let scenes = [
        ("open", build(&[OUTSIDE, SMOKE, FROSTED_BALL, GROUND, SKY, SUN, POINT, SPOT, LAMP, BULB])),
        ("room", build(&[FOG, INSIDE, ROOM, GLASS_BALL, LUMINAIRE, BEAM, PROFILED_POINT, SPOT, BULB])),
        ("sky image", build(&[OUTSIDE, FROSTED_BALL, GROUND, SKY_IMAGE])),
        ("fire", build(&[OUTSIDE, CHROMATIC_FIRE, FROSTED_BALL, GROUND, SUN, BULB])),
        ("beam", build(&[OUTSIDE, SMOKE, GROUND, BULB, POINT, SEARCHLIGHT])),
    ];
    let most = -statrs_z(testing::significance(2 * scenes.len() * 400) / 2.0);
    for (name, setup) in scenes {
        let aimed = setup.scene.aimed_starts().expect("a target");
        follow_their_densities(name, &setup, &aimed, most);
    }
    let nothing = build(&[OUTSIDE, GROUND, BALL, SUN]);
    assert!(nothing.scene.aimed_starts().is_none(), "a ball of chalk");
}

/// Starts that were `learnt`. They come as often as their densities say, up to `most` standard deviations, and emit as much as others.
fn follow_their_densities(name: &str, setup: &Setup, learnt: &Starts, most: f64) -> Vec<EmissionSample> {
    let (lights, geometry) = (&setup.scene.lights, &setup.scene.geometry);
    let sample = |starts: Option<&Starts>, seed: u64| -> Vec<EmissionSample> {
        let mut stream = Stream::new(seed, 0, 0, Purpose::Study);
        let samples = (0..400_000).filter_map(|_| lights.sample_emission(geometry, starts, &mut stream));
        samples.filter(|sample| sample.throughput.max_element() > 0.0).collect()
    };
    let (by_learnt, by_emitters) = (sample(Some(learnt), 1), sample(None, 2));
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
    let sample = by_learnt[0];
    let densities = learnt.densities(lights, &sample.start(), sample.unlearnt);
    assert_eq!(densities, Densities { point: sample.pdf, direction: sample.pdf_direction });
    by_learnt
}

/// Directions to a sky that are sampled through portals, against those without, counted as often as the densities say; and
/// what both bring. From around the portal, from far away and from within it.
#[test]
fn directions_through_portals_come_as_often_as_their_densities_say() {
    let (mut found, mut shares) = (Vec::new(), Vec::new());
    for sky in [SKY, SKY_IMAGE] {
        let setup = build(&[OUTSIDE, GROUND, LAMP, BULB, sky]);
        let (learnt, lights) = (lessons(&setup), &setup.scene.lights);
        let light = lights.environment.unwrap();
        let centre = learnt.portals(light as usize).next().expect("a portal").smallest.centre;
        let (hole, radius) = hole(&setup);
        let [above, below] = [vec3(2.0, 6.0, 1.0), vec3(1.0, -6.0, -2.0)].map(|way| hole + radius * way);
        for reference in [above, below, vec3(0.0, 0.0, 1e6), centre] {
            let sample = |aim: Aim<'_>, seed: u64| -> Vec<(Start, EmitterSample)> {
                let mut stream = Stream::new(seed, 0, 0, Purpose::Study);
                let pick = |_| lights.sample_emitter(&setup.scene.geometry, reference, aim, &mut stream);
                let of_sky = |sample: EmitterSample| match sample.point {
                    EmitterPoint::Direction(to) => {
                        Some((Start { light, position: reference, direction: -to }, sample))
                    }
                    _ => None,
                };
                (0..400_000).filter_map(pick).filter_map(of_sky).collect()
            };
            let (aim, plain) = (Aim { starts: Some(&learnt), ..Aim::default() }, Aim::default());
            let (by_portals, by_sky) = (sample(aim, 1), sample(plain, 2));
            let ratio = |start: &Start, sample: &EmitterSample| {
                let hit = lights.infinity_hit(-start.direction, reference, aim).unwrap();
                f64::from(hit.pdf / sample.pdf)
            };
            let came = tally(by_portals.iter().map(|(start, _)| (*start, 1.0)));
            let due = tally(by_sky.iter().map(|(start, sample)| (*start, ratio(start, sample))));
            let brings = |all: &[(Start, EmitterSample)]| {
                tally(all.iter().map(|(start, one)| (*start, f64::from(one.value.luminance() / one.pdf))))
            };
            found.extend([worst(&came, &due), worst(&brings(&by_portals), &brings(&by_sky))]);
            let unaimed = |(start, sample): &(Start, EmitterSample)| {
                f64::from(lights.unaimed(Some(&learnt), start, reference)) * ratio(start, sample)
            };
            assert!(by_sky.iter().map(unaimed).all(|one| (one - 1.0).abs() < 1e-4), "{reference}");
            let least =
                by_sky.iter().map(|(start, sample)| ratio(start, sample)).fold(f64::INFINITY, f64::min);
            shares.push(1.0 - least);
        }
    }
    let most = -statrs_z(testing::significance(8 * found.len()) / 2.0);
    let differ =
        shares.iter().any(|share| (0.01..0.06).contains(share)) && shares.iter().any(|share| *share > 0.15);
    assert!(differ, "as much from anywhere: {shares:?}");
    assert!(found.iter().all(|z| *z < most), "{found:?} standard errors, at most {most}");
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
        assert!(Starts::learn(lights, vec![(start, weight); count], Vec::new()).is_none());
    }
    // An outlier does not hide the others.
    let outlier = Start { direction: Vec3::X, ..start };
    let both = [vec![(start, 1.0); 1000], vec![(outlier, 1e6)]].concat();
    assert!(Starts::learn(lights, both, Vec::new()).is_some());
    // Equal positions cannot be told apart, and need not be.
    assert!(Starts::learn(lights, vec![(start, 1.0); 10_000], Vec::new()).is_some());
    // Of an emitter without power.
    let setup = build(&[FOG, INSIDE, ROOM, BULB, r#""dark": {"type": "point", "intensity": 0}"#]);
    let lights = &setup.scene.lights;
    let dark = lights.all.iter().position(|light| light.emitter.name == "point").unwrap();
    let start = Start { light: dark as u32, ..start };
    assert!(Starts::learn(lights, vec![(start, 1.0); 1000], Vec::new()).is_none());
}

/// An emitter so faint that no light subpath starts there may be hit all the same.
#[test]
fn a_lamp_where_no_light_subpath_starts_has_finite_densities() {
    let faint = r#""faint": {"type": "sphere", "radius": 0.1, "emitter": {"type": "area", "sampling_weight": 1e-20}}"#;
    let setup = build(&[FOG, INSIDE, ROOM, BULB, faint]);
    let lights = &setup.scene.lights;
    let start = Start { light: 0, position: Vec3::ZERO, direction: Vec3::Z };
    assert!((0..2).any(|light| lights.start_probability(light) == 0.0));
    let of = |light| (Start { light, ..start }, 1.0);
    let learn = |light| Starts::learn(lights, vec![of(light); 100], Vec::new());
    let learnt = learn(0).or(learn(1)).unwrap();
    for light in 0..2 {
        let unlearnt = Densities { point: lights.start_probability(light as usize), direction: 0.3 };
        let found = learnt.densities(lights, &Start { light, ..start }, unlearnt);
        assert!(found.point >= 0.0 && found.direction > 0.0 && found.both().is_finite(), "{found:?}");
    }
}
