//! Rendering: passes over blocks of pixels on all threads, until a sample or time budget is spent.
//!
//! Results depend on the seed alone: every walk draws from its own stream, blocks are fixed sets of pixels, and
//! their results are added up in block order, whichever thread made them.

pub mod adaptive;
mod batches;
mod block;
pub mod budget;
mod compiled;
mod fog;
pub mod instrument;
mod monitor;
mod observer;
pub mod pixel_sample;
mod primary;
pub mod strategy_images;
pub mod timing;

pub use monitor::Snapshot;

use crate::{
    film::{
        Channel, Film,
        accumulator::Accumulator,
        format::{XYZ_ROWS, planes, to_xyz},
        layer::{Content, Layer},
    },
    math::{Spectrum, Vec3},
    sampling::Sampler,
    scene::Scene,
    settings::integrator::FogSettings,
    transport::{Heuristic, Options, Strategies, profile::ProfileName},
};
use adaptive::{Adaptive, Developed, Precision, Reached};
use budget::Budget;
use fog::Preview;
use instrument::{BLOCKS_AT_ONCE, Instrument};
use monitor::{Monitor, Stopwatch};
use std::time::Duration;

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
    /// See [`Accumulator::noise`].
    pub noise: Option<f64>,
    /// The part of the pixels that have the requested precision, if one was requested.
    pub within: Option<f64>,
}

/// A finished render.
#[derive(Clone, Debug)]
pub struct Image {
    /// Row-major radiance, top row first.
    pub pixels: Vec<Spectrum>,
    /// Samples per pixel.
    pub samples_per_pixel: u64,
    /// Time spent on samples, pilot walks included.
    pub elapsed: Duration,
    /// See [`Accumulator::noise`].
    pub noise: Option<f64>,
    /// The part of each pixel that the scene covers, in [0, 1] for filters without negative lobes; empty
    /// where it was not requested.
    pub alpha: Vec<f32>,
    /// The channels of all layers, in their order.
    pub layers: Vec<Channel>,
    /// How far a requested precision was reached, if one was requested.
    pub reached: Option<Reached>,
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
    let mut monitor = Monitor { progress, marks: &[], show: &mut |_| {} };
    dispatch(scene, film, settings, Mode::Budget, layers, &mut monitor)
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
    dispatch(scene, film, settings, Mode::Budget, &[], &mut Monitor { progress, marks, show })
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
    let mut monitor = Monitor { progress, marks: &[], show: &mut |_| {} };
    dispatch(scene, film, settings, Mode::Precision(precision), layers, &mut monitor)
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
    let mut monitor = Monitor { progress, marks: &[], show: &mut |_| {} };
    dispatch(scene, film, &Settings { options, ..*settings }, Mode::Preview(fog), layers, &mut monitor)
}

/// What a render computes from its samples.
#[derive(Clone, Copy)]
enum Mode<'a> {
    /// An image, as good as the budget allows.
    Budget,
    /// An image that is good enough everywhere.
    Precision(Precision),
    /// A preview.
    Preview(&'a FogSettings),
}

fn dispatch(
    scene: &Scene,
    film: &Film,
    settings: &Settings,
    mode: Mode<'_>,
    layers: &[Layer],
    monitor: &mut Monitor<'_>,
) -> Image {
    let stopwatch = Stopwatch::start();
    let bench = Instrument::new(scene, film, settings);
    let preview = match mode {
        Mode::Precision(precision) => {
            let found = Adaptive::new(&bench, precision, &stopwatch).run(monitor.progress);
            return finish(&bench, &stopwatch, found, layers);
        }
        Mode::Preview(fog) => {
            let rays = bench.compiled.blocks().pilot_rays(scene, film, settings.seed);
            Some(Preview::new(scene, fog, settings.options.hide_emitters, rays))
        }
        Mode::Budget => None,
    };
    let squares = layers.iter().any(Layer::needs_squares);
    let accumulator = if squares { Accumulator::with_products } else { Accumulator::new }(film.len());
    let (accumulator, noise, stopwatch) =
        accumulate(&bench, preview.as_ref(), accumulator, stopwatch, monitor);
    let passes = accumulator.passes();
    let seen = primary::Pass::new(film, layers).run(&bench, passes);
    let pixels = accumulator.mean();
    let layers = layers.iter().flat_map(|layer| develop(layer, &pixels, &accumulator, &seen)).collect();
    let elapsed = stopwatch.elapsed();
    Image { pixels, samples_per_pixel: passes, elapsed, noise, alpha: seen.alpha, layers, reached: None }
}

