//! Errors: the place, what was expected, what was found, and a remedy.

use std::fmt;

/// A mistake in what the user gave (a scene, a file, an argument).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Error {
    /// Where: a file with line and column, a file with a JSON path, or an argument.
    pub place: String,
    /// What would have been right.
    pub expected: String,
    /// What was found there instead.
    pub found: String,
    /// What to do about it.
    pub remedy: String,
}

/// A result whose error names its place and remedy.
pub type Result<T> = std::result::Result<T, Error>;

impl Error {
    /// Builds an error from its four parts.
    pub fn new(
        place: impl fmt::Display,
        expected: impl Into<String>,
        found: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Self {
        Self {
            place: place.to_string(),
            expected: expected.into(),
            found: found.into(),
            remedy: remedy.into(),
        }
    }

    /// An operating-system failure on `path`.
    pub fn io(path: &std::path::Path, action: &str, error: &std::io::Error) -> Self {
        Self::new(
            path.display(),
            format!("a file to {action}"),
            error.to_string(),
            "check that the path exists and that you may access it",
        )
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { place, expected, found, remedy } = self;
        write!(f, "{place}: expected {expected}, found {found}\n  remedy: {remedy}")
    }
}

impl std::error::Error for Error {}
