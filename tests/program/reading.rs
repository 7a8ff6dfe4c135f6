//! Scene files in both spellings: what they mean, and what is said of broken ones.

use crate::{common::pieces::*, sandbox::Sandbox};
use serde_json::json;
use std::{fs, path::Path};
use tyndall::{
    description::{Object, TransformStep, Value},
    error::Error,
    format, scene, settings,
};

impl Sandbox {
    fn read_scene(&self, name: &str, definitions: &[(&str, &str)]) -> Result<Object, Error> {
        let definitions: Vec<_> = definitions.iter().map(|(n, v)| (n.to_string(), v.to_string())).collect();
        format::read(&self.path(name), &definitions)
    }
}

fn read_xml(inside: &str, definitions: &[(&str, &str)]) -> Result<Object, Error> {
    let text = format!("<scene version=\"3.0.0\">{inside}</scene>");
    Sandbox::with_files(&[("scene.xml", &text)]).read_scene("scene.xml", definitions)
}

fn read_json(text: &str, definitions: &[(&str, &str)]) -> Result<Object, Error> {
    Sandbox::with_files(&[("scene.json", text)]).read_scene("scene.json", definitions)
}

fn property<'a>(object: &'a Object, name: &str) -> &'a Value {
    &object.properties.iter().find(|p| p.name == name).unwrap_or_else(|| panic!("no {name}")).value
}

fn child(object: &Object, index: usize) -> &Object {
    match &object.properties[index].value {
        Value::Object(child) => child,
        other => panic!("{}", other.describe()),
    }
}

/// The value of `<... name="v"/>` in a plugin.
fn xml_value(element: &str) -> Value {
    let scene = read_xml(&format!("<shape type=\"s\">{element}</shape>"), &[]).unwrap();
    property(child(&scene, 0), "v").clone()
}

fn json_value(value: &str) -> Value {
    let text = format!("{{\"type\": \"scene\", \"s\": {{\"type\": \"s\", \"v\": {value}}}}}");
    property(child(&read_json(&text, &[]).unwrap(), 0), "v").clone()
}

/// Numbers are equal where builders take them for equal; places, tags, and names and ids that only one of the
/// spellings has to give do not count.
fn assert_same(a: &Object, b: &Object) {
    assert_eq!(a.plugin, b.plugin);
    assert_eq!(a.properties.len(), b.properties.len(), "{}", a.plugin);
    if let (Some(a), Some(b)) = (&a.id, &b.id) {
        assert_eq!(a, b);
    }
    for (p, q) in a.properties.iter().zip(&b.properties) {
        if !p.name.is_empty() && !q.name.is_empty() {
            assert_eq!(p.name, q.name);
        }
        match (&p.value, &q.value) {
            (Value::Object(a), Value::Object(b)) => assert_same(a, b),
            (Value::Integer(i), Value::Float(x)) | (Value::Float(x), Value::Integer(i)) => {
                assert_eq!(*i as f64, *x)
            }
            (a, b) => assert_eq!(a, b),
        }
    }
}

#[test]
fn both_spellings_of_a_scene_are_one_tree() {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scenes");
    for definitions in [vec![], vec![("res".to_owned(), "7".to_owned())]] {
        let xml = format::read(&scenes.join("lampbox_down.xml"), &definitions).unwrap();
        let json = format::read(&scenes.join("lampbox_down.json"), &definitions).unwrap();
        assert_same(&xml, &json);
        let width = property(child(child(&xml, 2), 2), "width");
        assert_eq!(*width, Value::Integer(if definitions.is_empty() { 48 } else { 7 }));
    }
}

