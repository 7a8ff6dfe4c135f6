//! Images against one another and against known radiance: every claim is tested statistically.

#[path = "../common/mod.rs"]
mod common;

mod adaptive;
mod agreement;
mod beams;
mod components;
mod depths;
mod determinism;
mod efforts;
mod equiangular;
mod extremes;
mod faces;
mod faults;
mod film_samples;
mod forced;
mod gather;
mod glowing;
mod groups;
mod guide;
mod heuristics;
mod layers;
mod modes;
mod motion;
mod openings;
mod overlaps;
mod smooth_shapes;
mod sobol;
mod starts;
mod traps;
