//! The number of samples of a scene, and the source of their random numbers.

use crate::{
    description::{Library, Object, Params, Registry},
    error::Result,
    sampling::Sampler,
};

/// Every sampler. Those of Mitsuba that stratify do so to spread numbers evenly, each in a way of its own; here all that
/// is Sobol's sequence.
pub(crate) const ROWS: Registry<Sampler> = Registry::new(
    "a sampler",
    &[
        ("independent", Sampler::Independent),
        ("ldsampler", Sampler::Sobol),
        ("multijitter", Sampler::Sobol),
        ("orthogonal", Sampler::Sobol),
        ("sobol", Sampler::Sobol),
        ("stratified", Sampler::Sobol),
    ],
);

/// The settings of a sampler.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sampling {
    /// Samples per pixel.
    pub samples_per_pixel: u64,
    pub sampler: Sampler,
}

impl Default for Sampling {
    fn default() -> Self {
        Self { samples_per_pixel: 4, sampler: Sampler::Independent }
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
