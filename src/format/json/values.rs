//! Objects that are values, not plugins.

use super::{
    super::text::{self, Spectrum, one_or_triple},
    Json, Node, value,
};
use crate::{
    description::{
        Property, Value,
        keyframes::{Interpolation, Key, Keyframes},
        nearest,
    },
    error::{Error, Result},
};
use std::path::Path;

/// `{"type": "ref", "id": ...}`
pub(super) fn reference(node: &Node) -> Result<Value> {
    node.allow(&["id"])?;
    Ok(Value::Reference(node.require("id")?.string()?.to_owned()))
}

/// `{"type": "rgb", "value": ...}`
pub(super) fn rgb(node: &Node) -> Result<Value> {
    node.allow(&["value"])?;
    let value = node.require("value")?;
    let rgb = match value.json {
        Json::String(text) => text::rgb(text),
        _ => one_or_triple(&value.one_or_more()?),
    };
    value.check(rgb).map(Value::Rgb)
}

/// `{"type": "keyframes", "value": [[time, value], ...]}`
pub(super) fn keyframes(node: &Node) -> Result<Value> {
    node.allow(&["value", "interpolation"])?;
    let interpolation = node.get("interpolation").map(|word| interpolation(&word)).transpose()?;
    let keys = node.require("value")?.items()?.iter().map(key).collect::<Result<_>>()?;
    Keyframes::new(interpolation.unwrap_or_default(), keys, &node.location).map(Value::Keyframes)
}

fn key(pair: &Node) -> Result<Key> {
    let items = pair.items().map_err(|_| pair.wrong("a pair [time, value]"))?;
    let [time, given] = items.as_slice() else { return Err(pair.wrong("a pair [time, value]")) };
    let (name, location) = (String::new(), given.location.clone());
    Ok(Key { time: time.number()?, value: Property { name, value: value(given)?, location } })
}

fn interpolation(node: &Node) -> Result<Interpolation> {
    let word = node.string()?;
    let names = Interpolation::NAMES;
    Interpolation::named(word).ok_or_else(|| {
        let remedy = format!("{}known: {}", nearest(word, &names), names.join(", "));
        Error::new(&node.location, "an interpolation", format!("\"{word}\""), remedy)
    })
}

/// `{"type": "spectrum", "value": ...}` or `{"type": "spectrum", "filename": ...}`. A constant spectrum is a
/// single pair.
pub(super) fn spectrum(node: &Node) -> Result<Value> {
    node.allow(&["value", "filename"])?;
    let spectrum = match (node.get("value"), node.get("filename")) {
        (Some(value), None) => sampled(&value)?,
        (None, Some(name)) => {
            let folder = node.location.file.parent().unwrap_or(Path::new(""));
            let path = folder.join(name.string()?);
            if !path.is_file() {
                return Err(name.wrong(format!("an existing file (looked for {})", path.display())));
            }
            text::spectrum_file(&path)?
        }
        (given, _) => {
            let found = if given.is_some() { "both" } else { "neither" };
            let expected = "either \"value\" or \"filename\" in a spectrum";
            return Err(Error::new(&node.location, expected, found, "give one of the two"));
        }
    };
    Ok(match spectrum {
        Spectrum::Constant(value) => Value::Spectrum(vec![(0.0, value)]),
        Spectrum::Sampled(pairs) => Value::Spectrum(pairs),
    })
}

fn sampled(value: &Node) -> Result<Spectrum> {
    let Json::Array(_) = value.json else {
        let wrong = |_| value.wrong("a number, or a list of [wavelength, value] pairs");
        return value.number().map(Spectrum::Constant).map_err(wrong);
    };
    let pair = |node: &Node| match node.numbers()?.as_slice() {
        [wavelength, value] => Ok((*wavelength, *value)),
        _ => Err(node.wrong("a pair [wavelength, value]")),
    };
    value.check(text::samples(value.items()?.iter().map(pair).collect::<Result<_>>()?))
}
