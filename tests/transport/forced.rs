//! Forced interaction shows the same image as walks that are left to chance, and with less noise where media are thin.

use crate::common::{
    self, Stage,
    claims::{Claims, Sample},
    pieces::*,
    strategies,
};
use serde_json::{Value, json};
use tyndall::{math::Spectrum, transport::Strategies};

/// A scene whose primary rays force an interaction.
fn forced(scene: &Value) -> Stage {
    let mut stage = Stage::new(scene);
    stage.setup.integrator.options.forced_interaction = true;
    stage
}

#[test]
fn a_scene_may_ask_for_it() {
    let requested = |more: Value| {
        let parts =
            [("sensor", camera([0.0, 1.0, 3.0], [0.0; 3], 8)), ("sky", sky(1.0)), ("integrator", more)];
        Stage::new(&scene(&parts)).setup.integrator.options.forced_interaction
    };
    assert!(requested(json!({"type": "volpath", "forced_interaction": true})));
    assert!(!requested(json!({"type": "bdpt"})));
}

const SEEDS: u64 = 16;

/// Forced and unforced images by some sets of strategies, each with seeds of its own.
fn agrees(name: &str, scene: &Value, sets: &[Strategies], samples_per_pixel: u64) {
    let (plain, forced) = (Stage::new(scene), forced(scene));
    let mut claims = Claims::new();
    for (i, set) in sets.iter().enumerate() {
        let first = 1000 * i as u64;
        let measure = |stage: &Stage, first| {
            Sample::of(&stage.renders(*set, samples_per_pixel, first..first + SEEDS), stage.width())
        };
        let what = format!("{name}: {} forced", common::name_of(*set));
        claims.equal(&what, &measure(&forced, first), &measure(&plain, first + 500));
    }
    claims.settle();
}

const USUAL: [Strategies; 2] = [Strategies::PT, Strategies::BDPT];

fn foggy_room(fog: Value) -> Vec<(&'static str, Value)> {
    vec![
        ("sensor", camera([0.0, 0.0, 0.9], [0.0, 0.0, -1.0], 8)),
        ("fog", fog),
        ("room", room(0.6, Some(named("fog")))),
        ("lamp", lamp_ball([0.2, 0.3, -0.3], 0.3, rgb(2.0, 3.0, 1.0))),
    ]
}

/// A cloud seen from outside.
fn cloud(interior: Value) -> Vec<(&'static str, Value)> {
    vec![
        ("sensor", camera([0.0, 0.6, 3.2], [0.0, 0.2, 0.0], 8)),
        ("floor", floor(-0.6, 2.0, 0.5)),
        ("cloud", null_box([-0.8, -0.4, -0.8], [0.8, 0.8, 0.8], Some(interior))),
        ("sky", sky(0.5)),
        ("sun", sun([0.3, -1.0, -0.2], 1.0)),
    ]
}

#[test]
fn in_thin_and_thick_fog() {
    for sigma_t in [0.02, 1.0, 30.0] {
        let fog = medium(sigma_t, 0.8, 0.3);
        // By chance, thick fog lets no camera subpath through to the lamp.
        let alone = [USUAL[0], USUAL[1], strategies("hit+lens"), strategies("hit")];
        let sets = if sigma_t > 10.0 { &alone[..3] } else { &alone };
        agrees(&format!("fog of {sigma_t}"), &scene(&foggy_room(fog)), sets, 48);
    }
}

#[test]
fn in_chromatic_fog() {
    let fog = medium(rgb(0.02, 1.0, 3.0), rgb(0.9, 0.7, 0.8), -0.2);
    agrees("chromatic fog", &scene(&foggy_room(fog)), &USUAL, 96);
    // What one channel does not see at all.
    let stain = medium(rgb(0.0, 0.1, 20.0), 0.9, 0.0);
    agrees("stain", &scene(&cloud(stain)), &USUAL, 96);
}

#[test]
fn around_a_cloud_under_the_sky() {
    for sigma_t in [json!(0.05), json!(4.0), rgb(0.3, 1.0, 2.0)] {
        agrees(&format!("cloud of {sigma_t}"), &scene(&cloud(medium(sigma_t, 0.9, 0.3))), &USUAL, 64);
    }
}

