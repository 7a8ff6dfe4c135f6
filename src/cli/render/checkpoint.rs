//! Keeps what a render has: its sums, from which it can go on, and the picture so far.

use super::{arguments::Render, target::Target, task::Task};
use crate::{
    cli::{console::complain, interrupt, provenance},
    error::Result,
    film::output,
    passes::budget::Budget,
    render::{
        Progress,
        sums::{
            AnySums, Kept, Picture,
            file::{read, write},
            samples::Samples,
        },
    },
};
use serde_json::Value;
use std::{
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

/// Time between two writes of the sums, and before the first one, unless the user wants another.
const PATIENCE: Duration = Duration::from_secs(60);
/// Time between two writes over the time of one: checkpoints cost less than a hundredth of a render.
const RESTRAINT: u32 = 128;
/// Time between two pictures in a viewer.
const VIEW_EVERY: Duration = Duration::from_millis(500);
/// Time between two pictures so far.
const PICTURE_EVERY: Duration = Duration::from_secs(5);

/// Does something now and then, and seldom enough.
struct Turn {
    every: Duration,
    last: Instant,
    cost: Duration,
}

impl Turn {
    fn new(every: Duration) -> Self {
        Self { every, last: Instant::now(), cost: Duration::ZERO }
    }

    /// What `work` gives, if it is its turn.
    fn take<T>(&mut self, work: impl FnOnce() -> T) -> Option<T> {
        if self.last.elapsed() < self.every.max(self.cost * RESTRAINT) {
            return None;
        }
        let started = Instant::now();
        let done = work();
        (self.last, self.cost) = (Instant::now(), started.elapsed());
        Some(done)
    }
}

/// What cannot be written is no reason to stop rendering.
fn warn(what: &str, done: Option<Result<()>>) {
    if let Some(Err(error)) = done {
        complain(&format!("warning: {what} is not written: {error}"));
    }
}

/// Shows what there is while a render goes on.
pub(super) struct Shown<'a> {
    task: &'a Task<'a>,
    picture: Option<Turn>,
    /// Writes the picture so far.
    draw: &'a dyn Fn(&dyn Picture) -> Result<()>,
    view: Turn,
}

impl<'a> Shown<'a> {
    /// With --preview, has the picture so far drawn; with --tev, shows it.
    pub(super) fn new(task: &'a Task<'a>, draw: &'a dyn Fn(&dyn Picture) -> Result<()>) -> Self {
        let picture = task.arguments.preview.then(|| Turn::new(PICTURE_EVERY));
        Self { task, picture, draw, view: Turn::new(VIEW_EVERY) }
    }

    /// Called now and then while rendering, and at the end of it.
    pub(super) fn watch(&mut self, progress: &Progress, picture: &dyn Picture) {
        if progress.is_last {
            return self.task.show(picture);
        }
        let draw = self.draw;
        warn("the picture so far", self.picture.as_mut().and_then(|turn| turn.take(|| draw(picture))));
        self.view.take(|| self.task.show(picture));
    }
}

/// Writes what there is while a render goes on.
pub(super) struct Keeper<'a> {
    /// Where the sums go; none where a render cannot go on from them.
    file: Option<SumsFile>,
    task: &'a Task<'a>,
    sums: Turn,
    shown: Shown<'a>,
    /// The file is to be there at the end, unless the image is then what was asked for.
    is_wanted: bool,
    /// The last sums are written, or cannot be.
    last: Option<Result<()>>,
}

impl<'a> Keeper<'a> {
    /// Keeps the sums of `task` in `file`; with --preview, has the picture so far drawn; with --tev, shows it.
    pub(super) fn new(
        file: Option<SumsFile>,
        task: &'a Task<'a>,
        draw: &'a dyn Fn(&dyn Picture) -> Result<()>,
    ) -> Self {
        let arguments = task.arguments;
        Self {
            file,
            task,
            sums: Turn::new(arguments.sums_every.unwrap_or(PATIENCE)),
            shown: Shown::new(task, draw),
            is_wanted: arguments.resume,
            last: None,
        }
    }

    /// Called now and then while rendering, and at the end of it: what is rendered of alpha and layers after that can be
    /// rendered again, samples cannot.
    pub(super) fn watch(&mut self, progress: &Progress, sums: &dyn Kept) {
        let Self { file, task, .. } = self;
        let is_done = is_done(task, progress, sums);
        let mut replace = || file.as_mut().map(|file| file.replace(sums, &task.made));
        if progress.is_last {
            self.shown.watch(progress, sums);
            let is_needed = self.task.arguments.sums.is_some() || self.is_wanted && !is_done;
            self.last = if is_needed || interrupt::came() { replace() } else { None };
            return;
        }
        let kept = self.sums.take(replace).flatten();
        self.is_wanted |= matches!(kept, Some(Ok(())));
        warn("the checkpoint", kept);
        self.shown.watch(progress, sums);
    }

