//! Errors in a file, with a remedy.

use crate::error::Error;
use std::{fmt, io};

/// An error in a file. The caller adds the place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// What would have been right.
    pub expected: String,
    /// What was found there instead.
    pub found: String,
    /// What to do about it.
    pub remedy: String,
}

impl Problem {
    pub(in crate::volume) fn new(
        expected: impl Into<String>,
        found: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Self {
        Self { expected: expected.into(), found: found.into(), remedy: remedy.into() }
    }

    /// Of a file that contradicts itself.
    pub(super) fn damage(expected: impl Into<String>, found: impl Into<String>) -> Self {
        Self::new(expected, found, "the file is damaged: export the volume again")
    }

    /// The error of this problem at `place`.
    pub fn at(self, place: impl fmt::Display) -> Error {
        Error::new(place, self.expected, self.found, self.remedy)
    }
}

impl From<io::Error> for Problem {
    fn from(error: io::Error) -> Self {
        Self::damage("a whole volume file", format!("one that cannot be read to its end ({error})"))
    }
}
