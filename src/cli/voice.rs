//! What the program says: results and summaries to standard output, plans, progress and warnings to standard error.

use crate::error::Result;
use clap::Args;
use indicatif::ProgressBar;
use serde_json::Value;
use std::{
    io::Write as _,
    path::PathBuf,
    sync::atomic::{AtomicBool, Ordering::Relaxed},
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

/// What was asked for as data, to standard output. A reader that has gone away is no reason to fail.
pub fn print(text: &str) {
    let _ = writeln!(std::io::stdout(), "{text}");
}

/// What is about to be done or has been done so far, to standard error, unless --quiet.
pub fn announce(text: &str) {
    if PROGRESS.load(Relaxed) {
        complain(text);
    }
}

/// Warnings and errors, to standard error.
pub fn complain(text: &str) {
    let _ = writeln!(std::io::stderr(), "{text}");
}

/// A progress bar of `length` steps, on standard error, unless --quiet.
pub fn bar(length: u64) -> ProgressBar {
    if PROGRESS.load(Relaxed) { ProgressBar::new(length) } else { ProgressBar::hidden() }
}
