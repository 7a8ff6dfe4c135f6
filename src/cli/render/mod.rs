//! `tyndall render`: a scene file in, an image and its PNG preview out.

mod animation;
pub(super) mod arguments;
mod checkpoint;
mod every;
mod features;
mod files;
pub(super) mod precision;
pub(super) mod preview;
mod progressive;
pub(super) mod target;
pub(super) mod task;
mod viewer;

use super::{
    console::{complain, say},
    denoise, interrupt,
    parsers::Frames,
    plan::Plan,
    progress::{Bar, noise_text, percent, samples_text},
    scene::threads,
};
use crate::{
    analysis::{darkness, study::clock::CpuClock},
    error::{Error, Result},
    film::output,
    math::Spectrum,
    passes::{Settings, budget::Budget, faults::Faults},
    render::{
        self, Image, Precision,
        progressive::Shaded,
        sums::{AnySums, Picture, samples::Samples},
    },
    scene::build::Setup,
    transport::Algorithm,
};
use animation::Clip;
use arguments::Render;
use checkpoint::{Keeper, Left, Shown, sums_file, wanted};
use serde_json::Value;
use std::{
    path::Path,
    sync::Mutex,
    time::{Duration, Instant},
};
use target::Target;
use task::Task;
use viewer::Viewer;

/// Runs the command.
pub(super) fn run(arguments: &Render) -> Result<()> {
    if arguments.scene.sensor.as_deref() != Some(every::ALL) {
        return run_one(arguments);
    }
    for one in every::sensor(arguments)? {
        run_one(&one)?;
        if let Some((name, _)) = interrupt::signal() {
            let sensor = one.scene.sensor.unwrap_or_default();
            complain(&format!("{name} at sensor {sensor}: those behind it are not rendered"));
            break;
        }
    }
    Ok(())
}

fn run_one(arguments: &Render) -> Result<()> {
    let started = Instant::now();
    if arguments.denoise {
        denoise::check()?;
    }
    let clip = Clip::read(arguments)?;
    let mut setup = clip.first()?;
    let mut target = Target::new(arguments, &setup)?;
    target.make_folder()?;
    arguments.pixels.progressive.map_or(Ok(()), |_| progressive::check(&setup))?;
    files::check(arguments, &setup, &target)?;
    let pool = threads(arguments.threads)?;
    let viewer = Mutex::new(None);
    let (task, chosen) = pool.install(|| Task::new(arguments, &setup, &viewer))?;
    check_kept(arguments, &task.settings, &target)?;
    if let Ok(mut viewer) = viewer.lock() {
        *viewer = arguments.tev.as_deref().map(Viewer::connect).transpose()?;
    }
    let plan = Plan::new(&setup, task.settings, chosen, arguments.error);
    let plan = plan.of_pixels(arguments.progressive());
    // Before this there is nothing that a signal should save.
    interrupt::listen();
    plan.announce(&arguments.scene.file, arguments.verbose);
    let load_time = started.elapsed().saturating_sub(task.settings.budget.spent).as_secs_f64();
    let figures = match arguments.frames {
        None => vec![pool.install(|| shoot(&setup, &task, &mut target, None))?],
        Some(frames) => pool.install(|| animate(&clip, &mut setup, task, target, frames))?,
    };
    arguments.answer.give(&report(figures, load_time, arguments.frames.is_some(), &plan))
}

/// Renders frame after frame; their figures.
fn animate(
    clip: &Clip<'_>,
    setup: &mut Setup,
    mut task: Task<'_>,
    mut target: Target,
    frames: Frames,
) -> Result<Vec<Value>> {
    let Frames { first, last } = frames;
    let digits = frames.digits();
    let (mut figures, mut spent, mut clock) = (Vec::new(), task.settings.budget.spent, task.clock);
    for frame in first..=last {
        let time = clip.time(frame);
        if !clip.rebuilds {
            let moved = setup.scene.set_time(time).map_err(|error| clip.explain(frame, error))?;
            if !moved && frame == first && first < last {
                complain(
                    "warning: nothing in this scene moves (no \"wind\", no keyframes, no numbered files): frames \
                     differ by noise only",
                );
            }
        } else if frame > first {
            *setup = clip.frame(frame, setup)?;
            task = Task::new(task.arguments, setup, task.viewer)?.0;
            (spent, clock) = (task.settings.budget.spent, task.clock);
        }
        let budget = Budget { spent, ..task.settings.budget };
        let settings = Settings { seed: seed_of(task.settings.seed, frame), budget, ..task.settings };
        let mut made = task.made.clone();
        made["settings"]["seed"] = settings.seed.into();
        made["settings"]["time"] = time.into();
        let task = Task { settings, made, clock, ..task };
        let label = format!("frame {frame} of {first}..{last}");
        let mut numbered = target.numbered(frame, digits);
        let mut figure = shoot(setup, &task, &mut numbered, Some(&label))?;
        // What was chosen for the first frame holds for all.
        target.display = numbered.display;
        (spent, clock) = (Duration::ZERO, CpuClock::start(0.0));
        figure["frame"] = frame.into();
        figure["time"] = time.into();
        figures.push(figure);
        if let Some((name, _)) = interrupt::signal() {
            complain(&format!("{name} in frame {frame}: continue with --frames {frame}..{last}"));
            break;
        }
    }
    Ok(figures)
}

