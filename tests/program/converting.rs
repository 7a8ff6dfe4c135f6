//! Scenes written again: nothing is lost on the way from one spelling to the other and back.

use crate::sandbox::Sandbox;
use arbtest::arbitrary::{Result, Unstructured as Entropy};
use std::{collections::HashSet, fs, ops::RangeInclusive, path::Path, sync::Arc};
use tyndall::{
    description::{Location, Object, Position, Property, TransformStep, Value},
    format,
    format::Spelling,
};

impl Sandbox {
    /// The tree in a file, without places.
    fn read(&self, name: &str, definitions: &[(&str, &str)]) -> Object {
        let root = format::read(&self.path(name), &pairs(definitions)).unwrap_or_else(|error| {
            panic!("{error}\n{}", fs::read_to_string(self.path(name)).unwrap_or_default())
        });
        without_places(root, &nowhere())
    }

    /// Converts one file to another and gives its text and the notes.
    fn convert(&self, from: &str, to: &str, definitions: &[(&str, &str)]) -> (String, Vec<String>) {
        let conversion = format::convert(&self.path(from), &self.path(to), &pairs(definitions)).unwrap();
        fs::write(self.path(to), &conversion.text).unwrap();
        (conversion.text, conversion.notes)
    }

    /// What comes back of `root` as a file of this spelling, and the file's text.
    fn through(&self, root: &Object, spelling: Spelling) -> (Object, String) {
        let text = format::write(root, spelling, Path::new("nowhere")).unwrap();
        let name = if spelling == Spelling::Xml { "scene.xml" } else { "scene.json" };
        fs::write(self.path(name), &text).unwrap();
        (self.read(name, &[]), text)
    }
}

fn pairs(definitions: &[(&str, &str)]) -> Vec<(String, String)> {
    definitions.iter().map(|(name, value)| ((*name).to_owned(), (*value).to_owned())).collect()
}

fn nowhere() -> Location {
    Location { file: Arc::new("nowhere/scene".into()), position: Position::Path(String::new()) }
}

fn without_places(mut object: Object, nowhere: &Location) -> Object {
    object.location = nowhere.clone();
    for property in &mut object.properties {
        property.location = nowhere.clone();
        if let Value::Object(child) = &mut property.value {
            *child = without_places(child.clone(), nowhere);
        }
    }
    object
}

/// Equal to the last bit: `-0.0` is not `0.0`.
fn assert_same(a: &Object, b: &Object, text: &str) {
    let (a, b) = (format!("{a:#?}"), format!("{b:#?}"));
    if let Some((a, b)) = a.lines().zip(b.lines()).find(|(a, b)| a != b) {
        panic!("{a} is not {b}:\n{text}");
    }
    assert_eq!(a, b, "{text}");
}

/// Checks `property` on as many cases, the same ones in every run.
fn check(cases: u32, property: impl Fn(&mut Entropy) -> Result<()>) {
    for case in 1..=cases {
        // The lower half of what arbtest calls a seed is a number of bytes.
        let seed = u64::from(case.wrapping_mul(0x9e37_79b9)) << 32 | 1 << 16;
        let checked = |u: &mut Entropy| property(u).inspect(|()| assert!(!u.is_empty(), "too few bytes"));
        arbtest::arbtest(checked).seed(seed).run();
    }
}

/// As many of what `make` makes.
fn several<T>(
    u: &mut Entropy,
    counts: RangeInclusive<usize>,
    mut make: impl FnMut(&mut Entropy) -> Result<T>,
) -> Result<Vec<T>> {
    (0..u.int_in_range(counts)?).map(|_| make(u)).collect()
}

fn between(u: &mut Entropy, low: f64, high: f64) -> Result<f64> {
    Ok(low + (high - low) * f64::from(u.arbitrary::<u32>()?) / f64::from(u32::MAX))
}

