//! What is known to fail is said before any work is done.

use super::scene::Scene;
use crate::{error::Result, film::output};
use std::path::{Path, PathBuf};

/// What a render keeps of every pixel, in numbers of four bytes, files in the making included: exact sums (24) and once
/// more while they are written, the pass at hand (6), the image and its files. Measured: 51, with 22 channels of layers 3 for
/// each, with batches 5 for each, with precision 134 in all; and some more.
pub(super) const NUMBERS: usize = 72;
/// An error unless `outputs` can be written, as [`output::check`] says. Where one of them is standard output, reports go
/// to standard error.
pub(super) fn check(outputs: &[(&Path, u64)]) -> Result<()> {
    output::check(outputs)?;
    if outputs.iter().any(|(path, _)| output::is_stdout(path)) {
        super::console::take_stdout();
    }
    Ok(())
}

/// The folder that a command writes to, which then exists: the one that was asked for, or one named after `scene` and what it is `of`.
pub(super) fn folder(wanted: Option<&PathBuf>, scene: &Scene, of: &str) -> Result<PathBuf> {
    let named = || PathBuf::from(format!("{}-{of}", scene.name().to_string_lossy()));
    let folder = wanted.cloned().unwrap_or_else(named);
    output::create_folder(&folder)?;
    Ok(folder)
}

/// What was written, in a line.
pub(super) fn listed(folder: &Path, files: &[PathBuf]) -> String {
    let names = files.iter().filter_map(|file| file.file_name()).map(|name| name.to_string_lossy());
    format!("in {}: {}", folder.display(), names.collect::<Vec<_>>().join(", "))
}

/// The same for files of which there may be none, all of them short.
pub(super) fn check_short<'a>(files: impl IntoIterator<Item = &'a PathBuf>) -> Result<()> {
    check(&files.into_iter().map(|path| (path.as_path(), 0)).collect::<Vec<_>>())
}
