//! What can be known of outputs before any work is done: that they can be written, are different files, and fit on disk.

use super::{explain, folder, partial::Partial, target::Target};
use crate::{
    error::{Error, Result},
    inputs,
};
use std::{
    collections::{HashMap, HashSet},
    fs::Metadata,
    io,
    path::{Path, PathBuf},
};

/// An error unless each of `outputs` (a path, and the bytes that it may take; 0 where these are few) can be written,
/// none of them twice and none of them one of the [`inputs`], and there is room for all. What is read is known by then.
pub fn check(outputs: &[(&Path, u64)]) -> Result<()> {
    let mut names: HashMap<PathBuf, &Path> = HashMap::new();
    let (mut tried, mut needs) = (HashSet::new(), HashMap::new());
    for &(path, bytes) in outputs {
        inputs::guard(path)?;
        let goal = match Target::of(path)? {
            Target::File(goal) => goal,
            Target::Stream(stream) => {
                is_writable(&stream).map_err(|error| explain(path, &stream, &error))?;
                continue;
            }
            Target::Stdout | Target::Stderr => continue,
        };
        let place = folder(&goal).canonicalize().map_err(|error| explain(path, &goal, &error))?;
        if let Some(other) = names.insert(place.join(goal.file_name().unwrap_or_default()), path) {
            return Err(same(path, other));
        }
        // Once for each folder: an animation has thousands of frames.
        if tried.insert(place.clone()) || goal.exists() {
            try_out(path, &goal)?;
        }
        needs.entry(device(&place)).or_insert((place, 0u64)).1 += bytes;
    }
    needs.values().try_for_each(|(place, bytes)| room(place, *bytes, free(place)))
}

/// Makes `folder`, and those it is in, unless it is there.
pub fn create_folder(folder: &Path) -> Result<()> {
    std::fs::create_dir_all(folder).map_err(|error| {
        let remedy = "choose another place, or check that you may create a folder there";
        Error::new(folder.display(), "a folder to write to", error.to_string(), remedy)
    })
}

fn same(path: &Path, other: &Path) -> Error {
    let found = match path == other {
        true => "the name of another file of this command".to_owned(),
        false => format!("the same file as {}", other.display()),
    };
    Error::new(path.display(), "a file of its own for each output", found, "choose another name")
}

/// Begins to write, and stops: the folder takes a file, and what is there may be replaced.
fn try_out(path: &Path, goal: &Path) -> Result<()> {
    let partial = Partial::begin(goal).map_err(|error| explain(path, goal, &error))?;
    let Ok(old) = goal.symlink_metadata() else { return Ok(()) };
    if is_writable(goal).is_ok() && is_renameable(&partial, &old, goal) {
        return Ok(());
    }
    let remedy = "allow yourself to write to it, or choose another name";
    Err(Error::new(path.display(), "a file that may be replaced", "a file protected from you", remedy))
}

#[cfg(unix)]
fn is_writable(path: &Path) -> io::Result<()> {
    Ok(rustix::fs::access(path, rustix::fs::Access::WRITE_OK)?)
}

#[cfg(not(unix))]
fn is_writable(path: &Path) -> io::Result<()> {
    std::fs::OpenOptions::new().append(true).open(path).map(drop)
}

/// In folders such as /tmp only the owners of file and folder may replace a file. A partial file is this user's.
#[cfg(unix)]
fn is_renameable(partial: &Partial, old: &Metadata, goal: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    const STICKY: u32 = 0o1000;
    let (Ok(own), Ok(folder)) = (partial.metadata(), folder(goal).metadata()) else { return true };
    folder.mode() & STICKY == 0 || [0, old.uid(), folder.uid()].contains(&own.uid())
}

#[cfg(not(unix))]
fn is_renameable(_: &Partial, old: &Metadata, _: &Path) -> bool {
    !old.permissions().readonly()
}