    /// What is left of the sums.
    pub(super) fn finish(self) -> Result<Left> {
        match (self.file, self.last) {
            (Some(file), Some(written)) => written.map(|()| Left::Kept(file.finish())),
            (Some(file), None) if file.is_ours || file.is_resumed => Ok(Left::Spent(file)),
            _ => Ok(Left::Nothing),
        }
    }
}

/// What a render leaves of its sums.
pub(super) enum Left {
    /// No file.
    Nothing,
    /// A file, from which it goes on.
    Kept(PathBuf),
    /// A file that nobody named, of an image that is what was asked for: of no more use once that is written.
    Spent(SumsFile),
}

/// The samples that `task` is to take, where it is said which.
pub(super) fn wanted(task: &Task<'_>) -> Option<Samples> {
    let Budget { first_sample: first, samples_per_pixel, .. } = task.settings.budget;
    samples_per_pixel.map(|spp| Samples::from(first..first + spp))
}

/// True if no limit of time kept a render from what it was asked for.
fn is_done(task: &Task<'_>, progress: &Progress, sums: &dyn Kept) -> bool {
    match progress.within {
        Some(share) => share >= 1.0,
        None => wanted(task).is_none_or(|wanted| wanted == sums.samples()),
    }
}

/// A file of sums and the one before it, which is kept while the last may still be damaged.
pub(super) struct SumsFile {
    path: PathBuf,
    /// What is there is whole, and of this render.
    is_ours: bool,
    /// This render goes on from what was there.
    is_resumed: bool,
}

/// Where the sums go: none where a render does not go on, or has no name to put them beside.
pub(super) fn sums_file(arguments: &Render, target: &Target) -> Option<SumsFile> {
    if arguments.batches.is_some() || arguments.frames.is_some() {
        return None;
    }
    let beside = || (!output::is_stream(&target.path)).then(|| target.sums());
    arguments.sums.clone().or_else(beside).map(|path| SumsFile::new(&path))
}

impl SumsFile {
    /// A file at `path`, links followed, for new sums.
    pub(super) fn new(path: &Path) -> Self {
        let path = std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        Self { path, is_ours: false, is_resumed: false }
    }

    fn beside(&self, end: &str) -> PathBuf {
        let mut name = self.path.as_os_str().to_owned();
        name.push(end);
        name.into()
    }

    fn previous(&self) -> PathBuf {
        self.beside(".previous")
    }

    fn before(&self) -> PathBuf {
        self.beside(".before")
    }

    /// All files that may be written or replaced.
    pub(super) fn names(&self) -> [PathBuf; 3] {
        [self.path.clone(), self.previous(), self.before()]
    }

    /// Writes `sums`. A file that another render wrote is put aside first.
    fn replace(&mut self, sums: &dyn Kept, made: &Value) -> Result<()> {
        if self.is_ours {
            let _ = std::fs::remove_file(self.previous());
            // Where the file system has no links, the last file has no other name while it is replaced.
            let _ = std::fs::hard_link(&self.path, self.previous());
        } else if !self.is_resumed {
            self.put_aside();
        }
        write(&self.path, sums, made)?;
        self.is_ours = true;
        Ok(())
    }

    /// Keeps the newest sums of an earlier render, which may have been killed.
    fn put_aside(&self) {
        let aside = self.before();
        let newest = [self.path.clone(), self.previous()].into_iter().find(|file| file.is_file());
        if newest.is_some_and(|newest| std::fs::rename(newest, &aside).is_ok()) {
            complain(&format!("note: the sums of an earlier render are kept as {}", aside.display()));
        }
    }

    fn finish(self) -> PathBuf {
        let _ = std::fs::remove_file(self.previous());
        self.path
    }

    /// Removes it.
    pub(super) fn remove(self) {
        let _ = std::fs::remove_file(self.finish());
    }

    /// The sums in it, or, where that is damaged or missing, in the one before it; of an image that is `made` so. None where
    /// no render has begun.
    pub(super) fn resume(&mut self, made: &Value) -> Result<Option<AnySums>> {
        let previous = self.previous();
        if !self.path.is_file() && !previous.is_file() {
            complain(&format!(
                "note: there is no {} yet: the render starts from the beginning",
                self.path.display()
            ));
            return Ok(None);
        }
        let (sums, found) = match read(&self.path) {
            Ok(whole) => {
                self.is_ours = true;
                whole
            }
            Err(error) => {
                let older = read(&previous).map_err(|_| error.clone())?;
                complain(&format!("warning: {error}\n  going on from {}", previous.display()));
                older
            }
        };
        provenance::must_equal(&self.path, &found, made)?;
        self.is_resumed = true;
        Ok(Some(sums))
    }
}
