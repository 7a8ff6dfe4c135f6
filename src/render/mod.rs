//! Rendering: passes over blocks of pixels on all threads, until a sample or time budget is spent.
//!
//! Results depend on the seed alone: every walk draws from its own stream, blocks are fixed sets of pixels, and
//! their results are added up in block order, whichever thread made them.

pub mod adaptive;
pub mod any_sums;
mod batches;
mod block;
pub mod budget;
mod compiled;
pub mod faults;
mod fill;
mod fog;
mod follower;
mod groups;
mod half;
pub mod instrument;
mod monitor;
mod observer;
pub mod pilot;
pub mod pixel_sample;
mod primary;
pub mod progressive;
mod radiance;
pub mod samples;
mod seen;
mod sorted;
pub mod strategy_images;
pub mod sums;
pub mod sums_file;
pub mod tiles;
pub mod timing;
mod tracks;
pub mod training;
mod trial;
mod turns;

pub use monitor::Snapshot;

use crate::{
    film::{
        Channel, Film,
        accumulator::Accumulator,
        format::{XYZ_ROWS, planes, to_xyz},
        layer::{Content, Layer},
        noise::Noise,
    },
    math::{Spectrum, Vec3},
    sampling::Sampler,
    scene::Scene,
    settings::integrator::FogSettings,
    transport::{Heuristic, Options, Strategies, profile::ProfileName},
};
use adaptive::{Adaptive, Halves, Precision, Reached};
use any_sums::{AnySums, Kept};
use budget::Budget;
use faults::Faults;
use fog::Preview;
use instrument::Instrument;
use monitor::{Monitor, Stopwatch};
use samples::Samples;
use seen::Seen;
use std::time::{Duration, Instant};
use sums::Sums;

/// What to render and for how long.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Strategies, depth, visibility of emitters.
    pub options: Options,
    /// Where the random numbers of walks come from.
    pub sampler: Sampler,
    /// When to stop.
    pub budget: Budget,
    /// The same seed gives the same image, bit for bit.
    pub seed: u64,
    /// The compiled estimator to use; must have all the scene needs. Heuristics other than the balance heuristic run
    /// on what [`ProfileName::weighing`] makes of it.
    pub profile: ProfileName,
}

/// How far a render is.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Pixel samples done, over all pixels.
    pub samples: u64,
    /// Passes (samples per pixel) completed.
    pub passes: u64,
    /// Time since the first sample.
    pub elapsed: Duration,
    /// Its estimated relative error, once it is known.
    pub noise: Option<Noise>,
    /// The part of the pixels that have the requested precision, if one was requested.
    pub within: Option<f64>,
    /// No more samples follow.
    pub is_last: bool,
}

/// A finished render.
#[derive(Clone, Debug)]
pub struct Image {
    /// Row-major radiance, top row first.
    pub pixels: Vec<Spectrum>,
    /// Samples of every pixel.
    pub samples_per_pixel: u64,
    /// The fraction of the pixels that have one more, where the time ended before all had it.
    pub unfinished: f64,
    /// Time spent on samples, and on pilots and learning before them.
    pub elapsed: Duration,
    /// Its estimated relative error, once it is known.
    pub noise: Option<Noise>,
    /// The part of each pixel that the scene covers, in [0, 1] for filters without negative lobes; empty
    /// where it was not requested.
    pub alpha: Vec<f32>,
    /// The channels of all layers, in their order.
    pub layers: Vec<Channel>,
    /// How far a requested precision was reached, if one was requested.
    pub reached: Option<Reached>,
    /// What went wrong on the way.
    pub faults: Faults,
}

impl Image {
    /// Samples per pixel, on average.
    pub fn samples(&self) -> f64 {
        self.samples_per_pixel as f64 + self.unfinished
    }
}

/// Renders `scene` onto `film`, reporting to `progress` now and then.
pub fn render(scene: &Scene, film: &Film, settings: &Settings, progress: &mut dyn FnMut(Progress)) -> Image {
    render_layers(scene, film, settings, &[], progress)
}

/// Renders `scene` onto `film`, and `layers` with it.
pub fn render_layers(
    scene: &Scene,
    film: &Film,
    settings: &Settings,
    layers: &[Layer],
    progress: &mut dyn FnMut(Progress),
) -> Image {
    let mut sums = AnySums::new(film, layers, None);
    go_on(scene, film, settings, layers, &mut sums, &mut |reached, _| progress(reached))
}

/// Renders `scene` onto `film`, and shows the image after each of `marks` (samples per pixel, in growing order, none
/// beyond the budget).
pub fn render_in_steps(
    scene: &Scene,
    film: &Film,
    settings: &Settings,
    marks: &[u64],
    progress: &mut dyn FnMut(Progress),
    show: &mut dyn FnMut(Snapshot),
) -> Image {
    let mut monitor = Monitor { watch: &mut |reached, _| progress(reached), marks, show };
    dispatch(scene, film, settings, Mode::Budget(&mut Sums::new(film, false, 0)), &[], &mut monitor)
}

