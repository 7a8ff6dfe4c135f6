//! Pieces that test scenes are put together from.

use serde_json::{Map, Value, json};

/// A scene of named parts, in order.
pub(crate) fn scene(parts: &[(&str, Value)]) -> Value {
    let mut scene = Map::from_iter([("type".to_owned(), json!("scene"))]);
    scene.extend(parts.iter().map(|(name, part)| ((*name).to_owned(), part.clone())));
    Value::Object(scene)
}

/// `object` with more properties.
pub(crate) fn with(object: Value, more: &[(&str, Value)]) -> Value {
    let Value::Object(mut map) = object else { panic!("not an object: {object}") };
    map.extend(more.iter().map(|(name, value)| ((*name).to_owned(), value.clone())));
    Value::Object(map)
}

/// A camera with a square image of `size` pixels, a quarter turn wide.
pub(crate) fn camera(origin: [f64; 3], target: [f64; 3], size: u32) -> Value {
    let across = (target[0] - origin[0]).abs() + (target[2] - origin[2]).abs();
    let up = if across > 0.0 { [0, 1, 0] } else { [0, 0, 1] };
    json!({
        "type": "perspective", "fov": 45, "near_clip": 1e-3,
        "to_world": [{"type": "lookat", "origin": origin, "target": target, "up": up}],
        "film": {"type": "hdrfilm", "width": size, "height": size, "rfilter": {"type": "box"}},
        "sampler": {"type": "independent", "sample_count": 4},
    })
}

/// An integrator with a bound on depth; -1 for none.
pub(crate) fn depth(max_depth: i64) -> Value {
    json!({"type": "bdpt", "max_depth": max_depth})
}

/// A colour.
pub(crate) fn rgb(r: f64, g: f64, b: f64) -> Value {
    json!({"type": "rgb", "value": [r, g, b]})
}

/// A reference.
pub(crate) fn named(id: &str) -> Value {
    json!({"type": "ref", "id": id})
}

/// A homogeneous medium.
pub(crate) fn medium(sigma_t: impl Into<Value>, albedo: impl Into<Value>, g: f64) -> Value {
    json!({
        "type": "homogeneous", "sigma_t": sigma_t.into(), "albedo": albedo.into(),
        "phase": {"type": "hg", "g": g},
    })
}

/// A diffuse surface.
pub(crate) fn diffuse(reflectance: impl Into<Value>) -> Value {
    json!({"type": "diffuse", "reflectance": reflectance.into()})
}

/// Scaling, then moving.
pub(crate) fn place(scale: [f64; 3], at: [f64; 3]) -> Value {
    json!([{"type": "scale", "value": scale}, {"type": "translate", "value": at}])
}

/// An index-matched box from `low` to `high`; without a medium where `interior` is none.
pub(crate) fn null_box(low: [f64; 3], high: [f64; 3], interior: Option<Value>) -> Value {
    let half = std::array::from_fn(|i| 0.5 * (high[i] - low[i]));
    let centre = std::array::from_fn(|i| 0.5 * (high[i] + low[i]));
    let shell = json!({"type": "cube", "to_world": place(half, centre), "bsdf": {"type": "null"}});
    match interior {
        Some(interior) => with(shell, &[("interior", interior)]),
        None => shell,
    }
}

/// An index-matched ball.
pub(crate) fn null_ball(centre: [f64; 3], radius: f64, interior: Value) -> Value {
    json!({
        "type": "sphere", "center": centre, "radius": radius, "bsdf": {"type": "null"}, "interior": interior,
    })
}

/// A room [-1, 1]^3 of diffuse walls that face inwards; `fog` fills it.
pub(crate) fn room(reflectance: impl Into<Value>, fog: Option<Value>) -> Value {
    let walls = json!({"type": "cube", "flip_normals": true, "bsdf": diffuse(reflectance)});
    match fog {
        Some(fog) => with(walls, &[("exterior", fog)]),
        None => walls,
    }
}

/// A square floor of half side `half` at height `y`, facing up.
pub(crate) fn floor(y: f64, half: f64, reflectance: impl Into<Value>) -> Value {
    let flat = json!([
        {"type": "scale", "value": half}, {"type": "rotate", "axis": [1, 0, 0], "angle": -90},
        {"type": "translate", "value": [0.0, y, 0.0]},
    ]);
    json!({"type": "rectangle", "to_world": flat, "bsdf": diffuse(reflectance)})
}

/// A ball that emits.
pub(crate) fn lamp_ball(centre: [f64; 3], radius: f64, radiance: impl Into<Value>) -> Value {
    json!({
        "type": "sphere", "center": centre, "radius": radius,
        "emitter": {"type": "area", "radiance": radiance.into()},
    })
}

/// A square of half side `half` at `at` that emits downwards.
pub(crate) fn lamp_panel(at: [f64; 3], half: f64, radiance: impl Into<Value>) -> Value {
    let facing_down = json!([
        {"type": "scale", "value": half}, {"type": "rotate", "axis": [1, 0, 0], "angle": 90},
        {"type": "translate", "value": at},
    ]);
    json!({
        "type": "rectangle", "to_world": facing_down,
        "emitter": {"type": "area", "radiance": radiance.into()},
    })
}

/// A point light.
pub(crate) fn point(at: [f64; 3], intensity: impl Into<Value>) -> Value {
    json!({"type": "point", "position": at, "intensity": intensity.into()})
}

/// A spotlight.
pub(crate) fn spot(at: [f64; 3], target: [f64; 3], intensity: impl Into<Value>) -> Value {
    let aim = json!([{"type": "lookat", "origin": at, "target": target, "up": [0.1, 1, 0.2]}]);
    json!({"type": "spot", "to_world": aim, "intensity": intensity.into(), "cutoff_angle": 30})
}

/// Parallel light along `direction`.
pub(crate) fn sun(direction: [f64; 3], irradiance: impl Into<Value>) -> Value {
    json!({"type": "directional", "direction": direction, "irradiance": irradiance.into()})
}

/// A beam of parallel light from a disk around `at` along `direction`.
pub(crate) fn beam(at: [f64; 3], direction: [f64; 3], radius: f64, irradiance: impl Into<Value>) -> Value {
    let target: [f64; 3] = std::array::from_fn(|i| at[i] + direction[i]);
    let aim = json!([{"type": "lookat", "origin": at, "target": target, "up": [0.1, 1, 0.2]}]);
    json!({"type": "collimated", "to_world": aim, "radius": radius, "irradiance": irradiance.into()})
}

/// The same radiance from everywhere.
pub(crate) fn sky(radiance: impl Into<Value>) -> Value {
    json!({"type": "constant", "radiance": radiance.into()})
}

/// A floor, and above it a cloud that thins out upwards, with `more` said of it, under sky and sun.
pub(crate) fn cloud_under_sky(more: &[(&str, Value)]) -> Value {
    let smoke = json!({"type": "heterogeneous", "tracker": "null_collision", "scale": 2, "albedo": 0.8,
        "sigma_t": {"type": "exponential", "height": -0.8, "scale_height": 0.8}});
    scene(&[
        ("sensor", camera([0.0, 0.6, 3.2], [0.0, 0.2, 0.0], 8)),
        ("floor", floor(-0.6, 2.0, 0.5)),
        ("cloud", null_box([-0.8, -0.4, -0.8], [0.8, 0.8, 0.8], Some(with(smoke, more)))),
        ("sky", sky(0.5)),
        ("sun", sun([0.3, -1.0, -0.2], 1.0)),
    ])
}
