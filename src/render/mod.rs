//! Rendering: passes over blocks of pixels on all threads, until a sample or time budget is spent.
//!
//! Results depend on the seed alone: every walk draws from its own stream, blocks are fixed sets of pixels, and
//! their results are added up in block order, whichever thread made them.

mod adaptive;
mod fog;
pub mod image;
pub mod instrument;
mod known;
mod layers;
mod monitor;
mod primary;
pub mod progressive;
mod seen;
mod subject;
pub mod sums;
mod turns;

pub use crate::passes::Settings;
pub use image::{Image, Precision, Progress, Reached, Snapshot};
pub use subject::{Stage, Subject};

use crate::{
    error::Result,
    film::{Channel, Film, accumulator::Accumulator, layer::Layer},
    passes::budget::Budget,
    settings::integrator::FogSettings,
    transport::{Algorithm, Heuristic, Options, Strategies},
};
use adaptive::Adaptive;
use fog::Preview;
use instrument::Instrument;
use known::{Known, late};
use monitor::{Monitor, Stopwatch};
use seen::Seen;
use std::time::{Duration, Instant};
use sums::{AnySums, Halves, Kept, Sums, samples::Samples};

/// Renders `subject` onto `film`, reporting to `progress` now and then.
pub fn render<'a>(
    subject: impl Into<Subject<'a>>,
    film: &Film,
    settings: &Settings,
    progress: &mut dyn FnMut(Progress),
) -> Result<Image> {
    render_layers(subject, film, settings, &[], progress)
}

/// Renders `subject` onto `film`, and `layers` with it.
pub fn render_layers<'a>(
    subject: impl Into<Subject<'a>>,
    film: &Film,
    settings: &Settings,
    layers: &[Layer],
    progress: &mut dyn FnMut(Progress),
) -> Result<Image> {
    let mut sums = AnySums::new(film, layers, None);
    go_on(subject, film, settings, layers, &mut sums, &mut |reached, _| progress(reached))
}

/// Renders `subject` onto `film`, and shows the image after each of `marks` (samples per pixel, in growing order, none
/// beyond the budget).
pub fn render_in_steps<'a>(
    subject: impl Into<Subject<'a>>,
    film: &Film,
    settings: &Settings,
    marks: &[u64],
    progress: &mut dyn FnMut(Progress),
    show: &mut dyn FnMut(Snapshot),
) -> Result<Image> {
    let mut monitor = Monitor { watch: &mut |reached, _| progress(reached), marks, show };
    dispatch(subject.into(), film, settings, Mode::Budget(&mut Sums::new(film, false, 0)), &[], &mut monitor)
}

/// Renders `subject` onto `film`, and `layers` with it, until every pixel is known with `precision` or the budget of
/// `settings` is spent. Layers of moments need passes over all pixels and are left out.
pub fn render_to_precision<'a>(
    subject: impl Into<Subject<'a>>,
    film: &Film,
    settings: &Settings,
    precision: Precision,
    layers: &[Layer],
    progress: &mut dyn FnMut(Progress),
) -> Result<Image> {
    let mut sums = AnySums::new(film, layers, Some(precision));
    go_on(subject, film, settings, layers, &mut sums, &mut |reached, _| progress(reached))
}

/// Resumes from `sums` of the same scene, film, layers and settings (except the budget). `watch` sees the progress and
/// the sums now and then.
pub fn go_on<'a>(
    subject: impl Into<Subject<'a>>,
    film: &Film,
    settings: &Settings,
    layers: &[Layer],
    sums: &mut AnySums,
    watch: &mut dyn FnMut(Progress, &dyn Kept),
) -> Result<Image> {
    match sums {
        AnySums::Samples(sums) => {
            let watch = &mut |progress, sums: &Sums| watch(progress, sums);
            let mut monitor = Monitor { watch, marks: &[], show: &mut |_| {} };
            dispatch(subject.into(), film, settings, Mode::Budget(sums), layers, &mut monitor)
        }
        AnySums::Adaptive(halves) => {
            let (stopwatch, started) = (Stopwatch::start(), Instant::now());
            // Pixels need different numbers of samples.
            let settings = &Settings { film_samples: settings.film_samples.unshared(), ..*settings };
            let stage = &Stage::new(subject.into(), film, settings, layers, Some(halves.precision));
            let watch = &mut |progress, halves: &Halves| watch(progress, halves);
            Adaptive { stage, stopwatch: &stopwatch, watch }.run(halves)?;
            finish(stage, started, halves, layers)
        }
    }
}

