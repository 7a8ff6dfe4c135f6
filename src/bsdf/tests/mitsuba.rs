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
    check_within(3e-4, bsdf, transport, table);
}

fn check_within(tolerance: f32, bsdf: &Bsdf, transport: Transport, table: [[f32; 3]; 6]) {
    for ([wi, wo], expected) in DIRECTIONS.into_iter().zip(table) {
        let (wi, wo) = (warp::spherical(wi.0, wi.1), warp::spherical(wo.0, wo.1));
        let found = bsdf.evaluate(Uv::At(Vec2::ZERO), wi, wo, transport).value;
        for i in 0..3 {
            let agree = (found[i] - expected[i]).abs() <= tolerance * expected[i] + 1e-9;
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
    assert!(close(reflected.pdf_fwd, 0.043_894_73, 1e-5) && close(reflected.weight.x, 1.0, 1e-5));
    let refracted = chance("dielectric", up, Transport::Radiance, |s| s.wo.z < 0.0);
    assert!(refracted.wo.distance(vec3(-0.368_424, -0.155_767, -0.916_515)) < 1e-5);
    assert!(close(refracted.weight.x, 1.0 / 2.25, 1e-5));
    let from_below = chance("dielectric", -up, Transport::Radiance, |s| s.wo.z > 0.0);
    assert!(close(from_below.pdf_fwd, 0.885_858_9, 1e-5) && close(from_below.weight.x, 2.25, 1e-5));
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

const BLACK: [f32; 3] = [0.0; 3];

fn rgb(r: f64, g: f64, b: f64) -> Value {
    Value::Rgb([r, g, b])
}

/// A plastic, coloured and all, and the same as properties of a rough one.
fn shiny() -> Vec<(&'static str, Value)> {
    vec![
        ("nonlinear", Value::Boolean(true)),
        ("diffuse_reflectance", rgb(0.9, 0.3, 1.0)),
        ("specular_reflectance", number(0.5)),
        ("int_ior", number(1.9)),
        ("ext_ior", number(1.0)),
    ]
}

#[test]
fn plastics_are_those_of_mitsuba() {
    let plain = built("plastic", &[]).unwrap();
    let table = [[0.156_008; 3], [0.126_946; 3], BLACK, BLACK, [0.018_713_7; 3], BLACK];
    check_against_mitsuba(&plain, Transport::Radiance, table);
    let shiny = built("plastic", &shiny()).unwrap();
    let table = [
        [0.198_274, 0.026_805_9, 0.291_508],
        [0.159_966, 0.021_626_8, 0.235_186],
        BLACK,
        BLACK,
        [0.024_731_4, 0.003_343_59, 0.036_360_7],
        BLACK,
    ];
    check_against_mitsuba(&shiny, Transport::Importance, table);
    for (cosine, reflectance) in [(0.8, 0.050_489_6), (0.1, 0.296_097_6)] {
        let mut stream = stream(0);
        let wi = warp::spherical(cosine, 0.4);
        let sample = |_| shiny.sample(UV, wi, Transport::Radiance, &mut stream);
        let found = (0..10_000).filter_map(sample).find(|sample| sample.dirac).unwrap();
        assert!(close_colors(found.weight * found.pdf_fwd, Spectrum::splat(reflectance), 1e-5));
        assert_eq!(found.wo, mirror(wi));
    }
}

#[test]
fn rough_plastics_are_those_of_mitsuba() {
    let check = |properties: &[(&str, Value)], table| {
        // Mitsuba's own transmittances are a quadrature, of up to 32 points a side.
        check_within(1e-3, &built("roughplastic", properties).unwrap(), Transport::Radiance, table);
    };
    check(&[], [[0.247_495; 3], [0.122_25; 3], BLACK, BLACK, [0.039_281_9; 3], BLACK]);
    let ggx = || ("distribution", text("ggx"));
    let table = [
        [0.198_241, 0.097_733, 0.231_37],
        [0.177_97, 0.091_033_8, 0.206_625],
        BLACK,
        BLACK,
        [0.289_518, 0.227_773, 0.309_87],
        BLACK,
    ];
    check(&[shiny(), vec![ggx(), ("alpha", number(0.3))]].concat(), table);
    let base = [("specular_reflectance", number(0.0)), ("diffuse_reflectance", number(0.8))];
    let table = [[0.204_411; 3], [0.183_683; 3], BLACK, BLACK, [0.144_343; 3], BLACK];
    check(&[&base[..], &[("alpha", number(0.4)), ("int_ior", text("water"))]].concat(), table);
    let table = [[0.164_927; 3], [0.135_907; 3], BLACK, BLACK, [0.065_119_4; 3], BLACK];
    let nonlinear = ("nonlinear", Value::Boolean(true));
    check(&[&base[..], &[ggx(), ("int_ior", number(1.6)), nonlinear]].concat(), table);
}

#[test]
fn masks_and_blends_are_those_of_mitsuba() {
    let both = || nested("twosided", &[("nested", nested("plastic", &shiny()))]);
    let mask = built("mask", &[("opacity", rgb(0.1, 0.2, 0.9)), ("nested", both())]).unwrap();
    let table = [
        [0.079_309_6, 0.010_722_4, 0.116_603],
        [0.063_986_3, 0.008_650_71, 0.094_074_4],
        BLACK,
        BLACK,
        [0.009_892_55, 0.001_337_44, 0.014_544_3],
        [0.082_391_4, 0.011_139, 0.121_134],
    ];
    check_against_mitsuba(&mask, Transport::Radiance, table);
    assert!(close(mask.null_transmission(UV, 0.3).x, 0.6, 1e-5));
    let index = [("int_ior", number(1.5)), ("ext_ior", number(1.0))];
    let frosted = nested("roughdielectric", &[&index[..], &[("alpha", number(0.3))]].concat());
    let diffuse = nested("diffuse", &[("reflectance", rgb(0.2, 0.3, 0.4))]);
    let sides = nested("twosided", &[("front", nested("plastic", &shiny())), ("back", diffuse)]);
    let blend =
        built("blendbsdf", &[("weight", number(0.3)), ("first", frosted), ("second", sides)]).unwrap();
    let table = [
        [0.125_355, 0.073_914_9, 0.153_325],
        [0.153_966, 0.112_465, 0.176_532],
        [2.370_13e-6; 3],
        [0.012_126_9; 3],
        [0.011_578_4, 0.005_162_07, 0.015_067_2],
        [0.065_633_1, 0.075_182_4, 0.084_731_7],
    ];
    check_against_mitsuba(&blend, Transport::Radiance, table);
    let pane = || nested("thindielectric", &index);
    let masked = built("mask", &[("opacity", number(0.3)), ("nested", pane())]).unwrap();
    let blended = [("weight", number(0.3)), ("first", pane()), ("second", nested("null", &[]))];
    let blended = built("blendbsdf", &blended).unwrap();
    for (bsdf, through) in [(masked, 0.896_789), (blended, 0.759_174)] {
        assert!(close(bsdf.null_transmission(UV, 0.3).x, through, 1e-5), "{bsdf:?}");
    }
}

#[test]
fn metals_with_textured_indices_are_those_of_mitsuba() {
    let squares = |color| nested("checkerboard", &[("color0", color), ("color1", number(1.0))]);
    let index = [("eta", squares(rgb(0.2, 0.9, 0.5))), ("k", squares(rgb(0.3, 0.2, 1.0)))];
    let metal = built("roughconductor", &[&index[..], &[("alpha", number(0.3))]].concat()).unwrap();
    let table = [
        [1.277_69, 0.068_019_1, 0.768_998],
        [1.110_06, 0.215_344, 0.741_608],
        BLACK,
        BLACK,
        [0.010_199_4, 0.007_301_71, 0.009_123_19],
        BLACK,
    ];
    check_against_mitsuba(&metal, Transport::Radiance, table);
}
