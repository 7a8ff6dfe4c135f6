//! Random streams, tabulated distributions, and portals that rays aim at.

pub mod cells;
pub mod crossings;
pub mod discrete;
pub mod grid;
mod inverse;
mod points;
pub mod portal;
pub mod quadtree;
pub mod sampler;
pub mod stream;
mod thinning;

pub use cells::Cells;
pub use discrete::Discrete;
pub use grid::{Cell, Grid};
pub use quadtree::{Basis, Quadtree};
pub use sampler::Sampler;
pub use stream::Stream;
pub use thinning::Thinning;
