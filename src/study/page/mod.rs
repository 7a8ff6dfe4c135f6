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
mod strips;
mod tone;
mod view;

use crate::{error::Result, film::output};
use std::{
    io::Write as _,
    path::{Path, PathBuf},
};

/// Writes `study.html` into the folder of a study, and says where it is.
pub fn write(folder: &Path) -> Result<PathBuf> {
    let outcome = read::outcome(&folder.join("study.json"))?;
    let html = view::Page::new(folder, &outcome)?.html()?;
    let path = folder.join("study.html");
    output::write(&path, |file| file.write_all(html.as_bytes()))?;
    Ok(path)
}
