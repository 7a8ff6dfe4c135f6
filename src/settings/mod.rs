//! What a scene and the command line say about how it is rendered: integrator, sampler, film.

pub mod film;
pub mod heuristic;
pub mod integrator;
pub mod options;
pub mod sampler;

use crate::{description::params::Child, error::Error, medium::DistanceMethod};

/// Settings of the command line that override those of the scene.
#[derive(Clone, Copy, Debug, Default)]
pub struct Overrides {
    /// Width and height [pixels].
    pub size: Option<(u32, u32)>,
    /// Free-flight sampling methods in heterogeneous media.
    pub tracker: Option<DistanceMethod>,
}

/// The error of a second one where there may be one.
pub fn only_one(second: &Child<'_>, what: &str) -> Error {
    Error::new(second.location, format!("one {what}"), format!("a second {what}"), "remove one of them")
}
