//! Beams of parallel light against closed forms, in agreement of all methods, and at extremes of their radius.

use crate::common::{
    Stage,
    claims::{Claims, Sample},
    pieces::*,
    strategies,
};
use serde_json::{Value, json};
use std::f64::consts::PI;
use tyndall::{math::Spectrum, transport::Strategies};

const SEEDS: u64 = 12;
const METHODS: [(&str, Strategies); 3] =
    [("pt", Strategies::PT), ("lt", Strategies::LT), ("bdpt", Strategies::BDPT)];

/// Half the height of what [`facing_wall`] sees of the wall (m).
const HALF: f64 = 2.0;
const ALBEDO: f64 = 0.6;

/// Parallel rays along -z at a wall in the plane z = 0, with more parts.
fn facing_wall(more: &[(&str, Value)]) -> Value {
    let view = json!([
        {"type": "scale", "value": [HALF, HALF, 1.0]},
        {"type": "lookat", "origin": [0, 0, 5], "target": [0, 0, 0], "up": [0, 1, 0]},
    ]);
    let film = json!({"type": "hdrfilm", "width": 16, "height": 16, "rfilter": {"type": "box"}});
    let sensor = json!({"type": "orthographic", "to_world": view, "film": film});
    let wall =
        json!({"type": "rectangle", "to_world": place([90.0, 90.0, 1.0], [0.0; 3]), "bsdf": diffuse(ALBEDO)});
    let depth = ("integrator", depth(2));
    let parts: Vec<(&str, Value)> =
        [("sensor", sensor), ("wall", wall), depth].into_iter().chain(more.iter().cloned()).collect();
    scene(&parts)
}

/// A direction at `angle` (rad) to -z.
fn tilted(angle: f64) -> [f64; 3] {
    [angle.sin(), 0.0, -angle.cos()]
}

#[test]
fn a_wall_within_a_beam_has_the_radiance_of_its_irradiance() {
    let mut claims = Claims::new();
    for angle in [0.0f64, 0.9] {
        let back = tilted(angle).map(|x| -30.0 * x);
        let lamp = ("beam", beam(back, tilted(angle), 9.0, 5.0));
        for sigma_t in [0.0, 0.7] {
            let ink = null_box([-40.0, -40.0, 0.5], [40.0, 40.0, 1.5], Some(medium(sigma_t, 0.0, 0.0)));
            let stage = Stage::new(&facing_wall(&[lamp.clone(), ("ink", ink)]));
            let depth = sigma_t * (1.0 / angle.cos() + 1.0);
            let expected = 5.0 * angle.cos() * (-depth).exp() * ALBEDO / PI;
            for (name, set) in METHODS {
                let images = stage.renders(set, 16, 0..SEEDS);
                claims.equal_to(&format!("{name}, {angle}, {sigma_t}"), &Sample::of(&images, 16), expected);
            }
        }
    }
    claims.settle();
}

/// All light that a wall sends back, over its albedo, is what the beam emits (W).
fn power_of(image: &[Spectrum]) -> f64 {
    let pixel = (2.0 * HALF / 16.0).powi(2);
    image.iter().map(|radiance| f64::from(radiance.y)).sum::<f64>() * pixel * PI / ALBEDO
}

#[test]
fn all_light_of_a_beam_arrives() {
    let mut claims = Claims::new();
    for (radius, scale) in [(0.7, 1.0), (1.4, 0.5), (1e-4, 1.0), (1e-10, 1.0)] {
        let lamp = json!({"type": "collimated", "radius": radius, "power": 3.0, "to_world": [
            {"type": "scale", "value": [scale, scale, 1]},
            {"type": "lookat", "origin": [-0.5, 0.3, 2], "target": [0.2, 0.3, 0], "up": [0, 1, 0]}]});
        let stage = Stage::new(&facing_wall(&[("beam", lamp)]));
        for (name, set) in METHODS {
            // Camera subpaths hardly ever see the spot of a laser.
            if name == "pt" && radius < 0.1 {
                continue;
            }
            let powers: Vec<f64> = stage.renders(set, 64, 0..SEEDS).iter().map(|i| power_of(i)).collect();
            claims.mean(&format!("{name}, radius {radius}"), &powers, 3.0);
        }
    }
    claims.settle();
}

/// A light subpath of a beam so wide that none of them arrives says nothing; next-event estimation needs none.
#[test]
fn a_huge_beam_is_a_sun() {
    let lamp = ("beam", beam([0.0, 0.0, 1e5], [0.0, 0.0, -1.0], 1e14, 2.0));
    let image = Stage::new(&facing_wall(&[lamp])).render(Strategies::PT, 1, 1);
    let expected = (2.0 * ALBEDO / PI) as f32;
    assert!(image.iter().all(|radiance| (radiance.y - expected).abs() < 1e-5 * expected), "{image:?}");
}

/// What lies behind the disk, beside the beam or in a shadow gets nothing; the disk is not seen, nor does it cast a shadow.
#[test]
fn beams_light_what_lies_before_them_only() {
    let behind = ("beam", beam([0.0, 0.0, -1.0], [0.0, 0.0, -1.0], 9.0, 5.0));
    let beside = ("beam", beam([9.0, 0.0, 2.0], [0.0, 0.0, -1.0], 2.0, 5.0));
    let at_camera = ("beam", beam([0.0, 0.0, 1.0], [0.0, 0.0, 1.0], 9.0, 5.0));
    for lamp in [behind, beside, at_camera] {
        for (name, set) in METHODS {
            let image = Stage::new(&facing_wall(std::slice::from_ref(&lamp))).render(set, 4, 1);
            assert!(image.iter().all(|radiance| *radiance == Spectrum::ZERO), "{name}");
        }
    }
}

