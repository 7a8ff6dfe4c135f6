//! Writes scenes in either format, from the tree that the renderer reads.
//!
//! What is kept: plugins, names, ids, references, order, every number to the last bit (whole numbers and others
//! apart; in XML, as the parameter takes them), colours, spectra, transforms step by step, strings, and which files are
//! meant. What is not: comments and layout, parameters and their defaults (their values are put in place), the division
//! into included files (their content is put in place), second names of objects (references lead straight to the ids), and
//! names of spectrum files (their values are put in place). In XML, colours of media above 1 become volumes. JSON gives a key to everything; a child without a name is called after its
//! tag, and what is so called loses the name again on the way back.

mod arrange;
mod json;
mod keys;
mod layout;
mod xml;

use super::{
    paths,
    read::{Spelling, read_whole, spelling},
};
use crate::{
    description::{Library, Location, Object, Property, TransformStep},
    error::{Error, Result},
};
use std::{collections::HashSet, path::Path, slice};

/// A scene converted: its text, and what its user should know.
#[derive(Clone, Debug, PartialEq)]
pub struct Conversion {
    /// The content of the new file.
    pub text: String,
    /// What could not stay as it was written, though it means the same.
    pub notes: Vec<String>,
}

/// The scene at `input` as the file `output` has to spell it (by its ending); nothing is written. `definitions` are
/// `name=value` pairs, which override the scene's own defaults.
pub fn convert(input: &Path, output: &Path, definitions: &[(String, String)]) -> Result<Conversion> {
    let (spelling, folder) = (spelling(output)?, paths::folder(output));
    let (draft, parameters) = read_whole(input, definitions)?;
    let (root, moved) = arrange::arrange(&draft.root, &draft.found, folder)?;
    let (input, mut notes) = (input.display(), Library::new(&draft.root)?.take_warnings());
    if !draft.included.is_empty() {
        let files: Vec<_> = draft.included.iter().map(|file| file.display().to_string()).collect();
        let files = files.join(", ");
        notes.push(format!("{input}: the contents of included files are written in place: {files}"));
    }
    let values = parameters.values().into_iter().map(|(name, value)| format!("${name} = {value}"));
    let values = values.collect::<Vec<_>>().join(", ");
    if !values.is_empty() {
        notes.push(format!("{input}: parameters are not kept, only their values: {values}"));
    }
    if moved > 0 {
        let folder = folder.display();
        notes.push(format!("names of {moved} files now start at {folder}; the files stay where they are"));
    }
    Ok(Conversion { text: spell(&root, spelling)?, notes })
}

/// The tree `root` as a file in `folder` would spell it.
pub fn write(root: &Object, spelling: Spelling, folder: &Path) -> Result<String> {
    spell(&arrange::arrange(root, &HashSet::new(), folder)?.0, spelling)
}

fn spell(root: &Object, spelling: Spelling) -> Result<String> {
    match spelling {
        Spelling::Xml => xml::file(root),
        Spelling::Json => json::file(root),
    }
}

/// The lines of a file that give an object `property`, which is a transform.
pub fn transform(property: &Property, spelling: Spelling) -> Result<String> {
    match spelling {
        Spelling::Xml => xml::property(property),
        Spelling::Json => json::property(property),
    }
}

/// The word for a step of a transform, and its parts by JSON's words for them.
fn parts(step: &TransformStep) -> (&'static str, Vec<(&'static str, &[f64])>) {
    match step {
        TransformStep::Translate(value) => ("translate", vec![("value", value)]),
        TransformStep::Scale(value) => ("scale", vec![("value", shortened(value))]),
        TransformStep::Rotate { axis, angle } => {
            ("rotate", vec![("axis", axis), ("angle", slice::from_ref(angle))])
        }
        TransformStep::LookAt { origin, target, up } => {
            ("lookat", vec![("origin", origin), ("target", target), ("up", up)])
        }
        TransformStep::Matrix(rows) => ("matrix", vec![("value", rows)]),
    }
}

/// One number for three that are the same, where that is what the reader makes of one.
fn shortened(values: &[f64; 3]) -> &[f64] {
    let [x, y, z] = values.map(f64::to_bits);
    if x == y && y == z { &values[..1] } else { values }
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