/// Any finite number there is, odd ones and usual ones more often.
fn finite(u: &mut Entropy) -> Result<f64> {
    let odd = [0.0, -0.0, 1.0, -1.0, 5e-324, f64::MAX, 0.1 + 0.2, 1e16, 1e22, 123_456_789.0];
    match u.int_in_range(0..=2)? {
        0 => u.choose(&odd).copied(),
        1 => between(u, -100.0, 100.0),
        _ => Ok(Some(f64::from_bits(u.arbitrary()?)).filter(|x| x.is_finite()).unwrap_or(2.5)),
    }
}

fn triple(u: &mut Entropy, number: impl Fn(&mut Entropy) -> Result<f64>) -> Result<[f64; 3]> {
    Ok([number(u)?, number(u)?, number(u)?])
}

/// Text that XML can hold.
fn text(u: &mut Entropy) -> Result<String> {
    let odd = ["", "$", "\\$", "\\\\$x", " a ", "<&\"'>", "a\tb\nc\r", "#$%", "\u{e9}\u{1f30d}", "]]>"];
    let usual: Vec<char> = (' '..='~').chain('\u{a0}'..='\u{ff}').chain('\u{4e00}'..='\u{4eff}').collect();
    match u.arbitrary()? {
        true => u.choose(&odd).map(|text| (*text).to_owned()),
        false => Ok(several(u, 0..=12, |u| u.choose(&usual).copied())?.into_iter().collect()),
    }
}

fn step(u: &mut Entropy) -> Result<TransformStep> {
    // Three such points are next to never in line, which would be no view.
    let near = |u: &mut Entropy| triple(u, |u| between(u, -10.0, 10.0));
    Ok(match u.int_in_range(0..=4)? {
        0 => TransformStep::Translate(triple(u, finite)?),
        1 => TransformStep::Scale(triple(u, finite)?),
        2 => TransformStep::Rotate { axis: triple(u, |u| between(u, 0.1, 10.0))?, angle: finite(u)? },
        3 => TransformStep::LookAt { origin: near(u)?, target: near(u)?, up: near(u)? },
        _ => TransformStep::Matrix(several(u, 16..=16, finite)?.try_into().unwrap()),
    })
}

fn spectrum(u: &mut Entropy) -> Result<Value> {
    let mut nm = 300.0;
    let rising = |u: &mut Entropy| {
        nm += between(u, 1.0, 100.0)?;
        Ok((nm, finite(u)?))
    };
    several(u, 2..=4, rising).map(Value::Spectrum)
}

fn value(u: &mut Entropy) -> Result<Value> {
    Ok(match u.int_in_range(0..=7)? {
        0 => Value::Boolean(u.arbitrary()?),
        1 => Value::Integer(u.arbitrary()?),
        2 => Value::Float(finite(u)?),
        3 => Value::String(text(u)?),
        4 => Value::Rgb(triple(u, finite)?),
        5 => Value::Vector(triple(u, finite)?),
        6 => Value::Transform(several(u, 0..=3, step)?),
        _ => spectrum(u)?,
    })
}

/// Tags with plugins, one of them unknown.
const PLUGINS: &[(&str, &str)] = &[
    ("shape", "sphere"),
    ("bsdf", "diffuse"),
    ("bsdf", "clay"),
    ("medium", "homogeneous"),
    ("rfilter", "gaussian"),
    ("volume", "gridvolume"),
    ("texture", "d65"),
    ("phase", "a \"b\" <c> $d"),
];

fn property(name: String, value: Value) -> Property {
    Property { name, value, location: nowhere() }
}

fn plugin(tag: &str, plugin: &str, properties: Vec<Property>) -> Object {
    let [tag, plugin] = [tag, plugin].map(str::to_owned);
    Object { tag: Some(tag), plugin, id: None, properties, location: nowhere() }
}

/// Chances in a hundred that objects of these depths, or fewer, have children.
const NESTED: [u8; 3] = [5, 33, 90];

/// A plugin without ids and references; names are given later.
fn object(u: &mut Entropy, depth: usize) -> Result<Object> {
    let is_nested = depth > 0 && u.ratio(NESTED[depth - 1], 100)?;
    if depth > 0 && !is_nested {
        return object(u, depth - 1);
    }
    let (tag, name) = *u.choose(PLUGINS)?;
    let mut values = several(u, 0..=3, value)?;
    if is_nested {
        values.extend(several(u, 0..=2, |u| object(u, depth - 1).map(Value::Object))?);
    }
    Ok(plugin(tag, name, values.into_iter().map(|value| property(String::new(), value)).collect()))
}

