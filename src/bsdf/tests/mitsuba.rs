//! Values of Mitsuba 3.9.1, that images may agree.

use super::*;

/// Cosine and azimuth of wi and wo for the tables below.
const DIRECTIONS: [[(f32, f32); 2]; 6] = [
    [(0.7, 0.4), (0.6, -2.5)],
    [(0.3, 1.0), (0.5, -1.8)],
    [(0.8, 0.4), (-0.75, -2.6)],
    [(-0.6, 2.0), (0.5, -1.3)],
    [(0.05, 0.0), (0.1, 3.0)],
    [(-0.9, 1.0), (-0.8, -2.0)],
];

/// `table` holds Mitsuba 3.9.1's `eval` (scalar_rgb) divided by |cos wo|, at `DIRECTIONS`.
fn check_against_mitsuba(bsdf: &Bsdf, transport: Transport, table: [[f32; 3]; 6]) {
    for ([wi, wo], expected) in DIRECTIONS.into_iter().zip(table) {
        let (wi, wo) = (warp::spherical(wi.0, wi.1), warp::spherical(wo.0, wo.1));
        let found = bsdf.evaluate(Vec2::ZERO, wi, wo, transport).value;
        for i in 0..3 {
            let agree = (found[i] - expected[i]).abs() <= 3e-4 * expected[i] + 1e-9;
            assert!(agree, "{bsdf:?} {wi} {wo}: {found} for {expected:?}");
        }
    }
}

#[test]
fn rough_dielectrics_are_those_of_mitsuba() {
    let grey = |table: [f32; 6]| table.map(|x| [x; 3]);
    let beckmann = built(
        "roughdielectric",
        &[("alpha", number(0.3)), ("int_ior", number(1.5)), ("ext_ior", number(1.0))],
    )
    .unwrap();
    let radiance = [0.094_104_5, 0.151_395, 3.385_9e-6, 0.017_324_1, 0.005_941_42, 0.066_477_8];
    let importance = [0.094_104_5, 0.151_395, 7.618_27e-6, 0.007_699_6, 0.005_941_42, 0.066_477_8];
    check_against_mitsuba(&beckmann, Transport::Radiance, grey(radiance));
    check_against_mitsuba(&beckmann, Transport::Importance, grey(importance));
    let ggx = built(
        "roughdielectric",
        &[
            ("distribution", text("ggx")),
            ("alpha_u", number(0.2)),
            ("alpha_v", number(0.5)),
            ("int_ior", text("water")),
        ],
    )
    .unwrap();
    let radiance = [0.049_296_9, 0.015_412_2, 0.348_387, 0.963_568, 3.176_23, 0.026_644_4];
    let importance = [0.049_296_9, 0.015_412_2, 0.618_702, 0.542_579, 3.176_23, 0.026_644_4];
    check_against_mitsuba(&ggx, Transport::Radiance, grey(radiance));
    check_against_mitsuba(&ggx, Transport::Importance, grey(importance));
}

#[test]
fn rough_conductors_are_those_of_mitsuba() {
    let black = [0.0; 3];
    let check = |properties: &[(&str, Value)], table| {
        let bsdf = built("roughconductor", properties).unwrap();
        check_against_mitsuba(&bsdf, Transport::Radiance, table);
    };
    let copper = [
        [1.605_15, 1.048_22, 0.873_985],
        [1.227_85, 0.823_358, 0.708_477],
        black,
        black,
        [0.010_16, 0.008_648_24, 0.008_262_72],
        black,
    ];
    check(&[("alpha", number(0.3)), ("material", text("Cu"))], copper);
    let gold = [
        [1.484_35, 1.232_35, 0.525_227],
        [0.177_606, 0.149_553, 0.072_694_9],
        black,
        black,
        [5.828_4, 5.496_51, 4.269_91],
        black,
    ];
    let anisotropic = |u, v| [("alpha_u", number(u)), ("alpha_v", number(v))];
    let ggx = [("distribution", text("ggx")), ("material", text("Au"))];
    check(&[anisotropic(0.2, 0.5), ggx].concat(), gold);
    let tinted = [[0.214_14; 3], [1.109_97; 3], black, black, black, black];
    let metal = [("eta", number(1.2)), ("k", number(2.0)), ("specular_reflectance", number(0.5))];
    check(&[&anisotropic(0.5, 0.15)[..], &metal[..]].concat(), tinted);
}

/// Mitsuba 3.9.1's reflectances at these cosines, for an index of 1.5 and for gold.
#[test]
fn smooth_interfaces_are_those_of_mitsuba() {
    let index = [("int_ior", number(1.5)), ("ext_ior", number(1.0))];
    let chance = |plugin, wi, transport, lobe: fn(&BsdfSample) -> bool| {
        let bsdf = built(plugin, &index).unwrap();
        let mut stream = stream(0);
        (0..1_000).filter_map(|_| bsdf.sample(UV, wi, transport, &mut stream)).find(lobe).unwrap()
    };
    let up = warp::spherical(0.8, 0.4);
    let reflected = chance("dielectric", up, Transport::Radiance, |s| s.wo.z > 0.0);
    assert!(close(reflected.forward, 0.043_894_73, 1e-5) && close(reflected.weight.x, 1.0, 1e-5));
    let refracted = chance("dielectric", up, Transport::Radiance, |s| s.wo.z < 0.0);
    assert!(refracted.wo.distance(vec3(-0.368_424, -0.155_767, -0.916_515)) < 1e-5);
    assert!(close(refracted.weight.x, 1.0 / 2.25, 1e-5));
    let from_below = chance("dielectric", -up, Transport::Radiance, |s| s.wo.z > 0.0);
    assert!(close(from_below.forward, 0.885_858_9, 1e-5) && close(from_below.weight.x, 2.25, 1e-5));
    let importance = chance("dielectric", -up, Transport::Importance, |s| s.wo.z > 0.0);
    assert!(close(importance.weight.x, 1.0, 1e-5));
    let pane = built("thindielectric", &index).unwrap();
    for (cosine, reflectance) in [(0.8, 0.084_098), (-0.3, 0.344_036_85), (0.1, 0.727_405_55)] {
        let sample =
            pane.sample(UV, warp::spherical(cosine, 0.4), Transport::Radiance, &mut stream(0)).unwrap();
        assert!(close(sample.weight.x, reflectance, 1e-5));
        assert!(close(pane.null_transmission(UV, cosine).x, 1.0 - reflectance, 1e-5));
    }
    let gold = built("conductor", &[("material", text("Au"))]).unwrap();
    for (cosine, colour) in
        [(0.8, [0.966_069, 0.801_277, 0.329_045]), (0.1, [0.973_435, 0.919_499, 0.718_891])]
    {
        let sample =
            gold.sample(UV, warp::spherical(cosine, 0.4), Transport::Radiance, &mut stream(0)).unwrap();
        assert!(close_colors(sample.weight, Spectrum::from(colour), 1e-5));
    }
}
