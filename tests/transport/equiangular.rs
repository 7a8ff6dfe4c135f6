//! Equiangular sampling shows the same image as sets of strategies without it, whatever it is combined with, and with less
//! noise around lamps in thin media.

use crate::common::{
    Stage,
    claims::{Claims, Sample},
    name_of,
    pieces::*,
    strategies,
};
use serde_json::{Value, json};
use tyndall::{math::Spectrum, transport::Strategies};

const SEEDS: u64 = 12;

fn and_along(set: Strategies) -> Strategies {
    Strategies { equiangular: true, ..set }
}

/// Bidirectional path tracing against `sets`, which cover all paths, with equiangular sampling; each with seeds of its own.
fn agrees(name: &str, stage: &Stage, sets: &[&str], samples_per_pixel: u64) {
    let measure =
        |set, first| Sample::of(&stage.renders(set, samples_per_pixel, first..first + SEEDS), stage.width());
    let all = measure(Strategies::BDPT, 500);
    let mut claims = Claims::new();
    for (i, names) in sets.iter().enumerate() {
        let set = and_along(strategies(names));
        claims.equal(&format!("{name}: {}", name_of(set)), &measure(set, 1000 * (i as u64 + 1)), &all);
    }
    claims.settle();
}

/// Sets that cover all paths where emitters are points.
const POINTS: [&str; 5] =
    ["hit+next-event+join+lens", "hit+next-event", "lens", "next-event+join", "hit+join+lens"];
/// Sets that cover all paths where emitters are shapes in view. The last has infinite variance: too few samples are too dark.
const SHAPES: [&str; 6] =
    ["hit+next-event+join+lens", "hit+next-event", "hit", "hit+join", "next-event+lens", "lens"];