/// Names that are no tags. Names and ids come from here by turns.
const NAMES: &[&str] = &["a", "to_world", "Größe", "x y", "interior", "p-1", "a<b>&\"c\"", "filename"];

/// Gives names and ids, and refers to objects before.
fn christen(u: &mut Entropy, object: &mut Object, before: &[String], ids: &mut Vec<String>) -> Result<()> {
    for (index, p) in object.properties.iter_mut().enumerate() {
        if !matches!(p.value, Value::Object(_)) || u.arbitrary()? {
            p.name = format!("{}{index}", u.choose(NAMES)?);
        }
        if let Value::Object(child) = &mut p.value {
            christen(u, child, before, ids)?;
            if u.ratio(1, 5)? {
                ids.push(format!("{}.{}", u.choose(&["id", "$id", "i\u{e9} d"])?, ids.len()));
                child.id = ids.last().cloned();
            }
        }
    }
    for (index, id) in before.iter().enumerate().step_by(4) {
        let name = if index.is_multiple_of(3) { format!("link {index}") } else { String::new() };
        object.properties.push(property(name, Value::Reference(id.clone())));
    }
    Ok(())
}

fn scene(u: &mut Entropy, objects: RangeInclusive<usize>) -> Result<Object> {
    let (mut properties, mut ids) = (Vec::new(), Vec::new());
    for (index, mut child) in several(u, objects, |u| object(u, 3))?.into_iter().enumerate() {
        christen(u, &mut child, &ids.clone(), &mut ids)?;
        if !index.is_multiple_of(3) {
            child.id.get_or_insert_with(|| format!("top {index}"));
            ids.extend(child.id.clone());
        }
        properties.push(property(String::new(), Value::Object(child)));
    }
    Ok(plugin("scene", "scene", properties))
}

#[test]
fn what_is_written_is_read_again() {
    let sandbox = Sandbox::new();
    check(400, |u| {
        let tree = scene(u, 0..=4)?;
        let (xml, text) = sandbox.through(&tree, Spelling::Xml);
        assert_same(&tree, &xml, &text);
        assert_eq!(format::write(&xml, Spelling::Xml, Path::new("nowhere")).unwrap(), text);
        Ok(())
    });
}

#[test]
fn both_ways_lose_nothing() {
    let sandbox = Sandbox::new();
    check(400, |u| {
        let tree = scene(u, 0..=4)?;
        let (json, text) = sandbox.through(&tree, Spelling::Json);
        let (again, same_text) = sandbox.through(&json, Spelling::Json);
        assert_same(&json, &again, &text);
        assert_eq!(text, same_text);
        let (xml, _) = sandbox.through(&json, Spelling::Xml);
        assert_same(&tree, &xml, &text);
        Ok(())
    });
}

