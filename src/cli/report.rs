//! `tyndall report`: a study's folder in, a page for people out.

use crate::{analysis::study::page, error::Result};
use clap::Args;
use std::path::PathBuf;

/// Make the page of a study.
#[derive(Args, Clone, Debug, PartialEq)]
pub struct Report {
    /// Folder of the study, with study.json and its images
    #[arg(value_name = "FOLDER")]
    pub folder: PathBuf,

    /// Also write its table, curves and images for a README to this folder: convergence.md, .svg and _strips.svg
    #[arg(long, value_name = "FOLDER")]
    pub record: Option<PathBuf>,
}

/// Runs the command.
pub(super) fn run(arguments: &Report) -> Result<()> {
    let mut paths = vec![page::write(&arguments.folder)?];
    if let Some(to) = &arguments.record {
        paths.extend(page::record(&arguments.folder, to)?);
    }
    paths.iter().for_each(|path| super::console::say(&path.display().to_string()));
    Ok(())
}
