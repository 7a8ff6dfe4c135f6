//! The scene: geometry and, on it, materials, media and lights.

pub mod accel;
