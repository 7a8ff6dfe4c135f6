//! The files that this process reads. No output takes the place of one: what reads a file that a user named notes it here,
//! and what writes files asks here, first of all names together before any work is done, and again when it writes.

use crate::error::{Error, Result};
use std::{
    collections::{BTreeMap, BTreeSet},
    fs::{self, Metadata},
    path::{Path, PathBuf},
    sync::{Mutex, MutexGuard, PoisonError},
    time::SystemTime,
};

/// What reads a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reader {
    /// The scene.
    Scene,
    /// The command, whose arguments name the file.
    Command,
}

impl Reader {
    fn name(self) -> &'static str {
        match self {
            Self::Scene => "the scene",
            Self::Command => "this command",
        }
    }
}

/// As the file was named, what reads it, and its stamp when it was noted first.
type Input = (PathBuf, Reader, Option<Stamp>);

/// By the names that all spellings of a path share.
type Inputs = BTreeMap<PathBuf, Input>;

/// Of the process, as its files are.
static READ: Mutex<Inputs> = Mutex::new(Inputs::new());

fn read() -> MutexGuard<'static, Inputs> {
    READ.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Where a file was to be read, and none was.
static MISSED: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

fn missed() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    MISSED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Notes that `reader` reads the plain file at `path`, or would if there were one.
pub fn note(path: &Path, reader: Reader) {
    match path.canonicalize() {
        Ok(at) if at.is_file() => {
            let stamp = stamp(&at);
            read().entry(at).or_insert_with(|| (path.to_owned(), reader, stamp));
        }
        Ok(_) => {}
        Err(_) => missed().extend(std::path::absolute(path)),
    }
}

/// When a file was written, and its bytes: another one has another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stamp {
    /// When it was written last.
    pub written: SystemTime,
    /// Its length (bytes).
    pub bytes: u64,
}

/// That of the file at `path`; none of one that is not there.
pub fn stamp(path: &Path) -> Option<Stamp> {
    let found = fs::metadata(path).ok()?;
    Some(Stamp { written: found.modified().ok()?, bytes: found.len() })
}

/// The files that were noted so far, by the names that all spellings of a path share, and where one was missed; with their
/// stamps when they were noted first.
pub fn all() -> Vec<(PathBuf, Option<Stamp>)> {
    let found: Vec<_> = read().iter().map(|(path, (.., stamp))| (path.clone(), *stamp)).collect();
    found.into_iter().chain(missed().iter().map(|path| (path.clone(), None))).collect()
}

/// An error if `path`, links followed, is a file that is read, another name of one (a hard link), or a folder that holds
/// one.
pub fn guard(path: &Path) -> Result<()> {
    let Ok(at) = path.canonicalize() else { return Ok(()) };
    match found(&at) {
        None => Ok(()),
        Some((name, reader, _)) => Err(refusal(path, &name, reader)),
    }
}

fn found(at: &Path) -> Option<Input> {
    let read = read();
    // Whatever a folder holds comes directly after it.
    let first = read.range(at.to_owned()..).next().filter(|(input, _)| input.starts_with(at));
    let linked = || {
        let wanted = identity(&at.metadata().ok().filter(has_other_names)?);
        read.iter().find(|(input, _)| input.metadata().is_ok_and(|found| identity(&found) == wanted))
    };
    first.or_else(linked).map(|(_, input)| input.clone())
}

fn refusal(path: &Path, name: &Path, reader: Reader) -> Error {
    let found = format!("{}, which {} reads", name.display(), reader.name());
    let remedy = match reader {
        Reader::Scene => "choose another name; -o names an image and what is written beside it",
        Reader::Command => "choose another name",
    };
    Error::new(path.display(), "a file that is only written", found, remedy)
}

/// Device and number: what all names of a file share.
#[cfg(unix)]
fn identity(found: &Metadata) -> (u64, u64) {
    use std::os::unix::fs::MetadataExt;
    (found.dev(), found.ino())
}

#[cfg(unix)]
fn has_other_names(found: &Metadata) -> bool {
    found.is_file() && std::os::unix::fs::MetadataExt::nlink(found) > 1
}

#[cfg(not(unix))]
fn identity(_: &Metadata) {}

#[cfg(not(unix))]
fn has_other_names(_: &Metadata) -> bool {
    false
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn what_is_read_is_guarded_under_all_its_names() {
        let desk = tempfile::tempdir().unwrap();
        let at = |name: &str| desk.path().join(name);
        fs::create_dir_all(at("x/y")).unwrap();
        for name in ["x/y/sky.exr", "x/free.exr", "x.exr"] {
            fs::write(at(name), "").unwrap();
        }
        note(&at("x/y/sky.exr"), Reader::Scene);
        let sky = at("x/y/sky.exr").canonicalize().unwrap();
        assert!(all().contains(&(sky.clone(), stamp(&sky))));
        note(&at("none.exr"), Reader::Scene);
        assert!(all().contains(&(at("none.exr"), None)) && guard(&at("none.exr")).is_ok());
        note(&at("x"), Reader::Command);
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink("x/y/sky.exr", at("link.exr")).unwrap();
            assert!(guard(&at("link.exr")).is_err());
        }
        fs::hard_link(at("x/y/sky.exr"), at("hard.exr")).unwrap();
        #[cfg(unix)]
        assert!(guard(&at("hard.exr")).is_err());
        for name in ["x/y/sky.exr", "x/y/../y/sky.exr", "x/y", "x"] {
            let error = guard(&at(name)).unwrap_err().to_string();
            assert!(error.contains("sky.exr, which the scene reads") && error.contains("-o"), "{error}");
        }
        for name in ["x/free.exr", "x.exr", "none.exr", "x/y/sky"] {
            guard(&at(name)).unwrap();
        }
    }
}
