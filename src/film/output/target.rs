//! Where the bytes of an output go: links are followed, and what is no plain file is told apart.

use super::{explain, folder};
use crate::error::{Error, Result};
use std::{
    fs::Metadata,
    io::ErrorKind,
    path::{Path, PathBuf},
    process,
};

/// Where the bytes of an output go.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Target {
    /// A plain file, which may not exist yet; no link.
    File(PathBuf),
    /// A device, a pipe, or a file that some process has open: written to as it is, never replaced.
    Stream(PathBuf),
    /// This program's own standard output.
    Stdout,
    /// This program's own standard error.
    Stderr,
}

/// As many links as Linux follows from one to the next.
const MOST_LINKS: usize = 40;

impl Target {
    /// Follows `path`. A folder, a disk, a socket and links that lead nowhere are errors.
    pub(super) fn of(path: &Path) -> Result<Self> {
        if path.as_os_str().as_encoded_bytes().ends_with(b"/") {
            return Err(unfit(path, "the name of a folder"));
        }
        let mut at = path.to_owned();
        for _ in 0..=MOST_LINKS {
            if let Some(descriptor) = descriptor(&at) {
                return Ok(descriptor);
            }
            match at.read_link() {
                Ok(next) => at = folder(&at).join(next),
                Err(_) => return Self::at(path, at),
            }
        }
        Err(unfit(path, "links that lead from one to the other without end"))
    }

    /// What is at the end of all links.
    fn at(path: &Path, at: PathBuf) -> Result<Self> {
        match at.symlink_metadata() {
            Ok(found) if found.is_dir() => Err(unfit(path, "a folder")),
            Ok(found) if found.is_file() => Ok(Self::File(at)),
            Ok(found) if !is_stream(&found) => Err(unfit(path, "a disk or a socket")),
            Ok(_) => Ok(Self::Stream(at)),
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(Self::File(at)),
            Err(error) => Err(explain(path, &at, &error)),
        }
    }
}

/// What `at` stands for where it is one of the names of an open file: /dev/fd/N, /proc/self/fd/N.
fn descriptor(at: &Path) -> Option<Target> {
    let folder = folder(at).canonicalize().ok()?;
    let is_own =
        folder == Path::new("/dev/fd") || folder == Path::new(&format!("/proc/{}/fd", process::id()));
    let is_of_any = is_own || (folder.starts_with("/proc") && folder.ends_with("fd"));
    is_of_any.then_some(match at.file_name()?.to_str()? {
        "1" if is_own => Target::Stdout,
        "2" if is_own => Target::Stderr,
        _ => Target::Stream(at.to_owned()),
    })
}

#[cfg(unix)]
fn is_stream(found: &Metadata) -> bool {
    use std::os::unix::fs::FileTypeExt;
    found.file_type().is_char_device() || found.file_type().is_fifo()
}

#[cfg(not(unix))]
fn is_stream(_: &Metadata) -> bool {
    true
}

fn unfit(path: &Path, found: &str) -> Error {
    let remedy = "name a plain file, a character device or a pipe";
    Error::new(path.display(), "a file to write", found, remedy)
}

#[cfg(unix)]
#[cfg(test)]
mod tests {
    use super::*;
    use std::os::unix::{fs::symlink, net::UnixListener};

    fn found(path: &Path) -> String {
        Target::of(path).unwrap_err().found
    }

    #[test]
    fn links_are_followed_as_far_as_they_lead() {
        let desk = tempfile::tempdir().unwrap();
        let at = |name: &str| desk.path().join(name);
        std::fs::create_dir(at("deep")).unwrap();
        symlink("deep/b", at("a")).unwrap();
        symlink("../c", at("deep/b")).unwrap();
        assert_eq!(Target::of(&at("a")).unwrap(), Target::File(at("deep/../c")));
        symlink("y", at("x")).unwrap();
        symlink("x", at("y")).unwrap();
        assert!(found(&at("x")).contains("without end"));
    }

    #[test]
    fn what_takes_no_file_is_refused() {
        let desk = tempfile::tempdir().unwrap();
        assert_eq!(found(desk.path()), "a folder");
        assert_eq!(found(&desk.path().join("missing/")), "the name of a folder");
        let socket = desk.path().join("socket");
        let _listener = UnixListener::bind(&socket).unwrap();
        assert_eq!(found(&socket), "a disk or a socket");
    }

    #[test]
    fn devices_and_open_files_are_streams() {
        assert_eq!(Target::of(Path::new("/dev/null")).unwrap(), Target::Stream("/dev/null".into()));
        assert_eq!(Target::of(Path::new("/dev/stdout")).unwrap(), Target::Stdout);
        assert_eq!(Target::of(Path::new("/dev/fd/2")).unwrap(), Target::Stderr);
        assert!(matches!(Target::of(Path::new("/proc/self/fd/0")).unwrap(), Target::Stream(_)));
    }
}