#[test]
fn in_fog_without_end() {
    let parts = [
        ("sensor", with(camera([0.0, 0.2, 1.5], [0.0, 0.0, 0.0], 8), &[("medium", named("fog"))])),
        ("fog", medium(rgb(0.2, 0.5, 1.0), 0.9, 0.3)),
        ("floor", with(floor(-0.6, 1.0, 0.5), &[("exterior", named("fog")), ("interior", named("fog"))])),
        ("lamp", with(lamp_ball([0.2, 0.4, -0.3], 0.3, 3.0), &[("exterior", named("fog"))])),
    ];
    agrees("endless", &scene(&parts), &USUAL, 512);
}

/// Smoke that varies, seen from outside or (`inside`) from within.
fn smoky(sigma_t: Value, tracker: &str, inside: bool, scale: f64) -> Value {
    let smoke = json!({"type": "heterogeneous", "tracker": tracker, "scale": scale, "sigma_t": sigma_t,
                       "albedo": 0.8, "phase": {"type": "hg", "g": 0.3}});
    let eye = if inside { [0.3, 0.1, 0.6] } else { [0.0, 0.6, 3.2] };
    scene(&[
        ("sensor", camera(eye, [0.0, 0.0, -0.3], 8)),
        ("floor", floor(-0.9, 2.0, 0.5)),
        ("smoke", null_box([-0.8, -0.8, -0.8], [0.8, 0.8, 0.8], Some(smoke))),
        ("ball", lamp_ball([0.2, -0.1, 0.1], 0.2, rgb(0.5, 0.3, 0.1))),
        ("sky", sky(rgb(0.3, 0.4, 0.6))),
    ])
}

fn waves() -> Value {
    json!({"type": "cosine", "constant": 1, "a": {"type": "wave", "amplitude": 0.9, "vector": [4, 2, 1]}})
}

#[test]
fn in_smoke_that_varies_by_every_tracker() {
    for tracker in ["closed_form", "march", "null_collision", "residual_ratio"] {
        for (scale, inside) in [(0.05, false), (2.0, false), (2.0, true)] {
            let name = format!("smoke of {scale} by {tracker}, inside {inside}");
            agrees(&name, &smoky(waves(), tracker, inside, scale), &USUAL[..1], 64);
        }
    }
    agrees("by both sides", &smoky(waves(), "null_collision", false, 2.0), &USUAL[1..], 48);
}

/// Wisps with nothing between them: cells whose mean says nothing, and light that misses them.
#[test]
fn in_chromatic_wisps_by_null_collisions() {
    let noise = json!({"type": "noise", "octaves": 3, "frequency": 3, "bias": -0.2, "amplitude": 1});
    let wisps =
        json!({"type": "product", "a": {"type": "constvolume", "value": rgb(0.3, 1.0, 2.5)}, "b": noise});
    for tracker in ["null_collision", "residual_ratio"] {
        agrees(&format!("wisps by {tracker}"), &smoky(wisps.clone(), tracker, false, 2.0), &USUAL, 96);
    }
}

/// Two clouds, a boundary that is half there, panes, and a lamp that is not seen.
#[test]
fn behind_what_lets_a_part_through() {
    let gauze = json!({"type": "mask", "opacity": 0.4, "b": diffuse(rgb(0.2, 0.5, 0.8))});
    let pane = json!({
        "type": "rectangle", "to_world": place([0.8, 0.8, 1.0], [0.0, 0.0, 0.2]),
        "bsdf": {"type": "thindielectric"},
    });
    let wrapped = json!({
        "type": "sphere", "center": [-0.3, -0.2, -0.4], "radius": 0.4, "bsdf": gauze,
        "interior": medium(2.0, 0.9, 0.2), "exterior": named("fog"),
    });
    let mut parts = foggy_room(medium(0.3, 0.8, 0.3));
    parts.push(("pane", pane));
    parts.push(("wrapped", wrapped));
    agrees("gauze and pane", &scene(&parts), &USUAL, 128);
    parts.push(("integrator", json!({"type": "bdpt", "hide_emitters": true, "max_depth": 4})));
    agrees("hidden lamp", &scene(&parts), &USUAL, 128);
}

