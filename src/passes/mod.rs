//! Passes: samples of all pixels, block by block, by an estimator that is compiled for what the scene has.
//!
//! Results depend on the seed alone: every walk draws from its own stream, and blocks are fixed sets of pixels.

pub mod blocks;
pub mod budget;
pub mod compiled;
pub mod faults;
mod fill;
pub mod observe;
pub mod pass;
mod ready;
pub mod splats;

use crate::{
    film::sharing::FilmSamples,
    sampling::Sampler,
    transport::{Options, profiles::ProfileName},
};
use budget::Budget;

/// What to render and for how long.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Strategies, depth, visibility of emitters.
    pub options: Options,
    /// Where the random numbers of walks come from.
    pub sampler: Sampler,
    /// Which samples of camera subpaths pixels take.
    pub film_samples: FilmSamples,
    /// When to stop.
    pub budget: Budget,
    /// The same seed gives the same image, bit for bit.
    pub seed: u64,
    /// The compiled estimator to use; must have all the scene needs. Heuristics other than the balance heuristic run
    /// on what [`ProfileName::weighing`] makes of it.
    pub profile: ProfileName,
}
