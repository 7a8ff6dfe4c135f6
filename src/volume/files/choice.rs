//! Which of a file's grids is meant.

use super::{Problem, Result};
use crate::description::nearest;

/// The name that is meant where none is given.
const USUAL: &str = "density";

/// The class of grids whose values are distances to a surface.
pub(super) const LEVEL_SET: &str = "level set";

/// No more grids than these are listed.
const LISTED: usize = 24;

/// No more of a name is shown (characters).
const SHOWN: usize = 80;

/// What a file says of a grid before its values.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Label {
    /// The name.
    pub name: String,
    /// The type, as the file's makers call it.
    pub kind: String,
    /// What the values are meant for, as the file's makers call it; empty where they do not say.
    pub class: String,
    /// Numbers to a sample, 1 or 3; none of types that are not read.
    pub channels: Option<usize>,
    /// True if +z is up there, as far as the file says who wrote it.
    pub is_z_up: bool,
    /// True of a grid that Blender's fluids wrote.
    pub is_of_fluids: bool,
}

impl Label {
    fn is_called(&self, name: &str) -> bool {
        self.name == name || self.plain_name() == name
    }

    /// The name without the number that the first of several of one name has.
    pub fn plain_name(&self) -> &str {
        self.name.strip_suffix("[0]").unwrap_or(&self.name)
    }

    /// True if values are distances to a surface.
    pub fn is_level_set(&self) -> bool {
        self.class == LEVEL_SET
    }
}

/// A file's text as a message may quote it.
pub(super) fn shown(text: &str) -> String {
    text.chars().flat_map(char::escape_debug).take(SHOWN).collect()
}

/// The number of the grid called `wanted` or, if none is, of "density" or the only one there is.
pub(super) fn choose(grids: &[Label], wanted: Option<&str>) -> Result<usize> {
    let find = |name: &str| grids.iter().position(|grid| grid.is_called(name));
    let only = || (grids.len() == 1).then_some(0);
    match wanted {
        Some(name) => find(name).ok_or_else(|| unknown(grids, name)),
        None => find(USUAL).or_else(only).ok_or_else(|| ambiguous(grids)),
    }
}

/// Names and types, as a message may quote them.
pub(super) fn list(grids: &[Label]) -> String {
    let one = |grid: &Label| format!("\"{}\" ({})", shown(&grid.name), shown(&grid.kind));
    let names: Vec<_> = grids.iter().take(LISTED).map(one).collect();
    let more = grids.len().saturating_sub(LISTED);
    if more > 0 { format!("{} and {more} more", names.join(", ")) } else { names.join(", ") }
}

fn unknown(grids: &[Label], name: &str) -> Problem {
    let known: Vec<_> = grids.iter().map(|grid| shown(&grid.name)).collect();
    let known: Vec<_> = known.iter().map(String::as_str).collect();
    let list = if grids.is_empty() { "none".into() } else { list(grids) };
    let remedy = format!("{}the file's grids: {list}", nearest(name, &known));
    Problem::new("the name of a grid of the file", format!("\"{}\"", shown(name)), remedy)
}

fn ambiguous(grids: &[Label]) -> Problem {
    if grids.is_empty() {
        return Problem::new("a file with a grid", "one without", "export the volume again");
    }
    let remedy = "choose one with the parameter \"grid\"";
    Problem::new(format!("one grid, or one that is named \"{USUAL}\""), list(grids), remedy)
}