/// Seed of a frame: no two frames of nearby seeds share one.
fn seed_of(seed: u64, frame: u32) -> u64 {
    seed ^ (u64::from(frame) + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15)
}

/// Options that keep what there is so far need samples to keep, and a place for it.
fn check_kept(arguments: &Render, settings: &Settings, target: &Target) -> Result<()> {
    let kept = [
        (arguments.sums.is_some(), "--sums"),
        (arguments.resume, "--resume"),
        (arguments.samples.is_some(), "--samples"),
        (arguments.preview, "--preview"),
        (arguments.tev.is_some(), "--tev"),
        (arguments.groups, "--groups"),
        (arguments.components, "--components"),
    ];
    let mut given = kept.into_iter().filter_map(|(is_given, name)| is_given.then_some(name));
    let algorithm = settings.options.algorithm;
    if algorithm.is_preview()
        && let Some(name) =
            given.find(|name| algorithm == Algorithm::Fog || ["--groups", "--components"].contains(name))
    {
        let expected = "an integrator that samples whole paths";
        let preview = algorithm.name();
        let remedy = format!("remove {name}; {preview} takes seconds");
        return Err(Error::new(name, expected, format!("the preview {preview}"), remedy));
    }
    let is_part = arguments.is_part();
    if arguments.preview && (is_part || output::is_stream(&target.path)) {
        let found = if is_part { "only sums to write" } else { "a device or pipe" };
        return Err(Error::new(
            "--preview",
            "an image file to write again and again",
            found,
            "name one with -o",
        ));
    }
    match &arguments.sums {
        Some(sums) if output::is_stream(sums) => {
            let remedy = "name a plain file, or leave out --sums";
            Err(Error::new(sums.display(), "a plain file for sums", "a device or pipe", remedy))
        }
        _ => Ok(()),
    }
}

/// Renders one image and writes it; its figures.
fn shoot(setup: &Setup, task: &Task<'_>, target: &mut Target, label: Option<&str>) -> Result<Value> {
    if let Some(wanted) = task.arguments.progressive() {
        let (image, shaded) = few_pixels(setup, task, target, wanted, label)?;
        let is_without_lens = progressive::is_without_lens(&task.arguments.estimator, setup);
        let text = progressive::text(&shaded, is_without_lens);
        let mut made = task.made.clone();
        made["progressive"] = text.as_str().into();
        let task = Task { made, ..*task };
        let mut figures = deliver(setup, &task, target, image, Some(&text), label)?;
        figures["progressive"] = progressive::json(&shaded);
        return Ok(figures);
    }
    let (image, written) = match task.arguments.batches {
        None => watched(setup, task, target, label)?,
        Some(count) => (batches(setup, task, target, count, label)?, nothing()),
    };
    let samples = image.samples();
    let figures = deliver(setup, task, target, image, None, label)?;
    // The image is not lost where the sums are.
    match written? {
        (Left::Kept(file), kept) => print_kept(&file, &kept, samples, task),
        (Left::Spent(file), _) => file.remove(),
        (Left::Nothing, _) => {}
    }
    Ok(figures)
}

/// Writes an image and says what became of it; its figures.
fn deliver(
    setup: &Setup,
    task: &Task<'_>,
    target: &mut Target,
    mut image: Image,
    shaded: Option<&str>,
    label: Option<&str>,
) -> Result<Value> {
    report_faults(&image, setup);
    let mut figures = figures(&image, task);
    if !task.arguments.is_part() {
        let exposure = target.expose(&image.pixels).unwrap_or_default();
        target.write(&setup.film, &mut image, &task.made)?;
        print_summary(&image, task, target, &exposure, shaded, label);
        explain_darkness(&image, setup, task);
        if task.arguments.denoise {
            let denoised = denoise::denoise(&target.path, target.display.of(&image.pixels))?;
            say(&format!("denoised: {}", denoised.display()));
            figures["denoised"] = denoised.display().to_string().into();
        }
        figures["exposure"] = target.display.of(&image.pixels).stops.into();
        figures["image"] = target.path.display().to_string().into();
    }
    Ok(figures)
}

