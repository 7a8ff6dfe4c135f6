//! `tyndall report`: a study's folder in, a page for people out.

use super::arguments;
use crate::{analysis::study::page, error::Result};

/// Runs the command.
pub fn run(arguments: &arguments::Report) -> Result<()> {
    let mut paths = vec![page::write(&arguments.folder)?];
    if let Some(to) = &arguments.record {
        paths.extend(page::record(&arguments.folder, to)?);
    }
    paths.iter().for_each(|path| super::say(&path.display().to_string()));
    Ok(())
}
