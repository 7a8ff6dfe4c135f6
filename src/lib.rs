//! Tyndall: a bidirectional path tracer for participating media, after Lafortune & Willems 1996 (LW96).
//!
//! The modules stand in the order of the pipeline; each may use those above it and none below.

pub mod error;
pub mod math;
pub mod sampling;

pub mod description;

pub mod film;
pub mod scene;

pub mod cli;
