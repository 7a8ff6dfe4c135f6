//! Vectors, frames, colours, warps and measures: what every other module builds on.

pub mod angle;
pub mod axes;
pub mod black_body;
pub mod bounds;
pub mod boxes;
pub mod cells;
pub mod channels;
pub mod cie;
pub mod colour;
pub mod cubic;
pub mod erf;
pub mod exact_sums;
pub mod frame;
pub mod fresnel;
pub mod measure;
pub mod offset;
pub mod ray_segment;
pub mod relative;
pub mod similarity;
pub mod spectrum;
pub mod srgb;
pub mod uv;
pub mod warp;
pub mod wrap;

pub use axes::axes;
pub use bounds::Bounds;
pub use channels::Channels;
pub use frame::Frame;
pub use glam::{Affine3A, DAffine3, DMat3, DMat4, DQuat, DVec3, Mat3, Vec2, Vec3, vec2, vec3};
pub use ray_segment::RaySegment;
pub use spectrum::{Spectrum, SpectrumExt};
pub use uv::{Attribute, Corners, Detail, Uv};
pub use wrap::Wrap;
