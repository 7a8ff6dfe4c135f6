//! Typed access to the parameters of an object. Unread parameters are errors: nothing is ignored silently.

use super::{
    colour,
    library::Library,
    object::{Location, Object, Position, Property, Value},
    parameter::{Default, Is, Kind, Parameter, Table, Word},
    registry::{nearest, suggest},
    spelling::spelling,
    substitutes,
    transform::{self, TransformStep},
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

/// An object's parameters while a builder reads them: each is a row of the plugin's table, which says what may be
/// given, and what counts where nothing is.
pub struct Params<'a> {
    /// The object being built.
    pub object: &'a Object,
    /// References, files, warnings.
    pub library: &'a Library,
    table: &'static Table,
    used: RefCell<Vec<bool>>,
}

impl<'a> Params<'a> {
    /// Nothing read yet.
    pub fn new(object: &'a Object, library: &'a Library, table: &'static Table) -> Self {
        let used = RefCell::new(vec![false; object.properties.len()]);
        Self { object, library, table, used }
    }

    /// Where the object is.
    pub fn location(&self) -> &'a Location {
        &self.object.location
    }

    /// The row of `name`, and what `of` takes from its kind. Without such a row it is a bug, which the test of all
    /// tables finds.
    fn row<T>(&self, name: &'static str, of: impl Fn(&Kind) -> Option<T>) -> Result<(&'static Parameter, T)> {
        let row = self.table.find(name).and_then(|row| Some((row, of(&row.kind)?)));
        note(&self.object.plugin, name, row.is_some());
        row.ok_or_else(|| {
            let expected = format!("a row for \"{name}\" in the table of the {}", self.object.plugin);
            Error::new(self.location(), expected, "none", "this is a bug: please report it with the scene")
        })
    }

    /// What was given as `name`, not marked as read.
    pub fn given(&self, name: &str) -> Option<&'a Property> {
        note(&self.object.plugin, name, self.table.find(name).is_some());
        self.object.properties.iter().find(|property| property.name == name)
    }

    /// True if `name` was given; does not mark it as read.
    pub fn has(&self, name: &str) -> bool {
        self.given(name).is_some()
    }

    fn take(&self, name: &str) -> Option<&'a Property> {
        let index = self.object.properties.iter().position(|p| p.name == name)?;
        self.used.borrow_mut()[index] = true;
        Some(&self.object.properties[index])
    }

    fn optional<T>(
        &self,
        name: &str,
        expected: &str,
        read: impl FnOnce(&'a Value) -> Option<T>,
    ) -> Result<Option<T>> {
        let Some(property) = self.take(name) else { return Ok(None) };
        match read(&property.value) {
            Some(value) => Ok(Some(value)),
            None => Err(wrong(property, expected)),
        }
    }

    /// A number in the range of its row, where given.
    pub fn optional_float(&self, name: &'static str) -> Result<Option<f64>> {
        let (row, range) = self.row(name, |kind| match kind {
            Kind::Number(range) | Kind::NumberOrName(range) => Some(*range),
            _ => None,
        })?;
        match self.optional(name, "a finite number", |v| number(v).filter(|x| x.is_finite()))? {
            Some(x) if !range.contains(x) => Err(self.complain(name, row.expected(x), x.to_string())),
            given => Ok(given),
        }
    }

    /// A number in the range of its row.
    pub fn float(&self, name: &'static str) -> Result<f64> {
        match (self.optional_float(name)?, self.default(name)) {
            (Some(x), _) | (None, Is(x)) => Ok(x),
            _ => Err(self.missing(name)),
        }
    }

    /// A whole number in the range of its row, where given.
    pub fn optional_integer(&self, name: &'static str) -> Result<Option<i64>> {
        let (row, range) =
            self.row(name, |kind| if let Kind::Integer(range) = kind { Some(*range) } else { None })?;
        let read = |v: &Value| match v {
            Value::Integer(i) => Some(*i),
            Value::Float(x) if x.fract() == 0.0 && x.abs() < 1e15 => Some(*x as i64),
            _ => None,
        };
        match self.optional(name, "an integer", read)? {
            Some(i) if !range.contains(i as f64) => {
                Err(self.complain(name, row.expected(i as f64), i.to_string()))
            }
            given => Ok(given),
        }
    }

    /// A whole number in the range of its row.
    pub fn integer(&self, name: &'static str) -> Result<i64> {
        match (self.optional_integer(name)?, self.default(name)) {
            (Some(i), _) => Ok(i),
            (None, Is(x)) => Ok(x as i64),
            _ => Err(self.missing(name)),
        }
    }

    /// A truth value, where given.
    pub fn optional_boolean(&self, name: &'static str) -> Result<Option<bool>> {
        self.row(name, |kind| matches!(kind, Kind::Boolean).then_some(()))?;
        self.optional(name, "a boolean", |v| if let Value::Boolean(b) = v { Some(*b) } else { None })
    }

    /// A truth value.
    pub fn boolean(&self, name: &'static str) -> Result<bool> {
        match (self.optional_boolean(name)?, self.default(name)) {
            (Some(b), _) | (None, Default::Yes(b)) => Ok(b),
            _ => Err(self.missing(name)),
        }
    }

    /// Text, where given.
    pub fn optional_string(&self, name: &'static str) -> Result<Option<&'a str>> {
        let is_text =
            |k: &Kind| matches!(k, Kind::Text(_) | Kind::Choice(_) | Kind::File | Kind::NumberOrName(_));
        self.row(name, |kind| is_text(kind).then_some(()))?;
        self.optional(name, "a string", |v| if let Value::String(s) = v { Some(s.as_str()) } else { None })
    }

    /// Text.
    pub fn string(&self, name: &'static str) -> Result<&'a str> {
        match (self.optional_string(name)?, self.default(name)) {
            (Some(text), _) | (None, Word(text)) => Ok(text),
            _ => Err(self.missing(name)),
        }
    }

    /// The meaning of the given word of its row, in capitals or not.
    pub fn choice<T: Copy>(&self, name: &'static str, meanings: &[(&str, T)]) -> Result<T> {
        let (row, words) =
            self.row(name, |kind| if let Kind::Choice(words) = kind { Some(*words) } else { None })?;
        note(&self.object.plugin, name, meanings.iter().map(|(word, _)| word).eq(words));
        let word = self.string(name)?;
        let meaning = meanings.iter().find(|(known, _)| known.eq_ignore_ascii_case(word));
        meaning.map(|(_, meaning)| *meaning).ok_or_else(|| {
            let mut error = self.complain(name, row.expected(0.0), format!("\"{word}\""));
            error.remedy = format!("{}{}", nearest(word, words), error.remedy);
            error
        })
    }

    /// A point or vector with finite entries, where given.
    pub fn optional_vector(&self, name: &'static str) -> Result<Option<DVec3>> {
        self.row(name, |kind| matches!(kind, Kind::Vector).then_some(()))?;
        self.optional(name, "three finite numbers", |v| match v {
            Value::Vector(v) | Value::Rgb(v) => Some(DVec3::from(*v)).filter(|v| v.is_finite()),
            _ => None,
        })
    }

    /// A point or vector with finite entries.
    pub fn vector(&self, name: &'static str) -> Result<DVec3> {
        match (self.optional_vector(name)?, self.default(name)) {
            (Some(v), _) => Ok(v),
            (None, Default::At(v)) => Ok(v.into()),
            _ => Err(self.missing(name)),
        }
    }

    /// One finite number for all channels or three, which must be given.
    pub fn channels(&self, name: &'static str) -> Result<DVec3> {
        self.row(name, |kind| matches!(kind, Kind::Channels).then_some(()))?;
        let read = |v: &Value| match v {
            Value::Vector(v) | Value::Rgb(v) => Some(DVec3::from(*v)),
            other => number(other).map(DVec3::splat),
        };
        let given = self.optional(name, "three finite numbers", |v| read(v).filter(|v| v.is_finite()))?;
        given.ok_or_else(|| self.missing(name))
    }

    /// A transform; the identity where not given. Must be finite and invertible.
    pub fn transform(&self, name: &'static str) -> Result<DMat4> {
        self.row(name, |kind| matches!(kind, Kind::Transform).then_some(()))?;
        let read = |v: &Value| match v {
            Value::Transform(steps) => Some(transform::compose(steps)),
            _ => None,
        };
        let Some(matrix) = self.optional(name, "a transform", read)? else { return Ok(DMat4::IDENTITY) };
        self.tell_of_axes(name);
        if matrix.is_finite() && matrix.inverse().is_finite() && matrix.determinant() != 0.0 {
            return Ok(matrix);
        }
        let found = "one that is singular or not finite";
        Err(self.complain(name, "an invertible transform", found))
    }

    /// Says where Mitsuba would not rotate: its rotations take the axis as it is.
    fn tell_of_axes(&self, name: &str) {
        let Some(Property { value: Value::Transform(steps), location, .. }) = self.given(name) else {
            return;
        };
        let is_unit = |axis: &[f64; 3]| (DVec3::from(*axis).length_squared() - 1.0).abs() < 1e-3;
        let is_other =
            |step: &TransformStep| matches!(step, TransformStep::Rotate { axis, .. } if !is_unit(axis));
        if matches!(location.position, Position::Text { .. }) && steps.iter().any(is_other) {
            let text = "the axis of <rotate> is made a unit vector; Mitsuba 3.9.1 scales and shears by one that is not";
            self.library.warn(location, text);
        }
    }

    /// A colour with finite entries >= 0, where given: a number (grey), rgb, a spectrum, or a plugin that represents
    /// one. What a spectrum becomes depends on what its row says the colour is of.
    pub fn optional_color(&self, name: &'static str) -> Result<Option<Spectrum>> {
        let (row, role) = self.row(name, |kind| match kind {
            Kind::Colour(role, _) | Kind::Texture(role, _) | Kind::Volume(role, _) => Some(*role),
            _ => None,
        })?;
        let Some(property) = self.take(name) else { return Ok(None) };
        let color = colour::read(property, self.library, role)?;
        // Of textures the builder knows whether every value fits.
        if !matches!(row.kind, Kind::Texture(..)) && f64::from(color.max_element()) > row.range().high {
            return Err(self.complain(name, row.expected(0.0), format!("{color}")));
        }
        Ok(Some(color))
    }

    /// The same; what its row says where not given.
    pub fn color(&self, name: &'static str) -> Result<Spectrum> {
        match (self.optional_color(name)?, self.default(name)) {
            (Some(color), _) => Ok(color),
            (None, Is(x)) => Ok(Spectrum::splat(x as f32)),
            _ => Err(self.missing(name)),
        }
    }

    /// A spectrum of several wavelengths, where given.
    pub fn optional_spectrum(&self, name: &'static str) -> Result<Option<&'a [(f64, f64)]>> {
        let (row, ()) = self.row(name, |kind| matches!(kind, Kind::Spectrum).then_some(()))?;
        match self.take(name).map(|property| &property.value) {
            None => Ok(None),
            Some(Value::Spectrum(pairs)) if pairs.len() > 1 => Ok(Some(pairs)),
            Some(other) => Err(self.complain(name, row.expected(0.0), other.describe())),
        }
    }

    /// A file named by the string `name`, relative to the file that names it. Must exist.
    pub fn file(&self, name: &'static str) -> Result<PathBuf> {
        let text = self.string(name)?;
        let location = self.given(name).map_or(self.location(), |p| &p.location);
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
        let is_child = |k: &Kind| matches!(k, Kind::Object(_) | Kind::Texture(..) | Kind::Volume(..));
        self.row(name, |kind| is_child(kind).then_some(()))?;
        let Some(property) = self.take(name) else { return Ok(None) };
        match self.as_child(property)? {
            Some(child) => Ok(Some(child)),
            None => Err(wrong(property, "an object or a reference")),
        }
    }

    /// All children (objects and references) of the kind `tag` that `wanted` accepts, marked as read, in file order.
    pub fn children(&self, tag: &str, wanted: impl Fn(&Child<'a>) -> bool) -> Result<Vec<Child<'a>>> {
        note(&self.object.plugin, tag, self.table.nested(tag).is_some());
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

    /// An error at the parameter `name` (or at the object where it was not given).
    pub fn complain(&self, name: &str, expected: impl Into<String>, found: impl Into<String>) -> Error {
        let property = self.object.properties.iter().find(|p| p.name == name);
        let place = property.map_or(self.location(), |p| &p.location);
        let expected = expected.into();
        let remedy = format!("change \"{name}\" to {expected}");
        Error::new(place, format!("{expected} for \"{name}\""), found, remedy)
    }

    /// What is expected of `name`, if `found` is not in the range of its row.
    pub fn expected(&self, name: &str, found: f64) -> Option<String> {
        let row = self.table.find(name).filter(|row| !row.range().contains(found))?;
        Some(row.expected(found))
    }

    /// The greatest number that the row of `name` allows.
    pub fn most(&self, name: &str) -> f64 {
        self.table.find(name).map_or(f64::INFINITY, |row| row.range().high)
    }

    /// The error for a parameter that must be given.
    pub fn missing(&self, name: &str) -> Error {
        let remedy = format!("add \"{name}\" to the {}", self.object.plugin);
        let row = self.table.find(name).or(self.table.nested(name));
        let expected = row.map_or("a value".into(), |row| row.expected(0.0));
        Error::new(self.location(), format!("{expected} called \"{name}\""), "nothing", remedy)
    }

    fn default(&self, name: &str) -> Default {
        self.table.find(name).map_or(Default::Optional, |row| row.default)
    }

    /// Every parameter must have been read, or be accepted without.
    pub fn finish(&self) -> Result<()> {
        for (property, used) in self.object.properties.iter().zip(self.used.borrow().iter()) {
            if *used || matches!(property.value, Value::Note(_)) {
                continue;
            }
            match self.table.find(&property.name) {
                Some(Parameter { kind: Kind::Ignored { silent: true }, .. }) => {}
                Some(Parameter { kind: Kind::Ignored { .. }, name, about: why, .. }) => self
                    .library
                    .warn(&property.location, &format!("\"{name}\" is accepted but not used: {why}")),
                row => return Err(self.unread(property, row)?),
            }
        }
        Ok(())
    }

    /// The error for a parameter that was not read, though it may have a `row`.
    fn unread(&self, property: &Property, row: Option<&Parameter>) -> Result<Error> {
        let plugin = &self.object.plugin;
        let mut found = property.value.describe();
        let child = self.as_child(property)?.map(|child| &child.object.plugin);
        if let (Value::Reference(_), Some(plugin)) = (&property.value, child) {
            found = format!("{found}, the plugin \"{plugin}\"");
        }
        let name = match property.name.as_str() {
            "" => "an unnamed child".into(),
            name => format!("\"{name}\""),
        };
        let has = |name: &str| self.table.find(name).or(self.table.nested(name)).is_some();
        let suggested = match substitutes::of_parameter(&property.name, has) {
            Some(instead) => instead.to_owned(),
            None => suggest(&property.name, "parameters known here", &self.table.names()),
        };
        let (expected, remedy) = match (row, child) {
            (Some(row), _) => (
                format!("a parameter that counts beside the others of the {plugin}"),
                format!("remove it, or change the others ({}: {})", row.name, row.about),
            ),
            (None, None) => (format!("a parameter of the {plugin}"), suggested),
            (None, Some(_)) => (
                format!("a child that a {plugin} can hold"),
                format!("move it to where it belongs, or remove it; {suggested}"),
            ),
        };
        Ok(Error::new(&property.location, expected, format!("{name}, {found}"), remedy))
    }
}

/// What builders asked for: plugin, name, and whether the plugin's table has it. For the test of all tables.
#[cfg(test)]
pub(crate) type Notes = std::collections::BTreeSet<(String, String, bool)>;

#[cfg(test)]
thread_local! {
    pub(crate) static NOTES: RefCell<Notes> = RefCell::default();
}

#[cfg(test)]
fn note(plugin: &str, name: &str, known: bool) {
    NOTES.with_borrow_mut(|notes| notes.insert((plugin.into(), name.into(), known)));
}

#[cfg(not(test))]
fn note(_: &str, _: &str, _: bool) {}

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
