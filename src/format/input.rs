//! The bytes of a scene file, which standard input can be.

use crate::{
    error::{Error, Result},
    inputs::{self, Reader},
};
use std::{io::Read as _, path::Path, sync::OnceLock};

/// The path that stands for standard input, as messages name it. Names of files in the scene start at the current
/// folder.
pub const STANDARD_INPUT: &str = "<stdin>";

/// True if `path` stands for standard input.
pub fn is_standard_input(path: &Path) -> bool {
    path.as_os_str() == STANDARD_INPUT
}

/// What the file at `path` holds, which a scene is read from. Standard input can be read only once, so its bytes are kept.
pub fn bytes(path: &Path) -> Result<Vec<u8>> {
    static KEPT: OnceLock<Vec<u8>> = OnceLock::new();
    let explain = |error| Error::io(path, "read", &error);
    if !is_standard_input(path) {
        inputs::note(path, Reader::Scene);
        return std::fs::read(path).map_err(explain);
    }
    if let Some(kept) = KEPT.get() {
        return Ok(kept.clone());
    }
    let mut read = Vec::new();
    std::io::stdin().read_to_end(&mut read).map_err(explain)?;
    Ok(KEPT.get_or_init(|| read).clone())
}
