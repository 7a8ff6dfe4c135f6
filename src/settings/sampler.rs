//! The number of samples of a scene, and the source of their random numbers.

use crate::{
    description::{Library, Object, Params, Registry},
    error::Result,
    sampling::Sampler,
};

/// Every sampler. Those of Mitsuba that stratify do so to spread numbers evenly, each in a way of its own; here all that
/// is Sobol's sequence. Its default, `independent`, says no more than that nothing was chosen.
pub(crate) const ROWS: Registry<Option<Sampler>> = Registry::new(
    "a sampler",
    &[
        ("independent", None),
        ("ldsampler", Some(Sampler::Sobol)),
        ("multijitter", Some(Sampler::Sobol)),
        ("orthogonal", Some(Sampler::Sobol)),
        ("sobol", Some(Sampler::Sobol)),
        ("stratified", Some(Sampler::Sobol)),
    ],
);

/// The settings of a sampler.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sampling {
    /// Samples per pixel.
    pub samples_per_pixel: u64,
    /// None for the default.
    pub sampler: Option<Sampler>,
}

impl Default for Sampling {
    fn default() -> Self {
        Self { samples_per_pixel: 4, sampler: None }
    }
}

/// Reads `object`.
pub(crate) fn build(object: &Object, library: &Library) -> Result<Sampling> {
    let sampler = *ROWS.find(object)?;
    let params = Params::new(object, library);
    let count = params.integer("sample_count", 4)?;
    params.accept_unused(&["seed", "jitter", "strength"], "the sequence of random numbers is Tyndall's own");
    params.finish()?;
    if count < 1 {
        return Err(params.complain("sample_count", "an integer >= 1", count.to_string()));
    }
    Ok(Sampling { samples_per_pixel: count as u64, sampler })
}
