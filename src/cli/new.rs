//! `tyndall new`: a scene to start from.

use super::{
    console::{announce, print},
    outputs::check_short,
};
use crate::{
    error::{Error, Result},
    film::output,
    format::starting::{Start, TEMPLATES, start},
    inputs::{self, Reader},
};
use clap::Args;
use std::path::{Path, PathBuf};

/// Write a scene to start from.
#[derive(Args, Clone, Debug, PartialEq)]
pub struct New {
    /// Template (fog, room or cloud), or a volume file (.vdb, .nvdb, .vol), or numbered ones (plume_####.vdb)
    #[arg(value_name = "TEMPLATE|VOLUME", value_parser = clap::builder::NonEmptyStringValueParser::new())]
    pub what: String,

    /// Scene file to write (.json), which must not exist; its folder is made [default: standard output]
    #[arg(short, long, value_name = "FILE", value_parser = json_file)]
    pub output: Option<PathBuf>,
}

fn json_file(text: &str) -> std::result::Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let is_json = path.extension().is_some_and(|end| end.eq_ignore_ascii_case("json"));
    if is_json { Ok(path) } else { Err("expected a file name that ends in .json".into()) }
}

/// The help on templates.
pub(super) fn templates() -> String {
    let line = |(name, shows, _): &(&str, &str, &str)| format!("  {name:6} {shows}");
    format!("Templates:\n{}", TEMPLATES.iter().map(line).collect::<Vec<_>>().join("\n"))
}

/// Runs the command.
pub(super) fn run(New { what, output }: &New) -> Result<()> {
    inputs::note(Path::new(what), Reader::Command);
    let folder = output.as_deref().and_then(Path::parent).filter(|folder| !folder.as_os_str().is_empty());
    if let Some(path) = output.as_ref().filter(|path| path.exists()) {
        let remedy = "choose another name, or remove the file first";
        return Err(Error::new(path.display(), "a file that does not exist yet", "one that does", remedy));
    }
    let Start { text, told } = start(what, folder.unwrap_or(Path::new(".")))?;
    told.iter().for_each(|line| announce(line));
    let Some(path) = output else {
        print(text.trim_end());
        return Ok(());
    };
    folder.map_or(Ok(()), output::create_folder)?;
    check_short([path])?;
    output::write(path, |file| file.write_all(text.as_bytes()))?;
    super::console::say(&format!("{0}: tyndall render {0}", path.display()));
    Ok(())
}
