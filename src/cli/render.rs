//! `tyndall render`: a scene file in, an image and its PNG preview out.

use super::{arguments, load};
use crate::{
    error::{Error, Result},
    film::{
        self, Film,
        format::{FileKind, Format},
    },
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
    let goal = Goal::new(arguments, &setup)?;
    let load_time = started.elapsed();
    let mut image = on_threads(arguments, || {
        let bar = Bar::new(&settings, setup.film.len());
        let (scene, film, layers) = (&setup.scene, &setup.film, &setup.integrator.layers);
        let image =
            render::render_layers(scene, film, &settings, layers, &mut |progress| bar.tell(&progress));
        bar.bar.finish_and_clear();
        image
    })?;
    goal.write(&setup.film, &mut image)?;
    let preview = goal.path.with_extension("png");
    film::png::write(&preview, setup.film.width as usize, setup.film.height as usize, &image.pixels)?;
    if let Some(report) = &arguments.report {
        write_report(report, &image, load_time, settings.profile)?;
    }
    print_summary(&image, &goal.path, &preview);
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

/// The image file: where, and what is in it. The PNG stands beside it.
struct Goal {
    path: PathBuf,
    format: Format,
}

impl Goal {
    /// The kind of file is that of the output's name, else that of the scene's film.
    fn new(arguments: &arguments::Render, setup: &Setup) -> Result<Self> {
        let scene = setup.film.format;
        let named = arguments.output.as_deref().and_then(|path| Some((path, path.extension()?)));
        let named =
            named.and_then(|(path, end)| Some((path, FileKind::of_extension(&end.to_string_lossy())?)));
        let (path, file) = match (named, &arguments.output) {
            (Some((path, file)), _) => (path.to_owned(), file),
            (None, Some(path)) => (path.with_extension(scene.file.extension()), scene.file),
            (None, None) => {
                let stem = PathBuf::from(arguments.scene.file.file_stem().unwrap_or_default());
                (stem.with_extension(scene.file.extension()), scene.file)
            }
        };
        if file != FileKind::OpenExr && !setup.integrator.layers.is_empty() {
            let expected = "an OpenEXR file, to hold the layers of the scene's aov or moment integrator";
            let found = format!("a file that holds {}", file.holds());
            let remedy = "let its name end in .exr, or set the film's file_format to openexr";
            return Err(Error::new(path.display(), expected, found, remedy));
        }
        let format = scene.in_file(file);
        if format.names() != scene.names() {
            let (holds, names) = (file.holds(), format.names().concat());
            super::complain(&format!("warning: {} holds {holds}; {names} is written", path.display()));
        }
        Ok(Self { path, format })
    }

    /// Writes the image, and the layers that it then no longer has.
    fn write(&self, film: &Film, image: &mut Image) -> Result<()> {
        let (width, height) = (film.width as usize, film.height as usize);
        let mut channels = self.format.channels(&image.pixels, &image.alpha);
        match self.format.file {
            FileKind::OpenExr => {
                channels.append(&mut image.layers);
                film::exr::write(&self.path, width, height, channels, self.format)
            }
            FileKind::Pfm => film::raster::write_pfm(&self.path, width, height, &channels),
            FileKind::Rgbe => film::raster::write_rgbe(&self.path, width, height, &image.pixels),
        }
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