/// Renders `scene` onto `film`, and `layers` with it, until every pixel is known with `precision` or the budget of
/// `settings` is spent. Layers of moments need passes over all pixels and are left out.
pub fn render_to_precision(
    scene: &Scene,
    film: &Film,
    settings: &Settings,
    precision: Precision,
    layers: &[Layer],
    progress: &mut dyn FnMut(Progress),
) -> Image {
    let mut sums = AnySums::new(film, layers, Some(precision));
    go_on(scene, film, settings, layers, &mut sums, &mut |reached, _| progress(reached))
}

/// Goes on from `sums`, which are of the same scene, film, layers and settings (but for the budget). `watch` sees the
/// progress and the sums now and then.
pub fn go_on(
    scene: &Scene,
    film: &Film,
    settings: &Settings,
    layers: &[Layer],
    sums: &mut AnySums,
    watch: &mut dyn FnMut(Progress, &dyn Kept),
) -> Image {
    match sums {
        AnySums::Samples(sums) => {
            let watch = &mut |progress, sums: &Sums| watch(progress, sums);
            let mut monitor = Monitor { watch, marks: &[], show: &mut |_| {} };
            dispatch(scene, film, settings, Mode::Budget(sums), layers, &mut monitor)
        }
        AnySums::Adaptive(halves) => {
            let (stopwatch, started) = (Stopwatch::start(), Instant::now());
            let bench =
                &Instrument::new(scene, film, settings).sorting(layers).with_precision(halves.precision);
            let watch = &mut |progress, halves: &Halves| watch(progress, halves);
            Adaptive { bench, stopwatch: &stopwatch, watch }.run(halves);
            finish(bench, started, halves, layers)
        }
    }
}

/// Shows `scene` on `film` as a preview that looks like `fog`, and `layers` with it. Of the options only the
/// visibility of emitters counts.
pub fn preview(
    scene: &Scene,
    film: &Film,
    settings: &Settings,
    fog: &FogSettings,
    layers: &[Layer],
    progress: &mut dyn FnMut(Progress),
) -> Image {
    let options = Options { strategies: Strategies::NONE, heuristic: Heuristic::Balance, ..settings.options };
    let watch = &mut |reached, _: &Sums| progress(reached);
    let mut monitor = Monitor { watch, marks: &[], show: &mut |_| {} };
    let mode = Mode::Preview(fog, &mut Sums::new(film, layers.iter().any(Layer::needs_squares), 0));
    dispatch(scene, film, &Settings { options, ..*settings }, mode, layers, &mut monitor)
}

/// What a render computes from its samples.
enum Mode<'a> {
    /// An image, as good as the budget allows.
    Budget(&'a mut Sums),
    /// A preview.
    Preview(&'a FogSettings, &'a mut Sums),
}

fn dispatch(
    scene: &Scene,
    film: &Film,
    settings: &Settings,
    mode: Mode<'_>,
    layers: &[Layer],
    monitor: &mut Monitor<'_>,
) -> Image {
    let (stopwatch, started) = (Stopwatch::start(), Instant::now());
    let bench = Instrument::new(scene, film, settings).sorting(layers);
    let (preview, sums) = match mode {
        Mode::Preview(fog, sums) => {
            let rays = bench.compiled.blocks().pilot_rays(scene, film, settings.seed);
            (Some(Preview::new(scene, fog, settings.options.hide_emitters, rays)), sums)
        }
        Mode::Budget(sums) => (None, sums),
    };
    accumulate(&bench, preview.as_ref(), sums, stopwatch, monitor);
    let image = sums.image();
    let seen =
        primary::Pass::new(film, layers).run(&bench, image.samples_per_pixel.max(1), late(settings, started));
    let known = Known { pixels: &image.pixels, passes: &sums.accumulator, seen: &seen };
    let layers = known.channels(layers, |plane| sums.plane(plane));
    Image { alpha: seen.alpha, layers, ..image }
}

/// True once alpha and layers, which come after the samples, take too long for the budget of a render that began at
/// `started`.
fn late(settings: &Settings, started: Instant) -> impl Fn() -> bool {
    const GRACE: Duration = Duration::from_millis(100);
    let budget = settings.budget;
    move || budget.is_over(started.elapsed().saturating_sub(GRACE))
}

/// The image of an adaptive render that began at `started`, with alpha, `layers`, and one more that shows how many samples
/// its pixels took.
fn finish(bench: &Instrument<'_>, started: Instant, halves: &Halves, layers: &[Layer]) -> Image {
    let seen = Seen::new(bench);
    let image = Image { noise: halves.noise(&|pixel| seen.of(pixel)), ..halves.image() };
    let (passes, is_over) = (image.samples_per_pixel.max(1), late(&bench.settings, started));
    let seen = primary::Pass::new(bench.film, layers).run(bench, passes, is_over);
    let known = Known { pixels: &image.pixels, passes: &Accumulator::new(0), seen: &seen };
    let mut layers = known.channels(layers, |plane| halves.plane(plane));
    let samples = image.reached.iter().flat_map(|reached| &reached.samples);
    layers.push(Channel { name: "samples.N".to_owned(), values: samples.map(|n| *n as f32).collect() });
    Image { alpha: seen.alpha, layers, ..image }
}

