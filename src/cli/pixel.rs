//! `tyndall pixel`: the paths of one pixel's samples, or of the brightest contributions to all pixels.

use super::{
    console::{self, say},
    estimator::Estimator,
    outputs::check_short,
    parsers::{Size, contributions, positive_u32, size, threads},
    scene::{self, Scene, load},
};
use crate::{
    analysis::pixel::{
        self,
        outliers::{self, Plan},
    },
    error::{Error, Result},
    film,
    passes::budget::Budget,
};
use clap::Args;
use std::{
    num::NonZeroUsize,
    path::{Path, PathBuf},
};

/// Write the paths of one pixel's samples.
///
/// A sample is what is found through the pixel. Where pixels share samples (see --film-samples), the image adds up those of
/// the pixels around it too, as its filter weighs them.
#[derive(Args, Clone, Debug, PartialEq)]
pub struct Arguments {
    /// Which scene.
    #[command(flatten)]
    pub scene: Scene,

    /// Column of the pixel, from 0 at the left
    #[arg(value_name = "X", required_unless_present = "outliers")]
    pub x: Option<u32>,

    /// Row of the pixel, from 0 at the top
    #[arg(value_name = "Y", required_unless_present = "outliers")]
    pub y: Option<u32>,

    /// Write the paths of N contributions that make single bright pixels, in place of one pixel's
    ///
    /// Of each pixel the brightest contribution counts, and of these come first those without which the image would have the
    /// least squared error. Each comes with its strategy, its weight, and its share of the pixel and of that error.
    #[arg(long, value_name = "N", num_args = 0..=1, default_missing_value = "10", value_parser = contributions, allow_negative_numbers = true)]
    pub outliers: Option<u16>,

    /// Number of the first sample, from 0
    #[arg(long, value_name = "N", default_value_t = 0, allow_negative_numbers = true)]
    pub sample: u32,

    /// Number of consecutive samples [default: 1; with --outliers the scene's sample_count]
    #[arg(long, value_name = "M", value_parser = positive_u32, allow_negative_numbers = true)]
    pub samples: Option<u32>,

    /// File to write to; of --outliers a page if its name ends in .html [default: standard output]
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
    let task = Task::of(arguments)?;
    let setup = load(&arguments.scene, arguments.estimator.overrides(arguments.size))?;
    check_short(&arguments.output)?;
    let settings = |samples| arguments.estimator.settings(&setup, arguments.seed, Budget::samples(samples));
    let (first, pool) = (arguments.sample, scene::threads(arguments.threads)?);
    match task {
        Task::Pixel(at) => {
            let settings = settings(setup.samples_per_pixel)?;
            let samples = arguments.samples.unwrap_or(1);
            let found = pool.install(|| pixel::examine(&setup, &settings, at, first, samples))?;
            give(arguments, &found.json())
        }
        Task::Outliers(most) => {
            let given = u32::try_from(setup.samples_per_pixel).unwrap_or(u32::MAX);
            let samples = arguments.samples.unwrap_or(given);
            // As a render of these samples has it.
            let settings = settings(u64::from(first) + u64::from(samples))?;
            let plan = Plan { most: usize::from(most), first, samples };
            let bar = console::bar(u64::from(samples));
            let mut show = |done| {
                bar.set_position(done);
                let share = || serde_json::json!({ "done": done as f64 / f64::from(samples) });
                console::update(done == u64::from(samples), share);
            };
            let found = pool.install(|| outliers::examine(&setup, &settings, &plan, &mut show))?;
            bar.finish_and_clear();
            let Some(path) = &arguments.output else { return give(arguments, &found.json()) };
            say(&outliers::table(&found));
            let name = arguments.scene.name().to_string_lossy().into_owned();
            give(
                arguments,
                &if is_page(path) { outliers::page(&setup, &name, &found)? } else { found.json() },
            )
        }
    }
}

/// What is asked for.
enum Task {
    /// The samples of this pixel.
    Pixel([u32; 2]),
    /// So many contributions to any pixel.
    Outliers(u16),
}

impl Task {
    /// An error where options contradict each other.
    fn of(arguments: &Arguments) -> Result<Self> {
        let Arguments { x, y, outliers, output, .. } = arguments;
        match (outliers, *x, *y) {
            (Some(most), None, _) => Ok(Self::Outliers(*most)),
            (Some(_), Some(x), y) => {
                let found = y.map_or(format!("X = {x}"), |y| format!("X = {x} and Y = {y}"));
                let remedy = "leave out X and Y, or leave out --outliers";
                Err(Error::new("--outliers", "a search of all pixels, without X and Y", found, remedy))
            }
            (None, x, y) => {
                if let Some(path) = output.as_deref().filter(|path| is_page(path)) {
                    let (expected, remedy) =
                        ("a file for JSON", "name it .json, or give --outliers, which has a page");
                    return Err(Error::new("--output", expected, path.display().to_string(), remedy));
                }
                // Both are there, or the arguments would not have been read.
                Ok(Self::Pixel([x.unwrap_or(0), y.unwrap_or(0)]))
            }
        }
    }
}

fn is_page(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("html"))
}

/// Prints `text`, or writes it to the file that was asked for.
fn give(arguments: &Arguments, text: &str) -> Result<()> {
    let Some(path) = &arguments.output else {
        console::print(text);
        return Ok(());
    };
    film::output::write(path, |file| writeln!(file, "{text}"))?;
    say(&path.display().to_string());
    Ok(())
}
