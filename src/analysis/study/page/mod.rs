//! `study.html`: a study on one page that needs nothing but itself. Curves, images, maps and numbers; by
//! [`write()`] from a folder with `study.json` and the images it names.

mod axis;
mod bias;
mod chart;
mod data;
pub(super) mod figures;
mod inline;
mod levels;
pub(super) mod maps;
mod measure;
pub(super) mod read;
mod record;
mod strips;
mod tone;
mod view;

use crate::{error::Result, film::output};
use std::path::{Path, PathBuf};

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
    output::create_folder(to)?;
    let files = record::files(&outcome, &page)?;
    let paths: Vec<_> = files.iter().map(|(name, _)| to.join(name)).collect();
    output::check(&paths.iter().map(|path| (path.as_path(), 0)).collect::<Vec<_>>())?;
    paths.into_iter().zip(files).map(|(path, (_, content))| text(path, &content)).collect()
}

fn text(path: PathBuf, content: &str) -> Result<PathBuf> {
    output::write(&path, |file| file.write_all(content.as_bytes()))?;
    Ok(path)
}
