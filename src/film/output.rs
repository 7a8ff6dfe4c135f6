//! Files written whole or not at all: into a partial file beside their goal, then renamed. Links are followed, the
//! owner and mode of a file are kept (other names of it, hard links, stay with the old content), and devices and pipes
//! are written to as they are.

mod check;
mod partial;
mod target;

pub use check::{check, create_folder};

use crate::{
    error::{Error, Result},
    inputs,
};
use partial::Partial;
use std::{
    fs::OpenOptions,
    io::{self, BufWriter, Cursor, ErrorKind, Seek, Write},
    path::Path,
};
use target::Target;

/// What an output is written to.
pub trait Sink: Write + Seek {}

impl<T: Write + Seek> Sink for T {}

/// Writes a file to `path` by `fill`, unless it is an input. A reader of `path` sees the old file or the new one, never
/// a part; a device or pipe gets all of it at once.
pub fn write(path: &Path, fill: impl FnOnce(&mut dyn Sink) -> io::Result<()>) -> Result<()> {
    inputs::guard(path)?;
    let target = Target::of(path)?;
    let at = if let Target::File(at) | Target::Stream(at) = &target { at } else { path };
    let written = match &target {
        Target::File(goal) => replace(goal, fill),
        Target::Stream(stream) => pour(fill, || OpenOptions::new().append(true).open(stream)),
        Target::Stdout => pour(fill, || Ok(io::stdout())),
        Target::Stderr => pour(fill, || Ok(io::stderr())),
    };
    written.map_err(|error| explain(path, at, &error))
}

/// True if `path` is a device or pipe, which has neither a kind of file in its name nor files beside it.
pub fn is_stream(path: &Path) -> bool {
    !matches!(Target::of(path), Ok(Target::File(_)) | Err(_))
}

/// True if `path` is this program's own standard output.
pub fn is_stdout(path: &Path) -> bool {
    matches!(Target::of(path), Ok(Target::Stdout))
}

fn replace(goal: &Path, fill: impl FnOnce(&mut dyn Sink) -> io::Result<()>) -> io::Result<()> {
    let mut partial = Partial::begin(goal)?;
    let mut writer = BufWriter::new(partial.file());
    fill(&mut writer)?;
    writer.flush()?;
    drop(writer);
    partial.finish(goal)
}

/// By way of memory: nobody can seek in a pipe.
fn pour<W: Write>(
    fill: impl FnOnce(&mut dyn Sink) -> io::Result<()>,
    open: impl FnOnce() -> io::Result<W>,
) -> io::Result<()> {
    let mut content = Cursor::new(Vec::new());
    fill(&mut content)?;
    let mut stream = open()?;
    stream.write_all(&content.into_inner())?;
    stream.flush()
}

fn folder(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// What hinders the writing of `path`, which leads to the file `at`.
fn explain(path: &Path, at: &Path, error: &io::Error) -> Error {
    let place = folder(at).display();
    let remedy = match error.kind() {
        ErrorKind::NotFound if folder(at).exists() => "check that it is still there".into(),
        ErrorKind::NotFound => format!("create the folder {place} first"),
        ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => {
            format!("choose another place, or allow yourself to write into {place}")
        }
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => format!("make room on the disk of {place}"),
        ErrorKind::FileTooLarge => {
            "raise the limit on the size of files (ulimit -f), or write a smaller file".into()
        }
        ErrorKind::NotADirectory => format!("choose a folder; {place} is none"),
        ErrorKind::InvalidFilename => "choose a shorter name".into(),
        ErrorKind::BrokenPipe => "let the reader of the pipe read to the end".into(),
        _ => format!("check that {place} can be written to"),
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
    fn others_may_read_a_new_file_and_an_old_one_keeps_its_mode() {
        use std::{fs::Permissions, os::unix::fs::PermissionsExt};
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("image");
        write(&path, |_| Ok(())).unwrap();
        std::fs::write(folder.path().join("plain"), "").unwrap();
        let mode = |name: &str| folder.path().join(name).metadata().unwrap().permissions().mode() & 0o777;
        assert_eq!(mode("image"), mode("plain"));
        for kept in [0o600, 0o664] {
            std::fs::set_permissions(&path, Permissions::from_mode(kept)).unwrap();
            write(&path, |_| Ok(())).unwrap();
            assert_eq!(mode("image"), kept);
        }
    }

    #[cfg(unix)]
    #[test]
    fn a_link_stays_and_its_file_is_replaced_or_made() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::create_dir(at("deep")).unwrap();
        std::os::unix::fs::symlink("deep/image", at("link")).unwrap();
        for content in ["new", "newer"] {
            write(&at("link"), |file| file.write_all(content.as_bytes())).unwrap();
            assert!(at("link").symlink_metadata().unwrap().is_symlink());
            assert_eq!(std::fs::read_to_string(at("deep/image")).unwrap(), content);
        }
        assert_eq!((names(folder.path()).len(), names(&at("deep")).len()), (2, 1));
    }

    #[cfg(unix)]
    #[test]
    fn devices_are_written_to_and_stay() {
        use std::os::unix::fs::FileTypeExt;
        let null = Path::new("/dev/null");
        write(null, |file| {
            file.write_all(b"gone")?;
            file.rewind()
        })
        .unwrap();
        assert!(null.metadata().unwrap().file_type().is_char_device() && is_stream(null));
        if Path::new("/dev/full").exists() {
            let error = write(Path::new("/dev/full"), |file| file.write_all(b"much")).unwrap_err();
            assert!(error.remedy.contains("make room"), "{error}");
        }
    }
}
