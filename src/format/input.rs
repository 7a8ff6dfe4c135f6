//! The bytes of a scene file, which standard input can be.

use super::starting::{self, Portrait};
use crate::{
    error::{Error, Result},
    inputs::{self, Reader, Stamp},
    volume::grid::is_volume,
};
use std::{
    io::Read as _,
    path::{Path, PathBuf},
    sync::{Arc, Mutex, OnceLock, PoisonError},
};

/// The path that stands for standard input, as messages name it. Names of files in the scene start at the current
/// folder.
pub const STANDARD_INPUT: &str = "<stdin>";

/// True if `path` stands for standard input.
pub fn is_standard_input(path: &Path) -> bool {
    path.as_os_str() == STANDARD_INPUT
}

/// The file, when it was written, and the scene around it.
type Kept = (PathBuf, Option<Stamp>, Arc<Portrait>);

/// The scene around the volume file at `path`. It is kept until the file is written again, as making it takes as long
/// as reading the file.
fn portrait(path: &Path) -> Result<Arc<Portrait>> {
    static KEPT: Mutex<Option<Kept>> = Mutex::new(None);
    let (mut kept, now) = (KEPT.lock().unwrap_or_else(PoisonError::into_inner), inputs::stamp(path));
    match &*kept {
        Some((of, then, portrait)) if of == path && *then == now => Ok(portrait.clone()),
        _ => {
            let portrait = Arc::new(starting::of_file(path)?);
            *kept = Some((path.to_owned(), now, portrait.clone()));
            Ok(portrait)
        }
    }
}

/// What was found and chosen where the scene at `path` is a volume file, a sentence each.
pub fn told(path: &Path) -> Result<Vec<String>> {
    if is_volume(path) { Ok(portrait(path)?.told(path)) } else { Ok(vec![]) }
}

/// The bytes of the scene at `path`; for a volume file, the scene around it, in its folder. Standard input can be read
/// only once, so its bytes are kept.
pub fn bytes(path: &Path) -> Result<Vec<u8>> {
    static KEPT: OnceLock<Vec<u8>> = OnceLock::new();
    let explain = |error| Error::io(path, "read", &error);
    if is_volume(path) {
        inputs::note(path, Reader::Scene);
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        return portrait(path).map(|portrait| portrait.text(&name).into_bytes());
    }
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
