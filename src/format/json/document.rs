//! JSON text as a tree that keeps the order of keys, with parameters substituted.

use super::{
    super::{parameters::Parameters, text::quoted},
    Node,
};
use crate::{
    description::{Location, Position},
    error::{Error, Result},
};
use json_spanned_value::{Value as Spanned, spanned};
use std::{path::PathBuf, sync::Arc};

/// A JSON value.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Json {
    Null,
    Boolean(bool),
    Integer(i64),
    Float(f64),
    String(String),
    Array(Vec<Json>),
    /// Keys are unique and in file order.
    Object(Vec<(String, Json)>),
}

/// Reads `text`, the content of `file`. A key given twice in one object is an error.
pub(super) fn parse(file: &Arc<PathBuf>, text: &str) -> Result<Json> {
    json_spanned_value::from_str::<spanned::Value>(text).map(tree).map_err(|error| {
        let (line, column) = (error.line().max(1), error.column().max(1));
        let start: usize = text.split_inclusive('\n').take(line - 1).map(str::len).sum();
        let offset = (start + column - 1).min(text.len());
        let message = error.to_string();
        let end = message.rfind(" at line ").unwrap_or(message.len());
        let message = message[..end].to_lowercase();
        let (before, after) = text.split_at_checked(offset).unwrap_or((text, ""));
        let ((expected, found, remedy), offset) = match slip(&message, before, after) {
            Some(slip) => slip,
            None => (explain(&message), offset),
        };
        Error::new(place(file, text, offset), expected, found, remedy)
    })
}

/// The place of the byte at `offset` in `text`.
fn place(file: &Arc<PathBuf>, text: &str, offset: usize) -> Location {
    let before = text.get(..offset).unwrap_or(text);
    let line = before.matches('\n').count() as u32 + 1;
    let column = before.rsplit('\n').next().map_or(0, |last| last.chars().count()) as u32 + 1;
    Location { file: file.clone(), position: Position::Text { line, column } }
}

/// What was expected, what was found, and what to do.
type Explanation = (&'static str, String, &'static str);

/// A common slip, told by the text `before` and `after` the place of an error, and where it is.
fn slip(message: &str, before: &str, after: &str) -> Option<(Explanation, usize)> {
    let word: String = after.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
    let says = |expected, found: &str, remedy| Some(((expected, found.to_owned(), remedy), before.len()));
    match after.chars().next()? {
        '/' | '#' => says("JSON, which has no comments", "a comment", "write it as a key: \"//\": \"...\""),
        '\'' => says("double quotes", "a single quote", "put \" in place of '"),
        ',' if message.contains("expected value") => says("one comma", "another", "remove one"),
        _ if message.starts_with("expected `,`") => {
            let end = before.trim_end().len();
            let next = after.lines().next()?.split_inclusive([' ', ',', ':', '}', ']']).next()?;
            let found =
                format!("{}, without a comma before it", next.trim_end_matches([' ', ',', ':', '}', ']']));
            Some((("a comma between two entries", found, "put a comma here"), end))
        }
        _ if message.starts_with("expected `:`") => {
            says("a colon after the key", "none", "write it like \"key\": value")
        }
        _ if ["True", "False"].contains(&word.as_str()) => {
            says("true or false in small letters", &word, "write true or false")
        }
        _ if ["None", "NaN", "Infinity", "nan", "inf"].contains(&word.as_str()) => {
            says("a JSON value", &word, "write a finite number")
        }
        _ => None,
    }
}

/// The parser's message, in small letters.
fn explain(message: &str) -> Explanation {
    let correct = "correct the JSON at or before this place";
    match message {
        m if m.starts_with("duplicate field: \"//") => (
            "each key once in an object",
            "a second comment with one key".to_owned(),
            "add to its key, such as \"//2\"",
        ),
        m if m.starts_with("duplicate") => (
            "each key once in an object",
            m.replace("duplicate field:", "a second"),
            "remove or rename one of the two",
        ),
        "recursion limit exceeded" => {
            ("JSON at most 127 levels deep", "deeper nesting".to_owned(), "flatten the scene")
        }
        "number out of range" => {
            ("a number within +-1.8e308", "one beyond".to_owned(), "write a smaller number")
        }
        "trailing characters" => (
            "the end of the file",
            "more after the scene".to_owned(),
            "remove what follows, or a brace too many before",
        ),
        "key must be a string" => ("a key in double quotes", "something else".to_owned(), "quote it"),
        "trailing comma" => ("another entry after the comma", "none".to_owned(), "remove the comma"),
        "expected value" => ("a JSON value", "none".to_owned(), correct),
        m if m.starts_with("eof") => {
            let found = m.replace("eof while parsing", "the end of the file within");
            ("well-formed JSON", found, "add what is missing: a value, or closing brackets and braces")
        }
        m => ("well-formed JSON", m.replace("expected", "not"), correct),
    }
}

fn tree(value: spanned::Value) -> Json {
    match value.into_inner() {
        Spanned::Null => Json::Null,
        Spanned::Bool(b) => Json::Boolean(b),
        Spanned::Number(n) => n.as_i64().map_or(Json::Float(n.as_f64().unwrap_or(f64::NAN)), Json::Integer),
        Spanned::String(s) => Json::String(s),
        Spanned::Array(items) => Json::Array(items.into_iter().map(tree).collect()),
        Spanned::Object(map) => {
            let mut entries: Vec<_> = map.into_iter().filter(|(key, _)| !is_comment(key)).collect();
            entries.sort_by_key(|(key, _)| key.start());
            Json::Object(entries.into_iter().map(|(key, value)| (key.into_inner(), tree(value))).collect())
        }
    }
}