/// Shows `subject` on `film` as a preview that looks like `fog`, and `layers` with it. Of the options only the
/// visibility of emitters counts.
pub fn preview<'a>(
    subject: impl Into<Subject<'a>>,
    film: &Film,
    settings: &Settings,
    fog: &FogSettings,
    layers: &[Layer],
    progress: &mut dyn FnMut(Progress),
) -> Result<Image> {
    let (algorithm, strategies) = (Algorithm::Fog, Strategies::NONE);
    let options = Options { algorithm, strategies, heuristic: Heuristic::Balance, ..settings.options };
    let watch = &mut |reached, _: &Sums| progress(reached);
    let mut monitor = Monitor { watch, marks: &[], show: &mut |_| {} };
    let mode = Mode::Preview(fog, &mut Sums::new(film, layers.iter().any(Layer::needs_squares), 0));
    dispatch(subject.into(), film, &Settings { options, ..*settings }, mode, layers, &mut monitor)
}

/// What a render computes from its samples.
enum Mode<'a> {
    /// An image, as good as the budget allows.
    Budget(&'a mut Sums),
    /// A preview.
    Preview(&'a FogSettings, &'a mut Sums),
}

fn dispatch(
    subject: Subject<'_>,
    film: &Film,
    settings: &Settings,
    mode: Mode<'_>,
    layers: &[Layer],
    monitor: &mut Monitor<'_>,
) -> Result<Image> {
    let (stopwatch, started) = (Stopwatch::start(), Instant::now());
    let stage = Stage::new(subject, film, settings, layers, None);
    let (fog, sums) = match mode {
        Mode::Preview(fog, sums) => (Some(fog), sums),
        Mode::Budget(sums) => (None, sums),
    };
    accumulate(&stage, fog, sums, stopwatch, monitor)?;
    let image = sums.image();
    let passes = image.samples_per_pixel.max(1);
    let seen = primary::Pass::new(film, layers).run(&stage, passes, late(settings, started))?;
    let known = Known { pixels: &image.pixels, passes: &sums.accumulator, seen: &seen };
    let layers = known.channels(layers, |plane| sums.plane(plane));
    Ok(Image { alpha: seen.alpha, layers, ..image })
}

/// The image of an adaptive render that began at `started`, with alpha, `layers`, and one more that shows how many samples
/// its pixels took.
fn finish(stage: &Stage<'_>, started: Instant, halves: &Halves, layers: &[Layer]) -> Result<Image> {
    let instrument = &stage.instrument;
    let seen = Seen::new(instrument);
    let image = Image { noise: halves.noise(&|pixel| seen.of(pixel)), ..halves.image() };
    let (passes, is_over) = (image.samples_per_pixel.max(1), late(&instrument.settings, started));
    let seen = primary::Pass::new(instrument.film, layers).run(stage, passes, is_over)?;
    let known = Known { pixels: &image.pixels, passes: &Accumulator::new(0), seen: &seen };
    let mut layers = known.channels(layers, |plane| halves.plane(plane));
    let samples = image.reached.iter().flat_map(|reached| &reached.samples);
    layers.push(Channel { name: "samples.N".to_owned(), values: samples.map(|n| *n as f32).collect() });
    Ok(Image { alpha: seen.alpha, layers, ..image })
}

/// Time between two estimates of the noise, which look at every pixel.
const NOISE_EVERY: Duration = Duration::from_millis(100);

