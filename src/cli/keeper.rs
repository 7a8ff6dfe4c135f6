//! Keeps what a render has: its sums, from which it can go on, and the picture so far.

use super::{arguments::Render, complain, made};
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
    file: PathBuf,
    made: Value,
    sums: Turn,
    picture: Option<Turn>,
    /// Writes the picture so far.
    draw: &'a dyn Fn(&Sums) -> Result<()>,
    /// The file is to be there at the end.
    is_wanted: bool,
}

impl<'a> Keeper<'a> {
    /// Keeps sums in `file`, as `arguments` say; with --preview, has the picture so far drawn.
    pub fn new(
        file: PathBuf,
        made: Value,
        arguments: &Render,
        draw: &'a dyn Fn(&Sums) -> Result<()>,
    ) -> Self {
        let picture = arguments.preview.then(|| Turn::new(PICTURE_EVERY));
        let sums = Turn::new(arguments.sums_every.unwrap_or(PATIENCE));
        Self { file, made, sums, picture, draw, is_wanted: arguments.sums.is_some() || arguments.resume }
    }

    /// Called now and then while rendering.
    pub fn watch(&mut self, sums: &Sums) {
        let Self { file, made, draw, .. } = self;
        self.is_wanted |= self.sums.take("the checkpoint", || replace(file, sums, made));
        if let Some(turn) = &mut self.picture {
            turn.take("the picture so far", || draw(sums));
        }
    }

    /// Called at the end: where the sums are, if they are kept; they are if the render was `interrupted`.
    pub fn finish(self, sums: &Sums, interrupted: bool) -> Result<Option<PathBuf>> {
        if !self.is_wanted && !interrupted {
            return Ok(None);
        }
        replace(&self.file, sums, &self.made)?;
        let _ = std::fs::remove_file(previous(&self.file));
        Ok(Some(self.file))
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
