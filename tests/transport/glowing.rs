//! Emissive media, against closed forms: slabs that emit and absorb, and rooms of one temperature.

use crate::common::{Stage, claims::Claims, name_of, pieces::*, strategies};
use serde_json::{Value, json};
use tyndall::transport::{Strategies, profiles::ProfileName};

/// A slab 1 m thick, seen by parallel rays that cross it straight.
fn slab(medium: Value) -> Value {
    let view = json!([{"type": "scale", "value": [0.2, 0.2, 1]},
        {"type": "lookat", "origin": [0, 0, 3], "target": [0, 0, 0], "up": [0, 1, 0]}]);
    let sensor = json!({
        "type": "orthographic", "to_world": view,
        "film": {"type": "hdrfilm", "width": 2, "height": 2, "rfilter": {"type": "box"}},
    });
    scene(&[("sensor", sensor), ("slab", null_box([-0.5, -0.5, -0.5], [0.5, 0.5, 0.5], Some(medium)))])
}

fn absorbing(kind: &str, sigma_t: f64) -> Value {
    json!({"type": kind, "sigma_t": sigma_t, "albedo": 0, "radiance": 1})
}

const ALONE: [&str; 5] = ["hit", "lens", "hit+next-event", "hit+lens", "hit+next-event+join+lens"];

/// The claim that every pixel of `scene` is `expected`, by every set of strategies.
fn shows(claims: &mut Claims, what: &str, scene: &Value, expected: f64, sets: &[&str], samples: u64) {
    let stage = Stage::new(scene);
    for (i, set) in sets.iter().enumerate() {
        let first = 1000 * i as u64;
        let images = stage.renders(strategies(set), samples, first..first + 16);
        claims.every_pixel(&format!("{what} by {set}"), &images, expected);
    }
}

/// 1 - exp(-tau), whatever the tracker is.
#[test]
fn a_slab_that_emits_and_absorbs() {
    let mut claims = Claims::new();
    for tau in [1e-3, 0.1, 1.0, 10.0, 1e3] {
        let expected = -f64::exp_m1(-tau);
        let samples = if tau > 10.0 { 4000 } else { 400 };
        let name = format!("slab of {tau}");
        shows(&mut claims, &name, &slab(absorbing("homogeneous", tau)), expected, &ALONE, samples);
    }
    // A number would fill the unit cube alone.
    let around = json!([{"type": "scale", "value": 2}, {"type": "translate", "value": [-1, -1, -1]}]);
    let even = json!({"type": "constvolume", "value": 2, "to_world": around});
    for tracker in ["auto", "march", "null_collision", "residual_ratio"] {
        let more = [("sigma_t", even.clone()), ("tracker", json!(tracker))];
        let medium = with(absorbing("heterogeneous", 2.0), &more);
        shows(&mut claims, tracker, &slab(medium), -f64::exp_m1(-2.0), &ALONE, 400);
    }
    claims.settle();
}

/// Light of matter that does not absorb: its thickness times the gain.
#[test]
fn a_slab_that_only_emits() {
    let mut claims = Claims::new();
    for kind in ["homogeneous", "heterogeneous"] {
        let neon = json!({"type": kind, "sigma_t": 0, "emission": 3, "emission_scale": 0.5});
        shows(&mut claims, kind, &slab(neon), 1.5, &ALONE, 100);
    }
    claims.settle();
}

/// Absorption and emission that vary: the integral of the gain times what is left of it. With sigma_t = s e^-z and a
/// gain of j e^-z the depth is its own variable: j/s (1 - exp(-tau)).
#[test]
fn a_slab_of_exponential_density() {
    let layers = json!({"type": "exponential", "up": [0, 0, 1], "scale_height": 0.3, "height": 0.2});
    let tau = 0.3 * 2.0 * ((0.7f64 / 0.3).exp() - (-0.3f64 / 0.3).exp());
    let expected = 0.75 * -f64::exp_m1(-tau);
    let mut claims = Claims::new();
    for tracker in ["auto", "null_collision", "residual_ratio"] {
        let given =
            json!({"type": "heterogeneous", "sigma_t": layers, "scale": 2, "albedo": 0, "tracker": tracker});
        for (name, factor) in [("emission", 1.5), ("radiance", 0.75)] {
            let value = if name == "emission" { layers.clone() } else { json!(1) };
            let medium = with(given.clone(), &[(name, value), ("emission_scale", json!(factor))]);
            let what = format!("{name}, {tracker}");
            shows(&mut claims, &what, &slab(medium), expected, &ALONE[2..], 400);
        }
    }
    claims.settle();
}

