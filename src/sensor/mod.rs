//! Sensors: where eye walks start and what light walks are joined to.

mod perspective;

pub use perspective::{Perspective, Projection};