#[test]
fn every_value_has_both_spellings() {
    let look = TransformStep::LookAt { origin: [0.0; 3], target: [0.0, 0.0, 1.0], up: [1.0, 0.0, 0.0] };
    let rows = [
        (r#"<float name="v" value="-1.25e-3"/>"#, "-1.25e-3", Value::Float(-1.25e-3)),
        (r#"<integer name="v" value="12"/>"#, "12", Value::Integer(12)),
        (r#"<boolean name="v" value="True"/>"#, "true", Value::Boolean(true)),
        (r#"<string name="v" value="a, b"/>"#, r#""a, b""#, Value::String("a, b".into())),
        (r#"<point name="v" value="1, 2 3"/>"#, "[1, 2, 3]", Value::Vector([1.0, 2.0, 3.0])),
        (r#"<vector name="v" x="1" y="2" z="3"/>"#, "[1, 2, 3.0]", Value::Vector([1.0, 2.0, 3.0])),
        (
            r#"<rgb name="v" value="0.1 0.2 0.3"/>"#,
            r#"{"type": "rgb", "value": [0.1, 0.2, 0.3]}"#,
            Value::Rgb([0.1, 0.2, 0.3]),
        ),
        (
            r##"<rgb name="v" value="#ff00ff"/>"##,
            r##"{"type": "rgb", "value": "#ff00ff"}"##,
            Value::Rgb([1.0, 0.0, 1.0]),
        ),
        (
            r#"<spectrum name="v" value="0.5"/>"#,
            r#"{"type": "spectrum", "value": 0.5}"#,
            Value::Spectrum(vec![(0.0, 0.5)]),
        ),
        (
            r#"<spectrum name="v" value="400:0.1, 700:0.4"/>"#,
            r#"{"type": "spectrum", "value": [[400, 0.1], [700, 0.4]]}"#,
            Value::Spectrum(vec![(400.0, 0.1), (700.0, 0.4)]),
        ),
        (r#"<transform name="v"/>"#, "[]", Value::Transform(vec![])),
        (
            r#"<transform name="v"><scale x="2"/><translate value="1,2,3"/></transform>"#,
            r#"[{"type": "scale", "x": 2}, {"type": "translate", "value": [1, 2, 3]}]"#,
            Value::Transform(vec![
                TransformStep::Scale([2.0, 1.0, 1.0]),
                TransformStep::Translate([1.0, 2.0, 3.0]),
            ]),
        ),
        (
            r#"<transform name="v"><rotate value="0 0 1" angle="90"/></transform>"#,
            r#"[{"type": "rotate", "axis": [0, 0, 1], "angle": 90}]"#,
            Value::Transform(vec![TransformStep::Rotate { axis: [0.0, 0.0, 1.0], angle: 90.0 }]),
        ),
        (
            r#"<transform name="v"><lookat origin="0,0,0" target="0,0,1"/></transform>"#,
            r#"[{"type": "lookat", "origin": [0, 0, 0], "target": [0, 0, 1]}]"#,
            Value::Transform(vec![look]),
        ),
        (
            r#"<transform name="v"><matrix value="2 0 0 0 3 0 0 0 4"/></transform>"#,
            r#"[{"type": "matrix", "value": [2, 0, 0, 0,  0, 3, 0, 0,  0, 0, 4, 0,  0, 0, 0, 1]}]"#,
            Value::Transform(vec![TransformStep::Matrix([
                2.0, 0.0, 0.0, 0.0, 0.0, 3.0, 0.0, 0.0, 0.0, 0.0, 4.0, 0.0, 0.0, 0.0, 0.0, 1.0,
            ])]),
        ),
    ];
    for (xml, json, value) in rows {
        assert_eq!(xml_value(xml), value, "{xml}");
        assert_eq!(json_value(json), value, "{json}");
    }
}

#[test]
fn a_constant_spectrum_file_and_a_sampled_one() {
    let files = [
        (
            "scene.xml",
            r#"<scene version="2.1.0"><bsdf type="b"><spectrum name="v" filename="s.spd"/></bsdf></scene>"#,
        ),
        (
            "scene.json",
            r#"{"type": "scene", "b": {"type": "b", "v": {"type": "spectrum", "filename": "s.spd"}}}"#,
        ),
        ("s.spd", "# glass\n400 0.1 # violet\n\n700.5\t0.4\n"),
    ];
    let sandbox = Sandbox::with_files(&files);
    for name in ["scene.xml", "scene.json"] {
        let scene = sandbox.read_scene(name, &[]).unwrap();
        let pairs = Value::Spectrum(vec![(400.0, 0.1), (700.5, 0.4)]);
        assert_eq!(*property(child(&scene, 0), "v"), pairs);
    }
}

#[test]
fn parameters_are_put_in_place_of_their_names() {
    let xml = r#"<default name="a" value="1"/><default name="b" value="$a"/><default name="b" value="3"/>
        <shape type="$kind"><float name="r" value="$b$a"/><string name="s" value="\$a"/></shape>"#;
    let scene = read_xml(xml, &[("kind", "sphere")]).unwrap();
    let shape = child(&scene, 0);
    assert_eq!(shape.plugin, "sphere");
    assert_eq!(*property(shape, "r"), Value::Float(11.0));
    assert_eq!(*property(shape, "s"), Value::String("$a".into()));
    let json = r#"{"type": "scene", "$defaults": {"n": 4, "x": 0.5, "on": false, "dir": "maps", "file": "$dir/a"},
        "s": {"type": "$kind", "n": "$n", "x": "$x", "on": "$on", "f": "$file.png", "v": ["$x", "$n", 2], "t": "\\$n"}}"#;
    let scene = read_json(json, &[("kind", "sphere"), ("x", "3"), ("on", "true"), ("dir", "7")]).unwrap();
    let shape = child(&scene, 0);
    assert_eq!(shape.plugin, "sphere");
    for (name, value) in [
        ("n", Value::Integer(4)),
        ("x", Value::Float(3.0)),
        ("on", Value::Boolean(true)),
        ("f", Value::String("7/a.png".into())),
        ("v", Value::Vector([3.0, 4.0, 2.0])),
        ("t", Value::String("$n".into())),
    ] {
        assert_eq!(*property(shape, name), value, "{name}");
    }
}

#[test]
fn names_and_references() {
    let xml = r#"<bsdf type="diffuse" id="a"/><alias id="a" as="b"/><alias id="b" as="c"/>
        <shape type="sphere"><ref name="skin" id="c"/><ref id="a"/></shape>"#;
    let scene = read_xml(xml, &[]).unwrap();
    let shape = child(&scene, 1);
    assert_eq!(*property(shape, "skin"), Value::Reference("a".into()));
    assert_eq!(shape.properties[1].name, "");
    // In JSON either the key or the object's own id leads to it; keys further in are no ids.
    let json = r#"{"type": "scene", "a": {"type": "diffuse", "id": "own"},
        "s": {"type": "sphere", "bsdf": {"type": "ref", "id": "a"}, "other": {"type": "ref", "id": "own"}},
        "t": {"type": "sphere", "bsdf": {"type": "diffuse"}}, "u": {"type": "sphere", "bsdf": {"type": "diffuse"}}}"#;
    let scene = read_json(json, &[]).unwrap();
    assert_eq!(child(&scene, 0).id.as_deref(), Some("own"));
    assert_eq!(child(&scene, 2).id.as_deref(), Some("t"));
    assert_eq!(child(child(&scene, 2), 0).id, None);
    for name in ["bsdf", "other"] {
        assert_eq!(*property(child(&scene, 1), name), Value::Reference("own".into()));
    }
}

#[test]
fn includes_and_search_folders() {
    let sandbox = Sandbox::with_files(&[
        (
            "scene.xml",
            r#"<scene version="3.0.0"><path value="assets"/><default name="r" value="2"/>
               <include filename="parts/all.xml"/><include filename="fog.xml" name="interior"/>
               <shape type="obj"><string name="filename" value="a.obj"/></shape>
               <shape type="obj"><string name="filename" value="b.obj"/></shape></scene>"#,
        ),
        ("b.obj", ""),
        ("assets/a.obj", ""),
        ("assets/fog.xml", r#"<medium version="3.0.0" type="homogeneous"/>"#),
        (
            "parts/all.xml",
            "<scene version=\"3.0.0\"><shape type=\"sphere\">\n<float name=\"radius\" value=\"$r\"/></shape>
             <shape type=\"obj\"><string name=\"filename\" value=\"a.obj\"/></shape>
             <shape type=\"obj\"><string name=\"filename\" value=\"c.obj\"/></shape></scene>",
        ),
        ("parts/c.obj", ""),
    ]);
    let scene = sandbox.read_scene("scene.xml", &[]).unwrap();
    assert_eq!(scene.properties.len(), 6);
    let radius = &child(&scene, 0).properties[0];
    assert_eq!(radius.value, Value::Float(2.0));
    assert!(radius.location.to_string().ends_with("parts/all.xml:2:1"), "{}", radius.location);
    assert_eq!(
        (scene.properties[3].name.as_str(), child(&scene, 3).tag.as_deref()),
        ("interior", Some("medium"))
    );
    // Names that a file's own folder answers stay as they are; the others become absolute.
    let name = |i: usize| match property(child(&scene, i), "filename") {
        Value::String(name) => name.clone(),
        other => panic!("{}", other.describe()),
    };
    let found = sandbox.path("assets/a.obj").display().to_string();
    assert_eq!([name(1), name(2), name(4), name(5)], [&found, "c.obj", &found, "b.obj"]);
}

/// Files that include one another, as `files` of [`Sandbox`].
const MANY_FILES: [(&str, &str); 5] = [
    (
        "a.xml",
        r#"<scene version="3.0.0"><path value="lib"/><default name="r" value="2"/><default name="again" value="$r"/>
           <default name="file" value="parts/b.xml"/><include filename="$file"/>
           <shape type="sphere"><float name="radius" value="$late"/></shape><include filename="found.xml"/>
           <shape type="sphere"><ref id="skin3"/><float name="radius" value="$again"/></shape></scene>"#,
    ),
    (
        "parts/b.xml",
        r#"<scene version="2.1.0"><default name="r" value="99"/><default name="late" value="3"/>
           <include filename="inner/c.xml"/><include filename="parts/inner/c.xml"/>
           <shape type="sphere"><float name="radius" value="$r"/></shape><bsdf type="diffuse" id="skin"/>
           <alias id="skin" as="skin2"/><alias id="skin2" as="skin3"/></scene>"#,
    ),
    (
        "parts/inner/c.xml",
        r#"<scene version="3.0.0"><shape type="sphere"><float name="radius" value="$late"/></shape></scene>"#,
    ),
    (
        "lib/found.xml",
        r#"<shape type="sphere" version="3.0.0"><float name="radius" value="5"/><ref id="skin"/></shape>"#,
    ),
    (
        "leak.xml",
        r#"<scene version="3.0.0"><include filename="parts/path.xml"/><include filename="found.xml"/></scene>"#,
    ),
];

/// The radii of all spheres in file order; what Mitsuba 3.9.1 makes of the same files.
#[test]
fn many_files_are_read_as_mitsuba_reads_them() {
    let sandbox = Sandbox::with_files(&MANY_FILES);
    for (definitions, expected) in [
        (&[][..], [3.0, 3.0, 2.0, 3.0, 5.0, 2.0]),
        (&[("r", "4")], [3.0, 3.0, 4.0, 3.0, 5.0, 4.0]),
        (&[("late", "6")], [6.0, 6.0, 2.0, 6.0, 5.0, 2.0]),
        (&[("again", "7"), ("file", "parts/b.xml")], [3.0, 3.0, 2.0, 3.0, 5.0, 7.0]),
    ] {
        let scene = sandbox.read_scene("a.xml", definitions).unwrap();
        let spheres = scene.properties.iter().filter_map(|p| match &p.value {
            Value::Object(child) if child.plugin == "sphere" => Some(property(child, "radius")),
            _ => None,
        });
        let expected = expected.map(Value::Float);
        assert!(spheres.eq(&expected), "{definitions:?}");
        let Value::Object(last) = &scene.properties.last().unwrap().value else { panic!() };
        assert_eq!(last.properties[0].value, Value::Reference("skin".into()));
    }
    let error = sandbox.read_scene("a.xml", &[("lat", "6")]).unwrap_err();
    assert!(error.found.contains("-D lat=6") && error.remedy.contains("did you mean \"late\""), "{error}");
}

/// A `path` holds for its file and what that includes, not for the file that includes it; a default holds from its
/// place on; the version is each file's own. As in Mitsuba.
#[test]
fn what_holds_in_a_file_and_what_beyond() {
    let sandbox = Sandbox::with_files(&MANY_FILES);
    let write = |name: &str, inside: &str| {
        fs::write(sandbox.path(name), format!("<scene version=\"3.0.0\">{inside}</scene>")).unwrap();
    };
    write("parts/path.xml", "<path value=\"../lib\"/><bsdf type=\"diffuse\" id=\"skin\"/>");
    let error = sandbox.read_scene("leak.xml", &[]).unwrap_err();
    assert!(error.place.ends_with("leak.xml:1:69") && error.expected.contains("existing file"), "{error}");
    write(
        "late.xml",
        "<shape type=\"s\"><float name=\"a\" value=\"$x\"/></shape><default name=\"x\" value=\"2\"/>",
    );
    assert!(sandbox.read_scene("late.xml", &[]).unwrap_err().found.contains("$x"));
    write("old.xml", "<include filename=\"parts/old.xml\"/>");
    let old =
        "<scene version=\"0.6.0\"><shape type=\"s\"><float name=\"someWord\" value=\"1\"/></shape></scene>";
    fs::write(sandbox.path("parts/old.xml"), old).unwrap();
    assert_eq!(
        property(child(&sandbox.read_scene("old.xml", &[]).unwrap(), 0), "some_word"),
        &Value::Float(1.0)
    );
    write("young.xml", "<shape type=\"s\"><float name=\"someWord\" value=\"1\"/></shape>");
    assert_eq!(
        property(child(&sandbox.read_scene("young.xml", &[]).unwrap(), 0), "someWord"),
        &Value::Float(1.0)
    );
}

/// As in Mitsuba 3.9.1, whose offsets are scaled; and the spelling `lookAt`, which it does not know.
#[test]
fn versions_before_2_are_upgraded() {
    let old = r#"<scene version="0.6.0">
        <bsdf type="diffuse" id="wall"><texture name="diffuseReflectance" type="checkerboard">
          <float name="uscale" value="2"/><float name="vscale" value="3"/><float name="uoffset" value="0.25"/></texture></bsdf>
        <sensor type="perspective"><transform name="toWorld"><lookAt origin="0,0,5" target="0,0,0" up="0,1,0"/></transform>
          <float name="nearClip" value="0.1"/><sampler type="ldsampler"><integer name="sampleCount" value="2"/></sampler></sensor>
        <shape type="rectangle"><ref id="wall"/></shape><emitter type="constant"/></scene>"#;
    let sandbox = Sandbox::with_files(&[("scene.xml", old)]);
    let texture = child(child(&sandbox.read_scene("scene.xml", &[]).unwrap(), 0), 0).clone();
    let steps = [TransformStep::Translate([0.25, 0.0, 0.0]), TransformStep::Scale([2.0, 3.0, 1.0])];
    assert_eq!(texture.properties.len(), 1);
    assert_eq!(property(&texture, "to_uv"), &Value::Transform(steps.to_vec()));
    sandbox.run("render scene.xml --size 4x4").ends(0);
    sandbox.run("convert scene.xml new.xml").ends(0);
    assert!(sandbox.text("new.xml").contains("name=\"to_uv\""));
    sandbox.run("info new.xml").ends(0);
    let twice = r#"<scene version="0.6.0"><shape type="s"><float name="a_b" value="1"/><float name="aB" value="2"/></shape></scene>"#;
    let error = Sandbox::with_files(&[("scene.xml", twice)]).read_scene("scene.xml", &[]).unwrap_err();
    assert!(error.found.contains("\"a_b\" again"), "{error}");
}

/// What Mitsuba 3.9.1 refuses, or takes for something else, means what it meant in 0.6.
#[test]
fn what_mitsuba_0_6_knew_is_read() {
    let [old, new] = [("0.6.0", OLD), ("3.0.0", NEW)].map(|(version, inside)| {
        let text = format!("<scene version=\"{version}\">{inside}</scene>");
        let sandbox = Sandbox::with_files(&[("scene.xml", &text)]);
        without_notes(&sandbox.read_scene("scene.xml", &[]).unwrap())
    });
    assert_same(&old, &new);
    let moving = r#"<scene version="0.6.0"><shape type="s"><animation name="toWorld"><transform time="0"><scale value="1"/></transform>
        <transform time="1"><scale value="2"/></transform></animation></shape></scene>"#;
    let moving = Sandbox::with_files(&[("scene.xml", moving)]).read_scene("scene.xml", &[]).unwrap();
    assert!(matches!(property(child(&moving, 0), "to_world"), Value::Keyframes(_)));
}

const OLD: &str = r##"
    <camera type="perspective"><sampler type="halton"><integer name="sampleCount" value="2"/></sampler>
      <film type="ldrfilm"><string name="pixelFormat" value="luminanceAlpha"/><string name="fileFormat" value="png"/>
        <float name="gamma" value="2.2"/></film></camera>
    <luminaire type="point"><blackbody name="intensity" temperature="3000K"/></luminaire>
    <shape type="cube">
      <bsdf type="lambertian"><srgb name="reflectance" value="#ff8000"/></bsdf></shape>
    <shape type="cube"><bsdf type="plastic"><spectrum name="diffuseReflectance" value="0.1, 0.2, 0.3"/></bsdf>
      <medium name="interior" type="homogeneous"><rgb name="sigmaS" value="3 1 0"/><float name="sigmaA" value="1"/>
        <string name="strategy" value="balance"/></medium></shape>
    <shape type="cube"><bsdf type="diffuse"><texture type="bitmap" name="reflectance"><string name="filename" value="a.png"/>
        <string name="filterType" value="ewa"/><float name="gamma" value="1"/></texture></bsdf>
      <medium name="interior" type="heterogeneous"><string name="method" value="woodcock"/>
        <volume name="density" type="gridvolume"><string name="filename" value="a.vol"/></volume></medium></shape>"##;

const NEW: &str = r##"
    <sensor type="perspective"><sampler type="ldsampler"><integer name="sample_count" value="2"/></sampler>
      <film type="hdrfilm"><string name="pixel_format" value="luminance_alpha"/></film></sensor>
    <emitter type="point"><texture name="intensity" type="blackbody"><float name="temperature" value="3000"/></texture></emitter>
    <shape type="cube">
      <bsdf type="diffuse"><rgb name="reflectance" value="#ff8000"/></bsdf></shape>
    <shape type="cube"><bsdf type="plastic"><rgb name="diffuse_reflectance" value="0.1, 0.2, 0.3"/></bsdf>
      <medium name="interior" type="homogeneous"><rgb name="sigma_t" value="4 2 1"/><rgb name="albedo" value="0.75 0.5 0"/></medium></shape>
    <shape type="cube"><bsdf type="diffuse"><texture type="bitmap" name="reflectance"><string name="filename" value="a.png"/>
        <string name="filter_type" value="bilinear"/><boolean name="raw" value="true"/></texture></bsdf>
      <medium name="interior" type="heterogeneous">
        <volume name="sigma_t" type="gridvolume"><string name="filename" value="a.vol"/><boolean name="use_grid_bbox" value="true"/></volume></medium></shape>"##;

/// Mitsuba reads what XML forbids, and takes no notice of what is no element.
#[test]
fn what_is_no_element_means_nothing() {
    let plain = read_xml("<shape type=\"s\"><float name=\"a\" value=\"1\"/></shape>", &[]).unwrap();
    for text in [
        "\n<?xml version=\"1.0\"?><!DOCTYPE scene SYSTEM \"a.dtd\"><scene version=\"3.0.0\"><shape type=\"s\"><float name=\"a\" value=\"1\"/></shape></scene>",
        "\u{feff}<scene version=\"3.0.0\"><!-- -- a -- --><shape type=\"s\"><!-- b ---><float name=\"a\" value=\"1\"><!--c--></float></shape></scene><!-- d -->",
        "<scene version=\"3.0.0\">one<shape type=\"s\"><![CDATA[two]]><float name=\"a\" value=\"1\">three</float></shape></scene>",
    ] {
        let sandbox = Sandbox::with_files(&[("scene.xml", text)]);
        let scene = sandbox.read_scene("scene.xml", &[]).unwrap();
        assert_same(&without_notes(&scene), &plain);
        let notes: Vec<_> = scene.properties.iter().filter(|p| matches!(p.value, Value::Note(_))).collect();
        assert_eq!(notes.len(), if text.contains("CDATA") { 3 } else { 0 });
        if let Some(last) = notes.last() {
            assert!(last.location.to_string().ends_with("scene.xml:1:84"), "{}", last.location);
        }
    }
}

/// As in Mitsuba, XML may be in Latin-1 where it says so.
#[test]
fn latin_letters_are_read() {
    let head = b"<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?><!-- caf\xe9 -->";
    let scene =
        b"<scene version=\"3.0.0\"><shape type=\"s\"><string name=\"a\" value=\"\xfc\"/></shape></scene>";
    let sandbox = Sandbox::with_files(&[]);
    fs::write(sandbox.path("scene.xml"), [&head[..], scene].concat()).unwrap();
    let scene = sandbox.read_scene("scene.xml", &[]).unwrap();
    assert_eq!(property(child(&scene, 0), "a"), &Value::String("\u{fc}".to_owned()));
}

fn without_notes(object: &Object) -> Object {
    let mut copy = object.clone();
    copy.properties.retain(|property| !matches!(property.value, Value::Note(_)));
    for property in &mut copy.properties {
        if let Value::Object(child) = &mut property.value {
            *child = without_notes(child);
        }
    }
    copy
}

/// Editors name the schema; people write comments.
#[test]
fn json_has_keys_that_mean_nothing() {
    let plain = read_json(
        r#"{"type": "scene", "a": {"type": "s", "t": [{"type": "matrix", "value": [1, 2, 3, 4, 5, 6, 7, 8, 9]}]}}"#,
        &[],
    );
    let with = read_json(
        r#"{"$schema": "x", "type": "scene", "//": "$one", "// 2": {}, "a": {"type": "s", "//": [3],
            "t": [{"type": "matrix", "//": 1, "value": [[1, 2, 3], [4, 5, 6], [7, 8, 9]]}]}}"#,
        &[],
    );
    let alone =
        read_json(r#"{"type": "scene", "a": {"type": "s", "t": [[1, 2, 3], [4, 5, 6], [7, 8, 9]]}}"#, &[]);
    let plain = plain.unwrap();
    assert_same(&with.unwrap(), &plain);
    assert_same(&alone.unwrap(), &plain);
}

/// Comments at the ends of lines, and the byte-order mark of some editors.
#[test]
fn meshes_may_hold_comments_and_a_mark() {
    let quad = "v -1 -1 0\nv 1 -1 0 # right\nv 1 1 0\nv -1 1 0\nf 1 2 3 4# a quad\n#f 1 2 3\n";
    let scene = json!({"type": "scene", "camera": camera([0.0, 0.0, 4.0], [0.0; 3], 4), "sky": sky(1.0),
        "wall": {"type": "obj", "filename": "wall.obj"}});
    for mark in ["", "\u{feff}"] {
        let (scene, wall) = (format!("{mark}{scene}"), format!("{mark}{quad}"));
        let sandbox = Sandbox::with_files(&[("scene.json", &scene), ("wall.obj", &wall)]);
        let said = sandbox.run("info scene.json").ends(0).out();
        assert!(said.contains("1 (2 primitives)"), "{said}");
    }
}

/// As in Mitsuba, the first is rendered.
#[test]
fn one_of_several_sensors_is_rendered() {
    let scene = scene(&[
        ("front", camera([0.0, 0.0, 4.0], [0.0; 3], 2)),
        ("away", camera([0.0, 0.0, 4.0], [0.0, 0.0, 9.0], 2)),
        ("lamp", lamp_ball([0.0; 3], 3.0, 2.0)),
    ]);
    let sandbox = Sandbox::with_scene(&scene);
    let said = sandbox.run("info scene.json").ends(0).err();
    assert!(said.contains("2 sensors. Sensor 0 (\"front\") is rendered"), "{said}");
    assert!(said.contains("--sensor chooses another: 1 (\"away\")"), "{said}");
    for (words, light) in [("", 2.0), ("--sensor 0", 2.0), ("--sensor away", 0.0), ("--sensor 1", 0.0)] {
        let run = sandbox.run(&format!("render scene.json --spp 1 -o a.exr {words}")).ends(0);
        assert_eq!(run.err().contains("2 sensors"), words.is_empty(), "{}", run.err());
        assert_eq!(sandbox.channels("a.exr")["R"][0], light, "{words}");
    }
    sandbox.run("render scene.json --sensor 2").refuses(&["from 0 to 1", "--sensor 2", "front"]);
    let kept = "render scene.json --strategies hit --sums a.sums";
    sandbox.run(&format!("{kept} --spp 1")).ends(0);
    sandbox.run(&format!("{kept} --spp 2 --resume --sensor 1")).refuses(&["sensor = \"1\""]);
}

/// The year after has no such day.
#[test]
fn a_timed_sky_may_start_on_the_29th_of_february() {
    let leap = json!({"type": "timed_sunsky", "start_year": 2024, "start_month": 2, "start_day": 29, "sky_scale": 0});
    let sandbox =
        Sandbox::with_scene(&scene(&[("camera", camera([0.0; 3], [0.0, 0.0, 9.0], 1)), ("sky", leap)]));
    sandbox.run("info scene.json").ends(0);
}

/// Each has its part of the batch's film, whatever its own.
#[test]
fn all_sensors_of_a_batch_are_rendered() {
    let batch = json!({"type": "batch", "front": camera([0.0, 0.0, 4.0], [0.0; 3], 9),
        "away": camera([0.0, 0.0, 4.0], [0.0, 0.0, 9.0], 9),
        "film": {"type": "hdrfilm", "width": 6, "height": 2, "rfilter": {"type": "box"}},
        "sampler": {"type": "independent", "sample_count": 1}});
    let sandbox = Sandbox::with_scene(&scene(&[("both", batch), ("lamp", lamp_ball([0.0; 3], 3.0, 2.0))]));
    sandbox.run("render scene.json --sensor all -o a.exr").ends(0);
    for (file, light) in [("a_front.exr", 2.0), ("a_away.exr", 0.0)] {
        assert_eq!(sandbox.channels(file)["R"], [light; 6], "{file}");
    }
    sandbox.run("render scene.json --sensor all --report r.json").refuses(&["--report", "one sensor"]);
    sandbox.run("render scene.json --sensor all --json").refuses(&["--json", "one sensor"]);
    sandbox.run("render scene.json --sensor away").ends(0);
    assert_eq!(sandbox.channels("scene.exr")["R"], [0.0; 6]);
    sandbox.run("render scene.json --sensor all -o /dev/null").refuses(&["device", "one sensor"]);
    let sandbox = Sandbox::with_scene(&scene(&[("lamp", lamp_ball([0.0; 3], 3.0, 2.0))]));
    sandbox.run("render scene.json --sensor all").refuses(&["a sensor in the scene", "none"]);
}

/// Whatever is in their ids.
#[test]
fn images_of_several_sensors_do_not_replace_each_other() {
    let named = |ids: [&str; 2]| {
        let cameras = ids.map(|id| {
            let mut camera = camera([0.0, 0.0, 4.0], [0.0; 3], 2);
            camera["id"] = id.into();
            camera
        });
        let [a, b] = cameras;
        scene(&[("a", a), ("b", b), ("lamp", lamp_ball([0.0; 3], 3.0, 2.0))])
    };
    let sandbox = Sandbox::with_scene(&named(["x.1", "x/../2"]));
    sandbox.run("render scene.json --sensor all --spp 1").ends(0);
    for file in ["scene_x_1.exr", "scene_x____2.exr"] {
        assert_eq!(sandbox.channels(file)["R"], [2.0; 4], "{file}");
    }
    let sandbox = Sandbox::with_scene(&named(["x.1", "X_1"]));
    sandbox.run("render scene.json --sensor all").refuses(&["a second one for scene_X_1", "another id"]);
}

/// Mitsuba 3 renames the parameters of scenes before version 2 only: in later ones such names are mistakes.
#[test]
fn versions_from_2_on_have_no_camel_case() {
    for version in ["2.0.0", "2.1.0", "3.0.0", "3.9"] {
        let text = format!(
            "<scene version=\"{version}\"><sensor type=\"perspective\"/>
             <bsdf type=\"dielectric\"><float name=\"intIOR\" value=\"1.3\"/></bsdf></scene>"
        );
        let scene = Sandbox::with_files(&[("scene.xml", &text)]).read_scene("scene.xml", &[]).unwrap();
        let Err(error) = scene::build::build(&scene, settings::Overrides::default()) else { panic!() };
        assert!(error.found.contains("intIOR") && error.remedy.contains("\"int_ior\""), "{error}");
    }
}

#[test]
fn spectra_with_a_type_are_textures() {
    let scene = read_xml(r#"<emitter type="e"><spectrum name="v" type="uniform"/></emitter>"#, &[]).unwrap();
    let Value::Object(spectrum) = property(child(&scene, 0), "v") else { panic!() };
    assert_eq!((spectrum.tag.as_deref(), spectrum.plugin.as_str()), (Some("texture"), "uniform"));
}

/// Place and message of each mistake, as parts that must occur in them.
struct Broken {
    text: &'static str,
    place: &'static str,
    words: &'static [&'static str],
}

fn broken(text: &'static str, place: &'static str, words: &'static [&'static str]) -> Broken {
    Broken { text, place, words }
}

fn check(rows: &[Broken], read: impl Fn(&str) -> Result<Object, Error>) {
    for Broken { text, place, words } in rows {
        let error = match read(text) {
            Err(error) => error,
            Ok(_) => panic!("not refused: {text}"),
        };
        assert!(error.place.ends_with(place), "{text}\n{error}");
        let message = error.to_string();
        for word in *words {
            assert!(message.contains(word), "{text}\n{error}\nlacks {word}");
        }
        assert!(!error.remedy.is_empty());
    }
}

#[test]
fn broken_xml_is_refused_with_place_and_remedy() {
    // All stand after `<scene version="3.0.0">`, which is 23 characters long.
    let rows = [
        broken("<shap type='s'/>", "scene.xml:1:24", &["<shap>", "did you mean \"shape\""]),
        broken("\n <shape type='s' idd='a'/>", "scene.xml:2:18", &["\"idd\"", "did you mean \"id\""]),
        broken("<shape/>", "scene.xml:1:24", &["\"type\"", "no attributes"]),
        broken("<shape type=''/>", "scene.xml:1:31", &["some text"]),
        broken("<float name='a' value='x'/>", "scene.xml:1:40", &["a finite number", "\"x\""]),
        broken("<float name='a' value='1 2'/>", "scene.xml:1:40", &["a finite number"]),
        broken("<float name='a' value='inf'/>", "scene.xml:1:40", &["finite"]),
        broken("<float value='1'/>", "scene.xml:1:24", &["\"name\"", "only value"]),
        broken("<float name='a' value='1'><b/></float>", "scene.xml:1:50", &["nothing in <float>", "<b>"]),
        broken("<integer name='a' value='1.0'/>", "scene.xml:1:42", &["whole number"]),
        broken("<string name='a'></string>", "scene.xml:1:24", &["\"value\""]),
        broken("<boolean name='a' value='yes'/>", "scene.xml:1:42", &["\"true\" or \"false\""]),
        broken("<point name='a' value='1,2'/>", "scene.xml:1:40", &["one or three numbers", "2 numbers"]),
        broken("<point name='a' x='1' y='2'/>", "scene.xml:1:24", &["no \"z\""]),
        broken("<vector name='a' value='1' x='2'/>", "scene.xml:1:24", &["either", "both"]),
        broken("<rgb name='a' value='1,2'/>", "scene.xml:1:38", &["one or three numbers"]),
        broken("<rgb name='a' value='#12345'/>", "scene.xml:1:38", &["six hexadecimal digits"]),
        broken(
            "<spectrum name='a' value='500:1 400:1'/>",
            "scene.xml:1:43",
            &["increasing", "400 after 500"],
        ),
        broken("<spectrum name='a' value='500:1 2'/>", "scene.xml:1:43", &["wavelength:value"]),
        broken("<spectrum name='a'/>", "scene.xml:1:24", &["neither"]),
        broken("<spectrum name='a' filename='no.spd'/>", "scene.xml:1:43", &["existing file", "looked in"]),
        broken("<translate x='1'/>", "scene.xml:1:24", &["inside <transform>"]),
        broken(
            "<transform name='t'><rotat x='1'/></transform>",
            "scene.xml:1:44",
            &["did you mean \"rotate\""],
        ),
        broken(
            "<transform name='t'><rotate angle='1'/></transform>",
            "scene.xml:1:44",
            &["axis other than zero"],
        ),
        broken("<transform name='t'><rotate x='1'/></transform>", "scene.xml:1:44", &["\"angle\""]),
        broken(
            "<transform name='t'><matrix value='1 2'/></transform>",
            "scene.xml:1:52",
            &["16 or 9", "2 numbers"],
        ),
        broken("<transform name='t'><scale value='1 2'/></transform>", "scene.xml:1:51", &["one or three"]),
        broken(
            "<transform name='t'><lookat origin='1 1 1' target='1,1,1'/></transform>",
            "scene.xml:1:44",
            &["target other than the origin"],
        ),
        broken(
            "<transform name='t'><lookat origin='0 0 0' target='0,1,0' up='0 2 0'/></transform>",
            "scene.xml:1:44",
            &["up that is not along"],
        ),
        broken("<float name='a' value='$res'/>", "scene.xml:1:40", &["$res", "-D res="]),
        broken(
            "<default name='rez' value='1'/><float name='a' value='$res'/>",
            ":1:71",
            &["did you mean \"rez\""],
        ),
        broken(
            "<float name='a' value='1'/>\n<float name='a' value='2'/>",
            "scene.xml:2:1",
            &["once", ":1:24"],
        ),
        broken("<ref id='fogg'/><medium type='m' id='fog'/>", "scene.xml:1:24", &["did you mean \"fog\""]),
        broken("<bsdf type='b' id='a'/><bsdf type='b' id='a'/>", "scene.xml:1:47", &["\"a\" again", ":1:24"]),
        broken("<bsdf type='b' id='a'/><alias id='b' as='c'/>", "scene.xml:1:47", &["\"b\"", "known ids: a"]),
        broken("<bsdf type='b' id='a'/><alias id='a' as='a'/>", "scene.xml:1:47", &["\"a\" again"]),
        broken("<bsdf type='b' id='a'><ref id='a'/></bsdf>", "scene.xml:1:46", &["circular", "a -> a"]),
        broken(
            "<bsdf type='b' id='a'><ref id='b'/></bsdf><bsdf type='b' id='b'><bsdf type='c'><ref id='a'/></bsdf></bsdf>",
            "scene.xml:1:103",
            &["a -> b -> a"],
        ),
        broken("<include filename='no.xml'/>", "scene.xml:1:33", &["existing file", "no.xml"]),
        broken("<include filename='scene.xml'/>", "scene.xml:1:33", &["circle"]),
        broken("<path value='no'/>", "scene.xml:1:30", &["existing folder"]),
        broken("<shape type='s'><path value='.'/></shape>", "scene.xml:1:40", &["outermost"]),
        broken("<scene type='scene'/>", "scene.xml:1:24", &["outermost element of a file"]),
        broken("<!-- \u{e9}\u{20ac} --><shap type='s'/>", "scene.xml:1:35", &["<shap>"]),
        broken("<shape type='s'>", "", &["well-formed XML"]),
        broken("<x:shape xmlns:x='u' type='s'/>", "scene.xml:1:24", &["namespace"]),
    ];
    check(&rows, |text| read_xml(text, &[]));
}

#[test]
fn broken_files_of_xml_are_refused() {
    let rows = [
        broken("<shape version='3.0.0' type='s'/>", "scene.xml:1:1", &["<scene>", "<shape>"]),
        broken("<scene/>", "scene.xml:1:1", &["version"]),
        broken("<scene version='4.0.0'/>", "scene.xml:1:8", &["0.x to 3.x"]),
        broken("<scene version='three'/>", "scene.xml:1:8", &["0.x to 3.x"]),
        broken("<scene version='3.0.0'><!-- a</scene>", "scene.xml:1:38", &["well-formed XML"]),
        broken("", "scene.xml:1:1", &["well-formed XML"]),
    ];
    check(&rows, |text| Sandbox::with_files(&[("scene.xml", text)]).read_scene("scene.xml", &[]));
}

#[test]
fn broken_json_is_refused_with_place_and_remedy() {
    let rows = [
        broken(r#"{"type": "scene""#, "scene.json:1:16", &["well-formed JSON", "the end of the file"]),
        broken("{\"type\": \"scene\",\n \"a\": 1,\n \"a\": 2}", "scene.json:3:5", &["once", "\"a\""]),
        broken("[1, 2, 3]", "$", &["\"type\"", "a list of 3"]),
        broken("{}", "$", &["\"type\""]),
        broken(r#"{"type": "sphere"}"#, "$", &["\"scene\"", "\"sphere\""]),
        broken(r#"{"type": "scene", "s": {"radius": 1}}"#, "$.s", &["\"type\"", "one with radius"]),
        broken(r#"{"type": "scene", "s": {"type": 3}}"#, "$.s.type", &["a string", "3"]),
        broken(r#"{"type": "scene", "s": null}"#, "$.s", &["null"]),
        broken(r#"{"type": "scene", "s": [1, 2]}"#, "$.s", &["three numbers", "2 numbers"]),
        broken(r#"{"type": "scene", "s": [1, "2", 3]}"#, "$.s[1]", &["a number", "\"2\""]),
        broken(r#"{"type": "scene", "s": 1e999}"#, "scene.json:1:29", &["within +-1.8e308"]),
        broken(r#"{"type": "scene", "a.b": 1}"#, r#"$["a.b"]"#, &["\".\""]),
        broken(
            r#"{"type": "scene", "s": {"type": "s", "$defaults": {}}}"#,
            "$.s.$defaults",
            &["in the scene"],
        ),
        broken(r#"{"type": "scene", "c": {"type": "rgb", "value": [1, 2]}}"#, "$.c.value", &["one or three"]),
        broken(
            r#"{"type": "scene", "c": {"type": "rgb", "valu": 1}}"#,
            "$.c.valu",
            &["did you mean \"value\""],
        ),
        broken(r#"{"type": "scene", "c": {"type": "rgb"}}"#, "$.c", &["\"value\""]),
        broken(
            r#"{"type": "scene", "c": {"type": "spectrum", "value": "a"}}"#,
            "$.c.value",
            &["a number, or"],
        ),
        broken(
            r#"{"type": "scene", "c": {"type": "spectrum", "value": [[1, 2, 3]]}}"#,
            "$.c.value[0]",
            &["pair"],
        ),
        broken(
            r#"{"type": "scene", "c": {"type": "spectrum", "value": [[2, 1], [1, 1]]}}"#,
            "$.c.value",
            &["increasing"],
        ),
        broken(
            r#"{"type": "scene", "r": {"type": "ref", "id": "fogg"}, "fog": {"type": "m"}}"#,
            "$.r",
            &["\"fog\""],
        ),
        broken(
            r#"{"type": "scene", "a": {"type": "b", "n": {"type": "ref", "id": "a"}}}"#,
            "$.a.n",
            &["a -> a"],
        ),
        broken(
            r#"{"type": "scene", "a": {"type": "b"}, "c": {"type": "d", "id": "a"}}"#,
            "$.c",
            &["\"a\" again"],
        ),
        broken(r#"{"type": "scene", "t": [{"type": "rotat"}]}"#, "$.t[0].type", &["did you mean \"rotate\""]),
        broken(
            r#"{"type": "scene", "t": [{"type": "rotate", "axis": [0, 0, 0], "angle": 1}]}"#,
            "$.t[0]",
            &["zero"],
        ),
        broken(r#"{"type": "scene", "t": [{"type": "scale"}]}"#, "$.t[0]", &["\"value\""]),
        broken(r#"{"type": "scene", "t": {"type": "scale", "value": 2}}"#, "$.t", &["[ and ]"]),
        broken(
            r#"{"type": "scene", "t": [{"type": "matrix", "value": [1]}]}"#,
            "$.t[0].value",
            &["16 or 9", "1 number"],
        ),
        broken(r#"{"type": "scene", "w": "$res"}"#, "$.w", &["$res", "$defaults"]),
        broken(
            r#"{"type": "scene", "$defaults": {"res": [1]}, "w": "$res"}"#,
            "$.$defaults.res",
            &["a list of 1"],
        ),
    ];
    check(&rows, |text| read_json(text, &[]));
}

#[test]
fn definitions_must_fit_the_scene() {
    let json = r#"{"type": "scene", "$defaults": {"res": 4}, "w": "$res"}"#;
    let error = read_json(json, &[("res", "big")]).unwrap_err();
    assert!(error.place.ends_with("$.w") && error.found == "-D res=big", "{error}");
    let xml = r#"<default name="res" value="4"/><integer name="w" value="$res"/>"#;
    for error in [read_json(json, &[("rez", "5")]).unwrap_err(), read_xml(xml, &[("rez", "5")]).unwrap_err()]
    {
        assert!(error.found.contains("-D rez=5") && error.remedy.contains("\"res\""), "{error}");
    }
    assert!(read_xml(xml, &[("res", "1"), ("res", "2")]).unwrap_err().expected.contains("not given before"));
}

#[test]
fn files_that_are_no_scenes_are_refused() {
    let sandbox = Sandbox::with_files(&[("scene.txt", "")]);
    fs::write(sandbox.path("latin.xml"), b"<scene version='3.0.0'><!-- \xe9 --></scene>").unwrap();
    for (name, word) in [
        ("scene.txt", ".xml or .json"),
        ("none.xml", "os error 2"),
        ("none.json", "os error 2"),
        ("latin.xml", "UTF-8"),
    ] {
        let message = sandbox.read_scene(name, &[]).unwrap_err().to_string();
        assert!(message.contains(name) && message.contains(word), "{message}");
    }
}

#[test]
fn mistakes_in_included_files_name_those_files() {
    let sandbox = Sandbox::with_files(&[
        ("scene.xml", r#"<scene version="3.0.0"><include filename="a.xml"/></scene>"#),
        ("a.xml", "<scene version=\"3.0.0\">\n<include filename=\"b.xml\"/></scene>"),
        ("b.xml", "<scene version=\"3.0.0\">\n\n  <include filename=\"a.xml\"/></scene>"),
    ]);
    let error = sandbox.read_scene("scene.xml", &[]).unwrap_err();
    assert!(error.place.ends_with("b.xml:3:12") && error.remedy.contains("circle"), "{error}");
}

#[test]
fn deep_nesting_is_an_error_not_a_crash() {
    let xml = |n| format!("{}{}", "<bsdf type='b'>".repeat(n), "</bsdf>".repeat(n));
    read_xml(&xml(90), &[]).unwrap();
    assert!(read_xml(&xml(50_000), &[]).unwrap_err().to_string().contains("at most 100 deep"));
    let json = |n| format!("{}1{}", r#"{"type": "scene", "a": "#.repeat(n), "}".repeat(n));
    read_json(&json(90), &[]).unwrap();
    assert!(read_json(&json(50_000), &[]).unwrap_err().to_string().contains("at most 127 levels"));
    read_json(&json(110), &[]).unwrap_err();
}

#[test]
fn small_files_that_would_grow_without_end_are_errors() {
    let laughs: String = (1..20)
        .map(|i| format!("<default name='x{i}_' value='{}'/>", format!("$x{}_", i - 1).repeat(10)))
        .collect();
    let error = read_xml(&format!("<default name='x0_' value='0123456789'/>{laughs}"), &[]).unwrap_err();
    assert!(error.expected.contains("at most 1048576 bytes"), "{error}");
    let twice = |i: usize| {
        format!("<scene version='3.0.0'>{0}{0}{0}</scene>", format!("<include filename='{i}.xml'/>"))
    };
    let files: Vec<(String, String)> = (0..12).map(|i| (format!("{i}.xml"), twice(i + 1))).collect();
    let mut files: Vec<(&str, &str)> =
        files.iter().map(|(name, text)| (name.as_str(), text.as_str())).collect();
    files.push(("12.xml", "<scene version='3.0.0'/>"));
    let error = Sandbox::with_files(&files).read_scene("0.xml", &[]).unwrap_err();
    assert!(error.expected.contains("at most 10000 includes"), "{error}");
}

/// Thousands of names of names must not take the square of their time.
#[test]
fn many_aliases_are_quick() {
    let many: String =
        (0..20_000).map(|i| format!("<bsdf type='b' id='a{i}'/><alias id='a{i}' as='b{i}'/>")).collect();
    let started = std::time::Instant::now();
    read_xml(&many, &[]).unwrap();
    assert!(started.elapsed().as_secs() < 10, "{:?}", started.elapsed());
}

#[test]
fn long_chains_and_fans_of_references_are_errors() {
    let chain: String = (0..50_000)
        .map(|i| format!("<bsdf type='b' id='b{i}'><ref id='b{}'/></bsdf>", i + 1))
        .chain(["<bsdf type='b' id='b50000'/>".to_owned()])
        .collect();
    assert!(read_xml(&chain, &[]).unwrap_err().to_string().contains("at most 100 deep"));
    let backwards: String = (0..200)
        .map(|i| match i {
            0 => "<bsdf type='b' id='b0'/>".to_owned(),
            i => format!("<bsdf type='b' id='b{i}'><ref id='b{}'/></bsdf>", i - 1),
        })
        .collect();
    assert!(read_xml(&backwards, &[]).unwrap_err().to_string().contains("at most 100 deep"));
    let fan: String = (0..60)
        .map(|i| match i {
            0 => "<bsdf type='b' id='b0'/>".to_owned(),
            i => format!("<bsdf type='b' id='b{i}'><ref id='b{0}'/><ref id='b{0}'/></bsdf>", i - 1),
        })
        .collect();
    assert!(read_xml(&fan, &[]).unwrap_err().to_string().contains("counted as a copy"));
}

/// The depth of 5 m of air that extinguishes as 1 / lambda^4, 1 at 550 nm: more for blue, less for red.
#[test]
fn a_power_of_the_wavelength_is_a_coefficient_in_both_spellings() {
    let air = serde_json::json!({"type": "homogeneous", "albedo": 0,
        "sigma_t": {"type": "inverse_power", "value": 0.2, "exponent": 4}});
    let look = |from: i32, to: i32| serde_json::json!([{"type": "lookat", "origin": [0, 0, from], "target": [0, 0, to], "up": [0, 1, 0]}]);
    let around = serde_json::json!({"type": "ref", "id": "air"});
    let sandbox = Sandbox::with_scene(&serde_json::json!({
        "type": "scene",
        "integrator": {"type": "non_scattering"},
        "air": air,
        "camera": {"type": "perspective", "fov": 1, "near_clip": 1e-4, "medium": around, "to_world": look(0, 1),
                   "film": {"type": "hdrfilm", "width": 2, "height": 2},
                   "sampler": {"type": "independent", "sample_count": 65536}},
        "lamp": {"type": "rectangle", "to_world": look(5, 0), "exterior": around,
                 "emitter": {"type": "area", "radiance": 1}},
    }));
    sandbox.run("convert scene.json scene.xml").ends(0);
    assert!(sandbox.text("scene.xml").contains("<texture type=\"inverse_power\" name=\"sigma_t\">"));
    for scene in ["scene.json", "scene.xml"] {
        let told = sandbox.run(&format!("info {scene} --json")).ends(0).out();
        let told: serde_json::Value = serde_json::from_str(&told).unwrap();
        let sigma_t = &told["media"][0]["largest_sigma_t"];
        for (channel, depth) in [0.493_680_74, 1.024_496, 2.357_694].into_iter().enumerate() {
            let found = sigma_t[channel].as_f64().unwrap();
            assert!((5.0 * found / depth - 1.0).abs() < 1e-5, "{scene}: {sigma_t}");
        }
    }
}

/// Writes Mitsuba's `.vol` of 10 voxels along each axis.
fn write_vol(sandbox: &Sandbox, name: &str, channels: i32, value: impl Fn(usize) -> f32) {
    let mut bytes = b"VOL\x03".to_vec();
    bytes.extend([1, 10, 10, 10, channels].iter().flat_map(|n: &i32| n.to_le_bytes()));
    bytes.extend([0.0f32, 0.0, 0.0, 1.0, 1.0, 1.0].iter().flat_map(|x| x.to_le_bytes()));
    bytes.extend((0..1000 * channels as usize).flat_map(|index| value(index).to_le_bytes()));
    fs::write(sandbox.path(name), bytes).unwrap();
}

#[test]
fn data_a_hair_out_of_range_renders_with_one_warning_and_is_refused_on_request() {
    let sandbox = Sandbox::with_scene(&scene(&[
        ("camera", camera([0.5, 0.5, 3.0], [0.5, 0.5, 0.5], 4)),
        (
            "box",
            null_box(
                [0.0; 3],
                [1.0; 3],
                Some(json!({"type": "heterogeneous",
                    "sigma_t": {"type": "gridvolume", "filename": "density.vol"},
                    "albedo": {"type": "gridvolume", "filename": "colour.vol"}})),
            ),
        ),
        ("sky", sky(1.0)),
    ]));
    write_vol(&sandbox, "density.vol", 1, |index| if index % 2 == 0 { -8e-24 } else { 1.0 });
    write_vol(&sandbox, "colour.vol", 3, |index| if index % 3 == 0 { 1.2 } else { 0.5 });
    let run = sandbox.run("render scene.json --quiet").ends(0);
    let lines: Vec<_> = run.err().lines().map(str::to_owned).collect();
    let said = ["500 values are out of range and changed: the worst, -8e-24, becomes 0.0", "1000 values are"];
    assert!(lines.len() == 2 && said.iter().zip(&lines).all(|(said, line)| line.contains(said)), "{lines:?}");
    sandbox.run("info scene.json --strict").refuses(&["density.vol", "-8e-24", "--strict"]);
    sandbox.run("render scene.json --strict").refuses(&["density.vol"]);
    write_vol(&sandbox, "density.vol", 1, |index| if index == 7 { f32::NAN } else { 1.0 });
    sandbox.run("render scene.json").refuses(&["density.vol", "NaN", "voxel (7, 0, 0)"]);
}

/// Mitsuba 3.9.1's mean of the image: 0.88804, 0.83747, 0.88799, to 0.1 %.
#[test]
fn a_homogeneous_medium_may_have_an_albedo_of_voxels() {
    let medium = |filename: &str| json!({"type": "homogeneous", "sigma_t": 3, "albedo": {"type": "gridvolume", "filename": filename}});
    let of = |fog: serde_json::Value| {
        scene(&[
            ("camera", with(camera([0.5, 0.5, -3.0], [0.5, 0.5, 0.5], 8), &[("fov", json!(40))])),
            ("box", null_box([0.0; 3], [1.0; 3], Some(fog))),
            ("sky", sky(1.0)),
        ])
    };
    let sandbox = Sandbox::with_scene(&of(medium("colour.vol")));
    let mut bytes = b"VOL\x03".to_vec();
    bytes.extend([1, 2, 1, 1, 3].iter().flat_map(|n: &i32| n.to_le_bytes()));
    let numbers = [0.0f32, 0.0, 0.0, 1.0, 1.0, 1.0, 0.9, 0.1, 0.1, 0.1, 0.1, 0.9];
    bytes.extend(numbers.iter().flat_map(|x| x.to_le_bytes()));
    fs::write(sandbox.path("colour.vol"), bytes).unwrap();
    sandbox.run("render scene.json --quiet --spp 2048 -o fog.exr").ends(0);
    let channels = sandbox.channels("fog.exr");
    for (channel, expected) in [("R", 0.888_04), ("G", 0.837_47), ("B", 0.887_99)] {
        let mean = channels[channel].iter().sum::<f32>() / 64.0;
        assert!((mean - expected).abs() < 0.003, "{channel}: {mean}, not {expected}");
    }
    let mut endless = of(medium("colour.vol")).as_object().unwrap().clone();
    endless.remove("box");
    endless.insert("fog".into(), with(medium("colour.vol"), &[("id", json!("fog"))]));
    endless.insert("camera".into(), with(endless["camera"].clone(), &[("medium", named("fog"))]));
    fs::write(sandbox.path("scene.json"), serde_json::to_string(&endless).unwrap()).unwrap();
    sandbox.run("info scene.json").refuses(&["an end", "surrounds the whole scene"]);
}

/// Mitsuba 3.9.1's mean of the image: 0.96613; with the same weight everywhere it would be 0.9649, with the
/// parts swapped 0.9637.
#[test]
fn a_blend_of_phase_functions_may_have_a_weight_of_voxels() {
    let weight = json!({"type": "gridvolume", "filename": "weight.vol"});
    let phase =
        json!({"type": "blendphase", "weight": weight, "a": {"type": "isotropic"}, "b": {"type": "hg"}});
    let of = |sigma_t: serde_json::Value, kind: &str| {
        let fog = json!({"type": kind, "sigma_t": sigma_t, "phase": phase});
        scene(&[
            ("camera", with(camera([0.5, 0.5, -3.0], [0.5, 0.5, 0.5], 8), &[("fov", json!(40))])),
            ("box", null_box([0.0; 3], [1.0; 3], Some(fog))),
            ("sky", sky(1.0)),
        ])
    };
    let sandbox = Sandbox::with_scene(&of(json!(1), "homogeneous"));
    let write = |channels: i32, weights: &[f32]| {
        let mut bytes = b"VOL\x03".to_vec();
        bytes.extend([1, 1, 1, 4, channels].iter().flat_map(|n: &i32| n.to_le_bytes()));
        bytes.extend([0.0f32, 0.0, 0.0, 1.0, 1.0, 1.0].iter().chain(weights).flat_map(|x| x.to_le_bytes()));
        fs::write(sandbox.path("weight.vol"), bytes).unwrap();
    };
    write(1, &[0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0]);
    for (name, kind) in [("even", "homogeneous"), ("varying", "heterogeneous")] {
        fs::write(sandbox.path("scene.json"), of(json!(1), kind).to_string()).unwrap();
        sandbox.run(&format!("render scene.json --quiet --spp 8192 -o {name}.exr")).ends(0);
        let mean = sandbox.channels(&format!("{name}.exr"))["R"].iter().sum::<f32>() / 64.0;
        assert!((mean - 0.966_13).abs() < 0.0006, "{name}: {mean}");
    }
    assert!(sandbox.run("info scene.json").ends(0).out().contains("mean cosine about 0.400"));
    write(3, &[[0.5; 4], [0.5; 4], [0.7; 4]].concat());
    sandbox.run("info scene.json").refuses(&["weight", "one value for all colours"]);
}
