//! Random streams and tabulated distributions.

pub mod discrete;
pub mod grid;
pub mod stream;

pub use discrete::Discrete;
pub use grid::{Cell, Grid};
pub use stream::Stream;
