//! Reads a scene file of either format as a description in which every reference is resolved.

use super::{
    draft::Draft,
    files::{self, Sources},
    foreign, input, json,
    parameters::Parameters,
    references, text, xml,
};
use crate::{
    description::Object,
    error::{Error, Result},
    volume::grid::is_volume,
};
use std::path::Path;

/// Reads the scene at `path`: Mitsuba XML (`.xml`) or JSON (`.json`). `definitions` are the user's
/// `name=value` pairs, which override the scene's own defaults; one that the scene never uses is an error.
///
/// In what comes back, ids are unique, every reference leads to an object, and none leads back to itself.
pub fn read(path: &Path, definitions: &[(String, String)]) -> Result<Object> {
    read_whole(path, definitions).map(|(draft, _)| draft.root)
}

/// The sources of the scene at `path`, read with the user's `definitions` as by [`read`]. Of numbered files, only the
/// one shown at `time` (s), by default the scene's own.
pub fn sources(path: &Path, definitions: &[(String, String)], time: Option<f64>) -> Result<Sources> {
    let (draft, _) = read_whole(path, definitions)?;
    Ok(Sources::of(path, draft, time))
}

/// [`read`], with what the tree does not show.
pub(super) fn read_whole(path: &Path, definitions: &[(String, String)]) -> Result<(Draft, Parameters)> {
    let mut parameters = Parameters::new(definitions)?;
    let found = match input::is_standard_input(path) {
        true => spelling_of(path, &text::of_file(path)?)?,
        false if is_volume(path) => Spelling::Json,
        false => foreign::known(path).map_or_else(|| spelling_by_name(path), Err)?,
    };
    let mut draft = match found {
        Spelling::Xml => xml::read(path, &mut parameters)?,
        Spelling::Json => json::read(path, &mut parameters)?,
    };
    parameters.finish()?;
    references::settle(&mut draft)?;
    files::note(&draft.root);
    Ok((draft, parameters))
}

/// How scenes are spelled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Spelling {
    /// Mitsuba's XML.
    Xml,
    /// The dictionary of `mitsuba.load_dict`, as JSON.
    Json,
}

/// The format of `text`, which came without a name.
fn spelling_of(path: &Path, text: &str) -> Result<Spelling> {
    match text.trim_start().chars().next() {
        Some('<') => Ok(Spelling::Xml),
        Some('{') => Ok(Spelling::Json),
        first => Err(Error::new(
            path.display(),
            "a scene that begins with < (Mitsuba XML) or { (JSON)",
            first.map_or("nothing".into(), |first| format!("\"{first}\"")),
            "check what is written to standard input",
        )),
    }
}

/// The format of the file at `path` by its name. That of a file that is not there needs no other ending.
fn spelling_by_name(path: &Path) -> Result<Spelling> {
    if path.exists() { spelling(path) } else { text::of_file(path).and_then(|_| spelling(path)) }
}

/// True if the file at `path` is a scene by its name.
pub fn is_scene(path: &Path) -> bool {
    spelling(path).is_ok()
}

/// The format according to the extension of the file name.
pub(super) fn spelling(path: &Path) -> Result<Spelling> {
    if path.is_dir() {
        return Err(Error::new(path.display(), "a scene file", "a folder", "name a file in it"));
    }
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    match extension.as_deref() {
        Some("xml") => Ok(Spelling::Xml),
        Some("json") => Ok(Spelling::Json),
        other => Err(Error::new(
            path.display(),
            "a scene file that ends in .xml or .json",
            other.map_or("a name without an extension".into(), |e| format!("one that ends in .{e}")),
            "rename the file to match its contents: .xml for Mitsuba XML, .json for JSON",
        )),
    }
}
