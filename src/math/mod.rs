//! Vectors, frames, colours, warps and measures: what every other room stands on.

pub mod black_body;
pub mod boxes;
pub mod cells;
pub mod cie;
pub mod colour;
pub mod frame;
pub mod fresnel;
pub mod lanes;
pub mod measure;
pub mod offset;
pub mod relative;
pub mod section;
pub mod similarity;
pub mod spectrum;
pub mod srgb;
pub mod warp;
pub mod wrap;

pub use frame::Frame;
pub use glam::{Affine3A, DAffine3, DMat3, DMat4, DVec3, Mat3, Vec2, Vec3, vec2, vec3};
pub use lanes::Lanes;
pub use section::Section;
pub use spectrum::{Spectrum, SpectrumExt};
pub use wrap::Wrap;
