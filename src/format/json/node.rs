//! A JSON value with its place, and its conversion to the expected type.

use super::{
    super::{
        plugins, steps, tags,
        text::{Parsed, triple},
    },
    Json,
};
use crate::{
    description::{Location, Position, nearest},
    error::{Error, Result},
};
use std::{path::PathBuf, sync::Arc};

/// A value and where it is.
pub(super) struct Node<'j> {
    pub location: Location,
    pub json: &'j Json,
}

/// What follows a key.
pub(super) struct Entry<'j> {
    pub name: String,
    pub node: Node<'j>,
}

/// The step to `name` in a JSON path.
pub(super) fn key(name: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "_-$".contains(c);
    if !name.is_empty() && name.chars().all(plain) { format!(".{name}") } else { format!("[{name:?}]") }
}

/// The step to an item in a JSON path.
pub(super) fn index(i: usize) -> String {
    format!("[{i}]")
}

/// The place reached from `location` by `steps`.
pub(super) fn below(location: &Location, steps: &str) -> Location {
    let path = match &location.position {
        Position::Path(path) => format!("{path}{steps}"),
        Position::Text { .. } => steps.to_owned(),
    };
    Location { file: location.file.clone(), position: Position::Path(path) }
}

impl<'j> Node<'j> {
    /// The outermost value of a file.
    pub(super) fn root(file: Arc<PathBuf>, json: &'j Json) -> Self {
        Self { location: Location { file, position: Position::Path("$".into()) }, json }
    }

    /// The value behind `name` in this one.
    pub(super) fn child<'k>(&self, name: &str, json: &'k Json) -> Node<'k> {
        Node { location: below(&self.location, &key(name)), json }
    }

    /// The error for a value that is not as `expected`.
    pub(super) fn wrong(&self, expected: impl Into<String>) -> Error {
        let expected = expected.into();
        let remedy = match self.json {
            Json::String(text) if expected.contains("number") && text.parse::<f64>().is_ok() => {
                format!("remove the quotes: {text}")
            }
            _ => format!("change it to {expected}"),
        };
        Error::new(&self.location, expected, self.json.describe(), remedy)
    }

    /// What a reader of text or numbers makes of it.
    pub(super) fn check<T>(&self, parsed: Parsed<T>) -> Result<T> {
        parsed.map_err(|m| {
            let remedy = format!("change it to {}", m.expected);
            Error::new(&self.location, m.expected, m.found, remedy)
        })
    }

    /// Everything in an object. Keys with a dot are errors, as in Mitsuba.
    pub(super) fn entries(&self) -> Result<Vec<Entry<'j>>> {
        let Json::Object(entries) = self.json else { return Err(self.wrong("an object in braces")) };
        let entry = |(name, json): &'j (String, Json)| {
            let node = self.child(name, json);
            if name.is_empty() || (name.contains(['.', '$']) && name != super::TAG) {
                let expected = "a name with neither \".\" nor \"$\" in it";
                let remedy = "rename it; \"$defaults\" belongs in the scene itself";
                return Err(Error::new(node.location, expected, format!("\"{name}\""), remedy));
            }
            Ok(Entry { name: name.clone(), node })
        };
        entries.iter().map(entry).collect()
    }

    /// The value behind `name`.
    pub(super) fn get(&self, name: &str) -> Option<Node<'j>> {
        let Json::Object(entries) = self.json else { return None };
        entries.iter().find(|(key, _)| key == name).map(|(_, json)| self.child(name, json))
    }

    /// The value behind `name`, which must be there.
    pub(super) fn require(&self, name: &str) -> Result<Node<'j>> {
        self.get(name).ok_or_else(|| {
            let remedy = format!("add \"{name}\"");
            Error::new(&self.location, format!("an object with \"{name}\""), self.keys(), remedy)
        })
    }

    fn keys(&self) -> String {
        match self.json {
            Json::Object(entries) if !entries.is_empty() => {
                let keys: Vec<_> = entries.iter().map(|(key, _)| key.as_str()).collect();
                format!("one with {}", keys.join(", "))
            }
            other => other.describe(),
        }
    }

    /// Keys other than `type` and these are errors.
    pub(super) fn allow(&self, names: &[&str]) -> Result<()> {
        for entry in self.entries()? {
            let name = entry.name.as_str();
            if name != "type" && !names.contains(&name) {
                let expected = format!("a key of \"{}\"", self.type_name()?);
                let remedy = format!("{}known here: {}", nearest(name, names), names.join(", "));
                return Err(Error::new(entry.node.location, expected, format!("\"{name}\""), remedy));
            }
        }
        Ok(())
    }

    /// The `type` of an object.
    pub(super) fn type_name(&self) -> Result<&'j str> {
        self.get("type").ok_or_else(|| self.untyped())?.string()
    }

    /// The last key of its path.
    fn name(&self) -> &str {
        match &self.location.position {
            Position::Path(path) => path.rsplit('.').next().unwrap_or_default(),
            Position::Text { .. } => "",
        }
    }

    /// The error for an object without a `type`. What it is meant to be stands in its only key or in its name.
    fn untyped(&self) -> Error {
        let only = match self.json {
            Json::Object(entries) if entries.len() == 1 => entries[0].0.replace('_', "").to_lowercase(),
            _ => String::new(),
        };
        let (is_step, in_list) = (steps::WORDS.contains(&only.as_str()), self.name().ends_with(']'));
        let tag = tags::by_name(self.name());
        let remedy = match plugins::plugins_of(tag).as_slice() {
            _ if is_step && in_list => format!("write {{\"type\": \"{only}\", ...}}"),
            _ if is_step && self.name() == "to_world" => format!("write [{{\"type\": \"{only}\", ...}}]"),
            [] => "add \"type\"".to_owned(),
            [kind] => format!("add \"type\": \"{kind}\""),
            known => format!("add \"type\", one of {}", known.join(", ")),
        };
        Error::new(&self.location, "an object with \"type\"", self.keys(), remedy)
    }

    /// Text, not empty.
    pub(super) fn string(&self) -> Result<&'j str> {
        match self.json {
            Json::String(text) if !text.is_empty() => Ok(text),
            _ => Err(self.wrong("a string that is not empty")),
        }
    }

    /// A number.
    pub(super) fn number(&self) -> Result<f64> {
        match self.json {
            Json::Integer(i) => Ok(*i as f64),
            Json::Float(x) => Ok(*x),
            _ => Err(self.wrong("a number")),
        }
    }

    /// Everything in a list.
    pub(super) fn items(&self) -> Result<Vec<Node<'j>>> {
        let Json::Array(items) = self.json else { return Err(self.wrong("a list in brackets")) };
        let item = |(i, json)| Node { location: below(&self.location, &index(i)), json };
        Ok(items.iter().enumerate().map(item).collect())
    }

    /// A list of numbers.
    pub(super) fn numbers(&self) -> Result<Vec<f64>> {
        self.items()?.iter().map(Self::number).collect()
    }

    /// Three numbers.
    pub(super) fn vector(&self) -> Result<[f64; 3]> {
        self.check(triple(&self.numbers()?))
    }

    /// One number or several.
    pub(super) fn one_or_more(&self) -> Result<Vec<f64>> {
        match self.json {
            Json::Array(_) => self.numbers(),
            _ => Ok(vec![self.number().map_err(|_| self.wrong("a number or a list of numbers"))?]),
        }
    }
}
