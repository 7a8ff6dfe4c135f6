//! Whatever heuristic shares the paths among the strategies, the image is the same: known radiance in furnaces, that of
//! the balance heuristic elsewhere.

use crate::common::{
    Stage,
    claims::{Claims, Sample},
    pieces::*,
    strategies,
};
use serde_json::{Value, json};
use tyndall::{
    settings::heuristic::Heuristic,
    transport::{Strategies, profiles::ProfileName},
};

const SEEDS: u64 = 12;

/// Those whose variance has a bound wherever that of the balance heuristic has one.
const SOUND: [&str; 4] = ["power", "maximum", "cutoff", "cutoff:0.6"];
const UNIFORM: [&str; 1] = ["uniform"];

/// Images of `parts` by bidirectional path tracing under a heuristic, with `set` of its strategies.
fn measure(parts: &[(&str, Value)], heuristic: &str, set: Strategies, samples: u64, first: u64) -> Sample {
    let integrator = json!({"type": "bdpt", "max_depth": 24, "heuristic": heuristic});
    let parts = [parts, &[("integrator", integrator)]].concat();
    let stage = Stage::new(&scene(&parts));
    assert_eq!(Heuristic::parse(heuristic), Ok(stage.setup.integrator.options.heuristic));
    Sample::of(&stage.renders(set, samples, first..first + SEEDS), stage.width())
}

/// All of `heuristics` against the balance heuristic with all strategies.
fn all_agree(
    name: &str,
    parts: &[(&str, Value)],
    heuristics: &[&str],
    set: Strategies,
    samples: u64,
    claims: &mut Claims,
) {
    let balance = measure(parts, "balance", Strategies::BDPT, samples, 0);
    for (index, heuristic) in heuristics.iter().enumerate() {
        let found = measure(parts, heuristic, set, samples, 1000 * (index as u64 + 1));
        claims.equal(&format!("{name}: {heuristic} against balance"), &found, &balance);
    }
}

/// A hollow ball of radius 1 around the camera whose wall reflects a half and shines: radiance is twice its own
/// everywhere, whatever fog that absorbs nothing fills it. Without fog all joins within it have the same density.
fn furnace(fog: Option<Value>) -> Vec<(&'static str, Value)> {
    let shell = json!({
        "type": "sphere", "radius": 1, "flip_normals": true, "bsdf": diffuse(0.5),
        "emitter": {"type": "area", "radiance": 1.5},
    });
    let view = camera([0.0, 0.0, 0.2], [0.0, 0.0, -1.0], 8);
    match fog {
        None => vec![("sensor", view), ("shell", shell)],
        Some(fog) => vec![
            ("fog", fog),
            ("sensor", with(view, &[("medium", named("fog"))])),
            ("shell", with(shell, &[("exterior", named("fog"))])),
        ],
    }
}

#[test]
fn furnaces_are_as_bright_as_they_must_be() {
    let mut claims = Claims::new();
    for (index, heuristic) in [&SOUND[..], &UNIFORM].concat().into_iter().enumerate() {
        let found = measure(&furnace(None), heuristic, Strategies::BDPT, 64, 1000 * index as u64);
        claims.equal_to(&format!("furnace: {heuristic}"), &found, 3.0);
    }
    for (index, heuristic) in SOUND.iter().enumerate() {
        for fog in [medium(0.7, 1.0, 0.4), medium(rgb(0.3, 0.6, 1.2), 1.0, 0.0)] {
            let found = measure(&furnace(Some(fog)), heuristic, Strategies::BDPT, 64, 1000 * index as u64);
            claims.equal_to(&format!("furnace of fog: {heuristic}"), &found, 3.0);
        }
    }
    claims.settle();
}

/// Fog in a room whose camera looks past a lamp.
fn foggy_room(fog: Value) -> Vec<(&'static str, Value)> {
    vec![
        ("sensor", camera([0.0, 0.0, 0.9], [0.0, 0.0, -1.0], 8)),
        ("fog", fog),
        ("room", room(0.6, Some(named("fog")))),
        ("lamp", lamp_ball([0.2, 0.3, -0.3], 0.3, rgb(2.0, 3.0, 1.0))),
    ]
}

#[test]
fn in_rooms_of_fog() {
    let mut claims = Claims::new();
    let grey = foggy_room(medium(1.0, 0.8, 0.3));
    all_agree("grey fog", &grey, &SOUND, Strategies::BDPT, 64, &mut claims);
    let chromatic = foggy_room(medium(rgb(0.2, 1.0, 3.0), rgb(0.9, 0.7, 0.8), -0.2));
    all_agree("chromatic fog", &chromatic, &SOUND, Strategies::BDPT, 96, &mut claims);
    claims.settle();
}

#[test]
fn around_a_glass_ball_of_fog() {
    let glass = json!({
        "type": "sphere", "center": [0, -0.2, -0.2], "radius": 0.6,
        "bsdf": {"type": "dielectric", "int_ior": 1.5}, "interior": medium(rgb(1.0, 2.0, 3.0), 0.95, 0.3),
    });
    let parts = [
        ("sensor", camera([0.0, 0.0, 0.9], [0.0, 0.0, -1.0], 8)),
        ("room", room(0.5, None)),
        ("lamp", lamp_panel([0.0, 0.9, 0.0], 0.7, 2.0)),
        ("glass", glass),
    ];
    let mut claims = Claims::new();
    all_agree("glass ball of fog", &parts, &SOUND, Strategies::BDPT, 96, &mut claims);
    claims.settle();
}

/// Light, camera and what scatters stay apart, and nothing that scatters is joined with what does: short segments are
/// what the uniform heuristic cannot stand.
#[test]
fn uniform_where_its_variance_is_finite() {
    let cloud = |sigma_t: Value| {
        vec![
            ("sensor", camera([0.0, 0.5, 3.5], [0.0, 0.0, 0.0], 8)),
            ("cloud", null_ball([0.0, 0.0, 0.0], 0.8, medium(sigma_t, 0.9, 0.2))),
            ("lamp", lamp_panel([0.0, 2.5, 0.0], 0.8, 3.0)),
            ("sky", sky(0.2)),
        ]
    };
    let pearl = json!({"type": "sphere", "radius": 0.4, "bsdf": {"type": "plastic"}});
    let mut claims = Claims::new();
    let set = strategies("hit+next-event+lens");
    all_agree("grey cloud", &cloud(json!(1.0)), &UNIFORM, set, 128, &mut claims);
    all_agree("chromatic cloud", &cloud(rgb(0.3, 1.0, 3.0)), &UNIFORM, set, 128, &mut claims);
    let around = [cloud(rgb(0.3, 1.0, 3.0)), vec![("pearl", pearl)]].concat();
    all_agree("cloud around a pearl", &around, &UNIFORM, set, 128, &mut claims);
    claims.settle();
}

#[test]
fn only_the_balance_heuristic_runs_on_every_profile() {
    for (_, heuristic) in Heuristic::NAMES {
        let fog = ProfileName::Fog.weighing(heuristic);
        let expected =
            if heuristic == Heuristic::Balance { ProfileName::Fog } else { ProfileName::Everything };
        assert_eq!(fog, expected, "{heuristic}");
    }
}
