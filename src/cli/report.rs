//! `tyndall report`: a study's folder in, a page for people out.

use super::arguments;
use crate::{error::Result, study::page};

/// Runs the command.
pub fn run(arguments: &arguments::Report) -> Result<()> {
    let path = page::write(&arguments.folder)?;
    super::say(&path.display().to_string());
    Ok(())
}
