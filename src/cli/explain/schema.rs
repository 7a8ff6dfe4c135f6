//! A JSON Schema (draft 7) of scenes: editors complete and check by it. References and parameters (`$name`) may stand
//! wherever the reader takes them.

use super::{KINDS, everything, plugins, rows, text};
use crate::description::{
    Table, colour,
    keyframes::Interpolation,
    parameter::{Default, Kind, Parameter, Range},
};
use serde_json::{Map, Value, json};

/// Colours that have a syntax of their own.
const VALUES: [&str; 2] = ["rgb", "spectrum"];

/// Steps of transforms with their keys.
const STEPS: [(&str, &[&str]); 5] = [
    ("translate", &["value", "x", "y", "z"]),
    ("rotate", &["axis", "x", "y", "z", "angle"]),
    ("scale", &["value", "x", "y", "z"]),
    ("lookat", &["origin", "target", "up"]),
    ("matrix", &["value"]),
];

/// The schema of a scene file.
pub(super) fn of_scenes() -> Value {
    let mut definitions = Map::new();
    for (tag, plugin, table) in everything() {
        definitions.insert(key(tag, plugin), plugin_of(plugin, table));
    }
    definitions.extend(values());
    let colours = |tag, fits: fn(&str) -> bool| colour_or(tag, fits);
    definitions.insert("colour".into(), colours("texture", colour::is_name));
    definitions.insert("colour or texture".into(), colours("texture", |_| true));
    definitions.insert("colour or volume".into(), colours("volume", |_| true));
    for (tag, _) in KINDS {
        definitions.insert((*tag).into(), any_of_kinds(&[tag]));
    }
    json!({
        "$schema": "http://json-schema.org/draft-07/schema#",
        "title": "A scene of Tyndall",
        "$ref": reference(&key("scene", "scene")),
        "definitions": definitions,
    })
}

fn key(tag: &str, plugin: &str) -> String {
    format!("{tag} {plugin}")
}

fn reference(key: &str) -> String {
    format!("#/definitions/{}", key.replace(' ', "%20"))
}

/// What is no plugin.
fn values() -> Map<String, Value> {
    let number = json!({"anyOf": [{"type": "number"}, {"$ref": "#/definitions/parameter"}]});
    let triple = json!({"type": "array", "items": number, "minItems": 3, "maxItems": 3});
    let object = |required: &str, properties: Value| {
        json!({"type": "object", "required": ["type", required], "additionalProperties": false,
               "patternProperties": comments(), "properties": properties})
    };
    let values = json!({
        "parameter": {"type": "string", "pattern": "\\$"},
        "number": number,
        "triple": triple,
        "rgb": object("value", json!({"type": {}, "value": {
            "anyOf": [{"$ref": "#/definitions/number"}, {"type": "array"}, {"type": "string"}]}})),
        "spectrum": {"type": "object", "additionalProperties": false, "patternProperties": comments(),
            "properties": {"type": {}, "value": {"type": ["number", "array", "string"]}, "filename": {"type": "string"}}},
        "ref": object("id", json!({"type": {}, "id": {"type": "string"}})),
        "keyframes": object("value", json!({"type": {}, "interpolation": {"enum": Interpolation::NAMES}, "value": {
            "type": "array", "minItems": 1, "items": {"type": "array", "minItems": 2, "maxItems": 2}}})),
        "transform": {"type": "array", "items": {
            "if": {"type": "array"},
            "then": {"items": {"$ref": "#/definitions/number"}},
            "else": of_types(STEPS.map(|(step, _)| (step, step.to_owned())).into())}},
    });
    let step = |(step, keys): (&str, &[&str])| {
        let keys = keys.iter().chain(&["type"]).map(|key| ((*key).to_owned(), json!({})));
        let properties = Value::Object(keys.collect());
        let step_of = json!({"type": "object", "additionalProperties": false, "patternProperties": comments(),
            "properties": properties});
        (step.to_owned(), step_of)
    };
    let mut all = values.as_object().cloned().unwrap_or_default();
    all.extend(STEPS.map(step));
    all
}

fn plugin_of(plugin: &str, table: &'static Table) -> Value {
    let mut properties = Map::new();
    properties.insert("type".into(), json!({"description": table.about, "const": plugin}));
    properties.insert(
        "id".into(),
        json!({"type": "string", "description": "The name by which others refer to it."}),
    );
    match plugin {
        "scene" => {
            properties.insert("$schema".into(), json!({"type": "string"}));
            properties.insert("$defaults".into(), json!({"type": "object"}))
        }
        _ => properties.insert("$tag".into(), json!({"type": "string"})),
    };
    let nested: Vec<_> = table.rows().filter(|row| row.kind == Kind::Nested).map(|row| row.name).collect();
    let (used, ignored) = rows(table);
    for row in used.iter().filter(|row| row.kind != Kind::Nested) {
        properties.insert(row.name.into(), value_of(row));
    }
    for row in ignored {
        properties.insert(row.name.into(), json!({"description": format!("Without effect: {}.", row.about)}));
    }
    let is_required = |row: &&&Parameter| row.default == Default::Required && row.kind != Kind::Nested;
    let mut required = vec!["type"];
    required.extend(used.iter().filter(is_required).map(|row| row.name));
    json!({
        "type": "object",
        "required": required,
        "properties": properties,
        "patternProperties": comments(),
        "additionalProperties": match nested.as_slice() {
            [] => json!(false),
            [one] => json!({"$ref": reference(one)}),
            several => any_of_kinds(several),
        },
    })
}

