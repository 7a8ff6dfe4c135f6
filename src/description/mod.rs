//! The scene description: one tree for all file formats, from which models are built.

pub mod colour;
pub mod keyframes;
mod library;
pub mod mend;
mod object;
pub mod parameter;
pub mod params;
pub mod registry;
mod spelling;
pub mod substitutes;
pub mod transform;
mod warnings;

pub use keyframes::Keyframes;
pub use library::{Kept, Library};
pub use object::{Location, Object, Position, Property, Value};
pub use parameter::{Plugin, Table};
pub(crate) use parameter::{rows, table};
pub use params::Params;
pub(crate) use registry::models;
pub use registry::{Build, Registry, nearest, suggest};
pub use transform::TransformStep;
