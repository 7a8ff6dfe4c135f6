//! Spheres and cylinders that bound media, in instances whose axes have different scales.

use crate::common::{
    Stage,
    claims::{Claims, Sample},
    pieces::*,
    strategies,
};
use serde_json::{Value, json};
use std::f64::consts::{PI, TAU};
use tyndall::transport::Strategies;

const SEEDS: u64 = 12;
const ROWS: u32 = 64;

/// A unit ball of triangles, whose volume is 0.2 % less than a ball's.
fn ball_of_triangles() -> String {
    let corner = |row: u32, column: u32| {
        let (up, around) =
            (PI * f64::from(row) / f64::from(ROWS), TAU * f64::from(column) / f64::from(2 * ROWS));
        format!("v {} {} {}\n", up.sin() * around.cos(), up.sin() * around.sin(), up.cos())
    };
    let number = |row: u32, column: u32| 1 + row * 2 * ROWS + column % (2 * ROWS);
    let face = |row: u32, column: u32| {
        let (next, right) = (row + 1, column + 1);
        let [a, b, c, d] =
            [number(row, column), number(next, column), number(next, right), number(row, right)];
        format!("f {a} {b} {c} {d}\n")
    };
    let all = |rows: u32| (0..rows).flat_map(|row| (0..2 * ROWS).map(move |column| (row, column)));
    let corners: String = all(ROWS + 1).map(|(row, column)| corner(row, column)).collect();
    corners + &all(ROWS).map(|(row, column)| face(row, column)).collect::<String>()
}

/// An instance of `shape`, full of fog, turned and with a scale of its own on each axis.
fn stretched(shape: Value, bsdf: Value) -> Value {
    let fog = with(shape, &[("bsdf", bsdf), ("interior", medium(2.0, 0.9, 0.4))]);
    let placed = json!([{"type": "scale", "value": [0.9, 0.35, 0.6]}, {"type": "rotate", "axis": [0, 0, 1], "angle": 25}]);
    json!({"type": "instance", "to_world": placed, "g": {"type": "shapegroup", "fog": fog}})
}

fn over_floor(fog: Value, eye: [f64; 3], lamp: [f64; 3]) -> Value {
    scene(&[
        ("integrator", depth(6)),
        ("sensor", camera(eye, [0.0, -0.1, 0.0], 8)),
        ("floor", floor(-0.8, 2.0, 0.6)),
        ("fog", fog),
        ("lamp", point(lamp, 3.0)),
    ])
}

const OUTSIDE: [f64; 3] = [0.3, 1.2, 2.5];
const ABOVE: [f64; 3] = [0.4, 1.5, 0.3];
const INSIDE: [f64; 3] = [0.2, 0.1, 0.1];

fn sample(stage: &Stage, set: Strategies, first: u64) -> Sample {
    Sample::of(&stage.renders(set, 64, first..first + SEEDS), stage.width())
}

#[test]
fn a_stretched_ball_of_fog_is_one_of_triangles() {
    let mesh = ball_of_triangles();
    let mut claims = Claims::new();
    for (name, eye, lamp) in
        [("outside", OUTSIDE, ABOVE), ("lamp inside", OUTSIDE, INSIDE), ("camera inside", INSIDE, ABOVE)]
    {
        let of = |shape: Value| over_floor(stretched(shape, json!({"type": "null"})), eye, lamp);
        let ball = Stage::new(&of(json!({"type": "sphere"})));
        let triangles =
            Stage::with_files(&of(json!({"type": "obj", "filename": "ball.obj"})), &[("ball.obj", &mesh)]);
        claims.equal(name, &sample(&ball, Strategies::BDPT, 0), &sample(&triangles, Strategies::BDPT, 1000));
    }
    claims.settle();
}

#[test]
fn stretched_shapes_of_fog_show_all_strategies_the_same() {
    let frosted = json!({"type": "roughdielectric", "alpha": 0.4});
    let mut claims = Claims::new();
    for (name, shape, bsdf) in [
        ("null ball", json!({"type": "sphere"}), json!({"type": "null"})),
        ("frosted ball", json!({"type": "sphere", "radius": 0.9}), frosted),
    ] {
        let stage = Stage::new(&over_floor(stretched(shape, bsdf), OUTSIDE, ABOVE));
        let all = sample(&stage, Strategies::BDPT, 0);
        for set in ["hit+lens", "hit+next-event+lens", "hit+next-event+join+lens"] {
            claims.equal(&format!("{name}: {set}"), &sample(&stage, strategies(set), 1000), &all);
        }
    }
    claims.settle();
}
