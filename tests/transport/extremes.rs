//! Numbers at the edge of what single precision holds, each against a known radiance or one method against another.

use crate::common::{
    Stage,
    claims::{Claims, Sample},
    pieces::*,
    strategies,
};
use serde_json::{Value, json};
use tyndall::transport::Strategies;

const SEEDS: u64 = 12;

fn sample(stage: &Stage, set: Strategies, first: u64) -> Sample {
    Sample::of(&stage.renders(set, 64, first..first + SEEDS), stage.width())
}

fn bdpt_is_pt(what: &str, parts: &[(&str, Value)]) {
    let stage = Stage::new(&scene(parts));
    let mut claims = Claims::new();
    claims.equal(what, &sample(&stage, Strategies::BDPT, 500), &sample(&stage, Strategies::PT, 0));
    claims.settle();
}

/// Under a sky of radiance 1 nothing that absorbs nothing can be told from it.
fn is_invisible(what: &str, parts: &[(&str, Value)]) {
    let mut all = vec![("sensor", camera([0.0, 0.0, 3.5], [0.0, 0.0, 0.0], 8)), ("sky", sky(1.0))];
    all.extend(parts.iter().cloned());
    let stage = Stage::new(&scene(&all));
    let mut claims = Claims::new();
    for (name, set) in [("hit", strategies("hit")), ("bdpt", Strategies::BDPT)] {
        claims.equal_to(&format!("{what}, {name}"), &sample(&stage, set, 0), 1.0);
    }
    claims.settle();
}

/// Ratios of densities overflow here, and a transmittance of 0 times one is no number.
#[test]
fn connections_through_opaque_media_bring_nothing() {
    let fog = with(medium(1e9, 0.5, 0.0), &[("radiance", json!(1.0))]);
    let room = scene(&[
        ("fog", fog),
        ("sensor", with(camera([0.1, 0.2, 0.9], [0.0, 0.0, -1.0], 8), &[("medium", named("fog"))])),
        ("room", room(0.5, Some(named("fog")))),
    ]);
    let ball = scene(&[
        ("sensor", camera([0.0, 0.5, 4.0], [0.0; 3], 8)),
        ("ball", null_box([-1.0; 3], [1.0; 3], Some(medium(1e25, 0.5, 0.5)))),
        ("lamp", point([0.0, 2.0, 2.0], 5.0)),
        ("sky", sky(1.0)),
    ]);
    for scene in [room, ball] {
        let images = Stage::new(&scene).renders(Strategies::BDPT, 16, 0..4);
        assert!(images.iter().flatten().all(|value| value.is_finite()));
    }
}

/// Each ray meets one of two faces in the same place, and which one is chance: rays to and fro that met different ones lost
/// 1 % of the light, unless a look around the scene had found by chance that the boundaries contradict each other.
#[test]
fn nested_media_may_share_faces() {
    let outer = null_box([-0.8; 3], [0.8; 3], Some(named("thin")));
    let inner =
        with(null_box([-0.3, -0.8, -0.3], [0.8; 3], Some(named("thick"))), &[("exterior", named("thin"))]);
    let parts = [
        ("thin", medium(0.5, 1.0, 0.3)),
        ("thick", medium(3.0, 1.0, 0.0)),
        ("outer", outer),
        ("inner", inner),
    ];
    is_invisible("nested boxes that share four faces", &parts);
}

/// Scattering by less than a degree: cosines near 1, where 1 - cos has few digits.
#[test]
fn sharp_forward_scattering_keeps_energy() {
    is_invisible("g = 0.9999", &[("cloud", null_box([-0.5; 3], [0.5; 3], Some(medium(4.0, 1.0, 0.9999))))]);
}

/// Mitsuba starts shadow rays some way off surfaces, behind a boundary as near as this.
#[test]
fn lamps_may_be_a_hair_from_a_boundary() {
    for gap in [1e-5, -1e-5] {
        let parts = [
            ("sensor", camera([0.0, 0.5, 3.5], [0.0, 0.0, 0.0], 8)),
            ("floor", floor(-1.0, 2.0, 0.5)),
            ("cloud", null_box([-0.7; 3], [0.7; 3], Some(medium(1.0, 0.9, 0.0)))),
            ("lamp", lamp_panel([0.0, 0.7 + gap, 0.0], 0.4, 3.0)),
        ];
        bdpt_is_pt(&format!("lamp {gap} above the top of a cloud"), &parts);
    }
}