/// The image of an adaptive render, with a layer that shows how many samples its pixels took.
fn finish(bench: &Instrument<'_>, stopwatch: &Stopwatch, found: Developed, layers: &[Layer]) -> Image {
    let Developed { pixels, passes, noise, reached } = found;
    let taken: u64 = reached.samples.iter().map(|n| u64::from(*n)).sum();
    let mean = (taken / reached.samples.len().max(1) as u64).clamp(1, passes);
    let seen = primary::Pass::new(bench.film, layers).run(bench, mean);
    let none = Accumulator::new(0);
    let mut layers: Vec<_> = layers.iter().flat_map(|layer| develop(layer, &pixels, &none, &seen)).collect();
    let values = reached.samples.iter().map(|n| *n as f32).collect();
    layers.push(Channel { name: "samples.N".to_owned(), values });
    let (elapsed, reached) = (stopwatch.elapsed(), Some(reached));
    Image { pixels, samples_per_pixel: mean, elapsed, noise, alpha: seen.alpha, layers, reached }
}

/// Adds up passes until the budget is spent; with the noise of their mean. A preview is shown in place of what the
/// estimator says.
fn accumulate(
    bench: &Instrument<'_>,
    preview: Option<&Preview<'_>>,
    mut accumulator: Accumulator,
    mut stopwatch: Stopwatch,
    monitor: &mut Monitor<'_>,
) -> (Accumulator, Option<f64>, Stopwatch) {
    let Instrument { film, settings: Settings { budget, seed, .. }, compiled, .. } = bench;
    let (blocks, count) = (compiled.blocks(), compiled.blocks().count());
    let mut pass = vec![Spectrum::ZERO; film.len()];
    let (mut next, mut noise) = (0, None);
    loop {
        let wanted = budget.limit_tasks(next + BLOCKS_AT_ONCE, count);
        let tasks = next..monitor.limit_tasks(wanted, accumulator.passes(), count);
        let outcomes = bench.work(tasks.clone(), |pass, block| match preview {
            None => compiled.render(pass, block, &|_| true),
            Some(preview) => blocks.show(preview, film, *seed, pass, block),
        });
        for (task, outcome) in tasks.clone().zip(&outcomes) {
            outcome.add_to(&mut pass);
            if (task + 1) % count == 0 {
                accumulator.add(&pass);
                pass.fill(Spectrum::ZERO);
            }
        }
        if next / count != tasks.end / count {
            noise = accumulator.noise();
        }
        next = tasks.end;
        let (elapsed, passes) = (stopwatch.elapsed(), accumulator.passes());
        if next.is_multiple_of(count) && monitor.is_mark(passes) {
            let show = || {
                (monitor.show)(Snapshot { pixels: accumulator.mean(), samples_per_pixel: passes, elapsed })
            };
            stopwatch.hold(show);
        }
        let samples = (next as u64 * film.len() as u64) / count as u64;
        (monitor.progress)(Progress { samples, passes, elapsed, noise, within: None });
        if budget.is_spent(next, count, elapsed) {
            return (accumulator, noise, stopwatch);
        }
    }
}

/// The channels of a layer. Variances are left out where a single pass cannot estimate them.
fn develop(layer: &Layer, pixels: &[Spectrum], passes: &Accumulator, seen: &primary::Seen) -> Vec<Channel> {
    let values = match layer.content {
        Content::Surface(quantity) => seen.of(quantity),
        Content::Image => {
            let mut values = planes(pixels.iter().copied());
            values.push(seen.alpha.clone());
            values
        }
        Content::Mean => planes(pixels.iter().map(|pixel| to_xyz(*pixel))),
        Content::SecondMoment => XYZ_ROWS.iter().map(|row| passes.second_moment(*row)).collect(),
        Content::Variance => Vec3::AXES.iter().filter_map(|row| passes.variance(*row)).collect(),
    };
    layer.channel_names().zip(values).map(|(name, values)| Channel { name, values }).collect()
}
