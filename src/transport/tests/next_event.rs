//! Emitter points: however one was found, it has the same densities from the same reference.

use super::{scenes::*, starts};
use crate::{
    math::{Vec3, vec3},
    sampling::{Stream, stream::Purpose},
    scene::{
        Scene,
        build::Setup,
        lights::{Aim, EmitterPoint, EmitterSample, Starts},
    },
    testing::{chi_square, significance},
};

/// Within the scenes, beyond their lamps, and so far away that all of them are a point.
fn references(stream: &mut Stream) -> Vec<Vec3> {
    let mut within = || vec3(stream.uniform(), stream.uniform(), stream.uniform()) * 1.8 - 0.9;
    let mut all: Vec<Vec3> = (0..40).map(|_| within()).collect();
    all.extend([vec3(0.0, 20.0, 3.0), vec3(-1e3, 0.0, 0.0), vec3(0.0, 0.0, 1e6)]);
    all
}

/// The density of `sample`'s point if a camera subpath from `reference` had hit it; none of points and directions.
fn density_of_hit(
    scene: &Scene,
    sample: &EmitterSample,
    reference: Vec3,
    aim: Aim<'_>,
) -> Option<EmitterSample> {
    let Scene { lights, geometry, .. } = scene;
    match sample.point {
        EmitterPoint::Surface(point) => {
            lights.surface_hit(geometry, sample.light, &point, reference, aim.sky)
        }
        EmitterPoint::Volume { position, .. } => {
            lights.volume_hit(sample.light, position, reference, aim.sky)
        }
        EmitterPoint::Direction(towards) => {
            let hit = lights.infinity_hit(towards, reference, aim);
            hit.filter(|hit| hit.light == sample.light)
        }
        EmitterPoint::Point(_) | EmitterPoint::Beam { .. } => None,
    }
}

fn is_close(a: f32, b: f32) -> bool {
    (a - b).abs() <= 1e-4 * a.max(b)
}

fn check(name: &str, parts: &[&str]) {
    let setup = build(parts);
    check_learnt(name, &setup, None);
    check_learnt(&format!("{name}, learnt"), &setup, Some(&starts::lessons(&setup)));
}

fn check_learnt(name: &str, setup: &Setup, starts: Option<&Starts>) {
    let aim = Aim { starts, ..Aim::default() };
    let Scene { lights, geometry, .. } = &setup.scene;
    let mut stream = Stream::new(19, 0, 0, Purpose::Study);
    let (mut hits, mut starts) = (0, 0);
    for reference in references(&mut stream) {
        for _ in 0..100 {
            if let Some(sample) = lights.sample_emitter(geometry, reference, aim, &mut stream)
                && let Some(hit) = density_of_hit(&setup.scene, &sample, reference, aim)
            {
                let same = is_close(hit.pdf, sample.pdf) && is_close(hit.pdf_start, sample.pdf_start);
                assert!(same, "{name} at {reference}: {sample:?} sampled, {hit:?} hit");
                hits += 1;
            }
            let Some(start) = lights.sample_emission(geometry, None, &mut stream) else { continue };
            let by_ratio = start.pdf * lights.connect_over_start(geometry, &start, reference, aim);
            let seen = EmitterSample { light: start.light, point: start.point, ..DARK };
            if let Some(hit) = density_of_hit(&setup.scene, &seen, reference, aim) {
                assert!(
                    is_close(hit.pdf, by_ratio),
                    "{name} at {reference}: {by_ratio} by {start:?}, {hit:?}"
                );
                starts += 1;
            }
        }
    }
    assert!(hits > 100 && starts > 100, "{name}: {hits} hits, {starts} starts");
}

const DARK: EmitterSample = EmitterSample {
    light: 0,
    point: EmitterPoint::Point(Vec3::ZERO),
    value: Vec3::ZERO,
    cosine: 1.0,
    pdf: 0.0,
    pdf_start: 0.0,
    pdf_direction: 0.0,
};

#[test]
fn an_emitter_point_has_one_density() {
    check("one lamp", &[FOG, INSIDE, ROOM, LAMP]);
    check("a sky", &[OUTSIDE, GROUND, SKY_IMAGE]);
    check("lights of all kinds", &[OUTSIDE, SMOKE, GROUND, SKY, SUN, POINT, SPOT, LAMP, BULB]);
    check("beams", &[OUTSIDE, SMOKE, GROUND, SEARCHLIGHT, SKY, LAMP, BULB]);
    check("in a room", &[FOG, INSIDE, ROOM, SPOT, BULB, PROFILED_POINT, LUMINAIRE]);
    check("fire and lamps", &[OUTSIDE, HAZE, FIRE_BALL, GROUND, LAMP, POINT]);
    check("fire under a sky", &[OUTSIDE, FIRE_BOX, GROUND, SKY]);
    check("glowing fog", &[GLOWING_FOG, INSIDE, SHELL, LAMP]);
}

/// Points under a sun, which are as likely as their density says.
#[test]
fn emitters_come_as_often_as_they_should() {
    const DRAWS: usize = 50_000;
    let point = |i: u32| {
        let [x, y, z] = [i % 4, i / 4 % 4, i / 16].map(|n| f64::from(n) * 0.4 - 0.7);
        format!(r#""point{i}": {{"type": "point", "position": [{x}, {y}, {z}], "intensity": {}}}"#, 1 + i * i)
    };
    let points: Vec<String> = (0..40).map(point).collect();
    let parts: Vec<&str> =
        [OUTSIDE, GROUND, SUN].into_iter().chain(points.iter().map(String::as_str)).collect();
    let setup = build(&parts);
    let Scene { lights, geometry, .. } = &setup.scene;
    let mut stream = Stream::new(29, 0, 0, Purpose::Study);
    let mut found = Vec::new();
    for reference in &references(&mut stream) {
        let (mut observed, mut expected) = ([0; 41], [0.0; 41]);
        for _ in 0..DRAWS {
            let sample = lights.sample_emitter(geometry, *reference, Aim::default(), &mut stream).unwrap();
            observed[sample.light as usize] += 1;
            expected[sample.light as usize] = f64::from(sample.pdf) * DRAWS as f64;
        }
        let sum = expected.iter().sum::<f64>() / DRAWS as f64;
        assert!((sum - 1.0).abs() < 1e-5, "at {reference} the probabilities sum to {sum}");
        let p = chi_square(&observed, &expected);
        found.push(p);
    }
    let level = significance(found.len());
    assert!(found.iter().all(|p| *p > level), "{found:?}");
}