/// True for keys that mean nothing in a scene: comments, and the schema that an editor checks it by.
fn is_comment(key: &str) -> bool {
    key.starts_with("//") || key == "$schema"
}

/// The key of the parameters' defaults.
const DEFAULTS: &str = "$defaults";

/// Takes the defaults out of the scene and puts parameters in place of their names everywhere else.
pub(super) fn substitute(scene: &mut Json, file: &Arc<PathBuf>, parameters: &mut Parameters) -> Result<()> {
    let mut kinds = Vec::new();
    if let Json::Object(entries) = scene
        && let Some(at) = entries.iter().position(|(key, _)| key == DEFAULTS)
    {
        let (name, defaults) = entries.remove(at);
        let root = Node::root(file.clone(), scene);
        declare(&root.child(&name, &defaults), parameters, &mut kinds)?;
    }
    let root = Node::root(file.clone(), scene).location;
    let mut substitution = Substitution { parameters, kinds, steps: Vec::new(), root };
    substitution.apply(scene)
}

/// A parameter's name and its default, which says of what kind its values are.
type Kinds = Vec<(String, Json)>;

fn declare(defaults: &Node, parameters: &mut Parameters, kinds: &mut Kinds) -> Result<()> {
    for entry in defaults.entries()? {
        let text = match entry.node.json {
            Json::Integer(i) => i.to_string(),
            Json::Float(x) => format!("{x:?}"),
            Json::Boolean(b) => b.to_string(),
            Json::String(s) => filled(s, &entry.node.location, parameters)?,
            other => {
                let found = other.describe();
                let remedy = "use one parameter for each number of the list";
                let place = &entry.node.location;
                return Err(Error::new(place, "a number, a boolean or a string", found, remedy));
            }
        };
        parameters.declare(&entry.name, &text);
        let kind = kind_of(entry.node.json, kinds);
        kinds.push((entry.name, kind));
    }
    Ok(())
}

/// A default that is just another parameter's name is of that parameter's kind.
fn kind_of(default: &Json, kinds: &Kinds) -> Json {
    let Json::String(text) = default else { return default.clone() };
    let other = kinds.iter().find(|(name, _)| text.strip_prefix('$') == Some(name));
    other.map_or_else(|| default.clone(), |(_, kind)| kind.clone())
}

fn filled(text: &str, location: &Location, parameters: &mut Parameters) -> Result<String> {
    parameters.substitute(text).map_err(|unfit| {
        let remedy = format!("{} (defaults belong in \"{DEFAULTS}\" of the scene)", unfit.remedy);
        Error::new(location, unfit.expected, unfit.found, remedy)
    })
}

/// A walk that replaces `$name`s.
struct Substitution<'p> {
    parameters: &'p mut Parameters,
    kinds: Kinds,
    /// The way from the root, as written in the places of errors.
    steps: Vec<String>,
    root: Location,
}

impl Substitution<'_> {
    fn apply(&mut self, json: &mut Json) -> Result<()> {
        match json {
            Json::Array(items) => {
                items.iter_mut().enumerate().try_for_each(|(i, item)| self.enter(super::node::index(i), item))
            }
            Json::Object(entries) => {
                entries.iter_mut().try_for_each(|(key, value)| self.enter(super::node::key(key), value))
            }
            Json::String(text) if text.contains('$') => {
                *json = self.replaced(text)?;
                Ok(())
            }
            Json::Null | Json::Boolean(_) | Json::Integer(_) | Json::Float(_) | Json::String(_) => Ok(()),
        }
    }

    fn enter(&mut self, step: String, json: &mut Json) -> Result<()> {
        self.steps.push(step);
        self.apply(json)?;
        self.steps.pop();
        Ok(())
    }

    fn replaced(&mut self, text: &str) -> Result<Json> {
        let place = super::node::below(&self.root, &self.steps.concat());
        let result = filled(text, &place, self.parameters)?;
        let Some(name) = text.strip_prefix('$').filter(|name| self.parameters.is_name(name)) else {
            return Ok(Json::String(result));
        };
        let default = self.kinds.iter().find(|(known, _)| known == name).map(|(_, default)| default);
        typed(&result, default).map_err(|expected| {
            let remedy = format!("give -D {name}=... a value of the same kind as its default");
            Error::new(place, expected, format!("-D {name}={result}"), remedy)
        })
    }
}

/// A parameter's text as a value of its default's kind; without a default, as what it looks like.
fn typed(text: &str, default: Option<&Json>) -> std::result::Result<Json, String> {
    let integer = text.parse().ok().map(Json::Integer);
    let float = || text.parse().ok().filter(|x: &f64| x.is_finite()).map(Json::Float);
    let number = || integer.or(float());
    let boolean = || text.parse().ok().map(Json::Boolean);
    let string = || Json::String(text.to_owned());
    match default {
        None => Ok(number().or_else(boolean).unwrap_or_else(string)),
        Some(Json::Integer(_)) => number().ok_or("a number".into()),
        Some(Json::Float(_)) => float().ok_or("a number".into()),
        Some(Json::Boolean(_)) => boolean().ok_or("true or false".into()),
        Some(_) => Ok(string()),
    }
}

impl Json {
    /// What it is, for error messages.
    pub(super) fn describe(&self) -> String {
        match self {
            Self::Null => "null".into(),
            Self::Boolean(b) => b.to_string(),
            Self::Integer(i) => i.to_string(),
            Self::Float(x) => x.to_string(),
            Self::String(s) => quoted(s),
            Self::Array(items) => format!("a list of {}", items.len()),
            Self::Object(_) => "an object".into(),
        }
    }
}
