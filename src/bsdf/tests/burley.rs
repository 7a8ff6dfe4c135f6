//! Burley's materials against values of Mitsuba 3.9.1.

use super::*;

/// Cosine and azimuth of wi and wo for the table below.
const DIRECTIONS: [[(f32, f32); 2]; 7] = [
    [(0.7, 0.4), (0.6, -2.5)],
    [(0.3, 1.0), (0.5, -1.8)],
    [(0.8, 0.4), (-0.75, -2.6)],
    [(-0.6, 2.0), (0.5, -1.3)],
    [(0.05, 0.0), (0.1, 3.0)],
    [(-0.9, 1.0), (-0.8, -2.0)],
    [(0.95, 0.3), (0.93, -2.7)],
];

const BLACK: [f32; 3] = [0.0; 3];

fn rgb(r: f64, g: f64, b: f64) -> Value {
    Value::Rgb([r, g, b])
}

/// Plugin, transport, parameters, and Mitsuba's `eval` (scalar_rgb) over |cos wo| at the directions.
type Row = (&'static str, Transport, Vec<(&'static str, Value)>, [[f32; 3]; 7]);

fn rows() -> Vec<Row> {
    vec![
        (
            "principled",
            Transport::Radiance,
            vec![],
            [[0.247539; 3], [0.23666; 3], BLACK, BLACK, [0.465465; 3], BLACK, [0.214396; 3]],
        ),
        (
            "principled",
            Transport::Radiance,
            vec![("base_color", rgb(0.8, 0.3, 0.1))],
            [
                [0.34295, 0.183931, 0.120324],
                [0.326222, 0.176952, 0.117244],
                BLACK,
                BLACK,
                [0.507651, 0.437342, 0.409218],
                BLACK,
                [0.309889, 0.150734, 0.0870719],
            ],
        ),
        (
            "principled",
            Transport::Radiance,
            vec![("base_color", rgb(0.8, 0.3, 0.1)), ("roughness", number(0.2)), ("metallic", number(1.0))],
            [
                [0.388132, 0.146972, 0.0505076],
                [0.0348653, 0.0146746, 0.00659833],
                BLACK,
                BLACK,
                [0.0891493, 0.0687558, 0.0605984],
                BLACK,
                [11.9128, 4.46732, 1.48911],
            ],
        ),
        (
            "principled",
            Transport::Radiance,
            vec![
                ("base_color", rgb(0.8, 0.3, 0.1)),
                ("roughness", number(0.4)),
                ("metallic", number(0.6)),
                ("anisotropic", number(0.7)),
                ("specular", number(0.8)),
            ],
            [
                [0.412079, 0.167927, 0.0702666],
                [1.21037, 0.573754, 0.319106],
                BLACK,
                BLACK,
                [0.0775719, 0.0442935, 0.0309822],
                BLACK,
                [1.49351, 0.604305, 0.248624],
            ],
        ),
        (
            "principled",
            Transport::Radiance,
            vec![
                ("base_color", rgb(0.8, 0.3, 0.1)),
                ("spec_tint", number(0.7)),
                ("roughness", number(0.3)),
                ("eta", number(1.8)),
            ],
            [
                [0.485663, 0.214291, 0.105743],
                [0.274513, 0.114057, 0.0498747],
                BLACK,
                BLACK,
                [0.313735, 0.234237, 0.202437],
                BLACK,
                [1.37189, 0.63602, 0.34167],
            ],
        ),
        (
            "principled",
            Transport::Radiance,
            vec![
                ("base_color", rgb(0.8, 0.3, 0.1)),
                ("spec_tint", number(0.7)),
                ("roughness", number(0.3)),
                ("metallic", number(0.3)),
                ("eta", number(0.7)),
            ],
            [
                [1.73088, 1.61981, 1.57538],
                [0.3615, 0.258631, 0.217483],
                BLACK,
                BLACK,
                [0.398986, 0.350203, 0.330689],
                BLACK,
                [2.377, 0.925034, 0.344247],
            ],
        ),
        (
            "principled",
            Transport::Radiance,
            vec![("base_color", rgb(0.8, 0.3, 0.1)), ("sheen", number(0.8))],
            [
                [0.346707, 0.187688, 0.12408],
                [0.373918, 0.224648, 0.16494],
                BLACK,
                BLACK,
                [0.972322, 0.902013, 0.87389],
                BLACK,
                [0.30989, 0.150735, 0.0870725],
            ],
        ),
        (
            "principled",
            Transport::Radiance,
            vec![
                ("base_color", rgb(0.8, 0.3, 0.1)),
                ("sheen", number(0.8)),
                ("sheen_tint", number(0.6)),
                ("flatness", number(0.7)),
            ],
            [
                [0.341755, 0.184422, 0.121489],
                [0.485565, 0.24863, 0.153855],
                BLACK,
                BLACK,
                [1.4259, 0.897853, 0.686634],
                BLACK,
                [0.250156, 0.128334, 0.0796055],
            ],
        ),
        (
            "principled",
            Transport::Radiance,
            vec![
                ("base_color", rgb(0.8, 0.3, 0.1)),
                ("clearcoat", number(0.9)),
                ("clearcoat_gloss", number(0.0)),
            ],
            [
                [0.36273, 0.203711, 0.140104],
                [0.334755, 0.185484, 0.125776],
                BLACK,
                BLACK,
                [0.511108, 0.440799, 0.412675],
                BLACK,
                [0.363232, 0.204077, 0.140415],
            ],
        ),
        (
            "principled",
            Transport::Radiance,
            vec![
                ("base_color", rgb(0.8, 0.3, 0.1)),
                ("clearcoat", number(0.5)),
                ("clearcoat_gloss", number(0.7)),
                ("eta", number(0.8)),
            ],
            [
                [0.468705, 0.309685, 0.246078],
                [1.02385, 0.874577, 0.814869],
                BLACK,
                BLACK,
                [0.817109, 0.746801, 0.718677],
                BLACK,
                [0.36469, 0.205534, 0.141872],
            ],
        ),
        (
            "principled",
            Transport::Radiance,
            vec![
                ("base_color", rgb(0.8, 0.3, 0.1)),
                ("spec_trans", number(1.0)),
                ("roughness", number(0.5)),
                ("eta", number(1.5)),
            ],
            [
                [0.0885197; 3],
                [0.0873897; 3],
                [0.233047, 0.142712, 0.0823946],
                [1.34504, 0.823663, 0.475542],
                [0.395157; 3],
                [0.0770982; 3],
                [0.0552409; 3],
            ],
        ),
        (
            "principled",
            Transport::Importance,
            vec![
                ("base_color", rgb(0.8, 0.3, 0.1)),
                ("spec_trans", number(0.6)),
                ("roughness", number(0.6)),
                ("metallic", number(0.2)),
                ("anisotropic", number(0.4)),
                ("eta", number(1.3)),
            ],
            [
                [0.23251, 0.0991312, 0.0457798],
                [0.360799, 0.193074, 0.125984],
                [0.464668, 0.28455, 0.164285],
                [1.49737, 0.916949, 0.529401],
                [0.175089, 0.142772, 0.129845],
                [0.00702232; 3],
                [0.197412, 0.0797576, 0.0326959],
            ],
        ),
        (
            "principled",
            Transport::Radiance,
            vec![
                ("base_color", rgb(0.8, 0.3, 0.1)),
                ("spec_trans", number(0.6)),
                ("roughness", number(0.6)),
                ("metallic", number(0.2)),
                ("anisotropic", number(0.4)),
                ("eta", number(1.3)),
            ],
            [
                [0.23251, 0.0991312, 0.0457798],
                [0.360799, 0.193074, 0.125984],
                [0.274951, 0.168373, 0.0972099],
                [2.53056, 1.54964, 0.894687],
                [0.175089, 0.142772, 0.129845],
                [0.00702232; 3],
                [0.197412, 0.0797576, 0.0326959],
            ],
        ),
        (
            "principled",
            Transport::Radiance,
            vec![
                ("base_color", rgb(0.8, 0.3, 0.1)),
                ("spec_trans", number(0.8)),
                ("roughness", number(0.7)),
                ("specular", number(0.0)),
            ],
            [
                [0.0511195, 0.0192459, 0.00649647],
                [0.0493906, 0.0190719, 0.00694447],
                BLACK,
                [0.00359734, 0.00220291, 0.00127185],
                [0.103091, 0.0889053, 0.083231],
                [3.00292e-05; 3],
                [0.0509594, 0.0191284, 0.00639595],
            ],
        ),
        (
            "principled",
            Transport::Radiance,
            vec![("base_color", rgb(0.8, 0.3, 0.1)), ("metallic", number(1.0)), ("specular", number(0.0))],
            [BLACK, BLACK, BLACK, BLACK, BLACK, BLACK, BLACK],
        ),
        (
            "principled",
            Transport::Radiance,
            vec![
                ("base_color", rgb(0.8, 0.3, 0.1)),
                ("metallic", number(0.2)),
                ("specular", number(0.6)),
                ("roughness", number(0.35)),
                ("spec_tint", number(0.4)),
                ("anisotropic", number(0.5)),
                ("sheen", number(0.3)),
                ("sheen_tint", number(0.2)),
                ("clearcoat", number(0.6)),
                ("clearcoat_gloss", number(0.3)),
                ("spec_trans", number(0.4)),
                ("flatness", number(0.3)),
            ],
            [
                [0.327915, 0.149939, 0.0787482],
                [0.39779, 0.211282, 0.136678],
                [0.0132964, 0.00814233, 0.00470098],
                [0.0709024, 0.0434187, 0.0250678],
                [0.323553, 0.228483, 0.190455],
                [0.0335152; 3],
                [1.13018, 0.523514, 0.280849],
            ],
        ),
        (
            "principled",
            Transport::Radiance,
            vec![
                ("base_color", rgb(0.0, 0.0, 0.0)),
                ("spec_tint", number(0.7)),
                ("sheen", number(1.0)),
                ("sheen_tint", number(1.0)),
                ("roughness", number(0.0)),
            ],
            [[0.00471219; 3], [0.0596234; 3], BLACK, BLACK, [0.580882; 3], BLACK, [0.00157519; 3]],
        ),
        (
            "principled",
            Transport::Importance,
            vec![
                ("base_color", rgb(0.8, 0.3, 0.1)),
                ("spec_trans", number(0.8)),
                ("roughness", number(0.3)),
                ("eta", number(0.6)),
            ],
            [
                [1.60394, 1.57221, 1.55951],
                [0.243935, 0.214544, 0.202787],
                [0.0743299, 0.0455176, 0.0262796],
                [0.0352434, 0.0215821, 0.0124604],
                [0.343234, 0.329295, 0.32372],
                [0.127774; 3],
                [0.571313, 0.539482, 0.526749],
            ],
        ),
        (
            "principledthin",
            Transport::Radiance,
            vec![],
            [[0.159019; 3], [0.14927; 3], BLACK, BLACK, [0.0703087; 3], [0.159167; 3], [0.159155; 3]],
        ),
        (
            "principledthin",
            Transport::Radiance,
            vec![
                ("base_color", rgb(0.8, 0.3, 0.1)),
                ("roughness", number(0.15)),
                ("spec_tint", number(0.1)),
                ("anisotropic", number(0.5)),
                ("spec_trans", number(0.8)),
                ("diff_trans", number(0.3)),
                ("eta", number(1.33)),
            ],
            [
                [0.0444652, 0.0174295, 0.00661526],
                [0.0423554, 0.0175854, 0.00767744],
                [0.0459914, 0.0172468, 0.00574892],
                [0.0200376, 0.00751412, 0.00250471],
                [0.0231661, 0.0113884, 0.00667735],
                [0.0457852, 0.0184569, 0.00752553],
                [0.143976, 0.105367, 0.0899234],
            ],
        ),
        (
            "principledthin",
            Transport::Radiance,
            vec![
                ("base_color", rgb(0.8, 0.3, 0.1)),
                ("roughness", number(0.6)),
                ("spec_tint", number(0.8)),
                ("spec_trans", number(1.0)),
                ("diff_trans", number(2.0)),
                ("eta", number(1.7)),
            ],
            [
                [0.130261, 0.0618331, 0.034462],
                [0.14419, 0.0926665, 0.0720573],
                [1.86778, 0.700416, 0.233472],
                [2.191, 0.821626, 0.273875],
                [0.457822, 0.436806, 0.428399],
                [0.0891787, 0.0397187, 0.0199347],
                [0.083247, 0.0369179, 0.0183863],
            ],
        ),
        (
            "principledthin",
            Transport::Radiance,
            vec![
                ("base_color", rgb(0.8, 0.3, 0.1)),
                ("roughness", number(0.6)),
                ("sheen", number(0.7)),
                ("sheen_tint", number(0.5)),
                ("flatness", number(0.4)),
                ("diff_trans", number(1.3)),
                ("eta", number(1.7)),
            ],
            [
                [0.0894056, 0.0338866, 0.011679],
                [0.122681, 0.05057, 0.0217257],
                [0.165521, 0.0620704, 0.0206901],
                [0.165521, 0.0620704, 0.0206901],
                [0.288659, 0.152718, 0.0983411],
                [0.0797199, 0.0298999, 0.00997192],
                [0.0771803, 0.0289427, 0.00964762],
            ],
        ),
        (
            "principledthin",
            Transport::Radiance,
            vec![
                ("base_color", rgb(0.8, 0.3, 0.1)),
                ("roughness", number(0.9)),
                ("sheen", number(0.7)),
                ("flatness", number(1.0)),
                ("spec_trans", number(0.5)),
                ("diff_trans", number(0.7)),
                ("eta", number(0.7)),
                ("spec_tint", number(1.0)),
            ],
            [
                [0.179687, 0.130086, 0.110246],
                [0.267426, 0.194478, 0.165299],
                [0.200936, 0.0753509, 0.025117],
                [0.0445634, 0.0167113, 0.00557042],
                [0.444788, 0.373793, 0.345395],
                [0.0658385, 0.0248772, 0.0084927],
                [0.0592067, 0.0222039, 0.00740275],
            ],
        ),
    ]
}

#[test]
fn burleys_materials_are_those_of_mitsuba() {
    for (plugin, transport, properties, table) in rows() {
        let bsdf = built(plugin, &properties).unwrap();
        for ([wi, wo], expected) in DIRECTIONS.into_iter().zip(table) {
            let (wi, wo) = (warp::spherical(wi.0, wi.1), warp::spherical(wo.0, wo.1));
            let found = bsdf.evaluate(UV, wi, wo, transport).value;
            let agree = (0..3).all(|i| (found[i] - expected[i]).abs() <= 5e-4 * expected[i] + 1e-6);
            assert!(agree, "{plugin} {properties:?} {wi} to {wo}: {found} for {expected:?}");
        }
    }
}
