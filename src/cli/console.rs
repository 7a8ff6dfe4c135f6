//! What the program says: results and summaries to standard output, plans, progress and warnings to standard error.

use super::{interrupt, outputs::check_short};
use crate::error::{Error, Result};
use clap::{Args, ValueEnum};
use indicatif::ProgressBar;
use serde_json::Value;
use std::{
    io::{self, ErrorKind, Write as _},
    path::PathBuf,
    sync::{
        Mutex, OnceLock,
        atomic::{AtomicBool, Ordering::Relaxed},
    },
    time::{Duration, Instant},
};

/// How a command gives its result.
#[derive(Args, Clone, Debug, Default, PartialEq)]
pub struct Answer {
    /// Print the result as one JSON document in place of the text (infinite values and NaN become null)
    #[arg(long)]
    pub json: bool,

    /// Also write the JSON document of --json to FILE
    #[arg(long, value_name = "FILE")]
    pub report: Option<PathBuf>,
}

impl Answer {
    /// An error unless the report can be written.
    pub fn check(&self) -> Result<()> {
        check_short(&self.report)
    }

    /// Writes and prints `result` where that was asked for.
    pub fn give(&self, result: &Value) -> Result<()> {
        if let Some(path) = &self.report {
            crate::film::output::write(path, |file| writeln!(file, "{result:#}"))?;
        }
        if self.json {
            print(&format!("{result:#}"));
        }
        Ok(())
    }
}

/// What progress looks like.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq, ValueEnum)]
pub enum ProgressForm {
    /// A bar, on a terminal
    #[default]
    Bar,
    /// Lines of JSON
    Json,
}

// Of the process, as its standard output and standard error are. Tests run the program, one process each.
static TEXT: AtomicBool = AtomicBool::new(true);
static PROGRESS: AtomicBool = AtomicBool::new(true);
static LINES: AtomicBool = AtomicBool::new(false);

/// From here on nothing is said but warnings, errors and what was asked for as data (`quiet`), or JSON takes the place
/// of text on standard output (`json`). `progress` is asked for as data where it is JSON.
pub(super) fn set(quiet: bool, json: bool, progress: ProgressForm) {
    TEXT.store(!quiet && !json, Relaxed);
    PROGRESS.store(!quiet, Relaxed);
    LINES.store(progress == ProgressForm::Json, Relaxed);
}

/// A result or summary for people, to standard output, unless --quiet or --json.
pub(super) fn say(text: &str) {
    if TEXT.load(Relaxed) {
        print(text);
    }
}

/// What was asked for as data, to standard output, unless a file is written there. Work goes on where that fails, so that
/// nothing is lost; [`heard`] tells in the end.
pub(super) fn print(text: &str) {
    if STDOUT_IS_TAKEN.load(Relaxed) {
        return complain(text);
    }
    note(writeln!(io::stdout(), "{text}").and_then(|()| io::stdout().flush()));
}

/// Standard output is one of the files that are written: what is said goes to standard error.
pub(super) fn take_stdout() {
    STDOUT_IS_TAKEN.store(true, Relaxed);
}

static STDOUT_IS_TAKEN: AtomicBool = AtomicBool::new(false);

/// Why standard output took no more.
static UNHEARD: OnceLock<io::Error> = OnceLock::new();

/// Remembers a failure of writing to standard output.
pub(super) fn note(said: io::Result<()>) {
    if let Err(error) = said {
        let _ = UNHEARD.set(error);
    }
}

/// An error unless all that was said was written, or nobody reads any more.
pub(super) fn heard() -> Result<()> {
    match UNHEARD.get() {
        Some(error) if error.kind() != ErrorKind::BrokenPipe => {
            let remedy = "redirect it elsewhere; all files were written";
            Err(Error::new("standard output", "to write what is reported", error.to_string(), remedy))
        }
        _ => Ok(()),
    }
}

/// What is about to be done or has been done so far, to standard error, unless --quiet.
pub(super) fn announce(text: &str) {
    if PROGRESS.load(Relaxed) {
        complain(text);
    }
}

/// Warnings and errors, to standard error.
pub(super) fn complain(text: &str) {
    let _ = writeln!(io::stderr(), "{text}");
}

/// A progress bar of `length` steps, on standard error, unless --quiet or --progress json.
pub(super) fn bar(length: u64) -> ProgressBar {
    let is_shown = PROGRESS.load(Relaxed) && !LINES.load(Relaxed);
    if is_shown { ProgressBar::new(length) } else { ProgressBar::hidden() }
}

/// Time between two updates, at least.
const UPDATE_EVERY: Duration = Duration::from_millis(100);

static UPDATED: Mutex<Option<Instant>> = Mutex::new(None);

/// An update of the progress for --progress json, to standard error; the last one is never left out. Where nobody reads
/// it any more, whoever asked for the render is gone: it ends.
pub(super) fn update(is_last: bool, progress: impl FnOnce() -> Value) {
    if !LINES.load(Relaxed) {
        return;
    }
    let Ok(mut updated) = UPDATED.lock() else { return };
    if is_last || updated.is_none_or(|before| before.elapsed() >= UPDATE_EVERY) {
        *updated = Some(Instant::now());
        if writeln!(io::stderr(), "{}", progress()).is_err() {
            interrupt::hang_up();
        }
    }
}
