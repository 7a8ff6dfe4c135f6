//! Scene files in both spellings: what they mean, and what is said of broken ones.

use std::{
    fs,
    path::{Path, PathBuf},
};
use tempfile::TempDir;
use tyndall::{
    description::{Object, TransformStep, Value},
    error::Error,
    scene,
};

/// A folder with scene files in it.
struct Desk {
    folder: TempDir,
}

impl Desk {
    fn new(files: &[(&str, &str)]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        for (name, text) in files {
            let path = folder.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
        Self { folder }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn read(&self, name: &str, definitions: &[(&str, &str)]) -> Result<Object, Error> {
        let definitions: Vec<_> = definitions.iter().map(|(n, v)| (n.to_string(), v.to_string())).collect();
        scene::read(&self.path(name), &definitions)
    }
}

fn read_xml(inside: &str, definitions: &[(&str, &str)]) -> Result<Object, Error> {
    let text = format!("<scene version=\"3.0.0\">{inside}</scene>");
    Desk::new(&[("scene.xml", &text)]).read("scene.xml", definitions)
}

fn read_json(text: &str, definitions: &[(&str, &str)]) -> Result<Object, Error> {
    Desk::new(&[("scene.json", text)]).read("scene.json", definitions)
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
        let xml = scene::read(&scenes.join("lampbox_down.xml"), &definitions).unwrap();
        let json = scene::read(&scenes.join("lampbox_down.json"), &definitions).unwrap();
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
        (r#"<spectrum name="v" value="0.5"/>"#, r#"{"type": "spectrum", "value": 0.5}"#, Value::Float(0.5)),
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
