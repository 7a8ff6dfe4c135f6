//! A scene as JSON.

use super::{
    constant,
    keys::{Keys, Tags, tags},
    layout::Json,
    parts, plain, shortened, unspeakable,
};
use crate::{
    description::{Keyframes, Object, Property, TransformStep, Value, keyframes::Interpolation},
    error::Result,
    format::{parameters::escaped, tags::derive},
};

/// The text of a file that holds `root`, in which all objects have their tags.
pub(super) fn file(root: &Object) -> Result<String> {
    if root.plugin != "scene" {
        let found = format!("\"{}\" as the type of the scene", root.plugin);
        return Err(unspeakable(&root.location, "JSON", found, "remove the type"));
    }
    Ok(object(root, true, None, &tags(root))?.file())
}

/// A `property` without objects in it as an entry of one.
pub(super) fn property(property: &Property) -> Result<String> {
    Ok(Json::entry(&property.name, &value(&property.value, None, &Tags::default())?))
}

/// `key` is that by which the outermost object leads to it: no need to say the id again.
fn object(object: &Object, outermost: bool, key: Option<&str>, tags: &Tags) -> Result<Json> {
    let mut entries = vec![("type".to_owned(), string(&object.plugin))];
    if let Some(id) = object.id.as_ref().filter(|id| key != Some(id)) {
        entries.push(("id".to_owned(), string(id)));
    }
    let mut keys = Keys::new(object, tags, outermost)?;
    for property in &object.properties {
        let key = keys.of(property);
        let mut json = value(&property.value, outermost.then_some(&key), tags)?;
        if let Value::Object(child) = &property.value {
            add_tag(&mut json, child, &key, object.tag.as_deref());
        }
        entries.push((key, json));
    }
    Ok(Json::Map(entries))
}

/// Writes the tag where it cannot be derived.
fn add_tag(json: &mut Json, object: &Object, key: &str, parent: Option<&str>) {
    let (Json::Map(entries), Some(tag)) = (json, &object.tag) else { return };
    if derive(&object.plugin, key, parent.unwrap_or_default()) != Some(tag) {
        entries.insert(1, ("$tag".into(), Json::string(tag)));
    }
}

fn value(value: &Value, key: Option<&String>, tags: &Tags) -> Result<Json> {
    Ok(match value {
        Value::Boolean(value) => Json::Word(value.to_string()),
        Value::Integer(value) => Json::Word(value.to_string()),
        Value::Float(value) => Json::Word(format!("{value:?}")),
        Value::String(text) | Value::Note(text) => string(text),
        Value::Rgb(values) => kind("rgb", one_or_more(shortened(values))),
        Value::Vector(values) => list(values),
        Value::Spectrum(pairs) => kind("spectrum", spectrum(pairs)),
        Value::Transform(steps) => Json::List(steps.iter().map(step).collect()),
        Value::Object(child) => object(child, false, key.map(String::as_str), tags)?,
        Value::Reference(id) => {
            Json::Map(vec![("type".into(), Json::string("ref")), ("id".into(), string(id))])
        }
        Value::Keyframes(keyframes) => of_keyframes(keyframes, tags)?,
    })
}

fn of_keyframes(keyframes: &Keyframes, tags: &Tags) -> Result<Json> {
    let mut entries = vec![("type".to_owned(), Json::string("keyframes"))];
    if keyframes.interpolation() != Interpolation::default() {
        entries.push(("interpolation".into(), Json::string(keyframes.interpolation().name())));
    }
    let pairs = keyframes
        .keys()
        .iter()
        .map(|key| Ok(Json::List(vec![Json::Word(plain(key.time)), value(&key.value.value, None, tags)?])));
    entries.push(("value".into(), Json::List(pairs.collect::<Result<_>>()?)));
    Ok(Json::Map(entries))
}

fn spectrum(pairs: &[(f64, f64)]) -> Json {
    match constant(pairs) {
        Some(value) => Json::Word(plain(value)),
        None => Json::List(pairs.iter().map(|(nm, value)| list(&[*nm, *value])).collect()),
    }
}

fn step(step: &TransformStep) -> Json {
    let (word, parts) = parts(step);
    let parts = parts.into_iter().map(|(name, values)| (name.to_owned(), one_or_more(values)));
    Json::Map([("type".to_owned(), Json::string(word))].into_iter().chain(parts).collect())
}

fn list(values: &[f64]) -> Json {
    Json::List(values.iter().map(|x| Json::Word(plain(*x))).collect())
}

fn one_or_more(values: &[f64]) -> Json {
    if let [value] = values { Json::Word(plain(*value)) } else { list(values) }
}

/// A text that is read as such.
fn string(text: &str) -> Json {
    Json::string(&escaped(text))
}

fn kind(kind: &str, value: Json) -> Json {
    Json::Map(vec![("type".into(), Json::string(kind)), ("value".into(), value)])
}
