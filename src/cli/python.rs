//! What the program leaves to Python: commands of the package `tyndall`, some of which need an extra of it.

use crate::error::{Error, Result};
use std::{
    ffi::{OsStr, OsString},
    process::Command,
};

/// The Python that is used.
const PYTHON: &str = "TYNDALL_PYTHON";

/// A command of the package.
pub(super) struct Script {
    /// Its name, which is that of its extra too, and what errors begin with.
    pub name: &'static str,
    /// Packages that it needs, in words.
    pub needs: &'static str,
}

impl Script {
    /// An error unless the command can run: better known before long work than after.
    pub(super) fn check(&self) -> Result<()> {
        self.run(&[OsStr::new("--check")], |said| self.lacking(said))
    }

    /// Runs it with `words`; the error of its `failure` says why.
    pub(super) fn run(&self, words: &[&OsStr], failure: impl Fn(String) -> Error) -> Result<()> {
        let name = interpreter();
        let done = Command::new(&name).args(["-m", "tyndall", self.name]).args(words).output();
        let done = done.map_err(|error| self.lacking(format!("{}: {error}", name.display())))?;
        if done.status.success() {
            return Ok(());
        }
        let said = String::from_utf8_lossy(&done.stderr).trim().to_owned();
        Err(failure(said.lines().last().unwrap_or("no word of why it failed").to_owned()))
    }

    /// The error where Python has not what is needed, as it `said`.
    fn lacking(&self, said: String) -> Error {
        let Self { name, needs } = self;
        let remedy = format!(
            "pip install '.[{name}]' in the folder of Tyndall's sources; {PYTHON} names another Python than {}",
            interpreter().display()
        );
        Error::new(*name, format!("Python with the packages tyndall and {needs}"), said, remedy)
    }
}

/// The Python that is run.
fn interpreter() -> OsString {
    std::env::var_os(PYTHON).unwrap_or_else(|| "python3".into())
}
