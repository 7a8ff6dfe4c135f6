//! Writes scenes in either format, from the tree and from what reading replaced.
//!
//! What is kept: plugins, names, ids, references, order, every number to the last bit (whole numbers and others
//! apart), colours, spectra, transforms step by step, strings, parameters with their defaults, and which files
//! are meant. What is not: comments and layout, the division into included files (their content is put in
//! place), second names of objects (references lead straight to the ids), and names of spectrum files (their
//! values are put in place). JSON gives a key to everything; a child without a name is called after its tag,
//! and what is so called loses the name again on the way back.

mod draw;
mod json;
mod keys;
mod kinds;
mod layout;
mod outline;
mod paths;
mod xml;

use super::{
    origins::{Declaration, Origins},
    parameters::Parameters,
    read::{Spelling, read_with_origins, spelling},
};
use crate::{
    description::{Location, Object},
    error::{Error, Result},
};
use std::path::Path;

/// A scene converted: its text, and what its user should know.
#[derive(Clone, Debug, PartialEq)]
pub struct Conversion {
    /// The content of the new file.
    pub text: String,
    /// What could not stay as it was written, though it means the same.
    pub notes: Vec<String>,
}

/// What becomes of a scene's parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Naming {
    /// They stay parameters where the new format allows it.
    Keep,
    /// Their values are put in their places.
    Fill,
}

/// The scene at `input` as the file `output` has to spell it (by its ending); nothing is written. `definitions`
/// are `name=value` pairs that become the defaults of the scene's parameters.
pub fn convert(
    input: &Path,
    output: &Path,
    definitions: &[(String, String)],
    naming: Naming,
) -> Result<Conversion> {
    let spelling = spelling(output)?;
    let (root, mut origins) = read_with_origins(input, definitions)?;
    if naming == Naming::Fill {
        origins.fill();
    }
    let mut conversion = spell(&root, &origins, spelling, paths::folder(output))?;
    if !origins.included.is_empty() {
        let files: Vec<_> = origins.included.iter().map(|file| file.display().to_string()).collect();
        let note = format!(
            "{}: the contents of included files are written in place: {}",
            input.display(),
            files.join(", ")
        );
        conversion.notes.insert(0, note);
    }
    Ok(conversion)
}

/// The tree `root` as a file in `folder` would spell it.
pub fn write(root: &Object, spelling: Spelling, folder: &Path) -> Result<String> {
    spell(root, &Origins::default(), spelling, folder).map(|conversion| conversion.text)
}

fn spell(root: &Object, origins: &Origins, spelling: Spelling, folder: &Path) -> Result<Conversion> {
    let (outline, moved) = draw::draw(root, origins, folder)?;
    let mut known = Known::new(&origins.declarations);
    if moved > 0 {
        let folder = folder.display();
        known
            .notes
            .push(format!("names of {moved} files now start at {folder}; the files stay where they are"));
    }
    let text = match spelling {
        Spelling::Xml => xml::file(&outline, &mut known)?,
        Spelling::Json => json::file(&outline, &mut known)?,
    };
    Ok(Conversion { text, notes: known.notes })
}

/// The parameters of a scene, and the notes about them.
struct Known<'a> {
    declarations: &'a [Declaration],
    parameters: Parameters,
    notes: Vec<String>,
}

impl<'a> Known<'a> {
    fn new(declarations: &'a [Declaration]) -> Self {
        Self { declarations, parameters: Parameters::of(declarations), notes: Vec::new() }
    }

    /// What `text` is with every parameter in place; none if that fails.
    fn value_of(&mut self, text: &str) -> Option<String> {
        self.parameters.substitute(text).ok()
    }

    /// The parameter whose name alone `text` is.
    fn whole<'t>(&self, text: &'t str) -> Option<&'t str> {
        text.trim().strip_prefix('$').filter(|name| self.parameters.is_name(name))
    }

    /// Says that the value replaces `text`.
    fn note(&mut self, place: &Location, text: &str, why: &str) {
        self.notes.push(format!("{place}: {text} is written as its value: {why}"));
    }
}

/// The value of a spectrum that has it at all wavelengths: a single pair, at no wavelength.
fn constant(pairs: &[(f64, f64)]) -> Option<f64> {
    if let [(0.0, value)] = pairs { Some(*value) } else { None }
}

/// A number, with a point or an exponent unless it is `-0`, `0`, `1`, ... itself. What is read from it is the
/// same to the last bit.
fn plain(x: f64) -> String {
    let text = format!("{x:?}");
    match text.strip_suffix(".0") {
        Some(whole) if whole != "-0" => whole.to_owned(),
        _ => text,
    }
}

/// The error for what `spelling` has no words for.
fn unspeakable(place: &Location, spelling: &str, found: impl Into<String>, remedy: &str) -> Error {
    Error::new(place, format!("what {spelling} can hold"), found, remedy)
}
