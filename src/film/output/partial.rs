//! Files in the making: beside their goal, under a name of their own, locked as long as somebody writes them.

use super::folder;
use std::{
    ffi::OsStr,
    fs::{self, File, Metadata},
    io,
    path::Path,
};
use tempfile::NamedTempFile;

/// A file that is not whole yet. Removed when dropped.
pub(super) struct Partial(NamedTempFile);

/// Random characters in the name of a partial file.
const RANDOM: usize = 12;
/// How the name of every partial file ends.
const ENDING: &str = ".partial";
/// Of the goal's name, to leave room for the rest in 255 bytes (characters).
const LONGEST_STEM: usize = 56;
/// Times to begin again where others take a new file for an abandoned one.
const ATTEMPTS: usize = 100;

impl Partial {
    /// Begins a file that is to become `goal`, with the rights of the one that is there. What killed processes left of
    /// the same goal is removed.
    pub(super) fn begin(goal: &Path) -> io::Result<Self> {
        let (folder, stem) = (folder(goal), stem(goal));
        sweep(folder, &stem);
        for _ in 0..ATTEMPTS {
            let file = builder(&stem).tempfile_in(folder)?;
            // Waits only for those that check whether it is abandoned. Some file systems have no locks.
            let _ = file.as_file().lock();
            if !file.path().exists() {
                continue;
            }
            if let Ok(old) = goal.metadata() {
                inherit(file.as_file(), &old);
            }
            return Ok(Self(file));
        }
        Err(io::Error::other("partial files are removed as soon as they are made"))
    }

    /// To write into.
    pub(super) fn file(&mut self) -> &mut File {
        self.0.as_file_mut()
    }

    /// Puts the file, now whole, in the place of `goal`.
    pub(super) fn finish(self, goal: &Path) -> io::Result<()> {
        // Without this a crash of the machine could leave the new name with no content.
        self.0.as_file().sync_data()?;
        self.0.persist(goal)?;
        // Nor should the name be lost; not every system can do this for a folder.
        if let Ok(folder) = File::open(folder(goal)) {
            let _ = folder.sync_all();
        }
        Ok(())
    }

    #[cfg(test)]
    fn abandon(self) {
        self.0.into_temp_path().keep().unwrap();
    }

    /// What is known of the file itself.
    #[cfg(unix)]
    pub(super) fn metadata(&self) -> io::Result<Metadata> {
        self.0.as_file().metadata()
    }
}

/// What the names of a goal's partial files begin with.
fn stem(goal: &Path) -> String {
    let name: String =
        goal.file_name().unwrap_or_default().to_string_lossy().chars().take(LONGEST_STEM).collect();
    format!(".{name}.")
}

/// With the permissions of any new file; temporaries are otherwise closed to all but their owner.
fn builder(stem: &str) -> tempfile::Builder<'_, 'static> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(stem).suffix(ENDING).rand_bytes(RANDOM);
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder
}

/// Gives a file the owner and mode of the `old` one, as far as this user may and its file system can.
fn inherit(file: &File, old: &Metadata) {
    #[cfg(unix)]
    {
        use std::os::unix::fs::{MetadataExt, fchown};
        if fchown(file, Some(old.uid()), Some(old.gid())).is_err() {
            let _ = fchown(file, None, Some(old.gid()));
        }
    }
    let _ = file.set_permissions(old.permissions());
}

/// Removes the partial files that nobody has locked.
fn sweep(folder: &Path, stem: &str) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    let paths = entries.flatten().filter(|entry| is_partial(&entry.file_name(), stem));
    paths.for_each(|entry| remove_abandoned(&entry.path()));
}

fn is_partial(name: &OsStr, stem: &str) -> bool {
    let random = |name: &str| name.strip_prefix(stem)?.strip_suffix(ENDING).map(str::to_owned);
    let random = random(&name.to_string_lossy());
    random.is_some_and(|r| r.len() == RANDOM && r.bytes().all(|byte| byte.is_ascii_alphanumeric()))
}

/// The lock is held until the file is gone: who has just made it waits for the lock, and then makes another.
fn remove_abandoned(path: &Path) {
    if !path.symlink_metadata().is_ok_and(|found| found.is_file()) {
        return;
    }
    let Ok(file) = File::options().write(true).open(path) else { return };
    if file.try_lock().is_ok() {
        let _ = fs::remove_file(path);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write as _;

    fn count(folder: &Path) -> usize {
        fs::read_dir(folder).unwrap().count()
    }

    #[test]
    fn only_abandoned_files_of_the_same_goal_are_removed() {
        let desk = tempfile::tempdir().unwrap();
        let goal = desk.path().join("a.exr");
        let begun = |name: &str| Partial::begin(&desk.path().join(name)).unwrap();
        begun("a.exr").abandon();
        begun("a").abandon();
        fs::write(desk.path().join(".a.exr.notes.partial"), "mine").unwrap();
        assert_eq!(count(desk.path()), 3);
        let (first, second) = (Partial::begin(&goal).unwrap(), Partial::begin(&goal).unwrap());
        assert_eq!(count(desk.path()), 4, "one abandoned, two at work");
        drop((first, second));
        assert_eq!(count(desk.path()), 2);
    }

    /// Threads that begin the same file at the same time sweep while others have not locked theirs yet.
    #[test]
    fn none_is_swept_away_while_it_is_written() {
        let desk = tempfile::tempdir().unwrap();
        let goal = desk.path().join("a.exr");
        let work = || {
            for _ in 0..50 {
                let mut partial = Partial::begin(&goal).unwrap();
                partial.file().write_all(b"whole").unwrap();
                partial.finish(&goal).unwrap();
            }
        };
        std::thread::scope(|scope| (0..4).for_each(|_| drop(scope.spawn(work))));
        assert_eq!((fs::read(&goal).unwrap(), count(desk.path())), (b"whole".to_vec(), 1));
    }

    #[test]
    fn long_names_have_room() {
        let desk = tempfile::tempdir().unwrap();
        let goal = desk.path().join("ä".repeat(127));
        Partial::begin(&goal).unwrap().finish(&goal).unwrap();
        assert!(goal.is_file());
    }
}
