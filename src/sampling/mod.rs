//! Random streams and tabulated distributions.

pub mod discrete;
pub mod stream;

pub use discrete::Discrete;
pub use stream::Stream;
