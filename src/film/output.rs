//! Files written whole or not at all: into a temporary beside its goal, then renamed.

use crate::error::{Error, Result};
use std::{
    io::{self, BufWriter, ErrorKind, Write},
    path::Path,
};
use tempfile::NamedTempFile;

/// Writes a file to `path` by `fill`. A reader of `path` sees the old file or the new one, never a part.
pub fn write(
    path: &Path,
    fill: impl FnOnce(&mut BufWriter<&mut NamedTempFile>) -> io::Result<()>,
) -> Result<()> {
    replaceable(path)?;
    replace(path, fill).map_err(|error| explain(path, &error))
}

fn replace(
    path: &Path,
    fill: impl FnOnce(&mut BufWriter<&mut NamedTempFile>) -> io::Result<()>,
) -> io::Result<()> {
    let mut temporary = temporary(folder(path))?;
    let mut writer = BufWriter::new(&mut temporary);
    fill(&mut writer)?;
    writer.flush()?;
    drop(writer);
    // Without this a crash of the machine could leave the new name with no content.
    temporary.as_file().sync_data()?;
    temporary.persist(path)?;
    Ok(())
}

fn folder(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// With the permissions of any new file; temporaries are otherwise closed to all but their owner.
fn temporary(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".").suffix(".partial");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder)
}

/// The rename would put a plain file in the place of a device such as /dev/null.
fn replaceable(path: &Path) -> Result<()> {
    match path.metadata() {
        Ok(existing) if !existing.is_file() => {
            let found = if existing.is_dir() { "a folder" } else { "a device or pipe" };
            Err(Error::new(path.display(), "a plain file to write", found, "name a plain file"))
        }
        _ => Ok(()),
    }
}

fn explain(path: &Path, error: &io::Error) -> Error {
    let folder = folder(path).display();
    let remedy = match error.kind() {
        ErrorKind::NotFound => format!("create the folder {folder} first"),
        ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => {
            format!("choose another place, or allow yourself to write into {folder}")
        }
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => format!("make room on the disk of {folder}"),
        ErrorKind::NotADirectory => format!("choose a folder; {folder} is none"),
        _ => format!("check that {folder} can be written to"),
    };
    Error::new(path.display(), "to write the file", error.to_string(), remedy)
}

/// An image must have as many pixels as its size says, and at least one.
pub(super) fn check_size(path: &Path, width: usize, height: usize, count: usize) -> Result<()> {
    if count > 0 && width.checked_mul(height) == Some(count) {
        return Ok(());
    }
    let found = format!("{width} x {height} and {count} pixels");
    let remedy = "give every pixel of an image with a positive size";
    Err(Error::new(path.display(), "width times height pixels, more than none", found, remedy))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = std::fs::read_dir(folder).unwrap();
        entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect()
    }

    #[test]
    fn a_failure_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("image");
        write(&path, |file| file.write_all(b"old")).unwrap();
        let error = write(&path, |file| {
            file.write_all(b"new")?;
            Err(ErrorKind::StorageFull.into())
        });
        assert!(error.unwrap_err().remedy.contains("make room"));
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
        assert_eq!(names(folder.path()), ["image"]);
    }

    #[test]
    fn errors_name_path_and_remedy() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("missing/image");
        let error = write(&path, |_| Ok(())).unwrap_err();
        assert!(
            error.place.contains("missing/image") && error.remedy.contains("create the folder"),
            "{error}"
        );
        let error = write(folder.path(), |_| Ok(())).unwrap_err();
        assert!(error.found.contains("a folder"), "{error}");
    }

    #[cfg(unix)]
    #[test]
    fn others_may_read_it_and_devices_stay() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("image");
        write(&path, |_| Ok(())).unwrap();
        std::fs::write(folder.path().join("plain"), "").unwrap();
        let mode = |name: &str| folder.path().join(name).metadata().unwrap().permissions().mode();
        assert_eq!(mode("image"), mode("plain"));
        assert!(write(Path::new("/dev/null"), |_| Ok(())).unwrap_err().found.contains("device"));
    }
}
