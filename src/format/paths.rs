//! Names of files, as another folder has to write them.

use crate::error::{Error, Result};
use std::{
    fmt,
    path::{Component, Path, PathBuf},
};

/// The folder of `file`.
pub(super) fn folder(file: &Path) -> &Path {
    file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// The name by which a scene in the folder `from` reaches `path`, which is named at `place`; absolute where there is no
/// other way.
pub(super) fn relative(path: &Path, from: &Path, place: impl fmt::Display) -> Result<String> {
    let path = match path.file_name() {
        Some(name) => settled(folder(path)).join(name),
        None => settled(path),
    };
    let from = settled(from);
    let (inner, outer): (Vec<_>, Vec<_>) = (path.components().collect(), from.components().collect());
    let shared = inner.iter().zip(&outer).take_while(|(a, b)| a == b).count();
    if shared == 0 {
        return text(&path, &place);
    }
    let up = std::iter::repeat_n(Component::ParentDir, outer.len() - shared);
    let parts = up.chain(inner[shared..].iter().copied());
    let parts: Vec<_> = parts.map(|part| text(Path::new(part.as_os_str()), &place)).collect::<Result<_>>()?;
    Ok(if parts.is_empty() { ".".into() } else { parts.join("/") })
}

/// An absolute path without links in its folders, so that `..` means what it says.
fn settled(path: &Path) -> PathBuf {
    let absolute = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    if let Ok(real) = absolute.canonicalize() {
        return real;
    }
    match (absolute.parent(), absolute.file_name()) {
        (Some(parent), Some(name)) if parent != absolute => settled(parent).join(name),
        _ => absolute,
    }
}

fn text(path: &Path, place: impl fmt::Display) -> Result<String> {
    path.to_str().map(str::to_owned).ok_or_else(|| {
        let remedy = "rename the file or folder";
        Error::new(place, "a file whose path is text in UTF-8", path.display().to_string(), remedy)
    })
}