#[test]
fn behind_glass() {
    let glass = json!({
        "type": "sphere", "center": [0, -0.2, -0.2], "radius": 0.6,
        "bsdf": {"type": "dielectric", "int_ior": 1.5}, "interior": medium(1.5, 0.9, 0.5),
    });
    let parts = [
        ("sensor", camera([0.0, 0.0, 0.95], [0.0, 0.0, 0.0], 8)),
        ("room", room(0.5, None)),
        ("lamp", lamp_panel([0.0, 0.9, 0.0], 0.7, 2.0)),
        ("glass", glass),
    ];
    agrees("fog in glass", &scene(&parts), &USUAL, 96);
}

#[test]
fn in_media_that_shine() {
    let shining = |medium: Value| with(medium, &[("radiance", rgb(1.0, 0.5, 0.2))]);
    let sets = [USUAL[0], USUAL[1], strategies("hit"), strategies("hit+lens")];
    agrees("glow", &scene(&foggy_room(shining(medium(0.7, 0.6, 0.3)))), &sets, 64);
    agrees("chromatic glow", &scene(&cloud(shining(medium(rgb(0.3, 1.0, 2.0), 0.6, 0.3)))), &USUAL, 64);
    for tracker in ["closed_form", "null_collision"] {
        let smoke = json!({"type": "heterogeneous", "tracker": tracker, "scale": 1.5, "sigma_t": waves(),
                           "albedo": 0.6});
        agrees(&format!("fire by {tracker}"), &scene(&cloud(shining(smoke))), &USUAL, 64);
    }
}

/// A slab 1 m thick that emits and absorbs, seen straight: 1 - exp(-tau).
#[test]
fn a_slab_that_glows_is_exact() {
    let view = json!([{"type": "scale", "value": [0.2, 0.2, 1]},
        {"type": "lookat", "origin": [0, 0, 3], "target": [0, 0, 0], "up": [0, 1, 0]}]);
    let film = json!({"type": "hdrfilm", "width": 2, "height": 2, "rfilter": {"type": "box"}});
    let sensor = json!({"type": "orthographic", "to_world": view, "film": film});
    let mut claims = Claims::new();
    for tau in [1e-3, 0.1, 1.0, 10.0] {
        let slab = json!({"type": "homogeneous", "sigma_t": tau, "albedo": 0, "radiance": 1});
        let parts =
            [("sensor", sensor.clone()), ("slab", null_box([-0.5, -0.5, -0.5], [0.5, 0.5, 0.5], Some(slab)))];
        let stage = forced(&scene(&parts));
        for set in ["hit", "hit+lens", "hit+next-event+join+lens"] {
            let images = stage.renders(strategies(set), 400, 0..16);
            claims.every_pixel(&format!("slab of {tau} by {set}"), &images, -f64::exp_m1(-tau));
        }
    }
    claims.settle();
}

/// Mean over pixels of the variance of a sample.
fn variance(stage: &Stage, set: Strategies) -> f64 {
    let (samples, seeds) = (16, 24u64);
    let images: Vec<Vec<Spectrum>> = stage.renders(set, samples, 0..seeds);
    let pixel = |i: usize| {
        let values: Vec<f64> = images.iter().map(|image| f64::from(image[i].y)).collect();
        let mean = values.iter().sum::<f64>() / seeds as f64;
        values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (seeds - 1) as f64
    };
    (0..images[0].len()).map(pixel).sum::<f64>() * samples as f64 / images[0].len() as f64
}

/// A thin cloud before nothing: all that is seen of it is one collision in fifty samples, or one in each.
#[test]
fn thin_media_are_less_noisy() {
    let parts = [
        ("sensor", camera([0.0, 0.2, 3.0], [0.0, 0.0, 0.0], 8)),
        ("cloud", null_ball([0.0; 3], 1.0, medium(0.01, 0.9, 0.3))),
        ("sun", sun([0.3, -1.0, -0.2], 10.0)),
    ];
    let scene = scene(&parts);
    for (set, factor) in [(Strategies::PT, 100.0), (Strategies::BDPT, 50.0)] {
        let (chance, forced) = (variance(&Stage::new(&scene), set), variance(&forced(&scene), set));
        assert!(factor * forced < chance, "{}: {chance} {forced}", common::name_of(set));
    }
}