/// Makes a progressive picture under a progress bar.
fn few_pixels(
    setup: &Setup,
    task: &Task<'_>,
    target: &Target,
    wanted: render::progressive::Progressive,
    label: Option<&str>,
) -> Result<(Image, Shaded)> {
    let Setup { scene, film, integrator, .. } = setup;
    let settings = &task.settings;
    let bar = Bar::new(*settings, None, wanted.pixels(film.len()), label);
    let mut made = task.made.clone();
    made["progressive"] = progressive::begun(wanted.method);
    let draw = |picture: &dyn Picture| target.draw(film, picture, &made);
    let mut shown = Shown::new(task, &draw);
    let fog = (settings.options.algorithm == Algorithm::Fog).then_some(&integrator.fog);
    let layers = &integrator.layers;
    let done =
        render::progressive::run(scene, film, settings, fog, layers, wanted, &mut |progress, picture| {
            bar.show_pixels(&progress, film.len());
            shown.watch(&progress, picture);
        });
    bar.finish();
    done
}

/// What is left of the sums, and the samples in them.
type Written = Result<(Left, Samples)>;

/// Of a render that has none.
fn nothing() -> Written {
    Ok((Left::Nothing, Samples::default()))
}

/// Renders one image under a progress bar; where what there is was kept.
fn watched(setup: &Setup, task: &Task<'_>, target: &Target, label: Option<&str>) -> Result<(Image, Written)> {
    let started = Instant::now();
    let bar = Bar::new(task.settings, task.precision, setup.film.len(), label);
    let Setup { film, integrator, .. } = setup;
    let (layers, settings) = (&integrator.layers, &task.settings);
    let done = if settings.options.algorithm == Algorithm::Fog {
        let show = &mut |progress| bar.show(&progress);
        (render::preview(setup, film, settings, &integrator.fog, layers, show)?, nothing())
    } else {
        keeping(setup, task, target, &bar)?
    };
    bar.finish();
    warn_of_first_pass(task, started.elapsed());
    Ok(done)
}

/// Renders one image, from sums that there are and into those that are kept.
fn keeping(setup: &Setup, task: &Task<'_>, target: &Target, bar: &Bar) -> Result<(Image, Written)> {
    let Setup { film, integrator, .. } = setup;
    let (arguments, settings, layers) = (task.arguments, &task.settings, &integrator.layers);
    let mut file = sums_file(arguments, target);
    let mut sums = match &mut file {
        Some(file) if arguments.resume => file.resume(&task.made)?,
        _ => None,
    }
    .unwrap_or_else(|| AnySums::new(film, layers, task.precision));
    let draw = |picture: &dyn Picture| target.draw(film, picture, &task.made);
    let mut keeper = Keeper::new(file, task, &draw);
    let image = render::go_on(setup, film, settings, layers, &mut sums, &mut |progress, sums| {
        bar.show(&progress);
        keeper.watch(&progress, sums);
    });
    let kept = keeper.finish();
    Ok((image?, kept.map(|left| (left, sums.kept().samples()))))
}

fn print_kept(file: &Path, samples: &Samples, taken: f64, task: &Task<'_>) {
    let file = file.display();
    if let Some((name, _)) = interrupt::signal() {
        let count = samples_text(taken);
        let text = format!("{name} after {count} samples/pixel: continue with the same command and --resume");
        return complain(&format!("{text} ({file} has the sums)"));
    }
    say(&format!("samples {samples}: {file}"));
    if task.precision.is_some() {
        return;
    }
    if let Some(wanted) =
        wanted(task).filter(|wanted| wanted != samples && task.arguments.time_limit.is_none())
    {
        complain(&format!("warning: {file} has other samples than {wanted}: the image is of {samples}"));
    }
}

