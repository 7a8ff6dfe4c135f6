//! Typed access to the parameters of an object. Unread parameters are errors: nothing is ignored silently.

use super::{
    Library, Location, Object, Position, Property, Value,
    colour::{self, Role},
    nearest, suggest, transform,
};
use crate::{
    error::{Error, Result},
    math::{DMat4, DVec3, Spectrum},
};
use std::{cell::RefCell, path::PathBuf};

/// A child object of another: the name it was given, and the object, references resolved.
#[derive(Clone, Copy, Debug)]
pub struct Child<'a> {
    /// The property's name; empty where the child is unnamed.
    pub name: &'a str,
    /// The child itself.
    pub object: &'a Object,
    /// Where the child (or the reference to it) is.
    pub location: &'a Location,
}

/// An object's parameters while a builder reads them.
pub struct Params<'a> {
    /// The object being built.
    pub object: &'a Object,
    /// References, files, warnings.
    pub library: &'a Library,
    used: RefCell<Vec<bool>>,
    requested: RefCell<Vec<&'static str>>,
}

impl<'a> Params<'a> {
    /// Nothing read yet.
    pub fn new(object: &'a Object, library: &'a Library) -> Self {
        let used = RefCell::new(vec![false; object.properties.len()]);
        Self { object, library, used, requested: RefCell::default() }
    }