/// One component of a blend passes light that the other absorbs or reflects.
#[test]
fn rough_glass_may_be_blended_with_black_and_grey() {
    let glass = json!({"type": "roughdielectric", "distribution": "ggx", "alpha": 0.3, "int_ior": 1.5});
    for grey in [0.0, 0.5] {
        let blend = json!({"type": "blendbsdf", "weight": 0.5, "b0": glass, "b1": diffuse(grey)});
        let parts = [
            ("sensor", camera([0.0, 0.0, 0.9], [0.0, 0.0, -1.0], 8)),
            ("room", room(0.5, None)),
            ("ball", with(lamp_ball([0.0, -0.2, -0.3], 0.1, 4.0), &[])),
            ("glass", json!({"type": "sphere", "center": [0.0, -0.2, -0.3], "radius": 0.5, "bsdf": blend})),
            ("lamp", lamp_panel([0.0, 0.95, 0.0], 0.4, 3.0)),
        ];
        bdpt_is_pt(&format!("rough glass and diffuse {grey}"), &parts);
    }
}

/// Walks through this ball have 400,000 segments in the mean. Roulette after 100,000, with factors that grow exponentially,
/// lost the light of a few per thousand and showed too small an error. Without roulette nothing is random.
#[test]
fn white_balls_lose_nothing_to_long_walks() {
    let ball = null_ball([0.0; 3], 1.0, medium(900.0, 1.0, 0.0));
    let inside = camera([0.0, 0.0, 0.1], [0.0; 3], 2);
    let stage = Stage::new(&scene(&[("sensor", inside), ("ball", ball), ("sky", sky(1.0))]));
    for pixel in stage.render(strategies("hit"), 8, 1) {
        assert!((pixel - 1.0).abs().max_element() < 1e-4, "{pixel}");
    }
}

/// A medium of density 0 costs what vacuum does: it is left out of the code that renders. One that shines stays.
#[test]
fn media_of_density_0_are_vacuum() {
    let stage = |fog: Value| {
        Stage::new(&scene(&[
            ("sensor", camera([0.0, 0.0, 3.5], [0.0; 3], 8)),
            ("sky", sky(1.0)),
            ("ball", null_ball([0.0; 3], 1.0, fog)),
            ("floor", floor(-1.5, 2.0, 0.5)),
        ]))
    };
    let of = |sigma_t: Value, scale: f64, more: &[(&str, Value)]| {
        let fog = json!({"type": "heterogeneous", "sigma_t": sigma_t, "scale": scale, "albedo": 0.8});
        stage(with(fog, more))
    };
    let constant = |value: f64| json!({"type": "constvolume", "value": value});
    let waves = |value: f64| json!({"type": "cosine", "value": value, "constant": 1, "wave": {"type": "wave", "amplitude": 0.5, "vector": [0, 1, 0]}});
    let vacuum = stage(medium(0.0, 0.8, 0.0));
    let truth = vacuum.render(Strategies::PT, 4, 1);
    for (name, nothing) in [
        ("constant", of(constant(0.0), 1.0, &[])),
        ("scale", of(constant(3.0), 0.0, &[])),
        ("waves", of(waves(0.0), 1.0, &[])),
        ("scaled waves", of(waves(2.0), 0.0, &[])),
    ] {
        assert_eq!(nothing.profile, vacuum.profile, "{name}");
        assert_eq!(nothing.render(Strategies::PT, 4, 1), truth, "{name}");
    }
    let thin = of(waves(1e-3), 1.0, &[]);
    assert_ne!(thin.profile, vacuum.profile);
    let shining = of(constant(0.0), 1.0, &[("emission", constant(0.5))]);
    let brighter = shining.render(Strategies::PT, 4, 1);
    let sum = |image: &[tyndall::math::Spectrum]| image.iter().map(|value| value.y).sum::<f32>();
    assert!(sum(&brighter) > 1.05 * sum(&truth), "{} and {}", sum(&brighter), sum(&truth));
}
