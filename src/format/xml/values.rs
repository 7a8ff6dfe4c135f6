//! Elements that hold one value.

use super::{
    super::text::{self, Parsed, Spectrum, one_or_triple},
    element::Element,
    files::Folders,
};
use crate::{
    description::Value,
    error::{Error, Result},
};

/// How a tag is read.
pub(super) struct Row {
    tag: &'static str,
    attributes: &'static [&'static str],
    read: fn(&Element, &Folders) -> Result<Value>,
}

const VALUE: &[&str] = &["name", "value"];
const POINT: &[&str] = &["name", "value", "x", "y", "z"];

/// All tags of values.
const ROWS: [Row; 8] = [
    Row { tag: "float", attributes: VALUE, read: |e, _| parse(e, text::float).map(Value::Float) },
    Row { tag: "integer", attributes: VALUE, read: |e, _| parse(e, text::integer).map(Value::Integer) },
    Row { tag: "boolean", attributes: VALUE, read: |e, _| parse(e, text::boolean).map(Value::Boolean) },
    Row { tag: "string", attributes: VALUE, read: |e, _| parse(e, |t| Ok(Value::String(t.to_owned()))) },
    Row { tag: "rgb", attributes: VALUE, read: |e, _| parse(e, text::rgb).map(Value::Rgb) },
    Row { tag: "spectrum", attributes: &["name", "value", "filename"], read: spectrum },
    Row { tag: "point", attributes: POINT, read: |e, _| vector(e) },
    Row { tag: "vector", attributes: POINT, read: |e, _| vector(e) },
];

/// The tags, for error messages.
pub(super) fn tags() -> [&'static str; 8] {
    ROWS.map(|row| row.tag)
}

/// How `tag` is read.
pub(super) fn find(tag: &str) -> Option<&'static Row> {
    const { &ROWS }.iter().find(|row| row.tag == tag)
}

/// The value of `element`, which `row` describes.
pub(super) fn read(row: &Row, element: &Element, folders: &Folders) -> Result<Value> {
    element.allow(row.attributes)?;
    element.require("name")?.nonempty()?;
    element.childless()?;
    (row.read)(element, folders)
}

fn parse<T>(element: &Element, read: impl FnOnce(&str) -> Parsed<T>) -> Result<T> {
    element.require("value")?.parse(read)
}

fn vector(element: &Element) -> Result<Value> {
    let absent = |name: &str| {
        let expected = format!("\"value\", or all of \"x\", \"y\", \"z\" in <{}>", element.tag);
        let remedy = format!("add {name}=\"...\"");
        Err(Error::new(&element.location, expected, format!("no \"{name}\""), remedy))
    };
    components(element, absent).map(Value::Vector)
}

/// `value` with one or three numbers; or `x`, `y`, `z`, each by itself or as `absent` says.
pub(super) fn components(element: &Element, absent: impl Fn(&str) -> Result<f64>) -> Result<[f64; 3]> {
    let component = |name| match element.get(name) {
        Some(attribute) => attribute.parse(text::float),
        None => absent(name),
    };
    match element.get("value") {
        None => Ok([component("x")?, component("y")?, component("z")?]),
        Some(_) if ["x", "y", "z"].iter().any(|name| element.get(name).is_some()) => Err(both(element)),
        Some(value) => value.parse(|t| one_or_triple(&text::floats(t)?)),
    }
}

fn both(element: &Element) -> Error {
    Error::new(&element.location, "either \"value\" or \"x\", \"y\", \"z\"", "both", "remove one of the two")
}

/// A constant spectrum is a single pair.
fn spectrum(element: &Element, folders: &Folders) -> Result<Value> {
    let spectrum = match (element.get("value"), element.get("filename")) {
        (Some(value), None) => value.parse(text::spectrum)?,
        (None, Some(name)) => {
            text::spectrum_file(&folders.find(&name.value).ok_or_else(|| folders.missing(name))?)?
        }
        (given, _) => {
            let found = if given.is_some() { "both" } else { "neither" };
            let expected = "either \"value\" or \"filename\" in <spectrum>";
            return Err(Error::new(&element.location, expected, found, "give one of the two"));
        }
    };
    Ok(match spectrum {
        Spectrum::Constant(value) => Value::Spectrum(vec![(0.0, value)]),
        Spectrum::Sampled(pairs) => Value::Spectrum(pairs),
    })
}
