//! `study.html`: a study on one page that needs nothing but itself. Curves, images, maps and numbers; by
//! [`write`] from a folder with `study.json` and the images it names.

mod axis;
mod chart;
mod data;
mod figures;
mod inline;
mod levels;
mod maps;
mod measure;
mod read;
mod record;
mod strips;
mod tone;
mod view;

use crate::{
    error::{Error, Result},
    film::output,
};
use std::{
    io::Write as _,
    path::{Path, PathBuf},
};

/// Writes `study.html` into the folder of a study, and says where it is.
pub fn write(folder: &Path) -> Result<PathBuf> {
    let outcome = read::outcome(&folder.join("study.json"))?;
    text(folder.join("study.html"), &view::Page::new(folder, &outcome)?.html()?)
}

/// Writes a record of the study in `folder` to the folder `to`: its table, its curves and its images, for a README. Says
/// where they are.
pub fn record(folder: &Path, to: &Path) -> Result<Vec<PathBuf>> {
    let outcome = read::outcome(&folder.join("study.json"))?;
    let page = view::Page::new(folder, &outcome)?;
    std::fs::create_dir_all(to).map_err(|error| Error::io(to, "make", &error))?;
    let files = record::files(&outcome, &page)?;
    files.into_iter().map(|(name, content)| text(to.join(name), &content)).collect()
}

fn text(path: PathBuf, content: &str) -> Result<PathBuf> {
    output::write(&path, |file| file.write_all(content.as_bytes()))?;
    Ok(path)
}
