//! Scenes to start from: small ones by name, and one around any volume file, which is also what a volume file is read as
//! where a scene is expected.

mod levels;
mod portrait;
mod smoke;
mod view;

use super::{parameters::escaped, paths::relative};
use crate::{
    description::suggest,
    error::{Error, Result},
    volume::grid::is_volume,
};
use std::path::{Path, PathBuf};

pub use portrait::{Portrait, of_file};

/// A small scene: its name, what it shows, its text.
type Template = (&'static str, &'static str, &'static str);

/// All of them.
pub const TEMPLATES: [Template; 3] = [
    ("fog", "a lamp over a jetty in fog", include_str!("fog.json")),
    ("room", "sunlight that falls through a window into a dusty room", include_str!("room.json")),
    ("cloud", "a cloud under a blue sky", include_str!("cloud.json")),
];

/// A new scene: its text, and what its user should know of it, a sentence each.
pub struct Start {
    /// The content of the new file.
    pub text: String,
    /// What was found in a volume file, and what was chosen for it.
    pub told: Vec<String>,
}

/// The scene that `what` names, a template or a volume file, as a file in `folder` would have it.
pub fn start(what: &str, folder: &Path) -> Result<Start> {
    if let Some((_, _, text)) = TEMPLATES.iter().find(|(name, ..)| *name == what) {
        return Ok(Start { text: (*text).to_owned(), told: vec![] });
    }
    let path = PathBuf::from(what);
    if !is_volume(&path) {
        let names = TEMPLATES.map(|(name, ..)| name);
        let expected = "the name of a template, or a volume file (.vdb, .nvdb, .vol)";
        return Err(Error::new(
            "tyndall new",
            expected,
            format!("\"{what}\""),
            suggest(what, "templates", &names),
        ));
    }
    let portrait = of_file(&path)?;
    let name = relative(&path, folder, what)?;
    Ok(Start { text: portrait.text(&name), told: portrait.told(&path) })
}
