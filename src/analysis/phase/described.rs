//! A phase function as words: its plugin name, then `name=value` for each parameter.
//!
//! A value is a number, true or false, or text; the name of a phase function makes a nested one, whose parameters are
//! then `name.parameter=value`; `@file` is the text of a file.

use crate::{
    description::{Library, Location, Object, Position, Property, Value},
    error::{Error, Result},
    inputs::{self, Reader},
    math::DVec3,
    phase::{self, Phase, ROWS},
    volume::Place,
};
use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

/// Builds the phase function.
pub fn build(plugin: &str, words: &[String]) -> Result<Phase> {
    let mut root = object(plugin, location(plugin));
    for word in words {
        let (path, text) = word.split_once('=').filter(|(path, _)| !path.is_empty()).ok_or_else(|| {
            Error::new(word, "name=value", "no name before \"=\"", "write parameters like g=0.5")
        })?;
        let steps: Vec<&str> = path.split('.').collect();
        insert(&mut root, &steps, value(word, text)?, word)?;
    }
    phase::build(&root, &Library::default(), &Place::new(DVec3::ZERO, 0.0)).map_err(respelled)
}

/// Puts a parameter in its place.
fn insert(object: &mut Object, steps: &[&str], value: Value, word: &str) -> Result<()> {
    let Some((name, rest)) = steps.split_first() else { return Ok(()) };
    let known = object.properties.iter_mut().find(|property| property.name == *name);
    match (known, rest) {
        (None, []) => {
            let location = location(word);
            object.properties.push(Property { name: (*name).into(), value, location });
            Ok(())
        }
        (Some(_), []) => {
            let remedy = "leave one of the two out";
            Err(Error::new(word, "every parameter once", format!("\"{name}\" again"), remedy))
        }
        (Some(Property { value: Value::Object(child), .. }), rest) => insert(child, rest, value, word),
        _ => {
            let expected = format!("a nested phase function \"{name}\" before its parameters");
            let remedy = format!("set its type first, as {name}=hg");
            Err(Error::new(word, expected, "none", remedy))
        }
    }
}

fn value(word: &str, text: &str) -> Result<Value> {
    if let Some(file) = text.strip_prefix('@') {
        let path = Path::new(file);
        inputs::note(path, Reader::Command);
        let text = std::fs::read_to_string(path).map_err(|error| Error::io(path, "read", &error))?;
        return Ok(Value::String(text));
    }
    Ok(match (text, text.parse::<f64>()) {
        ("true", _) => Value::Boolean(true),
        ("false", _) => Value::Boolean(false),
        (_, Ok(number)) => Value::Float(number),
        _ if ROWS.get(text).is_some() => Value::Object(object(text, location(word))),
        _ => Value::String(text.into()),
    })
}

fn object(plugin: &str, location: Location) -> Object {
    Object { tag: None, plugin: plugin.into(), id: None, properties: vec![], location }
}

/// Files that are named here are looked for from the current folder.
fn location(word: &str) -> Location {
    Location { file: Arc::new(PathBuf::from("phase")), position: Position::Path(word.into()) }
}

/// The same error with its remedy as words: where a scene says "g": 1.5, words say g=1.5.
fn respelled(error: Error) -> Error {
    let scene = error.remedy.strip_prefix("write it like \"").and_then(|rest| rest.split_once("\": "));
    match scene.map(|(name, value)| format!("write it like {name}={}", value.trim_matches('"'))) {
        Some(remedy) => Error { remedy, ..error },
        None => error,
    }
}
