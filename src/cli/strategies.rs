//! `tyndall strategies`: what every strategy is worth in a scene.

use super::{
    console::{self, Answer, say},
    estimator::Estimator,
    outputs,
    parsers::{Size, positive_u32, seed, size, threads},
    scene::{self, Scene, load},
};
use crate::{
    analysis::strategies::{self, Plan},
    error::Result,
    passes::budget::Budget,
};
use clap::Args;
use indicatif::ProgressStyle;
use std::{num::NonZeroUsize, path::PathBuf};

/// Show what every strategy is worth.
#[derive(Args, Clone, Debug, PartialEq)]
pub struct Arguments {
    /// Which scene.
    #[command(flatten)]
    pub scene: Scene,

    /// Folder to write to, created if missing [default: the name of the scene followed by -strategies, in the
    /// current folder]
    #[arg(short, long, value_name = "FOLDER")]
    pub output: Option<PathBuf>,

    /// Samples per pixel of the images [default: the scene's sample_count]
    #[arg(long, value_name = "N", value_parser = positive_u32, allow_negative_numbers = true)]
    pub spp: Option<u32>,

    /// Samples per pixel for each set of strategies in the comparison, rounded up to ten rounds of at least two;
    /// 0 for no comparison [default: --spp]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub pilots: Option<u32>,

    /// Show each strategy separately for paths of up to N segments, and by kind for longer paths
    #[arg(long, value_name = "D", default_value_t = 6, value_parser = clap::value_parser!(u32).range(1..=64))]
    pub depth: u32,

    /// Seed of all random numbers
    #[arg(long, value_name = "N", value_parser = seed, default_value_t = 0, allow_negative_numbers = true)]
    pub seed: u64,

    /// Threads to render with [default: one per processor]
    #[arg(long, value_name = "N", value_parser = threads, allow_negative_numbers = true)]
    pub threads: Option<NonZeroUsize>,

    /// Size of the image in pixels, where the film has no crop window [default: the scene's film]
    #[arg(long, value_name = "WxH", value_parser = size, allow_hyphen_values = true)]
    pub size: Option<Size>,

    /// How paths are sampled.
    #[command(flatten)]
    pub estimator: Estimator,

    /// How the shares are given.
    #[command(flatten)]
    pub answer: Answer,
}

/// Runs the command.
pub(super) fn run(arguments: &Arguments) -> Result<()> {
    let setup = load(&arguments.scene, arguments.estimator.overrides(arguments.size))?;
    arguments.answer.check()?;
    let budget = Budget::ENDLESS;
    let settings = arguments.estimator.requested(&setup, arguments.seed, budget)?;
    let passes = arguments.spp.map_or(setup.samples_per_pixel, u64::from) as usize;
    let pilots = arguments.pilots.map_or(passes, |pilots| pilots as usize);
    let plan = Plan { depth: arguments.depth, passes, pilots };
    strategies::check(&setup.film, &plan, &settings.options)?;
    let folder = outputs::folder(arguments.output.as_ref(), &arguments.scene, "strategies")?;
    strategies::check_files(&folder, &setup.film, &plan, &settings.options)?;
    let bar = console::bar(0);
    if let Ok(style) = ProgressStyle::with_template("{bar:30} {percent:>3} %  {eta} left") {
        bar.set_style(style);
    }
    let mut show = |done: usize, total: usize| {
        bar.set_length(total as u64);
        bar.set_position(done as u64);
        let share = || serde_json::json!({ "done": done as f64 / total.max(1) as f64 });
        console::update(done == total, share);
    };
    let pool = scene::threads(arguments.threads)?;
    let findings = pool.install(|| strategies::examine(&setup, &settings, &plan, &mut show))?;
    bar.finish_and_clear();
    let files = findings.write(&folder)?;
    say(&strategies::table(&findings.report));
    say(&outputs::listed(&folder, &files));
    arguments.answer.give(&serde_json::json!(findings.report))
}