/// Puts parameters in place of values in XML as it is written, and says which could be set to what.
fn parametrised(u: &mut Entropy, xml: &str) -> Result<(String, Vec<(String, &'static str)>)> {
    let others = [("float", "2.5"), ("integer", "7"), ("boolean", "false"), ("string", "other")];
    let lists = ["point", "vector", "rgb", "translate", "scale", "matrix"];
    let (mut defaults, mut body, mut settable) = (String::new(), String::new(), Vec::new());
    for line in xml.lines().skip(1) {
        let tag = line.trim_start_matches([' ', '<']).split([' ', '/', '>']).next().unwrap();
        let other = others.iter().find(|(known, _)| *known == tag).map(|(_, other)| *other);
        let value = line.rsplit_once(" value=\"").and_then(|(_, rest)| rest.strip_suffix("\"/>"));
        match value.filter(|_| other.is_some() || lists.contains(&tag)) {
            Some(value) if u.ratio(2, 3)? => {
                let name = format!("p{}_", defaults.lines().count());
                defaults += &format!("<default name=\"{name}\" value=\"{value}\"/>\n");
                body += &format!(
                    "{}value=\"${name}\"/>\n",
                    line.strip_suffix(&format!("value=\"{value}\"/>")).unwrap()
                );
                let is_set = u.arbitrary()?;
                settable.extend(other.filter(|_| is_set).map(|other| (name, other)));
            }
            _ => body += &format!("{line}\n"),
        }
    }
    Ok((format!("<scene version=\"3.0.0\">\n{defaults}{body}"), settable))
}

#[test]
fn values_take_the_place_of_parameters() {
    let sandbox = Sandbox::new();
    check(200, |u| {
        let tree = scene(u, 1..=4)?;
        let plain = format::write(&tree, Spelling::Xml, Path::new("nowhere")).unwrap();
        let (text, settable) = parametrised(u, &plain)?;
        fs::write(sandbox.path("a.xml"), &text).unwrap();
        let settings: Vec<_> = settable.iter().map(|(name, value)| (name.as_str(), *value)).collect();
        assert_same(&tree, &sandbox.read("a.xml", &[]), &text);
        for definitions in [&[][..], &settings] {
            let expected = sandbox.read("a.xml", definitions);
            let (json, _) = sandbox.convert("a.xml", "b.json", definitions);
            sandbox.convert("b.json", "c.xml", &[]);
            let (same, _) = sandbox.convert("a.xml", "d.xml", definitions);
            assert_same(&expected, &sandbox.read("c.xml", &[]), &json);
            assert_same(&expected, &sandbox.read("d.xml", &[]), &same);
        }
        Ok(())
    });
}

/// Mitsuba refuses `<integer>` for a parameter that takes any number.
#[test]
fn whole_numbers_in_xml_are_of_the_kind_that_the_parameter_takes() {
    let text = r#"{"type": "scene", "fog": {"type": "homogeneous", "sigma_t": 1, "albedo": 0},
        "path": {"type": "path", "max_depth": 3}}"#;
    let sandbox = Sandbox::with_files(&[("a.json", text)]);
    let (xml, _) = sandbox.convert("a.json", "a.xml", &[]);
    for line in ["<float name=\"sigma_t\" value=\"1\"/>", "<integer name=\"max_depth\" value=\"3\"/>"] {
        assert!(xml.contains(line), "{xml}");
    }
}

/// Mitsuba takes `<rgb>` for a reflectance there, and refuses one above 1.
#[test]
fn colours_of_media_above_1_are_volumes_in_xml() {
    let text = r#"{"type": "scene", "fog": {"type": "homogeneous", "sigma_t": {"type": "rgb", "value": [0.2, 1, 4]},
        "albedo": {"type": "rgb", "value": [0.5, 1, 0.9]}}, "sky": {"type": "constant"},
        "ball": {"type": "sphere", "interior": {"type": "ref", "id": "fog"}, "bsdf": {"type": "null"}},
        "camera": {"type": "perspective", "film": {"type": "hdrfilm", "width": 4, "height": 4}}}"#;
    let sandbox = Sandbox::with_files(&[("a.json", text)]);
    let (xml, _) = sandbox.convert("a.json", "a.xml", &[]);
    for line in [
        r#"<volume type="constvolume" name="sigma_t">"#,
        r#"<rgb name="value" value="0.2, 1, 4"/>"#,
        r#"<rgb name="albedo" value="0.5, 1, 0.9"/>"#,
    ] {
        assert!(xml.contains(line), "{xml}");
    }
    let told = sandbox.run("info a.xml").ends(0);
    assert!(told.out().contains("sigma_t 0.2 1 4 /m"), "{}", told.out());
    let varies =
        text.replace(r#"{"type": "rgb", "value": [0.2, 1, 4]}"#, r#"{"type": "polynomial", "x": "1, 1"}"#);
    fs::write(sandbox.path("b.json"), varies).unwrap();
    sandbox.run("info b.json").refuses(&["one value everywhere", "$.fog", "make the medium heterogeneous"]);
}

