//! Files: the text of one with places in it, and the folders in which names of others are looked up.

use super::{
    super::text,
    blank::blanked,
    element::{Attribute, Element},
};
use crate::{
    description::{Location, Object, Position, Property, Value},
    error::{Error, Result},
};
use std::{
    cell::RefCell,
    collections::HashSet,
    path::{Path, PathBuf},
    sync::Arc,
};

/// The text of a scene file.
pub(super) struct Source {
    /// The file as its user named it.
    pub file: Arc<PathBuf>,
    /// The file under the name that all spellings of its path share.
    pub identity: PathBuf,
    text: String,
    /// What its user shall know of it.
    pub notes: RefCell<Vec<Property>>,
    /// Where each line starts. Finding a place must cost no pass over the file, nor over a long line.
    lines: Vec<usize>,
    /// The bytes that begin no character: they do not count in columns.
    inner: Vec<usize>,
}

/// The path that all spellings of `path` share.
pub(super) fn identity(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| path.to_owned())
}

impl Source {
    /// Reads the file at `path`.
    pub(super) fn read(path: &Path) -> Result<Self> {
        let text = text::of_file(path)?;
        let lines = std::iter::once(0).chain(text.match_indices('\n').map(|(at, _)| at + 1)).collect();
        let inner = (0..text.len()).filter(|at| !text.is_char_boundary(*at)).collect();
        let (file, identity, notes) = (Arc::new(path.to_owned()), identity(path), RefCell::default());
        Ok(Self { file, identity, text: blanked(&text), notes, lines, inner })
    }

    /// Notes that the user shall know `text` of the byte at `offset`.
    pub(super) fn note(&self, offset: usize, text: impl Into<String>) {
        let (name, value) = (String::new(), Value::Note(text.into()));
        self.notes.borrow_mut().push(Property { name, value, location: self.location(offset) });
    }

    /// The file as XML.
    pub(super) fn parse(&self) -> Result<roxmltree::Document<'_>> {
        roxmltree::Document::parse(&self.text).map_err(|error| {
            let roxmltree::TextPos { row, col } = error.pos();
            let place = Location {
                file: self.file.clone(),
                position: Position::Text { line: row.max(1), column: col.max(1) },
            };
            let (expected, found, remedy) = explain(&error);
            Error::new(place, expected, found, remedy)
        })
    }

    /// The place of the byte at `offset`.
    pub(super) fn location(&self, offset: usize) -> Location {
        let line = self.lines.partition_point(|start| *start <= offset);
        let start = self.lines[line - 1];
        let inner = |end: usize| self.inner.partition_point(|at| *at < end);
        let column = offset - start - (inner(offset) - inner(start)) + 1;
        let position = Position::Text { line: line as u32, column: column as u32 };
        Location { file: self.file.clone(), position }
    }
}

/// What the parser expected, what it found, and what to do.
fn explain(error: &roxmltree::Error) -> (&'static str, String, String) {
    use roxmltree::Error as E;
    let message = error.to_string();
    let message = message.split(" at ").next().unwrap_or_default();
    let message = message.strip_suffix(" found").unwrap_or(message);
    let found = match message.strip_prefix("expected ").and_then(|rest| rest.split_once(" not ")) {
        Some((due, given)) => format!("{given} where {due} is due"),
        None => message.to_owned(),
    };
    let well_formed = "well-formed XML";
    match error {
        E::NoRootNode => {
            (well_formed, "no element".into(), "write <scene version=\"3.0.0\">...</scene>".into())
        }
        E::UnclosedRootNode => {
            (well_formed, "the end of the file within an element".into(), "close every element".into())
        }
        E::UnknownToken(_) => (
            "one root element and nothing after it",
            "more".into(),
            "remove the text here, or correct the markup before it".into(),
        ),
        E::UnexpectedCloseTag(due, given, _) => (
            well_formed,
            format!("</{given}> where </{due}> is due"),
            format!("close the <{due}>, or correct its tag"),
        ),
        _ => (well_formed, found, "correct the XML at or before this place".into()),
    }
}

/// Folders in which relative names of files are looked up: those of `path` elements, the latest first, then the
/// file's own folder, then those of the file that includes it.
#[derive(Clone, Default)]
pub(super) struct Folders {
    folders: Vec<PathBuf>,
    own: PathBuf,
}

impl Folders {
    /// Starts a file: its own folder comes first.
    pub(super) fn enter(&mut self, file: &Path) {
        self.own = file.parent().unwrap_or(Path::new("")).to_owned();
        self.folders.insert(0, self.own.clone());
    }

    /// A `path` element.
    pub(super) fn add(&mut self, element: &Element) -> Result<()> {
        element.allow(&["value"])?;
        element.childless()?;
        let attribute = element.require("value")?;
        let name = attribute.nonempty()?;
        let folder = self.folders.iter().map(|folder| folder.join(name)).find(|folder| folder.is_dir());
        let folder = folder.ok_or_else(|| attribute.wrong("an existing folder", self.looked_in()))?;
        self.folders.insert(0, folder);
        Ok(())
    }

    /// The file called `name`.
    pub(super) fn find(&self, name: &str) -> Option<PathBuf> {
        self.folders.iter().map(|folder| folder.join(name)).find(|path| path.is_file())
    }

    /// The error for a file that is in none of the folders.
    pub(super) fn missing(&self, name: &Attribute) -> Error {
        name.wrong("the name of an existing file", self.looked_in())
    }

    fn looked_in(&self) -> String {
        let shown = |folder: &PathBuf| match folder.as_os_str().is_empty() {
            true => ".".to_owned(),
            false => folder.display().to_string(),
        };
        let folders: Vec<_> = self.folders.iter().map(shown).collect();
        format!("correct the name; looked in: {}", folders.join(", "))
    }

    /// Makes names of files that `file` gives absolute where they lie in a folder other than its own, so that
    /// later stages need not know of folders, and adds their places to `found`. Such names are strings called
    /// `filename` or `..._filename`.
    pub(super) fn settle(&self, object: &mut Object, file: &Arc<PathBuf>, found: &mut HashSet<Location>) {
        if self.folders.len() < 2 {
            return;
        }
        for property in &mut object.properties {
            match &mut property.value {
                Value::Object(child) => self.settle(child, file, found),
                Value::String(name)
                    if property.name.ends_with("filename") && Arc::ptr_eq(&property.location.file, file) =>
                {
                    let elsewhere = self.find(name).filter(|path| *path != self.own.join(&*name));
                    let path = elsewhere.and_then(|path| std::path::absolute(path).ok());
                    if let Some(path) = path.as_deref().and_then(Path::to_str) {
                        path.clone_into(name);
                        found.insert(property.location.clone());
                    }
                }
                _ => {}
            }
        }
    }
}
