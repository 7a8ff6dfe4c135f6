//! What a user should know of a scene that is no error: each text once for all the places that it is true of.

use std::{collections::HashSet, path::Path};

/// So many places are named, and the others counted.
const NAMED: usize = 3;

/// Warnings in the order in which they came up.
#[derive(Debug, Default)]
pub(super) struct Warnings(Vec<Warning>);

#[derive(Debug, Default)]
struct Warning {
    text: String,
    /// The first ones.
    named: Vec<String>,
    places: HashSet<String>,
    /// It is all there is to say of a file.
    is_note: bool,
}

impl Warnings {
    /// Adds `text`, which is true of `place`.
    pub(super) fn add(&mut self, place: String, text: &str) {
        let known = self.0.iter().position(|warning| !warning.is_note && warning.text == text);
        let at = known.unwrap_or_else(|| {
            self.0.push(Warning { text: text.to_owned(), ..Warning::default() });
            self.0.len() - 1
        });
        self.0[at].add(place);
    }

    /// Adds `text` to what there is to say of a `file`, all of which is one warning.
    pub(super) fn note(&mut self, file: &Path, text: &str) {
        let place = file.display().to_string();
        match self.0.iter_mut().find(|warning| warning.is_note && warning.named == [place.as_str()]) {
            None => {
                let mut note = Warning { text: text.to_owned(), is_note: true, ..Warning::default() };
                note.add(place);
                self.0.push(note);
            }
            Some(note) if note.text.split("; ").any(|said| said == text) => {}
            Some(note) => note.text = format!("{}; {text}", note.text),
        }
    }

    /// A line for each place, or one for all of many.
    pub(super) fn into_lines(self) -> Vec<String> {
        self.0.into_iter().flat_map(Warning::into_lines).collect()
    }
}

impl Warning {
    fn add(&mut self, place: String) {
        if self.places.insert(place.clone()) && self.named.len() < NAMED {
            self.named.push(place);
        }
    }

    fn into_lines(self) -> Vec<String> {
        let Self { text, named, places, .. } = self;
        match places.len() {
            ..=NAMED => named.iter().map(|place| format!("{place}: {text}")).collect(),
            count => vec![format!("{} and {} more: {text}", named.join(", "), count - NAMED)],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_is_said_once_of_many_places() {
        let mut warnings = Warnings::default();
        for n in 0..10_000 {
            warnings.add(format!("line {n}"), "a mirrored axis");
            warnings.add(format!("line {}", n % 3), "a zero");
        }
        warnings.note(Path::new("a.ply"), "one thing");
        warnings.note(Path::new("a.ply"), "another");
        warnings.note(Path::new("a.ply"), "one thing");
        warnings.note(Path::new("b.ply"), "one thing");
        assert_eq!(
            warnings.into_lines(),
            [
                "line 0, line 1, line 2 and 9997 more: a mirrored axis",
                "line 0: a zero",
                "line 1: a zero",
                "line 2: a zero",
                "a.ply: one thing; another",
                "b.ply: one thing",
            ]
        );
    }
}