/// Time between two estimates of the noise, which look at every pixel.
const NOISE_EVERY: Duration = Duration::from_millis(100);

/// Adds samples until the budget is spent. A preview is shown in place of what the estimator says.
fn accumulate(
    bench: &Instrument<'_>,
    preview: Option<&Preview<'_>>,
    sums: &mut Sums,
    mut stopwatch: Stopwatch,
    monitor: &mut Monitor<'_>,
) {
    let Instrument { film, settings: Settings { budget, seed, .. }, compiled, .. } = bench;
    let (blocks, before) = (compiled.blocks(), sums.elapsed + budget.spent);
    let queue = Queue::new(budget, sums, blocks.count());
    let (mut next, mut noted) = (sums.blocks.min(queue.end), Instant::now());
    let seen = Seen::new(bench);
    // However long that takes, or no time would be enough to go on.
    if next < queue.end {
        bench.learn(queue.sample(next) as usize, &|| false);
    }
    loop {
        let passes = (next / queue.per_pass) as u64;
        let tasks = next..monitor.limit_tasks(queue.end, passes, queue.per_pass);
        let is_over = || budget.is_over(stopwatch.elapsed());
        let pass = |task| queue.sample(task) as usize;
        let render = |pass, block| match preview {
            None => bench.render(pass, block, &|_| true),
            Some(preview) => blocks.show(preview, film, *seed, pass, block),
        };
        let done = bench.work_in_turn(tasks.clone(), pass, is_over, render, |first, outcomes| {
            for (task, outcome) in (first..).zip(outcomes) {
                sums.add(queue.sample(task), outcome, queue.per_pass);
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
        let (elapsed, samples_per_pixel) = (stopwatch.elapsed(), sums.samples.count());
        if next.is_multiple_of(queue.per_pass) && monitor.is_mark(samples_per_pixel) {
            let pixels = || sums.accumulator.mean();
            let elapsed = budget.spent + elapsed;
            stopwatch.hold(|| (monitor.show)(Snapshot { pixels: pixels(), samples_per_pixel, elapsed }));
        }
        if next == queue.end || done < tasks.len() {
            sums.elapsed = before + elapsed;
            sums.note_last_noise(&|pixel| seen.of(pixel));
            return (monitor.watch)(sums.progress(elapsed, true), sums);
        }
    }
}

/// The blocks that are to be rendered, numbered over the passes that are missing. Of the first of these, some may be done.
struct Queue {
    had: Samples,
    first: u64,
    per_pass: usize,
    /// How many.
    end: usize,
}

impl Queue {
    /// What `budget` wants besides what `sums` have; blocks of another pass are left out of them.
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

    /// The number of the sample that `task` belongs to.
    fn sample(&self, task: usize) -> u64 {
        self.had.missing(self.first, (task / self.per_pass) as u64)
    }
}

/// What is known of an image, for its layers.
struct Known<'a> {
    pixels: &'a [Spectrum],
    passes: &'a Accumulator,
    seen: &'a primary::Seen,
}

impl Known<'_> {
    /// The channels of all `layers`; those that contributions are sorted into are planes in their order, from 1 on.
    fn channels(&self, layers: &[Layer], plane: impl Fn(usize) -> Vec<Spectrum>) -> Vec<Channel> {
        let mut sorted = 0;
        let mut channels = Vec::new();
        for layer in layers {
            let values = if layer.is_sorted() {
                sorted += 1;
                planes(plane(sorted).iter().copied())
            } else {
                self.develop(layer)
            };
            let named = layer.channel_names().zip(values);
            channels.extend(named.map(|(name, values)| Channel { name, values }));
        }
        channels
    }

    /// The values of a layer, channel by channel. Variances are left out where a single pass cannot estimate them.
    fn develop(&self, layer: &Layer) -> Vec<Vec<f32>> {
        let Self { pixels, passes, seen } = self;
        match layer.content {
            Content::Surface(quantity) => seen.of(quantity),
            Content::Image => {
                let mut values = planes(pixels.iter().copied());
                values.push(seen.alpha.clone());
                values
            }
            Content::Mean => planes(pixels.iter().map(|pixel| to_xyz(*pixel))),
            Content::SecondMoment => XYZ_ROWS.iter().map(|row| passes.second_moment(*row)).collect(),
            Content::Variance => Vec3::AXES.iter().filter_map(|row| passes.variance(*row)).collect(),
            // Sorted, not developed.
            Content::Part(_) => Vec::new(),
        }
    }
}
