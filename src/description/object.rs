//! The tree of a scene file: objects, what is given to each, and where it stands.

use super::{keyframes::Keyframes, transform::TransformStep};
use std::{fmt, path::PathBuf, sync::Arc};

/// Where in which file something is.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Location {
    /// The file as the user named it (an included file under its own name).
    pub file: Arc<PathBuf>,
    /// The place in it.
    pub position: Position,
}

/// A place in a file, in the file's own terms.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Position {
    /// XML: line and column, both from 1.
    Text {
        /// Line, from 1.
        line: u32,
        /// Column, from 1.
        column: u32,
    },
    /// JSON: a path such as `$.fog.sigma_t`.
    Path(String),
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.position {
            Position::Text { line, column } => write!(f, "{}:{line}:{column}", self.file.display()),
            Position::Path(path) => write!(f, "{} {path}", self.file.display()),
        }
    }
}

/// One plugin instance: `type`, optional `id`, and what was given to it.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// The XML tag (`shape`, `bsdf`, ...) of an object from XML; JSON has none.
    pub tag: Option<String>,
    /// The plugin name, as Mitsuba calls it.
    pub plugin: String,
    /// The name by which others refer to it.
    pub id: Option<String>,
    /// Parameters and children in file order.
    pub properties: Vec<Property>,
    /// Where it starts.
    pub location: Location,
}

impl Object {
    /// True if both say the same, under whatever names and wherever they stand in one file.
    pub fn says_what(&self, other: &Self) -> bool {
        let same = |(a, b): (&Property, &Property)| match (&a.value, &b.value) {
            (Value::Object(x), Value::Object(y)) => a.name == b.name && x.says_what(y),
            (x, y) => a.name == b.name && x == y,
        };
        self.plugin == other.plugin
            && self.location.file == other.location.file
            && self.properties.len() == other.properties.len()
            && self.properties.iter().zip(&other.properties).all(same)
    }

    /// The number called `name`, if it is one.
    pub fn number(&self, name: &str) -> Option<f64> {
        match self.properties.iter().find(|property| property.name == name)?.value {
            Value::Float(x) => Some(x),
            Value::Integer(i) => Some(i as f64),
            _ => None,
        }
    }
}

/// One parameter or child of an object.
#[derive(Clone, Debug, PartialEq)]
pub struct Property {
    /// Its name; empty for an unnamed child.
    pub name: String,
    /// What was given.
    pub value: Value,
    /// Where it is.
    pub location: Location,
}

/// What a property can hold.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// `true` or `false`.
    Boolean(bool),
    /// A whole number (accepted wherever a float is).
    Integer(i64),
    /// A number.
    Float(f64),
    /// Text.
    String(String),
    /// A linear-sRGB colour.
    Rgb([f64; 3]),
    /// Wavelength (nm) and value pairs in order of wavelength; a single pair has its value at all wavelengths.
    Spectrum(Vec<(f64, f64)>),
    /// A point or vector.
    Vector([f64; 3]),
    /// Steps applied in order, first step first.
    Transform(Vec<TransformStep>),
    /// A nested plugin.
    Object(Object),
    /// The id of an object elsewhere in the tree.
    Reference(String),
    /// What its reader has to say of the object: no parameter, but told when the scene is built.
    Note(String),
    /// Any of those of numbers, which changes in time. Builders see what it is at the scene's time.
    Keyframes(Keyframes),
}

impl Value {
    /// What it is, for error messages.
    pub fn describe(&self) -> String {
        match self {
            Self::Boolean(b) => format!("the boolean {b}"),
            Self::Integer(i) => format!("the integer {i}"),
            Self::Float(x) => format!("the number {x}"),
            Self::String(s) => format!("the string \"{s}\""),
            Self::Rgb(_) => "an rgb colour".into(),
            Self::Spectrum(_) => "a spectrum".into(),
            Self::Vector(_) => "a vector".into(),
            Self::Transform(_) => "a transform".into(),
            Self::Object(o) => format!("the plugin \"{}\"", o.plugin),
            Self::Reference(id) => format!("a reference to \"{id}\""),
            Self::Note(text) => text.clone(),
            Self::Keyframes(_) => "keyframes".into(),
        }
    }
}
