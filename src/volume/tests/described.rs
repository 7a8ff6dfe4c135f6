//! Volumes from scene files: both spellings, time and wind, and what is wrong with them.

use super::*;
use crate::{description::table, format, format::Spelling};
use std::path::Path;

/// The volume called `fog` of a scene, and the scene's description.
fn read(name: &str, text: &str, place: &Place) -> Result<(Object, Volume)> {
    let desk = tempfile::tempdir().unwrap();
    let path = desk.path().join(name);
    std::fs::write(&path, text).unwrap();
    let root = format::read(&path, &[])?;
    let library = Library::new(&root)?;
    let fog = library.resolve("fog", &root.location)?;
    let volume = build(fog, &library, place)?;
    Ok((root, volume))
}

const HERE: Place = Place::new(DVec3::ZERO, 0.0);

fn json(fog: &str, place: &Place) -> Result<Volume> {
    read("a.json", &format!(r#"{{"type": "scene", "fog": {fog}}}"#), place).map(|(_, volume)| volume)
}

/// Every model in JSON and in XML, with all its parameters.
const SPELLINGS: &[(&str, &str)] = &[
    (
        r#"{"type": "cosine", "constant": 1.5, "value": 2, "min": [-1, -2, -3], "max": [1, 2, 3],
            "to_world": [{"type": "scale", "value": 2}],
            "a": {"type": "wave", "amplitude": 0.5, "vector": [0, 15.7, 0]},
            "b": {"type": "wave", "amplitude": -0.2, "vector": [2.2, 22, 0], "phase": 0.4}}"#,
        r#"<volume type="cosine" id="fog"><float name="constant" value="1.5"/><float name="value" value="2"/>
           <point name="min" value="-1 -2 -3"/><point name="max" value="1 2 3"/>
           <transform name="to_world"><scale value="2"/></transform>
           <volume type="wave"><float name="amplitude" value="0.5"/><vector name="vector" value="0 15.7 0"/></volume>
           <volume type="wave"><float name="amplitude" value="-0.2"/><vector name="vector" value="2.2 22 0"/>
           <float name="phase" value="0.4"/></volume></volume>"#,
    ),
    (
        r#"{"type": "polynomial", "x": "0.8, -1, 0, 0, 1", "z": "0.8 -1 0 0 1", "half_width": 30, "wrap": "zero",
            "mixed": {"type": "term", "coefficient": 0.25, "powers": [1, 2, 0]}}"#,
        r#"<volume type="polynomial" id="fog"><string name="x" value="0.8, -1, 0, 0, 1"/>
           <string name="z" value="0.8 -1 0 0 1"/><float name="half_width" value="30"/>
           <string name="wrap" value="zero"/><volume type="term"><float name="coefficient" value="0.25"/>
           <vector name="powers" value="1 2 0"/></volume></volume>"#,
    ),
    (
        r#"{"type": "equipotential", "shape": "segment", "p0": [0, 1, 0], "p1": [2, 1, 0], "c": 0.1, "d": 3,
            "strength": -0.5, "value": {"type": "rgb", "value": [1, 2, 3]}}"#,
        r#"<volume type="equipotential" id="fog"><string name="shape" value="segment"/>
           <point name="p0" value="0 1 0"/><point name="p1" value="2 1 0"/><float name="c" value="0.1"/>
           <float name="d" value="3"/><float name="strength" value="-0.5"/><rgb name="value" value="1 2 3"/></volume>"#,
    ),
    (
        r#"{"type": "equipotential", "shape": "sphere", "center": [1, 2, 3], "radius": 0.5}"#,
        r#"<volume type="equipotential" id="fog"><string name="shape" value="sphere"/>
           <point name="center" value="1 2 3"/><float name="radius" value="0.5"/></volume>"#,
    ),
    (
        r#"{"type": "exponential", "up": [0, 0, 1], "height": 12, "scale_height": 40, "value": 0.1}"#,
        r#"<volume type="exponential" id="fog"><vector name="up" value="0 0 1"/><float name="height" value="12"/>
           <float name="scale_height" value="40"/><float name="value" value="0.1"/></volume>"#,
    ),
    (
        r#"{"type": "noise", "frequency": 3, "octaves": 5, "lacunarity": 2.1, "gain": 0.6, "amplitude": 2,
            "bias": -0.3, "seed": 9, "style": "fractal"}"#,
        r#"<volume type="noise" id="fog"><float name="frequency" value="3"/><integer name="octaves" value="5"/>
           <float name="lacunarity" value="2.1"/><float name="gain" value="0.6"/><float name="amplitude" value="2"/>
           <float name="bias" value="-0.3"/><integer name="seed" value="9"/><string name="style" value="fractal"/>
           </volume>"#,
    ),
    (
        r#"{"type": "sum", "haze": {"type": "constvolume", "value": 0.2},
            "drift": {"type": "wind", "velocity": [1, 0, 2], "gusts": {"type": "product",
            "a": {"type": "exponential"}, "b": {"type": "noise"}}}}"#,
        r#"<volume type="sum" id="fog"><volume type="constvolume"><float name="value" value="0.2"/></volume>
           <volume type="wind"><vector name="velocity" value="1 0 2"/><volume type="product">
           <volume type="exponential"/><volume type="noise"/></volume></volume></volume>"#,
    ),
];

