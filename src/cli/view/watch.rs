//! The scene's files, and when they were saved.

use super::board::{Board, Wish};
use crate::inputs::{self, Stamp};
use std::{collections::BTreeMap, path::PathBuf, thread, time::Duration};

/// Time between two looks at the files.
const EVERY: Duration = Duration::from_millis(500);
/// Time between two questions whether it is over.
const NAP: Duration = Duration::from_millis(50);

/// What is known of the files: their stamps when they were looked at last.
#[derive(Default)]
pub(super) struct Watch(BTreeMap<PathBuf, Option<Stamp>>);

impl Watch {
    /// Wishes that the scene be read again whenever one of its files was written, until it `is_over`.
    pub(super) fn tell(mut self, board: &Board, is_over: impl Fn() -> bool) {
        while !is_over() {
            let naps = EVERY.as_millis() / NAP.as_millis();
            (0..naps).take_while(|_| !is_over()).for_each(|_| thread::sleep(NAP));
            if self.is_news(inputs::all()) {
                board.wish([Wish::Reload]);
            }
        }
    }

    /// True if one of `files` is another than when this was last asked, or when it was noted.
    fn is_news(&mut self, files: Vec<(PathBuf, Option<Stamp>)>) -> bool {
        let mut is_news = false;
        for (path, noted) in files {
            let now = inputs::stamp(&path);
            is_news |= self.0.insert(path, now).unwrap_or(noted) != now;
        }
        is_news
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inputs::Reader;
    use std::fs;

    #[test]
    fn a_file_that_is_written_removed_or_missed_is_news_once() {
        let folder = tempfile::tempdir().unwrap();
        let [first, second] =
            ["a.json", "b.json"].map(|name| folder.path().canonicalize().unwrap().join(name));
        fs::write(&first, "1").unwrap();
        inputs::note(&first, Reader::Scene);
        // Before anybody looks at it.
        fs::write(&first, "12").unwrap();
        let mut watch = Watch::default();
        let at = folder.path().canonicalize().unwrap();
        // Other tests note files, too.
        let own = || inputs::all().into_iter().filter(|(path, _)| path.starts_with(&at)).collect();
        let mut has_changed = || watch.is_news(own());
        assert!(has_changed() && !has_changed());
        inputs::note(&second, Reader::Scene);
        assert!(!has_changed());
        fs::write(&second, "1").unwrap();
        assert!(has_changed() && !has_changed());
        fs::remove_file(&first).unwrap();
        assert!(has_changed() && !has_changed());
    }
}
