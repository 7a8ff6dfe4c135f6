//! The folder of a study. Everything in it is written whole or not at all, and what is done is never done again: a study
//! that was stopped goes on where it was.
//!
//! `runs/plan.json` holds the question and what pilots found; `runs/SCENE/reference/BATCH.exr` the parts of a reference;
//! `runs/SCENE/turns/CONTENDER/SEED.json` the numbers of one render, with its image at the largest budget beside it, written
//! before the numbers.

use super::{
    plan::Plan,
    question::{Question, first_difference},
};
use crate::{
    analysis::picture::{self, Picture},
    error::{Error, Result},
    film::output,
    inputs,
};
use serde::{Serialize, de::DeserializeOwned};
use std::{
    fs::{self, File, TryLockError},
    io::ErrorKind,
    path::{Path, PathBuf},
};

/// A folder that belongs to one study, and for now to this process alone.
#[derive(Debug)]
pub struct Store {
    root: PathBuf,
    /// Released when the process ends, however it ends.
    _lock: File,
}

/// The plan, in the folder.
const PLAN: &str = "runs/plan.json";
/// What says that somebody is at work, in `runs`: a name that no scene has (see [`super::contender::slug`]).
const LOCK: &str = ".lock";
/// What a study has done.
const RUNS: &str = "runs";
/// What it writes besides.
const PRODUCTS: [&str; 4] = [FILES[0], FILES[1], FILES[2], "images"];
/// The files of these.
const FILES: [&str; 3] = ["study.json", "study.csv", "study.html"];

impl Store {
    /// Opens `root` for `question`, and reads what is already planned for it. With `restart` all that an earlier study
    /// left there is removed first.
    pub fn open(root: &Path, question: &Question, restart: bool) -> Result<(Self, Plan)> {
        PRODUCTS.iter().chain([&RUNS]).try_for_each(|name| inputs::guard(&root.join(name)))?;
        output::create_folder(&root.join(RUNS))?;
        let store = Self { root: root.to_owned(), _lock: lock(&root.join(RUNS).join(LOCK))? };
        store.sweep()?;
        if restart && (store.has("study.json") || store.has_runs()?) {
            store.empty()?;
        }
        let plan = match store.has(PLAN) {
            true => store.planned(question)?,
            false if store.has("study.json") => return Err(store.taken("a study that was made otherwise")),
            false if store.has_runs()? => return Err(store.taken("the runs of a study without their plan")),
            false => Plan::new(question.clone()),
        };
        let files = FILES.map(|name| root.join(name));
        output::check(&files.each_ref().map(|file| (file.as_path(), 0)))?;
        store.write_json(PLAN, &plan)?;
        Ok((store, plan))
    }

    fn planned(&self, question: &Question) -> Result<Plan> {
        let plan: Plan =
            self.read_json(PLAN, "add --restart to drop what the folder holds, or choose another folder")?;
        match first_difference(&plan.question, question) {
            None => Ok(plan),
            Some((place, old, new)) => {
                Err(self.taken(&format!("one with {place} = {old}, but {new} is requested")))
            }
        }
    }

    fn taken(&self, found: &str) -> Error {
        let expected = "a folder without a study, or with the same one";
        let remedy = "choose another folder, or add --restart to drop what this one holds";
        Error::new(self.root.display(), expected, found, remedy)
    }

    /// True if a study has begun here.
    fn has_runs(&self) -> Result<bool> {
        Ok(entries(&self.root.join(RUNS))?.iter().any(|path| !is_lock(path)))
    }

    /// Removes an earlier study; the lock stays.
    fn empty(&self) -> Result<()> {
        for name in PRODUCTS {
            remove(&self.root.join(name))?;
        }
        for path in entries(&self.root.join(RUNS))? {
            if !is_lock(&path) {
                remove(&path)?;
            }
        }
        Ok(())
    }

    /// Removes what a killed process had begun to write: beside the study's products, and anywhere in its folders.
    fn sweep(&self) -> Result<()> {
        entries(&self.root)?.iter().filter(|path| is_partial(path)).try_for_each(|path| remove(path))?;
        [RUNS, "images"].into_iter().try_for_each(|name| sweep(&self.root.join(name)))
    }

    /// Where the folder is.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// True if the file `name`, relative to the folder, is there.
    pub fn has(&self, name: impl AsRef<Path>) -> bool {
        self.root.join(name).is_file()
    }

    /// Writes the plan.
    pub fn write_plan(&self, plan: &Plan) -> Result<()> {
        self.write_json(PLAN, plan)
    }

    /// Writes `value` to `name`.
    pub fn write_json(&self, name: impl AsRef<Path>, value: &impl Serialize) -> Result<()> {
        let text = serde_json::to_string_pretty(value).map_err(|error| {
            let remedy = "report this, with the command that you ran";
            Error::new(
                self.root.join(&name).display(),
                "values that JSON can hold",
                error.to_string(),
                remedy,
            )
        })?;
        self.write_text(name, &format!("{text}\n"))
    }

    /// Writes `text` to `name`.
    pub fn write_text(&self, name: impl AsRef<Path>, text: &str) -> Result<()> {
        output::write(&self.ready(name)?, |file| file.write_all(text.as_bytes()))
    }

