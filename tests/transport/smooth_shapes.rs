//! Light of lamps without extent by way of smooth shapes: connections that follow it back over the shape show what light subpaths
//! show that are connected to the lens.

use crate::common::{
    Stage,
    claims::{Claims, Sample},
    pieces::*,
};
use serde_json::{Value, json};
use tyndall::{
    math::Spectrum,
    transport::{Strategies, strategy::StrategyKind},
};

const SEEDS: u64 = 12;

/// A shape over a floor, before the camera; paths have no more segments than chains over it leave room for.
fn over_floor(shape: &Value, lamp: &Value, max_depth: u32) -> Value {
    scene(&[
        ("integrator", depth(i64::from(max_depth))),
        ("sensor", camera([0.3, 1.2, 2.5], [0.0, -0.5, 0.0], 8)),
        ("floor", floor(-0.7, 2.0, 0.6)),
        ("shape", shape.clone()),
        ("lamp", lamp.clone()),
    ])
}

fn bulb() -> Value {
    point([0.4, 1.5, 0.3], 3.0)
}

fn sunlight() -> Value {
    sun([-0.3, -1.0, -0.2], 2.0)
}

/// The shape's light without light subpaths at the lens, against all strategies.
fn agrees(name: &str, scene: &Value) {
    let stage = Stage::new(scene);
    let of = |set: Strategies, first: u64| stage.renders(set, 64, first..first + SEEDS);
    let followed = of(Strategies::BDPT.without(StrategyKind::Lens), 0);
    let (all, direct) = (of(Strategies::BDPT, 1000), of(Strategies::PT, 2000));
    let mut claims = Claims::new();
    let sample = |images: &[Vec<Spectrum>]| Sample::of(images, stage.width());
    claims.equal(&format!("{name}: followed back against light subpaths"), &sample(&followed), &sample(&all));
    claims.settle();
    let mean =
        |images: &[Vec<Spectrum>]| images.iter().flatten().map(|pixel| f64::from(pixel.x)).sum::<f64>();
    assert!(mean(&direct) < 0.98 * mean(&all), "{name}: nothing comes by way of the shape");
}

const GLASS: &str = "dielectric";
const METAL: &str = "conductor";

fn ball(bsdf: &str) -> Value {
    json!({"type": "sphere", "center": [0, 0, 0], "radius": 0.5, "bsdf": {"type": bsdf}})
}

#[test]
fn by_a_ball_of_glass() {
    agrees("ball and point", &over_floor(&ball(GLASS), &bulb(), 5));
    agrees("ball and sun", &over_floor(&ball(GLASS), &sunlight(), 5));
}

#[test]
fn by_a_ball_of_metal() {
    agrees("metal and point", &over_floor(&ball(METAL), &bulb(), 3));
}

/// The lamp is in a ball of glass.
#[test]
fn from_within_a_ball() {
    let shell = json!({"type": "sphere", "center": [0.4, 1.4, 0.3], "radius": 0.4, "bsdf": {"type": GLASS}});
    agrees("lamp in glass", &over_floor(&shell, &bulb(), 4));
}

/// Across the way of the light, above the floor.
fn tube(bsdf: &str) -> Value {
    json!({"type": "cylinder", "p0": [-0.6, 0.0, 0.1], "p1": [0.7, 0.2, -0.1], "radius": 0.45, "bsdf": {"type": bsdf}})
}

#[test]
fn by_a_tube_of_glass() {
    agrees("tube and point", &over_floor(&tube(GLASS), &bulb(), 5));
    agrees("tube and sun", &over_floor(&tube(GLASS), &sunlight(), 5));
    let inside_out = with(tube(GLASS), &[("flip_normals", json!(true))]);
    agrees("tube inside out", &over_floor(&inside_out, &bulb(), 4));
}

/// Its outside; and its inside, where the light comes by an open end.
#[test]
fn by_a_tube_of_metal() {
    agrees("metal tube and point", &over_floor(&tube(METAL), &bulb(), 3));
    let ring = json!({"type": "cylinder", "p0": [0, -0.69, 0], "p1": [0, -0.3, 0], "radius": 0.6, "flip_normals": true, "bsdf": {"type": METAL}});
    agrees("ring and point", &over_floor(&ring, &point([0.9, 1.5, 0.3], 3.0), 5));
    agrees("ring and sun", &over_floor(&ring, &sun([-0.6, -1.0, -0.2], 2.0), 5));
}

