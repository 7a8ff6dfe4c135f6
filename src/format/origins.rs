//! What reading replaces, kept so that the scene can be written again: texts with `$name`s in them, parameters
//! and their defaults, files that were included.

use super::json::below;
use crate::description::{Location, Position};
use std::{
    collections::{BTreeSet, HashMap, HashSet},
    path::PathBuf,
};

/// A parameter as the scene declares it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Declaration {
    /// What follows the `$`.
    pub name: String,
    /// Its default as text: `$` names another parameter, `\$` is a dollar sign.
    pub text: String,
    /// Its value.
    pub value: String,
    /// The type of its values, where the format states it.
    pub kind: Option<Kind>,
}

/// The value of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// `true` or `false`.
    Boolean,
    /// A whole number.
    Integer,
    /// A number.
    Float,
    /// Text.
    String,
}

/// Everything of a scene that its tree does not show.
#[derive(Debug, Default)]
pub(super) struct Origins {
    /// Texts with `$` in them, by element and attribute. A value in JSON is the attribute `value` of its place.
    texts: HashMap<Location, Vec<(String, String)>>,
    /// Where each step of a transform of XML is.
    steps: HashMap<Location, Vec<Location>>,
    /// Names of files that were found in a folder other than that of the file which gives them.
    found: HashSet<Location>,
    /// Parameters in the order of their declarations.
    pub declarations: Vec<Declaration>,
    /// Files that were included.
    pub included: BTreeSet<PathBuf>,
}

impl Origins {
    /// Remembers that `text` is at the attribute `name` of what is at `place`.
    pub(super) fn record(&mut self, place: Location, name: &str, text: &str) {
        self.texts.entry(place).or_default().push((name.to_owned(), text.to_owned()));
    }

    /// Remembers where the steps of the transform at `place` are.
    pub(super) fn record_steps(&mut self, place: Location, steps: Vec<Location>) {
        self.steps.insert(place, steps);
    }

    /// Remembers that the file named at `place` lies elsewhere than it says.
    pub(super) fn record_found(&mut self, place: Location) {
        self.found.insert(place);
    }

    /// Remembers a parameter; one already known keeps its value.
    pub(super) fn declare(&mut self, name: &str, value: &str, text: &str, kind: Option<Kind>) {
        if self.declarations.iter().all(|known| known.name != name) {
            let [name, value, text] = [name, value, text].map(str::to_owned);
            self.declarations.push(Declaration { name, text, value, kind });
        }
    }

    /// Forgets all parameters: every value is its own text.
    pub(super) fn fill(&mut self) {
        self.texts.clear();
        self.declarations.clear();
    }

    /// True if the file named at `place` lies elsewhere than it says.
    pub(super) fn was_found_elsewhere(&self, place: &Location) -> bool {
        self.found.contains(place)
    }

    /// The text with `$` at the attribute `name` (in JSON: the key) of what is at `place`.
    pub(super) fn attribute(&self, place: &Location, name: &str) -> Option<&str> {
        match &place.position {
            Position::Text { .. } => self.at(place, name),
            Position::Path(_) => self.at(&below(place, &super::json::key(name)), "value"),
        }
    }

    /// The text with `$` that is the value at `place` itself.
    pub(super) fn value(&self, place: &Location) -> Option<&str> {
        self.at(place, "value")
    }

    /// The text with `$` that is item `index` of the list at `place`; in JSON only.
    pub(super) fn item(&self, place: &Location, index: usize) -> Option<&str> {
        match &place.position {
            Position::Text { .. } => None,
            Position::Path(_) => self.at(&below(place, &super::json::index(index)), "value"),
        }
    }

    /// Where step `index` of the transform at `place` is.
    pub(super) fn step(&self, place: &Location, index: usize) -> Option<Location> {
        match &place.position {
            Position::Text { .. } => self.steps.get(place)?.get(index).cloned(),
            Position::Path(_) => Some(below(place, &super::json::index(index))),
        }
    }

    fn at(&self, place: &Location, name: &str) -> Option<&str> {
        let texts = self.texts.get(place)?;
        texts.iter().find(|(attribute, _)| attribute == name).map(|(_, text)| text.as_str())
    }
}