fn in_room(fog: Value, more: &[(&'static str, Value)]) -> Vec<(&'static str, Value)> {
    let mut parts = vec![
        ("sensor", camera([0.0, 0.0, 0.9], [0.0, 0.0, -1.0], 8)),
        ("fog", fog),
        ("room", room(0.6, Some(named("fog")))),
    ];
    parts.extend_from_slice(more);
    parts
}

fn ball() -> (&'static str, Value) {
    ("lamp", lamp_ball([0.2, 0.3, -0.3], 0.3, rgb(2.0, 3.0, 1.0)))
}

#[test]
fn in_fog_of_one_and_three_extinctions() {
    for (sigma_t, sets) in [(0.02, &SHAPES[..]), (1.0, &SHAPES[..5]), (10.0, &SHAPES[..5])] {
        let parts = in_room(medium(sigma_t, 0.8, 0.3), &[ball()]);
        agrees(&format!("fog of {sigma_t}"), &Stage::new(&scene(&parts)), sets, 64);
    }
    let parts = in_room(medium(rgb(0.05, 1.0, 8.0), rgb(0.9, 0.7, 0.8), -0.2), &[ball()]);
    agrees("chromatic fog", &Stage::new(&scene(&parts)), &SHAPES[..5], 64);
}

/// In view, at its centre, where no ray passes by; behind the camera; a hand's breadth before it; and out of reach.
#[test]
fn with_points_anywhere() {
    for at in [[0.0, 0.0, -0.4], [0.3, 0.2, 0.97], [0.02, 0.01, 0.85], [0.4, 0.5, -0.2]] {
        let parts = in_room(
            medium(0.8, 0.9, 0.5),
            &[("point", point(at, 0.5)), ("spot", spot([-0.6, 0.6, 0.2], [0.2, -0.5, -0.6], 2.0))],
        );
        agrees(&format!("point at {at:?}"), &Stage::new(&scene(&parts)), &POINTS, 96);
    }
}

/// Boundaries before and behind the point, media within media and none around.
#[test]
fn across_boundaries() {
    let parts = [
        ("sensor", camera([0.0, 0.5, 3.5], [0.0, 0.0, 0.0], 8)),
        ("floor", floor(-1.0, 2.0, 0.5)),
        ("box", null_box([-0.9; 3], [0.9; 3], Some(named("fog")))),
        ("fog", medium(0.7, 0.9, 0.4)),
        ("ball", with(null_ball([0.2, 0.0, 0.3], 0.4, medium(4.0, 0.8, 0.0)), &[("exterior", named("fog"))])),
        ("lamp", lamp_ball([-0.4, 0.3, -0.2], 0.2, 4.0)),
    ];
    agrees("nested", &Stage::new(&scene(&parts)), &SHAPES, 96);
}

#[test]
fn in_media_that_vary() {
    let waves = json!({"type": "cosine", "constant": 1,
                       "a": {"type": "wave", "amplitude": 0.9, "vector": [4, 2, 1]}});
    for tracker in ["closed_form", "null_collision"] {
        let smoke = json!({"type": "heterogeneous", "tracker": tracker, "scale": 1.5, "sigma_t": waves,
                           "albedo": 0.8});
        let parts = [
            ("sensor", camera([0.0, 0.6, 3.2], [0.0, 0.2, 0.0], 8)),
            ("floor", floor(-0.6, 2.0, 0.5)),
            ("cloud", null_box([-0.8, -0.4, -0.8], [0.8, 0.8, 0.8], Some(smoke))),
            ("lamp", lamp_ball([0.3, 0.2, 0.1], 0.15, 6.0)),
            ("sky", sky(0.1)),
        ];
        agrees(&format!("waves by {tracker}"), &Stage::new(&scene(&parts)), &SHAPES[..4], 96);
    }
}

#[test]
fn with_forced_interaction_and_through_a_lens() {
    let mut parts = in_room(medium(rgb(0.1, 0.5, 2.0), 0.8, 0.3), &[ball()]);
    let mut stage = Stage::new(&scene(&parts));
    stage.setup.integrator.options.forced_interaction = true;
    agrees("forced", &stage, &SHAPES[..5], 64);
    let lens = [("type", json!("thinlens")), ("aperture_radius", json!(0.1)), ("focus_distance", json!(1.2))];
    parts[0].1 = with(parts[0].1.clone(), &lens);
    agrees("thin lens", &Stage::new(&scene(&parts)), &SHAPES[..5], 64);
}

/// With black walls: all that is seen is light that scattered.
fn dark(parts: Vec<(&'static str, Value)>) -> Vec<(&'static str, Value)> {
    let paint = |(name, part)| (name, if name == "room" { room(0.0, Some(named("fog"))) } else { part });
    parts.into_iter().map(paint).collect()
}

/// Light that scatters once and nothing else, where every weight and contribution shows.
#[test]
fn of_light_that_scatters_once() {
    let lamp = [("point", point([0.4, 0.5, -0.2], 1.0)), ("integrator", depth(2))];
    let mut parts = dark(in_room(medium(rgb(0.1, 0.5, 2.0), 0.8, 0.3), &lamp));
    let sets = ["next-event", "next-event+lens"];
    let mut stage = Stage::new(&scene(&parts));
    agrees("once", &stage, &sets, 400);
    stage.setup.integrator.options.forced_interaction = true;
    agrees("once, forced", &stage, &sets, 400);
    let clips = [("near_clip", json!(0.3)), ("far_clip", json!(1.2))];
    parts[0].1 = with(parts[0].1.clone(), &clips);
    agrees("once, between planes", &Stage::new(&scene(&parts)), &sets, 400);
}

/// Where it does not apply it changes nothing, not a bit.
#[test]
fn it_is_left_out_where_it_cannot_help() {
    let sky_only =
        [("sensor", camera([0.0, 1.0, 3.5], [0.0; 3], 8)), ("fog", medium(0.1, 0.9, 0.0)), ("sky", sky(0.6))];
    let cloud = [("cloud", null_ball([0.0; 3], 0.9, named("fog")))];
    let clear = [
        ("sensor", camera([0.0, 0.0, 0.9], [0.0, 0.0, -1.0], 8)),
        ("room", room(0.6, None)),
        ("lamp", lamp_ball([0.2, 0.3, -0.3], 0.3, 2.0)),
    ];
    for parts in [[&sky_only[..], &cloud].concat(), clear.to_vec()] {
        let stage = Stage::new(&scene(&parts));
        let set = and_along(Strategies::BDPT);
        assert!(stage.render(set, 4, 3) == stage.render(Strategies::BDPT, 4, 3));
    }
}

/// Mean over pixels of the variance of an image.
fn noise(stage: &Stage, set: Strategies) -> f64 {
    let images: Vec<Vec<Spectrum>> = stage.renders(set, 16, 0..24);
    let pixel = |i: usize| {
        let values: Vec<f64> = images.iter().map(|image| f64::from(image[i].y)).collect();
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (values.len() - 1) as f64
    };
    (0..images[0].len()).map(pixel).sum::<f64>() / images[0].len() as f64
}

/// A lamp in haze at night, light that scatters once.
#[test]
fn glows_in_thin_media_are_less_noisy() {
    let parts = in_room(medium(0.01, 0.9, 0.3), &[("point", point([0.1, 0.1, -0.3], 1.0))]);
    let stage = Stage::new(&scene(&[&dark(parts)[..], &[("integrator", depth(2))]].concat()));
    for (set, factor) in [(Strategies::PT, 20.0), (Strategies::BDPT, 10.0)] {
        let (without, along) = (noise(&stage, set), noise(&stage, and_along(set)));
        assert!(factor * along < without, "{}: {without} {along}", name_of(set));
    }
}
