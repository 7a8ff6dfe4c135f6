//! A scene as a reader of either format leaves it.

use crate::description::{Location, Object};
use std::{
    collections::{BTreeSet, HashSet},
    path::PathBuf,
};

/// How deep objects may be nested, in the file or through references. Scenes need about ten; the
/// limit keeps every later recursion over the tree within its stack.
pub(super) const DEEPEST: usize = 100;

/// The tree as written, and what it does not show.
pub(super) struct Draft {
    /// The scene.
    pub root: Object,
    /// Names that are aliases of other ids.
    pub aliases: Vec<Alias>,
    /// Files that were included.
    pub included: BTreeSet<PathBuf>,
    /// Where files are named that were found in a folder other than that of the file which names them.
    pub found: HashSet<Location>,
}

/// A second name for an object.
pub(super) struct Alias {
    /// The second name.
    pub name: String,
    /// The id (or earlier second name) it refers to.
    pub target: String,
    /// Where it was given.
    pub location: Location,
}
