//! Objects that are values, not plugins.

use super::{
    super::text::{self, Spectrum, one_or_triple},
    Json, Node,
};
use crate::{
    description::Value,
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