    /// Reads what [`Store::write_json`] wrote; `remedy` is for files that are no longer whole.
    pub fn read_json<T: DeserializeOwned>(&self, name: impl AsRef<Path>, remedy: &str) -> Result<T> {
        let path = self.root.join(name);
        let text = fs::read_to_string(&path).map_err(|error| Error::io(&path, "read", &error))?;
        serde_json::from_str(&text).map_err(|error| {
            Error::new(path.display(), "the file as a study left it", error.to_string(), remedy)
        })
    }

    /// Writes an image to `name`.
    pub fn write_image(&self, name: impl AsRef<Path>, image: &Picture) -> Result<()> {
        image.write(&self.ready(name)?)
    }

    /// Reads one.
    pub fn read_image(&self, name: impl AsRef<Path>) -> Result<Picture> {
        picture::read(&self.root.join(name))
    }

    /// The path of `name`, in a folder that is there.
    fn ready(&self, name: impl AsRef<Path>) -> Result<PathBuf> {
        let path = self.root.join(name);
        output::create_folder(path.parent().unwrap_or(&self.root))?;
        Ok(path)
    }
}

fn sweep(folder: &Path) -> Result<()> {
    entries(folder)?.iter().try_for_each(|path| match path.is_dir() {
        true => sweep(path),
        false if is_partial(path) => remove(path),
        false => Ok(()),
    })
}

/// True for a file that was never whole; see [`output::write`].
fn is_partial(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    name.starts_with('.') && name.ends_with(".partial") && !path.is_dir()
}

fn is_lock(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name == LOCK)
}

fn lock(path: &Path) -> Result<File> {
    let file = File::create(path).map_err(|error| Error::io(path, "write", &error))?;
    match file.try_lock() {
        // Some file systems have no locks; the study is then as safe as its user is careful.
        Ok(()) | Err(TryLockError::Error(_)) => Ok(file),
        Err(TryLockError::WouldBlock) => {
            let remedy = "wait for it, end it, or choose another folder";
            Err(Error::new(path.display(), "a folder no other study works in", "one that is at work", remedy))
        }
    }
}

fn entries(folder: &Path) -> Result<Vec<PathBuf>> {
    match fs::read_dir(folder) {
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(Vec::new()),
        Err(error) => Err(Error::io(folder, "list", &error)),
        Ok(entries) => Ok(entries.flatten().map(|entry| entry.path()).collect()),
    }
}

fn remove(path: &Path) -> Result<()> {
    let result = if path.is_dir() { fs::remove_dir_all(path) } else { fs::remove_file(path) };
    match result {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(Error::io(path, "remove", &error)),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::{super::question::tests::question, *};

    #[test]
    fn only_the_same_study_goes_on() {
        let folder = tempfile::tempdir().unwrap();
        drop(Store::open(folder.path(), &question(), false).unwrap());
        let other = Question { seeds: 9, ..question() };
        let error = Store::open(folder.path(), &other, false).unwrap_err();
        assert!(error.found.contains("seeds = 2, but 9") && error.remedy.contains("--restart"), "{error}");
        let (store, plan) = Store::open(folder.path(), &question(), false).unwrap();
        assert_eq!(plan.question, question());
        let error = Store::open(folder.path(), &question(), false).unwrap_err();
        assert!(error.found.contains("at work"), "{error}");
        drop(store);
        assert_eq!(Store::open(folder.path(), &other, true).unwrap().1.question, other);
    }

    #[test]
    fn starting_anew_leaves_what_is_not_a_study_s() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        fs::create_dir(path("images")).unwrap();
        fs::write(path("images/holiday.jpg"), "sun").unwrap();
        fs::write(path("notes.txt"), "mine").unwrap();
        drop(Store::open(folder.path(), &question(), true).unwrap());
        assert!(path("images/holiday.jpg").exists());
        fs::write(path("runs/.a.partial"), "ha").unwrap();
        fs::write(path(".b.partial"), "ha").unwrap();
        fs::write(path("study.csv"), "old").unwrap();
        drop(Store::open(folder.path(), &question(), false).unwrap());
        assert!(
            !path("runs/.a.partial").exists() && !path(".b.partial").exists() && path("study.csv").exists()
        );
        drop(Store::open(folder.path(), &question(), true).unwrap());
        assert!(!path("study.csv").exists() && path("notes.txt").exists());
    }

    #[test]
    fn a_study_of_another_program_is_left_alone() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("study.json"), "{}").unwrap();
        assert!(Store::open(folder.path(), &question(), false).unwrap_err().found.contains("otherwise"));
        fs::write(folder.path().join("runs/plan.json"), "{").unwrap();
        let error = Store::open(folder.path(), &question(), false).unwrap_err();
        assert!(error.remedy.contains("--restart"), "{error}");
        for name in ["study.json", "runs/plan.json"] {
            fs::remove_file(folder.path().join(name)).unwrap();
        }
        fs::create_dir(folder.path().join("runs/fog")).unwrap();
        let error = Store::open(folder.path(), &question(), false).unwrap_err();
        assert!(error.found.contains("without their plan"), "{error}");
        drop(Store::open(folder.path(), &question(), true).unwrap());
        assert!(!folder.path().join("runs/fog").exists());
    }
}
