//! The number of samples of a scene, and the source of their random numbers.

use crate::{
    description::{Library, Object, Plugin, Registry, Table, parameter::Parameter, rows},
    error::Result,
    sampling::Sampler,
};

/// Every sampler. Mitsuba's stratified samplers spread numbers evenly, each in a way of its own; here all of them are
/// Sobol's sequence. `independent`, Mitsuba's default, means that nothing was chosen.
pub(crate) const ROWS: Registry<Plugin<Option<Sampler>>> = Registry::new(
    "a sampler",
    &[
        ("independent", plugin("The number of samples; Tyndall chooses how they are drawn.", None)),
        ("ldsampler", plugin(SOBOL, Some(Sampler::Sobol))),
        ("multijitter", plugin(SOBOL, Some(Sampler::Sobol))),
        ("orthogonal", plugin(SOBOL, Some(Sampler::Sobol))),
        ("sobol", plugin("Owen-scrambled Sobol sequences.", Some(Sampler::Sobol))),
        ("stratified", plugin(SOBOL, Some(Sampler::Sobol))),
    ],
);

const SOBOL: &str = "The same as `sobol`.";

const COMMON: &[Parameter] = rows! {
    integer("sample_count", within(1.0, MAX), Is(4.0), "Samples per pixel."),
    ignored("seed", "Tyndall has its own random sequences"),
    ignored("jitter", "Tyndall has its own random sequences"),
    ignored("strength", "Tyndall has its own random sequences"),
};

const fn plugin(about: &'static str, build: Option<Sampler>) -> Plugin<Option<Sampler>> {
    Plugin { table: Table { about, groups: &[COMMON] }, build }
}

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
    let (params, sampler) = ROWS.read(object, library)?;
    let samples_per_pixel = params.integer("sample_count")? as u64;
    params.finish()?;
    Ok(Sampling { samples_per_pixel, sampler: *sampler })
}
