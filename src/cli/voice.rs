//! What the program says: results and summaries to standard output, plans, progress and warnings to standard error.

use super::outputs::check_short;
use crate::error::{Error, Result};
use clap::Args;
use indicatif::ProgressBar;
use serde_json::Value;
use std::{
    io::{self, ErrorKind, Write as _},
    path::{Path, PathBuf},
    sync::{
        OnceLock,
        atomic::{AtomicBool, Ordering::Relaxed},
    },
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
    /// An error unless the report can be written and is none of the files `read`.
    pub fn check(&self, read: &[&Path]) -> Result<()> {
        check_short(&self.report, read)
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

// Of the process, as its standard output and standard error are. Tests run the program, one process each.
static TEXT: AtomicBool = AtomicBool::new(true);
static PROGRESS: AtomicBool = AtomicBool::new(true);

/// From here on nothing is said but warnings, errors and what was asked for as data (`quiet`), or JSON takes the place
/// of text on standard output (`json`).
pub fn set(quiet: bool, json: bool) {
    TEXT.store(!quiet && !json, Relaxed);
    PROGRESS.store(!quiet, Relaxed);
}

/// A result or summary for people, to standard output, unless --quiet or --json.
pub fn say(text: &str) {
    if TEXT.load(Relaxed) {
        print(text);
    }
}

/// What was asked for as data, to standard output, unless a file is written there. Work goes on where that fails, so that
/// nothing is lost; [`heard`] tells in the end.
pub fn print(text: &str) {
    if STDOUT_IS_TAKEN.load(Relaxed) {
        return complain(text);
    }
    note(writeln!(io::stdout(), "{text}").and_then(|()| io::stdout().flush()));
}

/// Standard output is one of the files that are written: what is said goes to standard error.
pub fn take_stdout() {
    STDOUT_IS_TAKEN.store(true, Relaxed);
}

static STDOUT_IS_TAKEN: AtomicBool = AtomicBool::new(false);

/// Why standard output took no more.
static UNHEARD: OnceLock<io::Error> = OnceLock::new();

/// Remembers a failure of writing to standard output.
pub fn note(said: io::Result<()>) {
    if let Err(error) = said {
        let _ = UNHEARD.set(error);
    }
}

/// An error unless all that was said was written, or nobody reads any more.
pub fn heard() -> Result<()> {
    match UNHEARD.get() {
        Some(error) if error.kind() != ErrorKind::BrokenPipe => {
            let remedy = "send it to another place; the files of this command are as they should be";
            Err(Error::new("standard output", "to write what is reported", error.to_string(), remedy))
        }
        _ => Ok(()),
    }
}

/// What is about to be done or has been done so far, to standard error, unless --quiet.
pub fn announce(text: &str) {
    if PROGRESS.load(Relaxed) {
        complain(text);
    }
}

/// Warnings and errors, to standard error.
pub fn complain(text: &str) {
    let _ = writeln!(io::stderr(), "{text}");
}

/// A progress bar of `length` steps, on standard error, unless --quiet.
pub fn bar(length: u64) -> ProgressBar {
    if PROGRESS.load(Relaxed) { ProgressBar::new(length) } else { ProgressBar::hidden() }
}