/// Renders images with consecutive seeds; their mean, with each of them as a layer. Where it is interrupted, those that
/// are finished count, or the first one if none is.
fn batches(
    setup: &Setup,
    task: &Task<'_>,
    target: &Target,
    count: u32,
    label: Option<&str>,
) -> Result<Image> {
    let mut images = Vec::new();
    for k in 0..count {
        let mut settings = task.settings;
        settings.seed = settings.seed.wrapping_add(k.into());
        settings.budget.spent = if k == 0 { settings.budget.spent } else { Duration::ZERO };
        let label =
            format!("{}batch {} of {count}", label.map_or(String::new(), |l| format!("{l}, ")), k + 1);
        let task = Task { settings, made: Value::Null, ..*task };
        let (image, _) = watched(setup, &task, target, Some(&label))?;
        if interrupt::came() {
            let has = if k == 0 { "a part of one".to_owned() } else { k.to_string() };
            complain(&format!("interrupted in batch {} of {count}: the image has {has}", k + 1));
        }
        if k == 0 || !interrupt::came() {
            images.push(image);
        }
        if interrupt::came() {
            break;
        }
    }
    Ok(match images.len() {
        1 => images.remove(0),
        _ => Image::mean_of(&images, &setup.integrator.layers, target.format),
    })
}

/// Says why an image is black, or next to it.
fn explain_darkness(image: &Image, setup: &Setup, task: &Task<'_>) {
    let options = &task.settings.options;
    let is_preview = options.algorithm == Algorithm::Fog;
    if !is_preview && let Some(reason) = darkness::reason(&image.pixels, setup, options) {
        complain(&format!("warning: {reason}"));
    }
}

/// What went wrong inside, as a warning.
fn report_faults(image: &Image, setup: &Setup) {
    let Faults { count, first } = &image.faults;
    if *count > 0 {
        let described: Vec<String> =
            first.iter().map(|fault| fault.describe(setup.film.width as usize)).collect();
        complain(&format!(
            "warning: {count} internal errors; please report them, with the scene. The first ones:\n  {}",
            described.join("\n  ")
        ));
    }
}

/// Figures of an image, for scripts.
fn figures(image: &Image, task: &Task<'_>) -> Value {
    let mut figures = serde_json::json!({
        "samples_per_pixel": image.samples_per_pixel,
        "render_seconds": image.elapsed.as_secs_f64(),
        "cpu_seconds": task.clock.seconds(),
        "relative_error": image.noise.map(|noise| noise.error),
        "relative_error_uncertainty": image.noise.map(|noise| noise.error * noise.uncertainty()),
        "profile": task.settings.profile.name(),
        "faults": image.faults.count,
    });
    if let Some(batches) = task.arguments.batches {
        figures["batches"] = batches.into();
    }
    if let Some(reached) = &image.reached {
        figures["pixels_within_error"] = reached.share.into();
        figures["least_samples"] = reached.samples.iter().min().copied().into();
        figures["most_samples"] = reached.samples.iter().max().copied().into();
    }
    figures
}

fn print_summary(
    image: &Image,
    task: &Task<'_>,
    target: &Target,
    exposure: &str,
    shaded: Option<&str>,
    label: Option<&str>,
) {
    let noise = match image.noise {
        Some(noise) => format!(", {}", noise_text(noise)),
        None if image.pixels.iter().all(|pixel| *pixel == Spectrum::ZERO) => ", no light was seen".to_owned(),
        None => String::new(),
    };
    let noise = match (&image.reached, task.precision) {
        (Some(reached), Some(Precision { error, .. })) => {
            let share = 100.0 * reached.share;
            format!("{noise}, {share:.1} % of the pixels within {}", percent(error))
        }
        _ => noise,
    };
    let noise = shaded.map_or(noise, |shaded| format!(", {shaded}"));
    let label = label.map_or(String::new(), |label| format!("{label}: "));
    let preview = target.preview().map_or(String::new(), |preview| format!(" and {}", preview.display()));
    say(&format!(
        "{label}{} samples/pixel in {:.1} s{noise}: {}{preview}{exposure}",
        samples_text(image.samples()),
        image.elapsed.as_secs_f64(),
        target.path.display(),
    ));
}

/// A first pass does not look at the time.
fn warn_of_first_pass(task: &Task<'_>, elapsed: Duration) {
    let algorithm = task.settings.options.algorithm;
    let limit = task.arguments.time_limit.filter(|limit| elapsed / 2 > *limit);
    if let Some(limit) = limit.filter(|_| algorithm.ends_in_first_pass()) {
        complain(&format!(
            "warning: --time-limit {} s was not kept: the first pass of {} is always made whole",
            limit.as_secs_f64(),
            algorithm.name()
        ));
    }
}

/// Figures for scripts: those of one image, or of every frame.
fn report(mut figures: Vec<Value>, load_seconds: f64, is_animation: bool, plan: &Plan) -> Value {
    let mut report = match is_animation {
        true => serde_json::json!({ "frames": figures }),
        false => figures.pop().unwrap_or_default(),
    };
    report["load_seconds"] = load_seconds.into();
    report["plan"] = plan.json();
    report
}