#[test]
fn numbers_keep_their_kind_and_every_bit() {
    let text = r#"{"type": "scene", "s": {"type": "sphere", "a": 1, "b": 1.0, "c": -0.0, "d": 0.1, "e": 1e300,
        "f": 9223372036854775807, "g": 5e-324, "v": [-0.0, 1e22, 3]}}"#;
    let sandbox = Sandbox::with_files(&[("a.json", text)]);
    sandbox.convert("a.json", "b.xml", &[]);
    sandbox.convert("b.xml", "c.json", &[]);
    assert_same(&sandbox.read("a.json", &[]), &sandbox.read("c.json", &[]), "");
    let xml = fs::read_to_string(sandbox.path("b.xml")).unwrap();
    for line in [r#"<integer name="a" value="1"/>"#, r#"<float name="b" value="1"/>"#, r#"value="-0.0""#] {
        assert!(xml.contains(line), "{xml}");
    }
    assert!(fs::read_to_string(sandbox.path("c.json")).unwrap().contains(r#""b": 1.0"#));
}

/// Without what only one of the spellings has: tags, and names made up.
fn tidied(mut object: Object) -> Object {
    object.tag = None;
    for p in &mut object.properties {
        if let Value::Object(child) = &mut p.value {
            *child = tidied(child.clone());
        }
        if matches!(p.value, Value::Object(_) | Value::Reference(_)) {
            p.name.clear();
        }
    }
    if object.id.as_ref().is_some_and(|id| id.starts_with("shape") || id == "sensor") {
        object.id = None;
    }
    object
}

#[test]
fn values_of_parameters_are_told() {
    let xml = r#"<scene version="3.0.0">
        <default name="res" value="48"/><default name="fov" value="40"/><default name="on" value="true"/>
        <default name="dir" value="maps"/><default name="wide" value="$fov"/><default name="idle" value="x"/>
        <default name="axis" value="0 1 0"/><default name="grey" value="0.5"/>
        <sensor type="perspective"><float name="fov" value="$fov"/><float name="wide" value="$wide"/>
          <transform name="to_world"><rotate value="$axis" angle="$fov"/><translate x="$res" y="1"/></transform>
          <film type="hdrfilm"><integer name="width" value="$res"/></film></sensor>
        <shape type="sphere"><boolean name="flip" value="$on"/><string name="map" value="$dir/a $on \$on.png"/>
          <rgb name="c" value="0.1 $grey 0.3"/><spectrum name="s" value="$grey"/></shape></scene>"#;
    let json = r#"{"type": "scene", "$defaults": {"n": 4, "x": 0.5, "on": false, "dir": "maps", "file": "$dir/a"},
        "s": {"type": "sphere", "n": "$n", "x": "$x", "on": "$on", "f": "$file.png", "v": ["$x", "$n", 2], "t": "\\$n",
              "c": {"type": "rgb", "value": "$x"}, "w": [{"type": "scale", "x": "$x"}]}}"#;
    let sandbox = Sandbox::with_files(&[("a.xml", xml), ("b.json", json)]);
    let of_xml = "$axis = 0 1 0, $dir = maps, $fov = 12.5, $grey = 0.5, $idle = x, $on = true, $res = 48, $wide = 12.5";
    let of_json = "$dir = maps, $file = maps/a, $n = 9, $on = false, $x = 0.5";
    for (from, set, said) in [("a.xml", ("fov", "12.5"), of_xml), ("b.json", ("n", "9"), of_json)] {
        for to in ["c.json", "d.xml"] {
            let (text, notes) = sandbox.convert(from, to, &[set]);
            let note = format!(
                "{}: parameters are not kept, only their values: {said}",
                sandbox.path(from).display()
            );
            assert_eq!(notes, [note]);
            let read = |name, definitions: &[_]| tidied(sandbox.read(name, definitions));
            assert_same(&read(from, &[set]), &read(to, &[]), &text);
        }
    }
}

