//! Scenes: read from either spelling into one description.

mod json;
mod parameters;
mod read;
mod references;
mod steps;
mod text;
mod xml;

pub use read::read;
