//! Elements that hold one value.

use super::{
    super::text::{self, Parsed, Spectrum, one_or_triple},
    element::{Attribute, Element},
    files::Folders,
};
use crate::{
    description::{Object, Property, Registry, Value, keyframes::Interpolation, nearest},
    error::{Error, Result},
    math::srgb::Srgb as _,
};

/// The attributes of a tag besides its key, and how its value is read.
pub(super) struct Row(&'static [&'static str], fn(&Element, &Folders) -> Result<Value>);

const VALUE: &[&str] = &["value"];
const POINT: &[&str] = &["value", "x", "y", "z"];

/// Of a colour.
pub(super) const RGB: Row = Row(VALUE, |e, _| parse(e, text::rgb).map(Value::Rgb));

/// All tags of values.
pub(super) const ROWS: Registry<Row> = Registry::new(
    "a value",
    &[
        ("float", Row(VALUE, |e, _| parse(e, text::float).map(Value::Float))),
        ("integer", Row(VALUE, |e, _| parse(e, text::integer).map(Value::Integer))),
        ("boolean", Row(VALUE, |e, _| parse(e, text::boolean).map(Value::Boolean))),
        ("string", Row(VALUE, |e, _| parse(e, |t| Ok(Value::String(t.to_owned()))))),
        ("rgb", RGB),
        ("spectrum", Row(&["value", "filename"], spectrum)),
        ("point", Row(POINT, |e, _| vector(e))),
        ("vector", Row(POINT, |e, _| vector(e))),
    ],
);

/// The value of `element`, which `row` describes. Its attribute `key` is its name or its time.
pub(super) fn read(
    Row(attributes, read): &Row,
    element: &Element,
    key: &str,
    folders: &Folders,
) -> Result<Value> {
    element.allow(&[&[key], *attributes].concat())?;
    element.require(key)?.nonempty()?;
    element.childless()?;
    read(element, folders)
}

/// True if `element`, a spectrum, has three numbers without wavelengths: 0.6's channels.
pub(super) fn is_rgb(element: &Element) -> bool {
    let numbers = element.get("value").and_then(|value| text::floats(&value.value).ok());
    numbers.is_some_and(|numbers| numbers.len() == 3)
}

/// 0.6's colour as on a screen: one number, three, or `#rrggbb`.
pub(super) fn srgb(element: &Element) -> Result<Value> {
    element.allow(&["name", "value"])?;
    element.childless()?;
    let value = element.require("value")?;
    let rgb = value.parse(text::rgb)?;
    let is_decoded = value.value.trim().starts_with('#');
    Ok(Value::Rgb(if is_decoded { rgb } else { rgb.map(|encoded| encoded.srgb_decoded()) }))
}

/// 0.6's black body: a plugin today.
pub(super) fn blackbody(element: &Element) -> Result<Value> {
    element.allow(&["name", "temperature"])?;
    element.childless()?;
    let kelvins = |text: &str| text::float(text.trim().trim_end_matches(['K', 'k']));
    let value = Value::Float(element.require("temperature")?.parse(kelvins)?);
    let location = element.location.clone();
    let temperature = Property { name: "temperature".into(), value, location: location.clone() };
    let (tag, plugin) = (Some("texture".to_owned()), "blackbody".to_owned());
    Ok(Value::Object(Object { tag, plugin, id: None, properties: vec![temperature], location }))
}

/// How values between two keys are interpolated.
pub(super) fn interpolation(attribute: &Attribute) -> Result<Interpolation> {
    let names = Interpolation::NAMES;
    Interpolation::named(&attribute.value).ok_or_else(|| {
        let remedy = format!("{}known: {}", nearest(&attribute.value, &names), names.join(", "));
        attribute.wrong("an interpolation", remedy)
    })
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
