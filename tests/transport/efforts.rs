//! How often strategies run and how long walks are changes the noise, not the image; and what a pilot chooses.

use crate::common::{
    Stage,
    claims::{Claims, Sample},
    pieces::*,
};
use serde_json::{Value, json};
use tyndall::{
    learning::pilot::{self, Choice, Decided},
    passes::{Settings, budget::Budget},
    transport::{Effort, Strategies, Survival},
};

fn foggy_room(fog: Value) -> Value {
    scene(&[
        ("sensor", camera([0.0, 0.0, 0.9], [0.0, 0.0, -1.0], 8)),
        ("room", room(0.6, Some(fog))),
        ("lamp", lamp_ball([0.2, 0.3, -0.3], 0.3, rgb(2.0, 3.0, 1.0))),
        ("point", point([-0.5, 0.5, 0.0], 0.3)),
    ])
}

const EFFORTS: [Effort; 4] = [
    Effort { survival: Survival::FourthRoot, ..Effort::EQUAL },
    Effort { light_walks: 0.5, connections: 4, ..Effort::EQUAL },
    Effort { light_walks: 2.0, connections: 2, ..Effort::EQUAL },
    Effort { survival: Survival::FourthRoot, light_walks: 0.3, connections: 3, ..Effort::EQUAL },
];

#[test]
fn every_effort_shows_the_same() {
    let mut claims = Claims::new();
    for (name, scene) in [
        ("fog", foggy_room(medium(1.0, 0.8, 0.3))),
        ("chromatic fog", foggy_room(medium(rgb(0.3, 1.0, 2.0), rgb(0.9, 0.5, 0.8), 0.3))),
        ("cloud", cloud_under_sky(&[])),
    ] {
        let mut stage = Stage::new(&scene);
        let mut measure = |effort: Effort, first: u64| {
            stage.setup.integrator.options.effort = effort;
            Sample::of(&stage.renders(Strategies::BDPT, 100, first..first + 24), stage.width())
        };
        let usual = measure(Effort::default(), 0);
        for (i, effort) in EFFORTS.into_iter().enumerate() {
            claims.equal(&format!("{name}: {effort:?}"), &measure(effort, 1000 * (i as u64 + 1)), &usual);
        }
    }
    claims.settle();
}

fn chosen(scene: &Value) -> Choice {
    let stage = Stage::new(scene);
    let settings = stage.settings(Strategies::BDPT, 1, 0);
    let settings = Settings { budget: Budget::ENDLESS, ..settings };
    pilot::choose(&stage.setup.scene, &stage.setup.film, &settings, Decided::default()).choice
}

/// Light subpaths find little of a scene without walls under a sky, and all that lights a room by its ceiling.
#[test]
fn a_pilot_leaves_out_what_does_not_pay() {
    let open = chosen(&cloud_under_sky(&[]));
    assert!(!open.strategies.need_light_walks() && open.gain > 1.1, "{open:?}");
    let lamp = |direction: [f64; 3]| {
        let target: Vec<f64> = (0..3).map(|i| [0.0, 0.5, 0.0][i] + direction[i]).collect();
        spot([0.0, 0.5, 0.0], [target[0], target[1], target[2]], 1.0)
    };
    let closed = chosen(&scene(&[
        ("sensor", camera([0.0, -0.5, 0.9], [0.0, -0.5, -1.0], 8)),
        ("room", room(0.6, Some(medium(1.0, 0.8, 0.3)))),
        ("lamp", lamp([0.0, 1.0, 0.0])),
    ]));
    assert!(closed.strategies.connection && closed.strategies.lens, "{closed:?}");
}

/// The light of a point lamp through glass is reached by light subpaths alone. Pilots may not see it.
#[test]
fn a_pilot_leaves_out_no_light() {
    let glass =
        with(null_ball([40.0, -30.0, -50.0], 0.01, json!({})), &[("bsdf", json!({"type": "dielectric"}))]);
    let mut glass = glass;
    glass.as_object_mut().unwrap().remove("interior");
    let mut parts = vec![
        ("sensor", camera([0.0, 0.6, 3.2], [0.0, 0.2, 0.0], 8)),
        ("floor", floor(-0.6, 2.0, 0.5)),
        ("sky", sky(0.5)),
        ("lamp", point([0.0, 3.0, 0.0], 0.001)),
    ];
    assert_eq!(chosen(&scene(&parts)).strategies, Strategies::PT);
    parts.push(("glass", glass));
    let choice = chosen(&scene(&parts));
    assert!(choice.strategies.lens && choice.strategies.connection, "{choice:?}");
}