#[test]
fn files_are_found_from_the_new_folder() {
    let sandbox = Sandbox::with_files(&[
        (
            "in/a.xml",
            r#"<scene version="3.0.0"><path value="assets"/>
               <include filename="parts/b.xml"/><shape type="obj"><string name="filename" value="m.obj"/></shape>
               <shape type="obj"><string name="filename" value="meshes/n.obj"/></shape>
               <shape type="obj"><string name="filename" value="/abs/o.obj"/></shape></scene>"#,
        ),
        ("in/assets/m.obj", ""),
        ("in/meshes/n.obj", ""),
        (
            "in/parts/b.xml",
            r#"<scene version="3.0.0"><shape type="ply"><string name="filename" value="c.ply"/></shape></scene>"#,
        ),
        ("in/parts/c.ply", ""),
        ("out/keep", ""),
    ]);
    let (json, notes) = sandbox.convert("in/a.xml", "out/a.json", &[]);
    for name in ["../in/parts/c.ply", "../in/assets/m.obj", "/abs/o.obj"] {
        assert!(json.contains(&format!("\"filename\": \"{name}\"")), "{name} in {json}");
    }
    assert!(notes.iter().any(|note| note.contains("parts/b.xml")), "{notes:?}");
    assert!(notes.iter().any(|note| note.contains("files now start at")), "{notes:?}");
    // In its own folder names stay.
    let (json, notes) = sandbox.convert("in/a.xml", "in/a.json", &[]);
    for name in ["parts/c.ply", "assets/m.obj", "meshes/n.obj", "/abs/o.obj"] {
        assert!(json.contains(&format!("\"filename\": \"{name}\"")), "{name} in {json}");
    }
    assert!(notes.iter().any(|note| note.contains("names of 2 files")), "{notes:?}");
}

