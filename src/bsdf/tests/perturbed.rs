//! Perturbed surfaces against values of Mitsuba 3.9.1.

use super::*;

/// Cosine and azimuth of wi and wo for the table below.
const DIRECTIONS: [[(f32, f32); 2]; 6] = [
    [(0.7, 0.4), (0.6, -2.5)],
    [(0.3, 1.0), (0.5, -1.8)],
    [(0.8, 0.4), (-0.75, -2.6)],
    [(-0.6, 2.0), (0.5, -1.3)],
    [(0.15, -2.5), (0.1, 3.0)],
    [(-0.9, 1.0), (-0.8, -2.0)],
];

/// Colour of the map, nested model, whether normals flip and light is shadowed, and Mitsuba's `eval` (scalar_rgb) over |cos wo|.
type Row = ([f64; 3], Value, [bool; 2], [f32; 6]);

fn rows() -> Vec<Row> {
    vec![
        (
            [0.7, 0.4, 0.9],
            nested("diffuse", &[]),
            [true, true],
            [0.0908864, 0.165456, 0.0, 0.0, 0.543888, 0.0],
        ),
        (
            [0.3, 0.6, 0.9],
            nested("roughconductor", &[("alpha_u", number(0.5)), ("alpha_v", number(0.8))]),
            [true, true],
            [0.449825, 0.0276715, 0.0, 0.0, 0.000249419, 0.0],
        ),
        (
            [0.75, 0.55, 0.8],
            nested("roughconductor", &[("alpha_u", number(0.5)), ("alpha_v", number(0.8))]),
            [true, false],
            [0.0, 0.248516, 0.0, 0.0, 0.456849, 0.0],
        ),
        (
            [0.3, 0.6, 0.9],
            nested("roughdielectric", &[("alpha", number(0.4))]),
            [true, true],
            [0.0131406, 0.000300163, 3.20772e-11, 0.0, 8.50019e-09, 0.0138941],
        ),
        ([0.75, 0.55, 0.8], nested("diffuse", &[]), [false, true], [0.0, 0.0445739, 0.0, 0.0, 0.0, 0.0]),
        (
            [0.7, 0.4, 0.9],
            nested("roughdielectric", &[("alpha", number(0.4))]),
            [true, false],
            [0.0193185, 0.301837, 0.0299024, 19.0481, 1.36266e-08, 0.00847511],
        ),
    ]
}

#[test]
fn normal_maps_are_those_of_mitsuba() {
    for (color, bsdf, [flips, shadows], table) in rows() {
        let properties = [
            ("normalmap", Value::Rgb(color)),
            ("flip_invalid_normals", Value::Boolean(flips)),
            ("use_shadowing_function", Value::Boolean(shadows)),
            ("nested", bsdf),
        ];
        let bsdf = built("normalmap", &properties).unwrap();
        for ([wi, wo], expected) in DIRECTIONS.into_iter().zip(table) {
            let (wi, wo) = (warp::spherical(wi.0, wi.1), warp::spherical(wo.0, wo.1));
            let found = bsdf.evaluate(UV, wi, wo, Transport::Radiance).value.x;
            let agree = (found - expected).abs() <= 1e-3 * expected + 1e-6;
            assert!(agree, "{properties:?} {wi} to {wo}: {found} for {expected}");
        }
    }
}