/// `pt` and `lt` show the same image of a scene, and so do `bdpt` and subsets of it.
fn methods_agree(what: &str, parts: &[(&str, Value)], samples_per_pixel: u64) {
    let stage = Stage::new(&scene(parts));
    let sets = [
        "hit+next-event",
        "lens",
        "next-event",
        "next-event+lens",
        "join+lens",
        "next-event+join",
        "next-event+equiangular",
        "hit+next-event+join+lens+equiangular",
    ];
    let measure = |(i, set): (u64, Strategies)| {
        Sample::of(&stage.renders(set, samples_per_pixel, 1000 * i..1000 * i + SEEDS), stage.width())
    };
    let all = measure((99, Strategies::BDPT));
    let mut claims = Claims::new();
    for (i, set) in (0..).zip(sets) {
        claims.equal(&format!("{what}: {set} against bdpt"), &measure((i, strategies(set))), &all);
    }
    claims.settle();
}

/// Across a room, and through the camera.
fn searchlight() -> Value {
    beam([-0.8, 0.6, -0.6], [0.8, -0.5, 0.6], 0.25, rgb(6.0, 4.0, 2.0))
}

fn in_the_room() -> (&'static str, Value) {
    ("sensor", camera([0.0, 0.0, 0.9], [0.0, 0.0, -1.0], 8))
}

#[test]
fn methods_agree_in_a_room_of_fog() {
    for (name, fog) in
        [("fog", medium(1.0, 0.8, 0.3)), ("colours", medium(rgb(0.2, 1.0, 3.0), rgb(0.9, 0.7, 0.8), -0.2))]
    {
        let parts = [in_the_room(), ("room", room(0.5, Some(fog))), ("beam", searchlight())];
        methods_agree(name, &parts, 96);
    }
}

/// The camera sits in the middle of the beam and looks at where it comes from.
#[test]
fn methods_agree_within_a_beam() {
    let lamp = beam([0.0, 0.0, -0.9], [0.0, 0.0, 1.0], 0.4, 3.0);
    let fog = medium(0.6, 0.8, 0.3);
    let parts = [in_the_room(), ("room", room(0.5, Some(fog))), ("beam", lamp)];
    // Next to the lens, connections to it alone have no finite variance.
    let stage = Stage::new(&scene(&parts));
    let mut claims = Claims::new();
    let [pt, bdpt] = [(Strategies::PT, 0), (Strategies::BDPT, 100)]
        .map(|(set, first)| Sample::of(&stage.renders(set, 128, first..first + SEEDS), stage.width()));
    claims.equal("bdpt against pt", &bdpt, &pt);
    claims.settle();
}

/// The disk lies half in a cloud, and its light crosses another that varies.
#[test]
fn methods_agree_across_boundaries() {
    let waves = json!({"type": "cosine", "constant": 1, "a": {"type": "wave", "amplitude": 0.9, "vector": [4, 2, 1]}});
    let smoke = json!({"type": "heterogeneous", "scale": 2, "sigma_t": waves, "albedo": 0.8});
    let parts = [
        ("sensor", camera([0.0, 0.5, 3.5], [0.0, 0.0, 0.0], 8)),
        ("floor", floor(-1.0, 2.0, 0.5)),
        ("cloud", null_box([-1.4, -0.3, -0.5], [-0.7, 0.6, 0.5], Some(medium(2.0, 0.8, 0.0)))),
        ("smoke", null_box([-0.5; 3], [0.6; 3], Some(smoke))),
        ("beam", beam([-1.0, 0.5, 0.0], [1.0, -0.5, 0.1], 0.3, 5.0)),
        ("point", point([1.5, 1.0, 1.0], 0.5)),
    ];
    methods_agree("across", &parts, 128);
}

/// What a glass ball makes of a beam is found by light subpaths alone.
#[test]
fn beams_through_glass_need_light_subpaths() {
    let ball = json!({"type": "sphere", "center": [3.0, 0.0, 2.5], "radius": 0.8,
                      "bsdf": {"type": "dielectric", "int_ior": 1.5, "ext_ior": 1.0}});
    let lamp = ("beam", beam([4.2, 0.0, 3.5], [-1.2, 0.0, -1.0], 0.5, 5.0));
    let deep = ("integrator", depth(8));
    let stage = Stage::new(&with(facing_wall(&[lamp, ("ball", ball)]), &[deep]));
    let [lt, bdpt] = [Strategies::LT, Strategies::BDPT].map(|set| stage.renders(set, 64, 0..SEEDS));
    assert!(lt.iter().all(|image| power_of(image) > 1.0));
    let mut claims = Claims::new();
    claims.equal("lt against bdpt", &Sample::of(&lt, 16), &Sample::of(&bdpt, 16));
    claims.settle();
    let black = stage.render(Strategies::PT, 4, 1);
    assert!(power_of(&black) < 0.1 * power_of(&lt[0]), "{}", power_of(&black));
}
