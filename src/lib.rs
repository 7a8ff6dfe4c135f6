//! Tyndall: a bidirectional path tracer for participating media, after Lafortune & Willems 1996 (LW96).
//!
//! The modules are listed in the order of the pipeline; each may use the ones above it, none below.

pub mod error;
pub mod inputs;
pub mod math;
pub mod memory;
pub mod sampling;

pub mod description;

pub mod phase;
pub mod volume;

pub mod texture;

pub mod bsdf;
pub mod emitter;
pub mod medium;
pub mod sensor;
pub mod shape;

pub mod film;

pub mod settings;

pub mod format;

pub mod scene;

pub mod guide;

pub mod transport;

pub mod first_pass;

pub mod passes;

pub mod learning;

pub mod render;

pub mod analysis;

pub mod cli;

#[cfg(test)]
mod testing;
