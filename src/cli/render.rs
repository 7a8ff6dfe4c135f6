//! `tyndall render`: a scene file in, an EXR and a PNG out.

use super::{arguments, load};
use crate::{
    error::{Error, Result},
    film,
    render::{self, Image, Progress, Settings, budget::Budget},
    scene::{build::Setup, integrator::Method},
    transport::{
        Options, Strategies,
        profile::{Needs, ProfileName},
    },
};
use indicatif::{ProgressBar, ProgressStyle};
use std::{
    io::Write as _,
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

/// Runs the command.
pub fn run(arguments: &arguments::Render) -> Result<()> {
    let started = Instant::now();
    let setup = load(&arguments.scene, arguments.size)?;
    let settings = settings(arguments, &setup)?;
    let output = output_path(arguments);
    let load_time = started.elapsed();
    let image = on_threads(arguments, || {
        let bar = Bar::new(&settings, setup.film.len());
        let image = render::render(&setup.scene, &setup.film, &settings, &mut |progress| bar.tell(&progress));
        bar.bar.finish_and_clear();
        image
    })?;
    let (width, height) = (setup.film.width as usize, setup.film.height as usize);
    film::exr::write(&output, width, height, &image.pixels)?;
    let preview = output.with_extension("png");
    film::png::write(&preview, width, height, &image.pixels)?;
    if let Some(report) = &arguments.report {
        write_report(report, &image, load_time, settings.profile)?;
    }
    print_summary(&image, &output, &preview);
    Ok(())
}

fn settings(arguments: &arguments::Render, setup: &Setup) -> Result<Settings> {
    let needed = ProfileName::leanest(Needs::of(&setup.scene));
    let profile = match arguments.profile {
        arguments::Profile::Everything => ProfileName::Everything,
        arguments::Profile::Fitted => needed,
    };
    let max_depth = match arguments.max_depth {
        Some(arguments::MaxDepth::Edges(edges)) => Some(edges),
        Some(arguments::MaxDepth::Unbounded) => None,
        None => setup.integrator.max_depth,
    };
    let options = Options {
        strategies: strategies(arguments, setup.integrator.method)?,
        max_depth,
        hide_emitters: setup.integrator.hide_emitters,
        seed: arguments.seed,
    };
    Ok(Settings { options, budget: budget(arguments, setup), seed: arguments.seed, profile })
}

fn budget(arguments: &arguments::Render, setup: &Setup) -> Budget {
    let samples_per_pixel = match (arguments.spp, arguments.time_limit) {
        (Some(spp), _) => Some(u64::from(spp)),
        (None, Some(_)) => None,
        (None, None) => Some(setup.samples_per_pixel),
    };
    Budget { samples_per_pixel, time: arguments.time_limit }
}

fn strategies(arguments: &arguments::Render, scene_method: Method) -> Result<Strategies> {
    let all = match (arguments.integrator, scene_method) {
        (Some(arguments::Integrator::Bdpt), _) | (None, Method::Bdpt) => Strategies::BDPT,
        (Some(arguments::Integrator::Pt), _) | (None, Method::Pt) => Strategies::PT,
        (Some(arguments::Integrator::Lt), _) | (None, Method::Lt) => Strategies::LT,
    };
    if arguments.strategies.is_empty() {
        return Ok(all);
    }
    let asked = |strategy| arguments.strategies.contains(&strategy);
    let chosen = Strategies {
        hit: asked(arguments::Strategy::Hit),
        next_event: asked(arguments::Strategy::NextEvent),
        join: asked(arguments::Strategy::Join),
        lens: asked(arguments::Strategy::Lens),
    };
    let kept = Strategies {
        hit: chosen.hit && all.hit,
        next_event: chosen.next_event && all.next_event,
        join: chosen.join && all.join,
        lens: chosen.lens && all.lens,
    };
    if kept == chosen {
        return Ok(kept);
    }
    Err(Error::new(
        "--strategies",
        "strategies that the integrator has",
        "one that it leaves out",
        "choose among those of --integrator bdpt: hit, next-event, join, lens",
    ))
}

/// The output's name always ends in .exr; the PNG stands beside it.
fn output_path(arguments: &arguments::Render) -> PathBuf {
    match &arguments.output {
        Some(path) => path.with_extension("exr"),
        None => PathBuf::from(arguments.scene.file.file_stem().unwrap_or_default()).with_extension("exr"),
    }
}

fn on_threads<T: Send>(arguments: &arguments::Render, work: impl FnOnce() -> T + Send) -> Result<T> {
    let threads = arguments.threads.map_or(0, usize::from);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(|error| {
        Error::new(
            "--threads",
            "a number of threads this machine can start",
            error.to_string(),
            "ask for fewer",
        )
    })?;
    Ok(pool.install(work))
}

/// A progress bar over pixel samples, or over time where only time ends the render.
struct Bar {
    bar: ProgressBar,
    by_time: bool,
}

impl Bar {
    fn new(settings: &Settings, pixels: usize) -> Self {
        let (length, template) = match settings.budget {
            Budget { samples_per_pixel: Some(spp), .. } => {
                (spp.saturating_mul(pixels as u64), "{bar:30} {percent:>3} %  {msg}  {eta} left")
            }
            Budget { time, .. } => {
                (milliseconds(time.unwrap_or(Duration::MAX)), "{bar:30} {percent:>3} %  {msg}  {eta} left")
            }
        };
        let bar = ProgressBar::new(length);
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        Self { bar, by_time: settings.budget.samples_per_pixel.is_none() }
    }

    fn tell(&self, progress: &Progress) {
        let noise =
            progress.noise.map_or("noise not known yet".to_owned(), |n| format!("noise {}", percent(n)));
        self.bar.set_message(format!("{} samples/pixel  {noise}", progress.passes));
        self.bar.set_position(if self.by_time { milliseconds(progress.elapsed) } else { progress.samples });
    }
}

fn milliseconds(time: Duration) -> u64 {
    u64::try_from(time.as_millis()).unwrap_or(u64::MAX)
}

/// A relative error, in percent with two digits.
fn percent(relative: f64) -> String {
    let digits = if relative >= 0.1 {
        0
    } else if relative >= 0.01 {
        1
    } else {
        2
    };
    format!("{:.digits$} %", 100.0 * relative)
}

fn print_summary(image: &Image, output: &Path, preview: &Path) {
    let noise = image.noise.map_or(String::new(), |n| format!(", noise {}", percent(n)));
    super::say(&format!(
        "{} samples/pixel in {:.1} s{noise}: {} and {}",
        image.samples_per_pixel,
        image.elapsed.as_secs_f64(),
        output.display(),
        preview.display()
    ));
}

/// Figures for scripts, as JSON.
fn write_report(path: &Path, image: &Image, load_time: Duration, profile: ProfileName) -> Result<()> {
    let report = serde_json::json!({
        "samples_per_pixel": image.samples_per_pixel,
        "render_seconds": image.elapsed.as_secs_f64(),
        "load_seconds": load_time.as_secs_f64(),
        "relative_error": image.noise,
        "profile": profile.name(),
    });
    film::output::write(path, |file| writeln!(file, "{report:#}"))
}
