//! `tyndall pixel`: the paths of one pixel's samples.

use super::{
    console::{self, say},
    estimator::Estimator,
    outputs::check_short,
    parsers::{Size, positive_u32, size, threads},
    scene::{self, Scene, load},
};
use crate::{analysis::pixel, error::Result, film, passes::budget::Budget};
use clap::Args;
use std::{num::NonZeroUsize, path::PathBuf};

/// Write the paths of one pixel's samples.
#[derive(Args, Clone, Debug, PartialEq)]
pub struct Arguments {
    /// Which scene.
    #[command(flatten)]
    pub scene: Scene,

    /// Column of the pixel, from 0 at the left
    #[arg(value_name = "X")]
    pub x: u32,

    /// Row of the pixel, from 0 at the top
    #[arg(value_name = "Y")]
    pub y: u32,

    /// Number of the first sample, from 0
    #[arg(long, value_name = "N", default_value_t = 0, allow_negative_numbers = true)]
    pub sample: u32,

    /// Number of consecutive samples
    #[arg(long, value_name = "M", default_value_t = 1, value_parser = positive_u32, allow_negative_numbers = true)]
    pub samples: u32,

    /// File to write to [default: standard output]
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,

    /// Seed of the render
    #[arg(long, value_name = "N", default_value_t = 0, allow_negative_numbers = true)]
    pub seed: u64,

    /// Threads to use [default: one per processor]
    #[arg(long, value_name = "N", value_parser = threads, allow_negative_numbers = true)]
    pub threads: Option<NonZeroUsize>,

    /// Size of the image in pixels, where the film has no crop window [default: the scene's film]
    #[arg(long, value_name = "WxH", value_parser = size, allow_hyphen_values = true)]
    pub size: Option<Size>,

    /// How paths are sampled.
    #[command(flatten)]
    pub estimator: Estimator,
}

/// Runs the command.
pub(super) fn run(arguments: &Arguments) -> Result<()> {
    let setup = load(&arguments.scene, arguments.estimator.overrides(arguments.size))?;
    check_short(&arguments.output)?;
    let budget = Budget::samples(setup.samples_per_pixel);
    let settings = arguments.estimator.settings(&setup, arguments.seed, budget)?;
    let at = [arguments.x, arguments.y];
    let pool = scene::threads(arguments.threads)?;
    let found =
        pool.install(|| pixel::examine(&setup, &settings, at, arguments.sample, arguments.samples))?;
    let json = found.json();
    let Some(path) = &arguments.output else {
        console::print(&json);
        return Ok(());
    };
    film::output::write(path, |file| writeln!(file, "{json}"))?;
    say(&path.display().to_string());
    Ok(())
}
