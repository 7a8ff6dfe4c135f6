//! A guide changes the noise, not the image: in every kind of scene, by every integrator.

use crate::common::{
    Stage,
    claims::{Claims, Sample},
    pieces::*,
};
use serde_json::{Value, json};
use tyndall::transport::{Effort, Guiding, LightStarts, Strategies};

/// Light comes round a wall, to plastic and fog.
fn divided_room(fog: Option<Value>) -> Value {
    scene(&[
        ("sensor", camera([0.0, 0.0, 0.9], [0.0, 0.0, -1.0], 8)),
        ("room", room(0.6, fog)),
        ("wall", floor(0.3, 0.5, 0.5)),
        ("ball", plastic_ball([0.4, -0.3, -0.4], 0.2)),
        ("lamp", lamp_ball([0.2, 0.7, -0.3], 0.15, rgb(2.0, 3.0, 1.0))),
        ("point", point([-0.5, 0.6, 0.0], 0.3)),
    ])
}

/// With a Dirac lobe and one that is not.
fn plastic_ball(center: [f64; 3], radius: f64) -> Value {
    json!({"type": "sphere", "center": center, "radius": radius, "bsdf": {"type": "plastic", "int_ior": 1.5}})
}

#[test]
fn guided_walks_show_the_same() {
    let mut claims = Claims::new();
    let forward =
        [("scale", json!(4)), ("albedo", rgb(0.95, 0.9, 0.8)), ("phase", json!({"type": "hg", "g": 0.7}))];
    let guided = Effort { guide: Guiding::Always, ..Effort::default() };
    for (name, scene) in [
        ("vacuum", divided_room(None)),
        ("fog", divided_room(Some(medium(0.7, 0.8, 0.3)))),
        ("cloud", cloud_under_sky(&forward)),
    ] {
        let mut stage = Stage::new(&scene);
        let mut measure = |strategies: Strategies, effort: Effort, first: u64| {
            stage.setup.integrator.options.effort = effort;
            Sample::of(&stage.renders(strategies, 100, first..first + 24), stage.width())
        };
        for (index, (kind, strategies)) in
            [("bdpt", Strategies::BDPT), ("pt", Strategies::PT), ("lt", Strategies::LT)]
                .into_iter()
                .enumerate()
        {
            let first = 10_000 * index as u64;
            let usual = measure(strategies, Effort::default(), first);
            claims.equal(&format!("{name}, {kind}"), &measure(strategies, guided, first + 1000), &usual);
            let both = Effort { starts: LightStarts::Learnt, connections: 2, ..guided };
            claims.equal(&format!("{name}, {kind}, both"), &measure(strategies, both, first + 2000), &usual);
        }
    }
    claims.settle();
}
