//! `tyndall completions` and `tyndall man`: what the definition of the arguments says, for shells and for `man`.

use super::{
    arguments::Arguments,
    console::{self, say},
};
use crate::{error::Result, film::output};
use clap::{Args, Command, CommandFactory};
use clap_mangen::Man;
use std::path::{Path, PathBuf};

/// Print a script for a shell.
#[derive(Args, Clone, Debug, PartialEq)]
pub struct Completions {
    /// The shell
    #[arg(value_enum, value_name = "SHELL")]
    pub shell: clap_complete::Shell,
}

/// Print or write manual pages.
#[derive(Args, Clone, Debug, PartialEq)]
pub struct Manual {
    /// Folder for the pages of all commands, created if missing [default: print the page of tyndall]
    #[arg(value_name = "FOLDER")]
    pub folder: Option<PathBuf>,
}

/// Prints the completions of a shell.
pub(super) fn complete(arguments: &Completions) -> Result<()> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut command(), "tyndall", &mut script);
    console::print(String::from_utf8_lossy(&script).trim_end());
    Ok(())
}

/// Prints the manual page of the program, or writes those of all its commands to a folder.
pub(super) fn run(arguments: &Manual) -> Result<()> {
    match &arguments.folder {
        None => console::print(page(&command()).trim_end()),
        Some(folder) => write(folder)?,
    }
    Ok(())
}

/// The program as its arguments define it; `help` is no page of its own.
fn command() -> Command {
    let mut command = Arguments::command().disable_help_subcommand(true);
    command.build();
    command
}

fn page(command: &Command) -> String {
    let mut page = Vec::new();
    let program = concat!("tyndall ", env!("CARGO_PKG_VERSION"));
    // Nothing fails that is written to memory.
    let _ = Man::new(command.clone()).source(program).render(&mut page);
    String::from_utf8_lossy(&page).into_owned()
}

fn write(folder: &Path) -> Result<()> {
    output::create_folder(folder)?;
    let whole = command();
    for command in std::iter::once(&whole).chain(whole.get_subcommands()) {
        let name = command.get_display_name().unwrap_or(command.get_name());
        let path = folder.join(format!("{name}.1"));
        output::write(&path, |file| file.write_all(page(command).as_bytes()))?;
        say(&path.display().to_string());
    }
    Ok(())
}
