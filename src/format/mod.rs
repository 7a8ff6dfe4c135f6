//! Scene files: every reader and writer of them. JSON and Mitsuba's XML are two spellings of one description.

mod draft;
mod files;
mod foreign;
mod input;
mod json;
mod parameters;
mod paths;
pub mod plugins;
mod read;
pub mod references;
pub mod starting;
mod steps;
pub mod tags;
mod text;
mod write;
mod xml;

pub use files::{Sources, file_fingerprint, fingerprint};
pub use input::{STANDARD_INPUT, bytes, is_standard_input, told};
pub use read::{Spelling, is_scene, read, sources};
pub use write::{Conversion, convert, transform, write};
