//! What is wrong with a file, told so that it can be mended.

use crate::error::Error;
use std::{fmt, io};

/// A mistake in a file. Who asked for the file knows the place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// What would have been right.
    pub expected: String,
    /// What stands there instead.
    pub found: String,
    /// What to do about it.
    pub remedy: String,
}

impl Problem {
    pub(super) fn new(
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