#[test]
fn names_are_made_up_and_dropped_again() {
    let xml = r#"<scene version="3.0.0"><bsdf type="diffuse" id="glass"/>
        <sensor type="perspective"><film type="hdrfilm"><rfilter type="gaussian"/></film></sensor>
        <shape type="sphere"><ref id="glass"/></shape><shape type="cube"/><shape type="cube" id="shape"/></scene>"#;
    let sandbox = Sandbox::with_files(&[("a.xml", xml)]);
    let (json, _) = sandbox.convert("a.xml", "b.json", &[]);
    for key in
        [r#""film""#, r#""rfilter""#, r#""bsdf": { "type": "ref""#, r#""shape_2": {"#, r#""shape_3": {"#]
    {
        assert!(json.contains(key), "no {key} in {json}");
    }
    let (again, _) = sandbox.convert("b.json", "c.xml", &[]);
    assert!(again.contains("<film type=\"hdrfilm\">") && again.contains("<ref id=\"glass\"/>"), "{again}");
    let (json_again, _) = sandbox.convert("c.xml", "d.json", &[]);
    assert_eq!(json, json_again);
}

#[test]
fn names_ids_and_aliases_do_not_get_mixed_up() {
    let xml = r#"<scene version="3.0.0"><default name="k" value="second"/>
        <bsdf type="diffuse" name="x" id="a"/><bsdf type="null" id="x"/><alias id="a" as="second"/>
        <float name="n" value="1"/><bsdf type="diffuse" id="n"/>
        <shape type="sphere"><ref id="$k"/></shape><shape type="sphere"><ref id="x"/></shape>
        <shape type="sphere"><ref id="n"/></shape></scene>"#;
    let sandbox = Sandbox::with_files(&[("a.xml", xml)]);
    for (from, to) in [("a.xml", "b.json"), ("b.json", "c.xml"), ("a.xml", "d.xml"), ("c.xml", "e.json")] {
        sandbox.convert(from, to, &[]);
        let root = sandbox.read(to, &[]);
        let shapes = root.properties.iter().filter_map(|p| match &p.value {
            Value::Object(child) if child.plugin == "sphere" => Some(child.properties[0].value.clone()),
            _ => None,
        });
        let ids = ["a", "x", "n"].map(|id| Value::Reference(id.into()));
        assert!(shapes.eq(ids), "{to}: {}", fs::read_to_string(sandbox.path(to)).unwrap());
        assert!(root.properties.iter().any(|p| p.value == Value::Float(1.0) && p.name == "n"));
    }
}

#[test]
fn what_a_spelling_cannot_hold_is_an_error() {
    let sandbox = Sandbox::with_files(&[
        ("control.json", r#"{"type": "scene", "s": {"type": "sphere", "note": "a\u0001"}}"#),
        (
            "dotted.xml",
            r#"<scene version="3.0.0"><shape type="sphere"><float name="a.b" value="1"/></shape></scene>"#,
        ),
        ("unknown.json", r#"{"type": "scene", "s": {"type": "blob"}}"#),
        ("told.json", r#"{"type": "scene", "s": {"type": "blob", "$tag": "shape"}}"#),
    ]);
    let refused = |from: &str, to: &str, words: &[&str]| {
        let error = format::convert(&sandbox.path(from), &sandbox.path(to), &[]).unwrap_err().to_string();
        words.iter().for_each(|word| assert!(error.contains(word), "{word}: {error}"));
    };
    refused("control.json", "a.xml", &["$.s.note", "U+0001", "what XML can hold"]);
    refused("dotted.xml", "a.json", &["dotted.xml:1:45", "a.b", "what JSON can hold"]);
    refused("unknown.json", "a.xml", &["$.s", "\"blob\"", "\"$tag\""]);
    refused("unknown.json", "a.yaml", &[".xml or .json"]);
    let (xml, _) = sandbox.convert("told.json", "told.xml", &[]);
    assert!(xml.contains("<shape type=\"blob\" id=\"s\"/>"), "{xml}");
    assert!(sandbox.convert("told.xml", "again.json", &[]).0.contains("\"$tag\": \"shape\""));
}

/// `1.0` as `1`: in XML, a whole number is of the kind that its parameter takes.
fn without_points(text: &str) -> String {
    let mut parts = text.split(".0");
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |all, part| {
        let is_longer = part.starts_with(|next: char| next.is_ascii_digit() || next == 'e');
        if is_longer { all + ".0" + part } else { all + part }
    })
}

/// Every scene that is shipped, there and back.
#[test]
fn shipped_scenes_come_back() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folders = ["scenes", "scenes/crosscheck", "tests/scenes"];
    let entries = folders.iter().flat_map(|folder| fs::read_dir(root.join(folder)).unwrap());
    let mut seen = HashSet::new();
    for path in entries.map(|entry| entry.unwrap().path()) {
        let (ours, other) = match path.extension().and_then(|e| e.to_str()) {
            Some("xml") => ("xml", "json"),
            Some("json") => ("json", "xml"),
            _ => continue,
        };
        // Beside the scene, so that names of files stay; nothing is written there.
        let there = format::convert(&path, &path.with_extension(format!("new.{other}")), &[]).unwrap();
        let sandbox = Sandbox::with_files(&[(&format!("there.{other}"), &there.text)]);
        let back = sandbox.convert(&format!("there.{other}"), &format!("back.{ours}"), &[]).0;
        let direct = format::convert(&path, &path.with_extension(format!("new.{ours}")), &[]).unwrap();
        let same = |text: &str| if ours == "json" { without_points(text) } else { text.to_owned() };
        assert_eq!(same(&direct.text), same(&back), "{}", path.display());
        assert!(there.notes.iter().all(|note| note.contains("only their values")), "{:?}", there.notes);
        seen.insert(ours);
    }
    assert_eq!(seen.len(), 2);
}

#[test]
fn a_constant_spectrum_stays_one() {
    let xml = r#"<scene version="3.0.0"><bsdf type="diffuse" id="b">
        <spectrum name="reflectance" value="0.5"/></bsdf></scene>"#;
    let sandbox = Sandbox::with_files(&[("a.xml", xml)]);
    sandbox.convert("a.xml", "b.json", &[]);
    sandbox.convert("b.json", "c.xml", &[]);
    for name in ["b.json", "c.xml"] {
        let again = sandbox.read(name, &[]);
        assert_same(&tidied(sandbox.read("a.xml", &[])), &tidied(again), name);
    }
}