#[test]
fn both_spellings_say_the_same_and_turn_into_each_other() {
    for (json, xml) in SPELLINGS {
        let json = format!(r#"{{"type": "scene", "fog": {json}}}"#);
        let xml = format!(r#"<scene version="3.0.0">{xml}</scene>"#);
        let (root, from_json) = read("a.json", &json, &HERE).unwrap();
        let (_, from_xml) = read("a.xml", &xml, &HERE).unwrap();
        assert_eq!(format!("{from_json:?}"), format!("{from_xml:?}"));
        let written = format::write(&root, Spelling::Xml, Path::new("")).unwrap();
        let (_, again) = read("b.xml", &written, &HERE).unwrap();
        assert_eq!(format!("{from_json:?}"), format!("{again:?}"), "{written}");
    }
}

/// Values worked out by hand.
#[test]
fn values_are_those_of_the_formulas() {
    let value = |fog: &str, at: Vec3| json(fog, &HERE).unwrap().eval::<f32>(at);
    let close = |found: f32, expected: f32| assert!((found - expected).abs() < 1e-6, "{found} {expected}");
    let cosine = r#"{"type": "cosine", "value": 2, "to_world": [{"type": "scale", "value": 2}],
        "a": {"type": "wave", "amplitude": 0.5, "vector": [0, 3, 0], "phase": 0.25}}"#;
    close(value(cosine, vec3(9.0, 0.8, 9.0)), 2.0 * (1.0 + 0.5 * 1.45f32.cos()));
    let tile = |wrap| {
        format!(
            r#"{{"type": "polynomial", "x": "0.8, -1, 0, 0, 1", "wrap": "{wrap}", "half_width": 0.5,
            "t": {{"type": "term", "coefficient": 3, "powers": [1, 2, 0]}}}}"#
        )
    };
    let inside = |x: f32, y: f32| 0.8 - x + x.powi(4) + 3.0 * x * y * y;
    close(value(&tile("repeat"), vec3(0.3, -0.4, 7.0)), inside(0.3, -0.4));
    close(value(&tile("repeat"), vec3(2.3, 3.6, 7.0)), inside(0.3, -0.4));
    close(value(&tile("zero"), vec3(0.3, -0.4, 7.0)), inside(0.3, -0.4));
    assert_eq!(value(&tile("zero"), vec3(0.6, -0.4, 7.0)), 0.0);
    let thing =
        |shape: &str| format!(r#"{{"type": "equipotential", "c": 0.5, "d": 2, "strength": 3, {shape}}}"#);
    let around = |squared: f32| 3.0 / (0.5 + 2.0 * squared);
    close(value(&thing(r#""center": [1, 0, 0]"#), vec3(0.0, 2.0, 0.0)), around(5.0));
    let ends = r#""p0": [0, 0, 0], "p1": [2, 0, 0]"#;
    close(value(&thing(&format!(r#""shape": "line", {ends}"#)), vec3(5.0, 3.0, 0.0)), around(9.0));
    close(value(&thing(&format!(r#""shape": "segment", {ends}"#)), vec3(5.0, 3.0, 0.0)), around(18.0));
    let sphere = thing(r#""shape": "sphere", "radius": 2"#);
    close(value(&sphere, vec3(0.0, 3.0, 0.0)), around(5.0));
    close(value(&sphere, vec3(0.0, 1.0, 0.0)), around(0.0));
    let fog = r#"{"type": "exponential", "up": [0, 5, 0], "height": 1, "scale_height": 2, "value": 0.3}"#;
    close(value(fog, vec3(8.0, 4.0, 0.0)), 0.3 * (-1.5f32).exp());
    close(value(fog, vec3(8.0, -1e6, 0.0)) / (0.3 * 60f32.exp()), 1.0);
}

/// BMA02 fig. 6 by waves, as it is printed.
#[test]
fn a_product_of_cosines_is_two_waves() {
    let pi = std::f64::consts::PI;
    let wave = |name: &str, amplitude: f64, [x, y, z]: [f64; 3]| {
        let vector = [x, y, z].map(|k| format!("{:?}", k * pi)).join(", ");
        format!(r#", "{name}": {{"type": "wave", "amplitude": {amplitude}, "vector": [{vector}]}}"#)
    };
    let waves = [
        wave("a", 0.5, [0.0, 5.0, 0.0]),
        wave("b", 0.2, [0.7, 7.0, 0.0]),
        wave("c", 0.2, [-0.25, 5.0, 0.0]),
        wave("d", 0.05, [1.0, 0.0, 0.5]),
        wave("e", 0.05, [1.0, 0.0, -0.5]),
    ];
    let fog = json(&format!(r#"{{"type": "cosine"{}}}"#, waves.concat()), &HERE).unwrap();
    let mut stream = Stream::new(7, 0, 0, Purpose::Study);
    for _ in 0..100 {
        let at = position(&mut stream);
        let [x, y, z] = at.as_dvec3().to_array();
        let expected = 1.0
            + 0.5 * (5.0 * pi * y).cos()
            + 0.2 * (7.0 * pi * (y + 0.1 * x)).cos()
            + 0.2 * (5.0 * pi * (y - 0.05 * x)).cos()
            + 0.1 * (pi * x).cos() * (pi * z / 2.0).cos();
        assert!((f64::from(fog.eval::<f32>(at)) - expected).abs() < 1e-6);
    }
}

#[test]
fn wind_moves_what_is_in_it_and_nothing_else() {
    let noise = r#""n": {"type": "noise", "frequency": 2, "bias": 0.1}"#;
    let blowing = format!(r#"{{"type": "wind", "velocity": [0.5, 0, -2], {noise}}}"#);
    let both = format!(r#"{{"type": "sum", "w": {blowing}, "still": {{"type": "exponential"}}}}"#);
    let at = |time| Place { time, ..HERE };
    let moving = json(&blowing, &at(1.5)).unwrap();
    let start = json(&blowing, &at(0.0)).unwrap();
    let (sum, still) = (json(&both, &at(1.5)).unwrap(), json(r#"{"type": "exponential"}"#, &HERE).unwrap());
    let mut stream = Stream::new(8, 0, 0, Purpose::Study);
    for _ in 0..100 {
        let from = position(&mut stream);
        let to = from + vec3(0.75, 0.0, -3.0);
        assert!((moving.eval::<f32>(to) - start.eval::<f32>(from)).abs() < 1e-5);
        let parts = moving.eval::<f32>(to) + still.eval::<f32>(to);
        assert!((sum.eval::<f32>(to) - parts).abs() < 1e-6);
    }
    let twice = format!(r#"{{"type": "wind", "velocity": [0.5, 0, -2], "w": {blowing}}}"#);
    let (twice, later) = (json(&twice, &at(1.5)).unwrap(), json(&blowing, &at(3.0)).unwrap());
    assert_eq!(twice.eval::<f32>(Vec3::ONE), later.eval::<f32>(Vec3::ONE));
}

/// Seen from 1e5 m away from the file's origin nothing is lost.
#[test]
fn recentring_changes_nothing() {
    let recentre = DVec3::new(1e5, -3e4, 7e4);
    let place = Place { recentre, ..HERE };
    for (fog, _) in SPELLINGS {
        let (far, near) = (json(fog, &place).unwrap(), json(fog, &HERE).unwrap());
        let mut stream = Stream::new(9, 0, 0, Purpose::Study);
        for _ in 0..50 {
            // Exactly representable in both.
            let at = (position(&mut stream) * 64.0).round() / 64.0;
            let other: Spectrum = near.eval((at.as_dvec3() + recentre).as_vec3());
            let found: Spectrum = far.eval(at);
            assert!(
                (found - other).abs().max_element() <= 2e-6 * other.abs().max_element(),
                "{found} {other}"
            );
        }
    }
}

const TABLE: Table = table! {
    "Any plugin.";
    volume("a", "", f64::INFINITY, Is(0.25), ""),
    volume("b", "", f64::INFINITY, Is(0.25), ""),
    volume("c", "", f64::INFINITY, Is(0.25), ""),
    volume("d", "", f64::INFINITY, Is(0.25), ""),
    volume("e", "", f64::INFINITY, Is(0.25), ""),
};

#[test]
fn a_parameter_may_be_a_number_or_a_volume() {
    let text = r#"{"type": "scene", "fog": {"type": "heterogeneous", "a": 0.5, "b": {"type": "exponential"},
        "c": {"type": "rgb", "value": [1, 2, 3]}, "d": {"type": "ref", "id": "waves"}},
        "waves": {"type": "cosine", "a": {"type": "wave", "vector": [1, 0, 0]}}}"#;
    let desk = tempfile::tempdir().unwrap();
    let path = desk.path().join("a.json");
    std::fs::write(&path, text).unwrap();
    let root = format::read(&path, &[]).unwrap();
    let library = Library::new(&root).unwrap();
    let params = Params::new(library.resolve("fog", &root.location).unwrap(), &library, &TABLE);
    let get = |name| parameter(&params, name, &HERE).unwrap();
    assert!(
        matches!(get("a"), Volume::Constant(c) if c.eval::<Spectrum>(Vec3::ZERO) == Spectrum::splat(0.5))
    );
    assert!(matches!(get("b"), Volume::Exponential(_)));
    assert!(
        matches!(get("c"), Volume::Constant(c) if c.eval::<Spectrum>(Vec3::ZERO) == Spectrum::new(1.0, 2.0, 3.0))
    );
    assert!(matches!(get("d"), Volume::Cosine(_)));
    assert!(
        matches!(get("e"), Volume::Constant(c) if c.eval::<Spectrum>(Vec3::ZERO) == Spectrum::splat(0.25))
    );
    params.finish().unwrap();
}