/// Adds samples until the budget is spent: of the estimator, or of the preview `fog`.
fn accumulate(
    stage: &Stage<'_>,
    fog: Option<&FogSettings>,
    sums: &mut Sums,
    mut stopwatch: Stopwatch,
    monitor: &mut Monitor<'_>,
) -> Result<()> {
    let Instrument { settings, compiled, .. } = &stage.instrument;
    let budget = &settings.budget;
    let before = sums.elapsed + budget.spent;
    let queue = Queue::new(budget, sums, compiled.blocks().count());
    let (mut next, mut noted) = (sums.blocks.min(queue.end), Instant::now());
    let seen = Seen::new(&stage.instrument);
    // However long learning takes: otherwise short budgets would never make progress.
    if next < queue.end {
        stage.instrument.learn(queue.sample(next) as usize, &|| false);
    }
    let mut is_ended = next == queue.end;
    while !is_ended {
        let passes = (next / queue.per_pass) as u64;
        let end = monitor.limit_tasks(queue.end, passes, queue.per_pass);
        is_ended = stage.show(queue.sample(next), |instrument, most| {
            let tasks = next..end.min(queue.end_of(next, most));
            let is_over = || budget.is_over(stopwatch.elapsed());
            let pass = |task| queue.sample(task) as usize;
            let preview = fog.map(|fog| Preview::of(&*instrument.compiled, fog, settings));
            let render = |pass, block| match &preview {
                None => instrument.render(pass, block, &|_| true),
                Some(preview) => {
                    let compiled = &*instrument.compiled;
                    preview.show(compiled, pass, compiled.blocks().pixels(pass, block))
                }
            };
            let done = instrument.work_in_turn(tasks.clone(), pass, is_over, render, |first, outcomes| {
                for (task, outcome) in (first..).zip(outcomes) {
                    let sample = queue.sample(task);
                    let sharing = instrument.compiled.sharing(sample as usize);
                    sums.add(sample, outcome, queue.per_pass, sharing.as_ref());
                }
                if noted.elapsed() > NOISE_EVERY {
                    sums.note_noise(&|pixel| seen.of(pixel));
                    noted = Instant::now();
                }
                let elapsed = stopwatch.elapsed();
                sums.elapsed = before + elapsed;
                (monitor.watch)(sums.progress(elapsed, false), sums);
            });
            next += done;
            // A moving scene on one block has one task per call, which always finishes: by `done` alone, it would never end.
            next == queue.end || done < tasks.len() || is_over()
        })?;
        let (elapsed, samples_per_pixel) = (stopwatch.elapsed(), sums.samples.count());
        sums.elapsed = before + elapsed;
        if next.is_multiple_of(queue.per_pass) && monitor.is_mark(samples_per_pixel) {
            let pixels = || sums.accumulator.mean();
            let elapsed = budget.spent + elapsed;
            stopwatch.hold(|| (monitor.show)(Snapshot { pixels: pixels(), samples_per_pixel, elapsed }));
        }
    }
    sums.note_last_noise(&|pixel| seen.of(pixel));
    (monitor.watch)(sums.progress(stopwatch.elapsed(), true), sums);
    Ok(())
}

/// The blocks to render, numbered over the missing passes. Some blocks of the first pass may be done.
struct Queue {
    had: Samples,
    first: u64,
    per_pass: usize,
    /// How many.
    end: usize,
}

impl Queue {
    /// The samples that `budget` wants and `sums` lack. Drops unfinished blocks of another pass from `sums`.
    fn new(budget: &Budget, sums: &mut Sums, per_pass: usize) -> Self {
        let (had, wanted) = (sums.samples.clone(), budget.wanted());
        let passes = usize::try_from(had.missing_of(&wanted));
        let end = passes.map_or(usize::MAX, |passes| passes.saturating_mul(per_pass));
        let queue = Self { had, first: wanted.start, per_pass, end };
        match end {
            0 => drop(sums.drop_unfinished()),
            _ => sums.start(queue.sample(0)),
        }
        queue
    }

    /// The end of the tasks of `passes` passes, from the pass of `task` on.
    fn end_of(&self, task: usize, passes: usize) -> usize {
        (task / self.per_pass).saturating_add(passes).saturating_mul(self.per_pass)
    }

    /// The number of the sample that `task` belongs to.
    fn sample(&self, task: usize) -> u64 {
        self.had.missing(self.first, (task / self.per_pass) as u64)
    }
}