    /// Where the object is.
    pub fn location(&self) -> &'a Location {
        &self.object.location
    }

    /// The property called `name`, marked as read.
    pub fn property(&self, name: &'static str) -> Option<&'a Property> {
        self.requested.borrow_mut().push(name);
        self.take(name)
    }

    fn take(&self, name: &str) -> Option<&'a Property> {
        let index = self.object.properties.iter().position(|p| p.name == name)?;
        self.used.borrow_mut()[index] = true;
        Some(&self.object.properties[index])
    }

    /// True if `name` was given; does not mark it as read.
    pub fn has(&self, name: &str) -> bool {
        self.object.properties.iter().any(|p| p.name == name)
    }

    fn optional<T>(
        &self,
        name: &'static str,
        expected: &str,
        read: impl FnOnce(&'a Value) -> Option<T>,
    ) -> Result<Option<T>> {
        let Some(property) = self.property(name) else { return Ok(None) };
        match read(&property.value) {
            Some(value) => Ok(Some(value)),
            None => Err(wrong(property, expected)),
        }
    }

    /// A finite number, where given.
    pub fn optional_float(&self, name: &'static str) -> Result<Option<f64>> {
        self.optional(name, "a finite number", |v| number(v).filter(|x| x.is_finite()))
    }

    /// A finite number.
    pub fn float(&self, name: &'static str, default: f64) -> Result<f64> {
        Ok(self.optional_float(name)?.unwrap_or(default))
    }

    /// A finite number from `low` to `high` (both allowed).
    pub fn float_within(&self, name: &'static str, default: f64, low: f64, high: f64) -> Result<f64> {
        let value = self.float(name, default)?;
        if (low..=high).contains(&value) {
            return Ok(value);
        }
        let expected = match high == f64::MAX {
            true => format!("a number >= {low}"),
            false => format!("a number from {low} to {high}"),
        };
        Err(self.complain(name, expected, value.to_string()))
    }

    /// A whole number.
    pub fn integer(&self, name: &'static str, default: i64) -> Result<i64> {
        let read = |v: &Value| match v {
            Value::Integer(i) => Some(*i),
            Value::Float(x) if x.fract() == 0.0 && x.abs() < 1e15 => Some(*x as i64),
            _ => None,
        };
        Ok(self.optional(name, "an integer", read)?.unwrap_or(default))
    }

    /// A truth value.
    pub fn boolean(&self, name: &'static str, default: bool) -> Result<bool> {
        let read = |v: &Value| if let Value::Boolean(b) = v { Some(*b) } else { None };
        Ok(self.optional(name, "a boolean", read)?.unwrap_or(default))
    }

    /// Text, where given.
    pub fn optional_string(&self, name: &'static str) -> Result<Option<&'a str>> {
        self.optional(name, "a string", |v| if let Value::String(s) = v { Some(s.as_str()) } else { None })
    }

    /// Text.
    pub fn string(&self, name: &'static str, default: &'a str) -> Result<&'a str> {
        Ok(self.optional_string(name)?.unwrap_or(default))
    }

    /// One of a few words.
    pub fn choice<T: Copy>(&self, name: &'static str, default: T, choices: &[(&str, T)]) -> Result<T> {
        let Some(word) = self.optional_string(name)? else { return Ok(default) };
        choices.iter().find(|(w, _)| *w == word).map(|(_, value)| *value).ok_or_else(|| {
            let words: Vec<_> = choices.iter().map(|(w, _)| *w).collect();
            let expected = format!("one of {}", words.join(", "));
            let mut error = self.complain(name, expected, format!("\"{word}\""));
            error.remedy = format!("{}{}", nearest(word, &words), error.remedy);
            error
        })
    }

    /// A point or vector with finite entries, where given.
    pub fn optional_vector(&self, name: &'static str) -> Result<Option<DVec3>> {
        self.optional(name, "three finite numbers", |v| match v {
            Value::Vector(v) | Value::Rgb(v) => Some(DVec3::from(*v)).filter(|v| v.is_finite()),
            _ => None,
        })
    }

    /// A transform; the identity where not given. Must be finite and invertible.
    pub fn transform(&self, name: &'static str) -> Result<DMat4> {
        let read = |v: &Value| match v {
            Value::Transform(steps) => Some(transform::compose(steps)),
            _ => None,
        };
        let Some(matrix) = self.optional(name, "a transform", read)? else { return Ok(DMat4::IDENTITY) };
        if matrix.is_finite() && matrix.inverse().is_finite() && matrix.determinant() != 0.0 {
            return Ok(matrix);
        }
        let found = "one that is singular or not finite";
        Err(self.complain(name, "an invertible transform", found))
    }

    /// A colour of matter with finite entries >= 0: a number (grey), rgb, a spectrum, or a plugin that
    /// represents one; where given.
    pub fn optional_color(&self, name: &'static str) -> Result<Option<Spectrum>> {
        self.color_of(name, Role::Matter)
    }

    /// A colour of matter with finite entries >= 0: a reflectance, an albedo, an extinction.
    pub fn color(&self, name: &'static str, default: f32) -> Result<Spectrum> {
        Ok(self.optional_color(name)?.unwrap_or(Spectrum::splat(default)))
    }

    /// An index of refraction or the like: as [`Self::color`], but spectra may exceed 1.
    pub fn index(&self, name: &'static str, default: f32) -> Result<Spectrum> {
        Ok(self.color_of(name, Role::Index)?.unwrap_or(Spectrum::splat(default)))
    }

    /// Radiance, irradiance or intensity, with finite entries >= 0: spectra are the light itself, not seen in
    /// daylight.
    pub fn emission(&self, name: &'static str, default: f32) -> Result<Spectrum> {
        Ok(self.optional_emission(name)?.unwrap_or(Spectrum::splat(default)))
    }

    /// The same, where given.
    pub fn optional_emission(&self, name: &'static str) -> Result<Option<Spectrum>> {
        self.color_of(name, Role::Light)
    }

    fn color_of(&self, name: &'static str, role: Role) -> Result<Option<Spectrum>> {
        let Some(property) = self.property(name) else { return Ok(None) };
        colour::read(property, self.library, role).map(Some)
    }

    /// A file named by the string `name`, relative to the file that names it. Must exist.
    pub fn file(&self, name: &'static str) -> Result<PathBuf> {
        let Some(text) = self.optional_string(name)? else {
            return Err(self.missing(name, "a file name"));
        };
        let property = self.object.properties.iter().find(|p| p.name == name);
        let location = property.map_or(self.location(), |p| &p.location);
        let path = self.library.file(text, location);
        if path.is_file() {
            return Ok(path);
        }
        Err(Error::new(
            location,
            "the name of an existing file",
            format!("\"{text}\""),
            format!("no file is at {}; paths start at the folder of the scene file", path.display()),
        ))
    }

    /// The child object called `name`, where given.
    pub fn child(&self, name: &'static str) -> Result<Option<Child<'a>>> {
        let Some(property) = self.property(name) else { return Ok(None) };
        match self.as_child(property)? {
            Some(child) => Ok(Some(child)),
            None => Err(wrong(property, "an object or a reference")),
        }
    }

    /// All children (objects and references) that `wanted` accepts, marked as read, in file order.
    pub fn children(&self, wanted: impl Fn(&Child<'a>) -> bool) -> Result<Vec<Child<'a>>> {
        let mut found = Vec::new();
        for (index, property) in self.object.properties.iter().enumerate() {
            if let Some(child) = self.as_child(property)?
                && wanted(&child)
            {
                self.used.borrow_mut()[index] = true;
                found.push(child);
            }
        }
        Ok(found)
    }

    fn as_child(&self, property: &'a Property) -> Result<Option<Child<'a>>> {
        let (name, location) = (property.name.as_str(), &property.location);
        Ok(match &property.value {
            Value::Object(object) => Some(Child { name, object, location }),
            Value::Reference(id) => {
                Some(Child { name, object: self.library.resolve(id, location)?, location })
            }
            _ => None,
        })
    }

    /// Reads and drops parameters that have no meaning here, with a warning that says so.
    pub fn accept_unused(&self, names: &[&'static str], why: &str) {
        for name in names {
            // Not requested: no user should be advised to use them.
            if let Some(property) = self.take(name) {
                self.library.warn(&property.location, &format!("\"{name}\" is accepted but not used: {why}"));
            }
        }
    }

    /// Reads and drops a parameter that cannot change what is rendered.
    pub fn accept_silently(&self, name: &'static str) {
        // Not requested: no user should be advised to use it.
        let _ = self.take(name);
    }

    /// An error at the parameter `name` (or at the object where it was not given).
    pub fn complain(&self, name: &str, expected: impl Into<String>, found: impl Into<String>) -> Error {
        let property = self.object.properties.iter().find(|p| p.name == name);
        let place = property.map_or(self.location(), |p| &p.location);
        let expected = expected.into();
        let remedy = format!("change \"{name}\" to {expected}");
        Error::new(place, format!("{expected} for \"{name}\""), found, remedy)
    }

    /// The error for a parameter that must be given.
    pub fn missing(&self, name: &str, expected: &str) -> Error {
        let found = "nothing";
        let remedy = format!("add \"{name}\" to the {}", self.object.plugin);
        Error::new(self.location(), format!("{expected} called \"{name}\""), found, remedy)
    }

    /// Every parameter must have been read.
    pub fn finish(&self) -> Result<()> {
        let used = self.used.borrow();
        let Some(index) = used.iter().position(|used| !used) else { return Ok(()) };
        let property = &self.object.properties[index];
        let mut known = self.requested.borrow().clone();
        known.sort_unstable();
        known.dedup();
        let mut found = property.value.describe();
        let child = self.as_child(property)?.map(|child| &child.object.plugin);
        if let (Value::Reference(_), Some(plugin)) = (&property.value, child) {
            found = format!("{found}, the plugin \"{plugin}\"");
        }
        let name = if property.name.is_empty() {
            "an unnamed child".into()
        } else {
            format!("\"{}\"", property.name)
        };
        let remedy = suggest(&property.name, "parameters known here", &known);
        let (expected, remedy) = match child {
            None => (format!("a parameter of the {}", self.object.plugin), remedy),
            Some(_) => (
                format!("a child that a {} can hold", self.object.plugin),
                format!("move it to where it belongs, or remove it; {remedy}"),
            ),
        };
        Err(Error::new(&property.location, expected, format!("{name}, {found}"), remedy))
    }
}

fn number(value: &Value) -> Option<f64> {
    match value {
        Value::Float(x) => Some(*x),
        Value::Integer(i) => Some(*i as f64),
        _ => None,
    }
}

fn wrong(property: &Property, expected: &str) -> Error {
    let Property { name, value, location } = property;
    Error::new(location, format!("{expected} for \"{name}\""), value.describe(), spelling(property, expected))
}

/// How what is expected is written in the file that holds `property`.
pub(super) fn spelling(property: &Property, expected: &str) -> String {
    let name = &property.name;
    let is_json = matches!(property.location.position, Position::Path(_));
    let (json, tag, example) = match expected {
        "a finite number" => ("1.5", "float", "value=\"1.5\"/"),
        "an integer" => ("2", "integer", "value=\"2\"/"),
        "a boolean" => ("true", "boolean", "value=\"true\"/"),
        "a string" => ("\"text\"", "string", "value=\"text\"/"),
        "three finite numbers" => ("[1, 2, 3]", "point", "value=\"1, 2, 3\"/"),
        COLOR => ("{\"type\": \"rgb\", \"value\": [0.1, 0.2, 0.3]}", "rgb", "value=\"0.1, 0.2, 0.3\"/"),
        "a transform" => (
            "[{\"type\": \"translate\", \"value\": [1, 2, 3]}]",
            "transform",
            "><translate value=\"1, 2, 3\"/></transform",
        ),
        "an object or a reference" => ("{\"type\": \"ref\", \"id\": \"...\"}", "ref", "id=\"...\"/"),
        _ => return format!("change \"{name}\" to {expected}"),
    };
    match is_json {
        true => format!("write it like \"{name}\": {json}"),
        false => format!("write it like <{tag} name=\"{name}\" {example}>"),
    }
}

/// What a colour is.
pub(super) const COLOR: &str = "a colour (a number, rgb or spectrum) with finite entries >= 0";
