//! Where light subpaths start changes the noise, not the image: for emitters of all kinds, whatever was learnt.

use crate::common::{
    Stage,
    claims::{Claims, Sample},
    pieces::*,
};
use serde_json::{Value, json};
use tyndall::transport::{Effort, LightStarts, Sky, Strategies};

fn panel(emitter: Value) -> Value {
    with(lamp_panel([0.1, 0.85, -0.2], 0.25, 1.0), &[("emitter", emitter)])
}

/// In a closed room: shapes, some of them dark towards most of it, a beam, points.
fn lamps() -> Value {
    let projector = json!({"type": "projector", "fov": 40, "irradiance": 2.0,
        "to_world": [{"type": "lookat", "origin": [-0.6, 0.6, 0.5], "target": [0.4, -0.9, -0.3], "up": [0, 1, 0]}]});
    scene(&[
        ("sensor", camera([0.0, 0.0, 0.9], [0.0, 0.0, -1.0], 8)),
        ("room", room(0.6, Some(medium(0.7, 0.8, 0.3)))),
        ("ball", lamp_ball([0.4, -0.3, -0.4], 0.2, rgb(2.0, 3.0, 1.0))),
        ("panel", panel(json!({"type": "area", "radiance": 2.0}))),
        (
            "beam",
            with(
                lamp_panel([-0.5, 0.85, 0.2], 0.2, 1.0),
                &[("emitter", json!({"type": "directionalarea", "radiance": 4.0}))],
            ),
        ),
        ("point", point([-0.5, 0.5, 0.0], 0.3)),
        ("spot", spot([0.5, 0.5, 0.5], [0.0, -1.0, 0.0], 1.0)),
        ("projector", projector),
    ])
}

/// Under sky and sun: what is lit fills a small part of what starts from infinity reach.
fn outdoors() -> Value {
    let smoke = json!({"type": "heterogeneous", "tracker": "null_collision", "scale": 2, "albedo": 0.8,
        "sigma_t": {"type": "exponential", "height": -0.8, "scale_height": 0.8}});
    scene(&[
        ("sensor", camera([0.0, 0.3, 1.2], [0.0, 0.2, 0.0], 8)),
        ("floor", floor(-0.6, 4.0, 0.5)),
        ("roof", floor(1.0, 0.7, 0.5)),
        ("cloud", null_box([-0.8, -0.4, -0.8], [0.8, 0.8, 0.8], Some(smoke))),
        ("sky", sky(0.5)),
        ("sun", sun([0.3, -1.0, -0.2], 1.0)),
        ("searchlight", beam([2.0, 3.0, 0.5], [-1.0, -1.2, -0.2], 2.0, rgb(0.5, 1.0, 2.0))),
    ])
}

/// Whether next-event estimation connects to the sky changes the noise, not the image.
#[test]
fn a_sky_that_is_hit_only_shows_the_same() {
    let mut claims = Claims::new();
    let mut stage = Stage::new(&outdoors());
    let mut measure = |strategies: Strategies, effort: Effort, first: u64| {
        stage.setup.integrator.options.effort = effort;
        Sample::of(&stage.renders(strategies, 100, first..first + 24), stage.width())
    };
    let usual = measure(Strategies::BDPT, Effort::default(), 0);
    let hit = Effort { sky: Sky::Hit, ..Effort::default() };
    claims.equal("pt", &measure(Strategies::PT, hit, 1000), &usual);
    claims.equal("bdpt", &measure(Strategies::BDPT, hit, 2000), &usual);
    let learnt = Effort { starts: LightStarts::Learnt, light_walks: 2.0, connections: 2, ..hit };
    claims.equal("bdpt, learnt", &measure(Strategies::BDPT, learnt, 3000), &usual);
    claims.settle();
}

/// A medium that shines, and a lamp in it.
fn fire() -> Value {
    let mut fire = medium(1.0, 0.7, 0.2);
    fire["emission"] = rgb(0.5, 0.3, 0.1);
    scene(&[
        ("sensor", camera([0.0, 0.6, 3.2], [0.0, 0.2, 0.0], 8)),
        ("floor", floor(-0.6, 2.0, 0.5)),
        ("fire", null_box([-0.5, -0.4, -0.5], [0.5, 0.6, 0.5], Some(fire))),
        ("ball", lamp_ball([1.2, 0.5, 0.0], 0.2, 1.0)),
    ])
}

/// The same scenes with glass that light subpaths may aim at, and the smoke.
#[test]
fn aimed_starts_show_the_same() {
    let glass = json!({"type": "sphere", "center": [0.35, -0.1, 0.3], "radius": 0.15,
        "bsdf": {"type": "roughdielectric", "alpha": 0.2}});
    let mut claims = Claims::new();
    for (name, scene) in [("lamps", lamps()), ("outdoors", outdoors()), ("fire", fire())] {
        let mut stage = Stage::new(&with(scene, &[("glass", glass.clone())]));
        assert!(stage.setup.scene.aimed_starts().is_some(), "{name}: nothing to aim at");
        let mut measure = |strategies: Strategies, starts: LightStarts, first: u64| {
            stage.setup.integrator.options.effort = Effort { starts, ..Effort::default() };
            Sample::of(&stage.renders(strategies, 100, first..first + 24), stage.width())
        };
        for (strategies, first) in [(Strategies::BDPT, 0), (Strategies::LT, 2000)] {
            let usual = measure(strategies, LightStarts::Emitted, first);
            let aimed = measure(strategies, LightStarts::Aimed, first + 1000);
            claims.equal(&format!("{name}, {strategies:?}"), &aimed, &usual);
        }
    }
    claims.settle();
}

#[test]
fn learnt_starts_show_the_same() {
    let mut claims = Claims::new();
    let learnt = Effort { starts: LightStarts::Learnt, ..Effort::default() };
    for (name, scene) in [("lamps", lamps()), ("outdoors", outdoors()), ("fire", fire())] {
        let mut stage = Stage::new(&scene);
        let mut measure = |strategies: Strategies, effort: Effort, first: u64| {
            stage.setup.integrator.options.effort = effort;
            Sample::of(&stage.renders(strategies, 100, first..first + 24), stage.width())
        };
        let usual = measure(Strategies::BDPT, Effort::default(), 0);
        let more = Effort { light_walks: 2.0, connections: 2, ..learnt };
        claims.equal(&format!("{name}, bdpt"), &measure(Strategies::BDPT, learnt, 1000), &usual);
        claims.equal(&format!("{name}, more"), &measure(Strategies::BDPT, more, 2000), &usual);
        let unseen = Strategies { emitter_hit: false, ..Strategies::BDPT };
        claims.equal(&format!("{name}, no hits"), &measure(unseen, learnt, 3000), &usual);
        let all = measure(Strategies::LT, Effort::default(), 4000);
        claims.equal(&format!("{name}, lt"), &measure(Strategies::LT, learnt, 5000), &all);
    }
    claims.settle();
}
