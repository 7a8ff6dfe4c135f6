//! `tyndall convert`: converts a scene between XML and JSON.

use super::{arguments, complain, outputs::check_short};
use crate::{error::Result, film, format, format::Naming};

/// Runs the command.
pub fn run(arguments: &arguments::Convert) -> Result<()> {
    let arguments::Convert { input, output, definitions, fill } = arguments;
    let naming = if *fill { Naming::Fill } else { Naming::Keep };
    let conversion = format::convert(input, output, definitions, naming)?;
    check_short([output], &[])?;
    film::output::write(output, |file| file.write_all(conversion.text.as_bytes()))?;
    for note in &conversion.notes {
        complain(&format!("note: {note}"));
    }
    super::say(&output.display().to_string());
    Ok(())
}
