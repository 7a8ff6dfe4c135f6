//! Sensors that measure one number: what they say of a lamp whose light is known.

use crate::{common::pieces::*, sandbox::Sandbox};
use serde_json::{Value, json};
use std::f32::consts::{FRAC_PI_4, PI};

const ORIGIN: [f64; 3] = [0.0; 3];

/// What `meter` says of a ball of radius 1 and radiance 3, by `integrator`.
fn measured(meter: &Value, integrator: &str) -> f32 {
    let lamp = lamp_ball(ORIGIN, 1.0, 3.0);
    let sandbox = Sandbox::with_scene(&scene(&[("meter", meter.clone()), ("lamp", lamp)]));
    sandbox.run(&format!("render scene.json --integrator {integrator} --spp 5000 --threads 1")).ends(0);
    let red = sandbox.channels("scene.exr")["R"].clone();
    assert_eq!(red.len(), 1);
    red[0]
}

/// By every integrator.
fn says(meter: &Value, expected: f32, tolerance: f32) {
    for integrator in ["pt", "bdpt", "lt"] {
        says_by(integrator, meter, expected, tolerance);
    }
}

fn says_by(integrator: &str, meter: &Value, expected: f32, tolerance: f32) {
    let found = measured(meter, integrator);
    let is_near = (found - expected).abs() <= tolerance * expected;
    assert!(is_near, "{meter} by {integrator}: {found}, not {expected}");
}

#[test]
fn a_radiancemeter_sees_one_ray() {
    let along = |x: f64| json!({"type": "radiancemeter", "origin": [x, 0.2, -4], "direction": [0, 0, 2]});
    let placed = json!({"type": "radiancemeter", "to_world": [{"type": "translate", "value": [0.5, 0, -4]}]});
    for (meter, expected) in [(along(0.5), 3.0), (along(1.5), 0.0), (placed, 3.0)] {
        says_by("pt", &meter, expected, 1e-6);
        says_by("bdpt", &meter, expected, 1e-6);
        // No light subpath finds the ray.
        says_by("lt", &meter, 0.0, 0.0);
    }
}

/// Positions are exact around what is measured, however far that is from the origin of the file.
#[test]
fn meters_far_from_the_origin_see_as_sharply() {
    let far = |x: f64| [1e7 + x, 0.0, 0.0];
    for (x, light) in [(0.3, 3.0), (0.45, 0.0)] {
        let [start, disc] = [far(x), [1e7 + x, 0.0, 2.0]];
        let place = json!([{"type": "scale", "value": 1e-3}, {"type": "translate", "value": disc}]);
        for meter in [
            json!({"type": "radiancemeter", "origin": [start[0], 0, 4], "direction": [0, 0, -1]}),
            json!({"type": "distant", "direction": [0, 0, -1], "target": start}),
            json!({"type": "distant", "direction": [0, 0, -1], "target": {"type": "disk", "to_world": place}}),
        ] {
            let parts = [("meter", meter.clone()), ("lamp", lamp_ball(far(0.0), 0.4, 3.0))];
            let sandbox = Sandbox::with_scene(&scene(&parts));
            sandbox.run("render scene.json --integrator pt --spp 1").ends(0);
            assert_eq!(sandbox.channels("scene.exr")["R"], [light], "{meter}");
        }
    }
}

/// Its one pixel has no neighbours that would show it light which few samples find.
#[test]
fn a_meter_sees_rare_light_before_it_calls_itself_precise() {
    let place = json!([{"type": "translate", "value": [0, 0, -4]}]);
    let floor = json!({"type": "rectangle", "to_world": place, "meter": {"type": "irradiancemeter"}});
    let sandbox = Sandbox::with_scene(&scene(&[
        ("floor", floor),
        ("sky", sky(0.3)),
        ("lamp", lamp_ball(ORIGIN, 0.3, 5.0)),
    ]));
    let found = (0..8).map(|seed| {
        sandbox.run(&format!("render scene.json --integrator pt --error 0.05 --seed {seed}")).ends(0);
        sandbox.channels("scene.exr")["R"][0]
    });
    let found: Vec<f32> = found.collect();
    // The lamp hides a part of the sky.
    let expected = 0.3 * PI + (5.0 - 0.3) * PI * 0.3f32.powi(2) / 16.0 * 0.92;
    assert!(found.iter().all(|one| (one / expected - 1.0).abs() < 0.15), "{found:?}, not {expected}");
}

#[test]
fn a_distant_sensor_sees_its_target_evenly() {
    let flat =
        |shape: &str, scale: f64| json!({"type": shape, "to_world": [{"type": "scale", "value": scale}]});
    let distant = |target: Value| json!({"type": "distant", "direction": [0, 0, -1], "target": target});
    // The sphere around the box around the ball is wider by the root of 3.
    says(&json!({"type": "distant", "direction": [1, 2, -1]}), 1.0, 0.02);
    says(&distant(flat("rectangle", 1.0)), 3.0 * FRAC_PI_4, 0.02);
    says(&distant(flat("disk", 2.0)), 0.75, 0.02);
    // One of four times the area, seen at 60 degrees.
    let tilted = json!([{"type": "scale", "value": 2}, {"type": "rotate", "axis": [1, 0, 0], "angle": 60}]);
    says(&distant(json!({"type": "disk", "to_world": tilted})), 1.5, 0.02);
    for (point, expected) in [([0.9, 0.0, 7.0], 3.0), ([1.1, 0.0, 0.0], 0.0)] {
        says_by("bdpt", &distant(json!(point)), expected, 1e-6);
    }
}

#[test]
fn an_irradiancemeter_counts_all_light_on_its_shape() {
    let on = |shape: &str, angle: f64| {
        let place = json!([{"type": "scale", "value": 0.02}, {"type": "rotate", "axis": [1, 0, 0], "angle": angle},
            {"type": "translate", "value": [0, 0, -2]}]);
        json!({"type": shape, "to_world": place, "meter": {"type": "irradiancemeter"}})
    };
    // pi L (r / d)^2 cos.
    for shape in ["rectangle", "disk"] {
        says(&on(shape, 0.0), 0.75 * PI, 0.02);
        says(&on(shape, 45.0), 0.75 * PI * 0.5f32.sqrt(), 0.02);
        says(&on(shape, 180.0), 0.0, 0.02);
    }
    // L times the solid angle of the lamp, and the cross section of a ball by its area.
    says(&on("sphere", 0.0), 3.0 * 2.0 * PI * (1.0 - 0.75f32.sqrt()) / 4.0, 0.06);
}

#[test]
fn a_meter_on_a_shape_is_chosen_by_its_name() {
    let floor = json!({"type": "rectangle", "on_floor": {"type": "irradiancemeter"}});
    let parts = [("a", camera([0.0, 0.0, 4.0], ORIGIN, 2)), ("floor", floor), ("sky", sky(2.0))];
    let sandbox = Sandbox::with_scene(&scene(&parts));
    sandbox.run("render scene.json --spp 16 --sensor all").ends(0);
    assert_eq!(sandbox.channels("scene_a.exr")["R"].len(), 4);
    let found = sandbox.channels("scene_on_floor.exr")["R"].clone();
    assert!(found.len() == 1 && (found[0] / (2.0 * PI) - 1.0).abs() < 1e-5, "{found:?}");
}