/// Keys that mean nothing.
fn comments() -> Value {
    json!({"^//": {}})
}

/// An object of one of these kinds.
fn any_of_kinds(tags: &[&str]) -> Value {
    let names =
        |tag: &&str| plugins(tag).into_iter().map(|(name, _)| (name, key(tag, name))).collect::<Vec<_>>();
    any(tags.iter().flat_map(names).collect())
}

/// The same, or a reference.
fn any(mut types: Vec<(&str, String)>) -> Value {
    types.push(("ref", "ref".into()));
    of_types(types)
}

/// An object of one of these types: chosen by its type, so that what is wrong is told of that one.
fn of_types(types: Vec<(&str, String)>) -> Value {
    let names: Vec<_> = types.iter().map(|(name, _)| name).collect();
    let rules = types.iter().map(|(name, key)| {
        json!({"if": {"required": ["type"], "properties": {"type": {"const": name}}}, "then": {"$ref": reference(key)}})
    });
    json!({"type": "object", "required": ["type"], "properties": {"type": {"enum": names}},
           "allOf": rules.collect::<Vec<_>>()})
}

/// A colour, or one of the plugins of the kind `tag` that `fits`.
fn colour_or(tag: &str, fits: fn(&str) -> bool) -> Value {
    let mut types: Vec<_> = VALUES.iter().map(|name| (*name, (*name).to_owned())).collect();
    for (kind, plugin, _) in everything() {
        if kind == tag && fits(plugin) || kind == "texture" && colour::is_name(plugin) && tag != kind {
            types.push((plugin, key(kind, plugin)));
        }
    }
    json!({"if": {"type": "object"}, "then": any(types), "else": {"$ref": "#/definitions/number"}})
}

fn value_of(row: &Parameter) -> Value {
    let mut value = match row.kind {
        Kind::Number(range) => parametrised(number(range, "number")),
        Kind::Integer(range) => parametrised(number(range, "integer")),
        Kind::NumberOrName(range) => json!({"anyOf": [number(range, "number"), {"type": "string"}]}),
        Kind::Boolean => parametrised(json!({"type": "boolean"})),
        Kind::Text(_) | Kind::File => json!({"type": "string"}),
        Kind::Choice(words) => parametrised(json!({"enum": words})),
        Kind::Vector => json!({"anyOf": [{"$ref": "#/definitions/triple"}, {"type": "object"}]}),
        Kind::Channels => {
            json!({"anyOf": [{"$ref": "#/definitions/number"}, {"$ref": "#/definitions/triple"}]})
        }
        Kind::Transform => one("transform"),
        Kind::Colour(..) => one("colour"),
        Kind::Texture(..) => one("colour or texture"),
        Kind::Volume(..) => one("colour or volume"),
        Kind::Spectrum => one("spectrum"),
        Kind::Object(tag) => one(tag),
        Kind::Nested | Kind::Ignored { .. } => json!({}),
    };
    if can_change(row.kind) {
        let is_one =
            json!({"type": "object", "required": ["type"], "properties": {"type": {"const": "keyframes"}}});
        value = json!({"if": is_one, "then": {"$ref": "#/definitions/keyframes"}, "else": value});
    }
    value["description"] = json!(format!("{} ({}; {})", row.about, text::allowed(row), text::default(row)));
    match row.default {
        Default::Is(x) => value["default"] = json!(x),
        Default::Yes(b) => value["default"] = json!(b),
        Default::Word(word) => value["default"] = json!(word),
        Default::At(v) => value["default"] = json!(v),
        _ => {}
    }
    value
}

/// True for what is made of numbers, or may be.
fn can_change(kind: Kind) -> bool {
    !matches!(
        kind,
        Kind::Integer(_)
            | Kind::Boolean
            | Kind::Choice(_)
            | Kind::File
            | Kind::Object(_)
            | Kind::Nested
            | Kind::Ignored { .. }
    )
}

fn number(range: Range, kind: &str) -> Value {
    let mut number = json!({"type": kind});
    if range.low > f64::MIN {
        number[if range.open[0] { "exclusiveMinimum" } else { "minimum" }] = json!(range.low);
    }
    if range.is_bounded() {
        number[if range.open[1] { "exclusiveMaximum" } else { "maximum" }] = json!(range.high);
    }
    number
}

/// A definition; what stands beside a reference would not count.
fn one(key: &str) -> Value {
    json!({"allOf": [{"$ref": reference(key)}]})
}

/// The same, or a parameter.
fn parametrised(value: Value) -> Value {
    json!({"anyOf": [value, {"$ref": "#/definitions/parameter"}]})
}
