//! Vectors, frames, colours, warps and measures: what every other room stands on.

pub mod cie;
pub mod colour;
pub mod frame;
pub mod fresnel;
pub mod measure;
pub mod offset;
pub mod similarity;
pub mod spectrum;
pub mod warp;

pub use frame::Frame;
pub use glam::{DMat3, DMat4, DVec3, Mat3, Vec2, Vec3, vec2, vec3};
pub use spectrum::{Spectrum, SpectrumExt};