#[test]
fn by_planes() {
    let turned = json!([{"type": "scale", "value": [0.5, 0.3, 0.4]}, {"type": "rotate", "axis": [1, 1, 0], "angle": 30}]);
    let block = json!({"type": "cube", "to_world": turned, "bsdf": {"type": GLASS}});
    agrees("block and point", &over_floor(&block, &bulb(), 4));
    agrees("block and sun", &over_floor(&block, &sunlight(), 4));
    let inside_out = with(block, &[("flip_normals", json!(true))]);
    agrees("block inside out", &over_floor(&inside_out, &bulb(), 4));
    let up = json!([{"type": "rotate", "axis": [1, 0, 0], "angle": -90}]);
    let water = json!({"type": "rectangle", "to_world": up, "bsdf": {"type": GLASS, "int_ior": 1.33}});
    agrees("water and point", &over_floor(&water, &bulb(), 3));
    agrees("water and sun", &over_floor(&water, &sunlight(), 3));
    let mirror = json!({"type": "disk", "to_world": [{"type": "scale", "value": 0.6}, {"type": "rotate", "axis": [0, 1, 0], "angle": 60},
        {"type": "translate", "value": [-1, 0, 0]}], "bsdf": {"type": METAL}});
    agrees("mirror and point", &over_floor(&mirror, &bulb(), 3));
}

/// Through fog on both sides of the glass, and through colours of it: a lamp within a ball.
#[test]
fn in_fog() {
    for fog in [medium(0.5, 0.9, 0.4), medium(rgb(0.3, 0.6, 1.0), 0.8, 0.0)] {
        let glass = with(ball(GLASS), &[("interior", medium(0.4, 0.9, 0.0)), ("exterior", named("fog"))]);
        let scene = scene(&[
            ("integrator", depth(4)),
            ("sensor", camera([0.0, 0.3, 3.5], [0.0, 0.0, 0.0], 8)),
            ("fog", fog),
            ("bank", null_box([-1.2, -1.2, -1.2], [1.2, 1.2, 1.2], Some(named("fog")))),
            ("glass", glass),
            ("lamp", point([0.1, 0.2, 0.1], 3.0)),
        ]);
        agrees("ball in fog", &scene);
    }
}

/// Light that travels in parallel within a disk, and in a cone.
#[test]
fn by_beams_and_spots() {
    agrees("beam", &over_floor(&ball(GLASS), &beam([0.2, 2.0, 0.1], [0.0, -1.0, 0.0], 0.4, 5.0), 5));
    agrees("spot", &over_floor(&ball(GLASS), &spot([0.5, 2.0, 0.3], [0.0, 0.0, 0.0], 9.0), 5));
}

/// A primary ray that continues twice, from a collision in fog and from the glass behind it, is two walks: what the first can be
/// connected to is nothing to the second.
#[test]
fn behind_fog_that_forces_collisions() {
    let pane = json!({"type": "rectangle", "to_world": place([1.5, 1.5, 1.0], [0.2, 0.6, 1.6]), "bsdf": {"type": GLASS}});
    let mut parts = vec![
        ("integrator", depth(6)),
        ("sensor", camera([0.3, 1.2, 2.5], [0.0, -0.5, 0.0], 8)),
        ("floor", floor(-0.7, 2.0, 0.6)),
        ("shape", ball(GLASS)),
        ("lamp", bulb()),
        ("pane", pane),
        ("bank", null_box([-1.0, -0.5, 1.9], [1.5, 2.0, 2.3], Some(medium(0.3, 0.5, 0.0)))),
    ];
    let stage = Stage::new(&scene(&parts));
    let plain = stage.renders(Strategies::BDPT, 64, 0..SEEDS);
    let unfollowed =
        stage.renders(Strategies::BDPT.without(StrategyKind::Connection), 64, 2000..2000 + SEEDS);
    parts[0].1 = with(depth(6), &[("forced_interaction", json!(true))]);
    let stage = Stage::new(&scene(&parts));
    let forced = stage.renders(Strategies::BDPT, 64, 1000..1000 + SEEDS);
    let mut claims = Claims::new();
    let sample = |images: &[Vec<Spectrum>]| Sample::of(images, stage.width());
    claims.equal("forced collisions against others", &sample(&forced), &sample(&plain));
    claims.settle();
    let mean =
        |images: &[Vec<Spectrum>]| images.iter().flatten().map(|pixel| f64::from(pixel.x)).sum::<f64>();
    assert!(mean(&unfollowed) < 0.9 * mean(&plain), "nothing comes by way of the ball and the pane");
}
