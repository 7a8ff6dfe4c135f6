//! The scene's files, and when they were saved.

use super::board::{Board, Wish};
use crate::inputs::{self, Stamp};
use std::{
    collections::BTreeMap,
    path::PathBuf,
    thread,
    time::{Duration, SystemTime},
};

/// Time between two looks at the files.
const EVERY: Duration = Duration::from_millis(500);
/// Time between two questions whether it is over.
const NAP: Duration = Duration::from_millis(50);

/// What is known of the files that were read.
pub(super) struct Watch(BTreeMap<PathBuf, Option<Stamp>>);

impl Watch {
    /// As they are now.
    pub(super) fn new() -> Self {
        Self(inputs::all().into_iter().map(|path| (path.clone(), inputs::stamp(&path))).collect())
    }

    /// True if a file was written after `time`, when reading began.
    pub(super) fn is_newer(&self, time: SystemTime) -> bool {
        self.0.values().flatten().any(|stamp| stamp.written > time)
    }

    /// Wishes that the scene be read again whenever one of its files was written, until it `is_over`.
    pub(super) fn tell(mut self, board: &Board, is_over: impl Fn() -> bool) {
        while !is_over() {
            let naps = EVERY.as_millis() / NAP.as_millis();
            (0..naps).take_while(|_| !is_over()).for_each(|_| thread::sleep(NAP));
            if self.has_changed() {
                board.wish([Wish::Reload]);
            }
        }
    }

    /// True if a file is another than when this was last asked. Files that were not read then are no news.
    fn has_changed(&mut self) -> bool {
        let now = Self::new();
        let is_other =
            |(path, stamp): (&PathBuf, &Option<Stamp>)| now.0.get(path).is_some_and(|found| found != stamp);
        let has_changed = self.0.iter().any(is_other);
        *self = now;
        has_changed
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inputs::Reader;
    use std::fs;

    #[test]
    fn a_file_that_is_written_or_removed_is_news_once() {
        let folder = tempfile::tempdir().unwrap();
        let [first, second] = ["a.json", "b.json"].map(|name| folder.path().join(name));
        fs::write(&first, "1").unwrap();
        inputs::note(&first, Reader::Scene);
        let mut watch = Watch(BTreeMap::from([(first.canonicalize().unwrap(), inputs::stamp(&first))]));
        assert!(!watch.has_changed());
        assert!(watch.is_newer(SystemTime::UNIX_EPOCH) && !watch.is_newer(SystemTime::now() + EVERY));
        fs::write(&first, "12").unwrap();
        assert!(watch.has_changed() && !watch.has_changed());
        fs::write(&second, "1").unwrap();
        inputs::note(&second, Reader::Scene);
        assert!(!watch.has_changed());
        fs::remove_file(&first).unwrap();
        assert!(watch.has_changed());
    }
}
