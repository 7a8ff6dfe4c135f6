//! The scene description: one tree, whichever spelling it was read from. Models build themselves from it.

pub mod colour;
mod library;
pub mod params;
pub mod transform;

pub use library::Library;
pub use params::Params;
use std::{fmt, path::PathBuf, sync::Arc};
pub use transform::TransformStep;

/// Where in which file something stands.
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
    /// The XML tag (`shape`, `bsdf`, ...), where the spelling has one; JSON has none.
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

/// One parameter or child of an object.
#[derive(Clone, Debug, PartialEq)]
pub struct Property {
    /// Its name; empty for an unnamed child.
    pub name: String,
    /// What was given.
    pub value: Value,
    /// Where it stands.
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
    /// Wavelength [nm] and value pairs in order of wavelength; a single pair has its value at all wavelengths.
    Spectrum(Vec<(f64, f64)>),
    /// A point or vector.
    Vector([f64; 3]),
    /// Steps applied in order, first step first.
    Transform(Vec<TransformStep>),
    /// A nested plugin.
    Object(Object),
    /// The id of an object elsewhere in the tree.
    Reference(String),
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
        }
    }
}

/// One row of a registry: how a plugin is called and built. Everything that lists names reads these rows.
pub struct Row<T> {
    /// Mitsuba's plugin name, or ours where Mitsuba has none.
    pub name: &'static str,
    /// Builds it from its description.
    pub build: fn(&Params<'_>) -> crate::error::Result<T>,
}

/// Builds `object` by the row that bears its plugin name; every parameter that the row's builder did not ask
/// for is an error. `kind` names the category in the error (`bsdf`, `phase function`, ...).
pub fn build_by_row<T>(
    object: &Object,
    library: &Library,
    kind: &str,
    rows: &[Row<T>],
) -> crate::error::Result<T> {
    let row = find_row(object, kind, rows, |row| row.name)?;
    let params = Params::new(object, library);
    let built = (row.build)(&params)?;
    params.finish()?;
    Ok(built)
}

/// The row that bears the plugin name of `object`; `name` is a row's.
pub fn find_row<'a, R>(
    object: &Object,
    kind: &str,
    rows: &'a [R],
    name: fn(&R) -> &'static str,
) -> crate::error::Result<&'a R> {
    rows.iter().find(|row| name(row) == object.plugin).ok_or_else(|| {
        let names: Vec<_> = rows.iter().map(name).collect();
        crate::error::Error::new(
            &object.location,
            format!("the type of a {kind}"),
            format!("\"{}\"", object.plugin),
            suggest(&object.plugin, "known", &names),
        )
    })
}

/// At most so many names are listed in a message.
const LISTED: usize = 24;

/// The known name closest to `found`, if one is close, and the names that are known after `what` ("known",
/// "known ids"); of very many names only those that look most like it.
pub fn suggest(found: &str, what: &str, known: &[&str]) -> String {
    let mut shown = known.to_vec();
    if known.len() > LISTED {
        shown.sort_by_key(|name| (strsim::damerau_levenshtein(found, name), *name));
        shown.truncate(LISTED / 2);
    }
    let list = if known.is_empty() { "none".into() } else { shown.join(", ") };
    let rest = match known.len() - shown.len() {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    format!("{}{what}: {list}{rest}", nearest(found, known))
}

/// "did you mean ...? " for the known name closest to `found`; empty where none is close.
pub fn nearest(found: &str, known: &[&str]) -> String {
    // Whether a name is written in camel case or with underscores is no great distance.
    let plain = |name: &str| name.replace(['_', '-'], "").to_lowercase();
    let between = |a: &str, b: &str| {
        strsim::damerau_levenshtein(a, b).min(1 + strsim::damerau_levenshtein(&plain(a), &plain(b)))
    };
    known
        .iter()
        .map(|name| (between(found, name), name))
        .min()
        .filter(|(distance, name)| *distance <= 1 + name.len().min(found.len()) / 3)
        .map(|(_, name)| format!("did you mean \"{name}\"? "))
        .unwrap_or_default()
}
