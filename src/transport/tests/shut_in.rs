//! From where nothing is seen, nothing is connected: which media are shut in.

use super::scenes::build;
use crate::{
    math::{Bounds, Vec3},
    medium::MediumIndex,
    sampling::{Stream, stream::Purpose},
    scene::{Scene, lights::Aim},
    shape::Ray,
};

/// A ball of milk around the origin, the camera outside.
const MILK: &str = r#""milk": {"type": "homogeneous", "sigma_t": 20, "albedo": 0.99},
    "camera": {"type": "perspective", "to_world": [{"type": "lookat", "origin": [0, 0, 5], "target": [0, 0, 0], "up": [0, 1, 0]}]},
    "sky": {"type": "constant"}"#;
const INTERIOR: &str = r#""interior": {"type": "ref", "id": "milk"}"#;
const LAMP: &str = r#""lamp": {"type": "rectangle", "to_world": [{"type": "translate", "value": [0, 3, 0]}], "emitter": {"type": "area"}}"#;

fn ball(name: &str, bsdf: &str, more: &str) -> String {
    format!(r#""{name}": {{"type": "sphere", "bsdf": {{"type": "{bsdf}"}}, {more}}}"#)
}

/// Whether the milk is shut in where these are in the scene too.
fn is_shut_in(parts: &[&str]) -> bool {
    let setup = build(&[&[MILK], parts].concat());
    let found = setup.scene.is_shut_in(MediumIndex(1));
    assert!(!found || sees_nothing(&setup.scene), "{parts:?}");
    found
}

/// No point of the first shape's inside sees one of an emitter.
fn sees_nothing(scene: &Scene) -> bool {
    let Bounds { low, high } = scene.geometry.shapes()[0].bounds();
    (0..1000).all(|index| {
        let mut stream = Stream::new(8, index, 0, Purpose::Study);
        let within = Vec3::from_array([(); 3].map(|()| stream.uniform()));
        let position = low + (high - low) * (0.25 + 0.5 * within);
        let sample = scene.lights.sample_emitter(&scene.geometry, position, Aim::default(), &mut stream);
        sample.is_none_or(|sample| {
            let Some((direction, square)) = sample.point.seen_from(position) else { return true };
            let t_max = if sample.point.is_infinite() { f32::INFINITY } else { 0.999 * square.sqrt() };
            scene.geometry.occluded(&Ray { origin: position, direction, t_max })
        })
    })
}

#[test]
fn media_behind_closed_surfaces_that_scatter_all_light_are_shut_in() {
    let frosted = ball("ball", "roughdielectric", INTERIOR);
    assert!(is_shut_in(&[&frosted, LAMP]));
    assert!(is_shut_in(&[
        &ball("ball", "dielectric", INTERIOR),
        &ball("other", "null", r#""center": [3, 0, 0]"#)
    ]));
    assert!(is_shut_in(&[
        r#""box": {"type": "cube", "flip_normals": true, "bsdf": {"type": "dielectric"}, "exterior": {"type": "ref", "id": "milk"}}"#
    ]));
}

#[test]
fn media_that_see_a_light_or_the_open_are_not() {
    let frosted = ball("ball", "roughdielectric", INTERIOR);
    let within = LAMP.replace("[0, 3, 0]", "[0, 0, 0]");
    let bubble = r#""radius": 0.2, "exterior": {"type": "ref", "id": "milk"}"#;
    let further = format!(r#""center": [3, 0, 0], {INTERIOR}"#);
    for parts in [
        &[&*ball("ball", "null", INTERIOR)][..],
        &[&ball("ball", "thindielectric", INTERIOR)],
        &[&frosted, &within],
        &[&frosted, r#""lamp": {"type": "point", "position": [0.1, 0.2, 0]}"#],
        &[&ball("ball", "diffuse", &format!(r#"{INTERIOR}, "emitter": {{"type": "area"}}"#))],
        &[&frosted, &ball("bubble", "null", bubble)],
        &[&frosted, &ball("open", "null", &further)],
        &[&format!(r#""pane": {{"type": "disk", "bsdf": {{"type": "dielectric"}}, {INTERIOR}}}"#)],
        &[&ball("ball", "roughdielectric", &format!(r#""radius": 9, {INTERIOR}"#))],
        &[
            &frosted,
            r#""lamp": {"type": "point", "position": [0, 3, 0], "medium": {"type": "ref", "id": "milk"}}"#,
        ],
    ] {
        assert!(!is_shut_in(parts), "{parts:?}");
    }
}
