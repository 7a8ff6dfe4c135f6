//! Keeps what a render has: its sums, from which it can go on, and the picture so far.

use super::{complain, made, render::Task, viewer::Viewer};
use crate::{
    error::Result,
    render::{
        sums::Sums,
        sums_file::{read, write},
    },
};
use serde_json::Value;
use std::{
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

/// Time between two writes of the sums, and before the first one, unless the user wants another.
const PATIENCE: Duration = Duration::from_secs(60);
/// Time between two writes over the time that one takes: what is kept costs less than a hundredth of a render.
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

    /// True if it was done just now; a failure is no reason to stop rendering.
    fn take(&mut self, what: &str, work: impl FnOnce() -> Result<()>) -> bool {
        if self.last.elapsed() < self.every.max(self.cost * RESTRAINT) {
            return false;
        }
        let started = Instant::now();
        let done = work();
        (self.last, self.cost) = (Instant::now(), started.elapsed());
        if let Err(error) = &done {
            complain(&format!("warning: {what} is not written: {error}"));
        }
        done.is_ok()
    }
}

/// Writes what there is while a render goes on.
pub struct Keeper<'a> {
    /// Where the sums go; none where a render cannot go on from them.
    file: Option<PathBuf>,
    made: &'a Value,
    sums: Turn,
    picture: Option<Turn>,
    /// Writes the picture so far.
    draw: &'a dyn Fn(&Sums) -> Result<()>,
    viewer: Option<(Viewer, Turn)>,
    /// The file is to be there at the end.
    is_wanted: bool,
}

impl<'a> Keeper<'a> {
    /// Keeps the sums of `task` in `file`; with --preview, has the picture so far drawn; with --tev, shows it.
    pub fn new(
        file: Option<PathBuf>,
        task: &'a Task<'a>,
        draw: &'a dyn Fn(&Sums) -> Result<()>,
    ) -> Result<Self> {
        let Task { arguments, made, .. } = task;
        let viewer = arguments.tev.as_deref().map(Viewer::connect).transpose()?;
        Ok(Self {
            file,
            made,
            sums: Turn::new(arguments.sums_every.unwrap_or(PATIENCE)),
            picture: arguments.preview.then(|| Turn::new(PICTURE_EVERY)),
            draw,
            viewer: viewer.map(|viewer| (viewer, Turn::new(VIEW_EVERY))),
            is_wanted: arguments.sums.is_some() || arguments.resume,
        })
    }

    /// Called now and then while rendering.
    pub fn watch(&mut self, sums: &Sums) {
        let Self { file, made, draw, .. } = self;
        if let Some(file) = file {
            self.is_wanted |= self.sums.take("the checkpoint", || replace(file, sums, made));
        }
        if let Some(turn) = &mut self.picture {
            turn.take("the picture so far", || draw(sums));
        }
        if let Some((viewer, turn)) = &mut self.viewer {
            turn.take("the picture in tev", || viewer.show(sums));
        }
    }

    /// Called at the end: where the sums are, if they are kept; they are if the render was `interrupted`.
    pub fn finish(mut self, sums: &Sums, interrupted: bool) -> Result<Option<PathBuf>> {
        if let Some((viewer, _)) = &mut self.viewer {
            viewer.show(sums).unwrap_or_else(|error| complain(&format!("warning: {error}")));
        }
        let Some(file) = self.file.filter(|_| self.is_wanted || interrupted) else { return Ok(None) };
        replace(&file, sums, self.made)?;
        let _ = std::fs::remove_file(previous(&file));
        Ok(Some(file))
    }
}

/// The file before the last: kept while the last may still be damaged.
fn previous(file: &Path) -> PathBuf {
    let mut name = file.as_os_str().to_owned();
    name.push(".previous");
    name.into()
}

fn replace(file: &Path, sums: &Sums, made: &Value) -> Result<()> {
    if file.is_file() {
        let _ = std::fs::rename(file, previous(file));
    }
    write(file, sums, made)
}

/// The sums in `file`, or, where that is damaged or missing, in the one before it; of an image that is `made` so.
pub fn resume(file: &Path, made: &Value) -> Result<Sums> {
    let (sums, found) = read(file).or_else(|error| {
        let older = read(&previous(file)).map_err(|_| error.clone())?;
        complain(&format!("warning: {error}\n  going on from {}", previous(file).display()));
        Ok(older)
    })?;
    made::must_equal(file, &found, made)?;
    Ok(sums)
}
