//! Images: what a render leaves behind.

pub mod exr;
mod output;
pub mod png;