/// A room of one temperature looks the same everywhere, whatever is in it (Kirchhoff): walls that emit what they
/// do not reflect, fog that emits what it does not scatter.
fn isothermal(fog: Value, reflectance: f64) -> Value {
    let walls = with(
        room(reflectance, Some(fog)),
        &[("emitter", json!({"type": "area", "radiance": 1.0 - reflectance}))],
    );
    scene(&[("sensor", camera([0.1, 0.2, 0.8], [0.0, 0.0, -1.0], 2)), ("walls", walls)])
}

#[test]
fn rooms_of_one_temperature() {
    let grey = |sigma_t: f64, albedo: f64| with(medium(sigma_t, albedo, 0.4), &[("radiance", json!(1))]);
    let chromatic = with(medium(rgb(0.3, 1.0, 3.0), rgb(0.9, 0.5, 0.0), 0.0), &[("radiance", json!(1))]);
    let varying = json!({"type": "heterogeneous", "albedo": 0.7, "radiance": 1, "scale": 2,
        "sigma_t": {"type": "exponential", "scale_height": 0.5}});
    let tracked = with(varying.clone(), &[("tracker", json!("null_collision"))]);
    let coloured = with(
        tracked.clone(),
        &[
            ("scale", json!(1)),
            (
                "sigma_t",
                json!({"type": "product",
        "a": {"type": "constvolume", "value": rgb(0.3, 1.0, 3.0)},
        "b": {"type": "exponential", "scale_height": 0.8}}),
            ),
        ],
    );
    let mut claims = Claims::new();
    let sets = ["hit", "hit+next-event", "hit+lens", "hit+next-event+join+lens"];
    for (name, fog, reflectance, profile) in [
        ("black walls", grey(1.0, 0.7), 0.0, ProfileName::Fire),
        ("white fog", grey(2.0, 0.95), 0.5, ProfileName::Fire),
        ("black fog", grey(3.0, 0.0), 0.5, ProfileName::Fire),
        ("chromatic", chromatic, 0.3, ProfileName::Everything),
        ("varying", varying, 0.3, ProfileName::Fire),
        ("null collisions", tracked, 0.3, ProfileName::Fire),
        ("null collisions in colour", coloured, 0.3, ProfileName::Everything),
    ] {
        let scene = isothermal(fog, reflectance);
        assert_eq!(Stage::new(&scene).profile, profile, "{name}");
        shows(&mut claims, name, &scene, 1.0, &sets, 500);
    }
    claims.settle();
}

/// Emission seen directly is a path of one segment; hiding emitters hides surfaces, not media.
#[test]
fn depth_counts_and_media_are_not_hidden() {
    let mut claims = Claims::new();
    let given = slab(absorbing("homogeneous", 1.0));
    let by = |integrator: Value| with(given.clone(), &[("integrator", integrator)]);
    let expected = -f64::exp_m1(-1.0);
    shows(&mut claims, "one segment", &by(depth(1)), expected, &ALONE, 200);
    let hiding = json!({"type": "bdpt", "hide_emitters": true});
    shows(&mut claims, "hidden", &by(hiding), expected, &ALONE, 200);
    claims.settle();
    let dark = Stage::new(&by(depth(0))).render(Strategies::BDPT, 2, 0);
    assert!(dark.iter().all(|pixel| pixel.max_element() == 0.0), "{}", name_of(Strategies::BDPT));
}

/// A ball in its box: half of the points sampled lie outside and must not shine. The power that arrives far away is
/// that of the ball: 4 pi j V.
#[test]
fn light_starts_within_the_medium_only() {
    let ball = null_ball([0.0; 3], 0.5, json!({"type": "homogeneous", "sigma_t": 0, "emission": 2}));
    let scene = scene(&[("sensor", camera([0.0, 0.0, 3.0], [0.0; 3], 2)), ("ball", ball)]);
    let setup = Stage::new(&scene).setup;
    let power = setup.scene.lights.all[0].emitter.power(0.0, 1.0);
    let expected = 4.0 * std::f64::consts::PI * 2.0 * std::f64::consts::PI / 6.0;
    assert!((power / expected - 1.0).abs() < 0.1, "{power} {expected}");
    // The mean radiance of the image by quadrature: chords of the ball through a view of 45 degrees.
    let n = 400;
    let half = f64::to_radians(22.5).tan();
    let chord = |i: i32, j: i32| {
        let at = |i: i32| ((f64::from(i) + 0.5) / f64::from(n) * 2.0 - 1.0) * half;
        let (x, y) = (at(i), at(j));
        let distance = 3.0 * ((x * x + y * y) / (1.0 + x * x + y * y)).sqrt();
        2.0 * (0.25 - distance * distance).max(0.0).sqrt()
    };
    let mean: f64 = (0..n * n).map(|k| chord(k % n, k / n)).sum::<f64>() / f64::from(n * n);
    let mut claims = Claims::new();
    shows(&mut claims, "ball", &scene, 2.0 * mean, &ALONE, 400);
    claims.settle();
}