/// Folders with the same number are on the same disk.
#[cfg(unix)]
fn device(folder: &Path) -> u64 {
    std::os::unix::fs::MetadataExt::dev(&match folder.metadata() {
        Ok(found) => found,
        Err(_) => return 0,
    })
}

#[cfg(not(unix))]
fn device(_: &Path) -> u64 {
    0
}

/// What this user may still write to the disk of `folder` (bytes); none where it does not tell.
#[cfg(unix)]
fn free(folder: &Path) -> Option<u64> {
    let disk = rustix::fs::statvfs(folder).ok().filter(|disk| disk.f_blocks > 0)?;
    Some(disk.f_bavail.saturating_mul(disk.f_frsize))
}

#[cfg(not(unix))]
fn free(_: &Path) -> Option<u64> {
    None
}

fn room(folder: &Path, needed: u64, free: Option<u64>) -> Result<()> {
    let Some(free) = free.filter(|free| *free < needed) else { return Ok(()) };
    let mebibytes = |bytes: u64| format!("{:.1} MiB", bytes as f64 / (1u64 << 20) as f64);
    let expected = format!("a disk with room for {}", mebibytes(needed));
    let remedy = "make room, choose a folder on another disk, or write a smaller image";
    Err(Error::new(folder.display(), expected, format!("{} free", mebibytes(free)), remedy))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_left_behind_and_nothing_is_touched() {
        let desk = tempfile::tempdir().unwrap();
        let (new, old) = (desk.path().join("new"), desk.path().join("old"));
        std::fs::write(&old, "old").unwrap();
        check(&[(&new, 1), (&old, 1), (Path::new("/dev/null"), u64::MAX)]).unwrap();
        assert_eq!(std::fs::read(&old).unwrap(), b"old");
        assert_eq!(std::fs::read_dir(desk.path()).unwrap().count(), 1);
    }

    #[test]
    fn two_outputs_are_two_files() {
        let desk = tempfile::tempdir().unwrap();
        let (a, b) = (desk.path().join("a"), desk.path().join("b"));
        std::fs::create_dir(desk.path().join("x")).unwrap();
        let same = desk.path().join("x/../a");
        assert!(check(&[(&a, 0), (&b, 0)]).is_ok());
        assert!(check(&[(&a, 0), (&same, 0)]).unwrap_err().found.contains("the same file as"));
        std::fs::write(&a, "scene").unwrap();
        inputs::note(&a, inputs::Reader::Scene);
        assert!(check(&[(&same, 0)]).unwrap_err().found.contains("which the scene reads"));
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink("b", desk.path().join("link")).unwrap();
            assert!(check(&[(&b, 0), (&desk.path().join("link"), 0)]).is_err());
        }
    }

    #[test]
    fn a_disk_that_is_too_small_is_named_with_sizes() {
        let disk = Path::new("/disk");
        assert!(room(disk, 10, Some(10)).is_ok() && room(disk, 10, None).is_ok());
        let error = room(disk, 3 << 20, Some(1 << 19)).unwrap_err().to_string();
        assert!(
            error.starts_with("/disk: expected a disk with room for 3.0 MiB, found 0.5 MiB free"),
            "{error}"
        );
        let desk = tempfile::tempdir().unwrap();
        let paths = [desk.path().join("a"), desk.path().join("b")];
        let half = u64::MAX / 2;
        assert!(check(&[(&paths[0], half), (&paths[1], half)]).is_err());
    }

    #[test]
    fn a_missing_folder_is_an_error_or_made() {
        let desk = tempfile::tempdir().unwrap();
        let path = desk.path().join("x/y/a");
        let error = check(&[(&path, 0)]).unwrap_err();
        assert!(error.remedy.contains("create the folder"), "{error}");
        create_folder(path.parent().unwrap()).unwrap();
        assert!(check(&[(&path, 0)]).is_ok() && create_folder(&path.join("z")).is_ok());
    }
}
