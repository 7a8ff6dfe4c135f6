//! Rendering: passes over blocks of pixels on all threads, until a sample or time budget is spent.
//!
//! Results depend on the seed alone: every walk draws from its own stream, blocks are fixed sets of pixels, and
//! their results are added up in block order whatever thread made them.

mod block;
pub mod budget;
mod fog;
mod primary;
mod watch;

pub use watch::Snapshot;

use crate::{
    film::{
        Channel, Film,
        accumulator::Accumulator,
        format::{XYZ_ROWS, planes, to_xyz},
        layer::{Content, Layer},
    },
    math::{Spectrum, Vec3},
    scene::{Scene, integrator::Look},
    transport::{
        Estimator, Options, Strategies,
        profile::{Bounded, ChromaticFog, Everything, Fire, Fog, Profile, ProfileName, Smoke, Vacuum},
    },
};
use block::{Blocks, Outcome};
use budget::Budget;
use fog::Preview;
use rayon::prelude::*;
use std::time::Duration;
use watch::{Clock, Watch};

/// What to render and for how long.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Strategies, depth, visibility of emitters.
    pub options: Options,
    /// When to stop.
    pub budget: Budget,
    /// The same seed gives the same image, bit for bit.
    pub seed: u64,
    /// The compiled estimator to use; must have all the scene needs.
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
    /// The part of each pixel that the scene covers, in [0, 1] for filters without negative lobes; empty where
    /// nobody asked for it.
    pub alpha: Vec<f32>,
    /// The channels of all layers, in their order.
    pub layers: Vec<Channel>,
}

/// Blocks that are worked on between two looks at the clock: enough to keep any machine's threads busy, and
/// independent of their number.
const BLOCKS_AT_ONCE: usize = 64;

/// Renders `scene` onto `film`, telling `progress` now and then.
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
    let mut watch = Watch { progress, marks: &[], show: &mut |_| {} };
    dispatch(scene, film, settings, None, layers, &mut watch)
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
    dispatch(scene, film, settings, None, &[], &mut Watch { progress, marks, show })
}

/// Shows `scene` on `film` as a preview that looks like `look`, and `layers` with it. Of the options only the
/// visibility of emitters counts.
pub fn preview(
    scene: &Scene,
    film: &Film,
    settings: &Settings,
    look: &Look,
    layers: &[Layer],
    progress: &mut dyn FnMut(Progress),
) -> Image {
    let options = Options { strategies: Strategies::NONE, ..settings.options };
    let mut watch = Watch { progress, marks: &[], show: &mut |_| {} };
    dispatch(scene, film, &Settings { options, ..*settings }, Some(look), layers, &mut watch)
}

fn dispatch(
    scene: &Scene,
    film: &Film,
    settings: &Settings,
    look: Option<&Look>,
    layers: &[Layer],
    watch: &mut Watch<'_>,
) -> Image {
    match settings.profile {
        ProfileName::Vacuum => render_as::<Vacuum>(scene, film, settings, look, layers, watch),
        ProfileName::Fog => render_as::<Fog>(scene, film, settings, look, layers, watch),
        ProfileName::Bounded => render_as::<Bounded>(scene, film, settings, look, layers, watch),
        ProfileName::Smoke => render_as::<Smoke>(scene, film, settings, look, layers, watch),
        ProfileName::Fire => render_as::<Fire>(scene, film, settings, look, layers, watch),
        ProfileName::ChromaticFog => render_as::<ChromaticFog>(scene, film, settings, look, layers, watch),
        ProfileName::Everything => render_as::<Everything>(scene, film, settings, look, layers, watch),
    }
}

fn render_as<P: Profile>(
    scene: &Scene,
    film: &Film,
    settings: &Settings,
    look: Option<&Look>,
    layers: &[Layer],
    watch: &mut Watch<'_>,
) -> Image {
    let clock = Clock::start();
    let blocks = Blocks::new::<P>(film.len());
    let (per_pass, per_block) = (blocks.walks_per_pass(), blocks.walks_per_block());
    let estimator = Estimator::<P>::new(scene, settings.options, per_pass, per_block);
    let squares = layers.iter().any(Layer::needs_squares);
    let accumulator = if squares { Accumulator::with_products } else { Accumulator::new }(film.len());
    let Options { hide_emitters, seed, .. } = settings.options;
    let rays = || blocks.pilot_rays(&estimator, film, seed);
    let preview = look.map(|look| Preview::new(scene, look, hide_emitters, rays()));
    let preview = preview.as_ref();
    let job = Job { estimator: &estimator, preview, film, blocks: &blocks, settings };
    let (accumulator, noise, clock) = job.accumulate(accumulator, clock, watch);
    let passes = accumulator.passes();
    let seen = primary::Pass::new(film, layers).run(scene, &job, passes);
    let pixels = accumulator.mean();
    let layers = layers.iter().flat_map(|layer| develop(layer, &pixels, &accumulator, &seen)).collect();
    let elapsed = clock.elapsed();
    Image { pixels, samples_per_pixel: passes, elapsed, noise, alpha: seen.alpha, layers }
}

/// What does not change during a render.
struct Job<'a, P: Profile> {
    estimator: &'a Estimator<'a, P>,
    /// Shown in place of what the estimator says.
    preview: Option<&'a Preview<'a>>,
    film: &'a Film,
    blocks: &'a Blocks,
    settings: &'a Settings,
}

impl<P: Profile> Job<'_, P> {
    /// Adds up passes until the budget is spent; with the noise of their mean.
    fn accumulate(
        &self,
        mut accumulator: Accumulator,
        mut clock: Clock,
        watch: &mut Watch<'_>,
    ) -> (Accumulator, Option<f64>, Clock) {
        let Self { estimator, preview, film, blocks, settings } = *self;
        let mut pass = vec![Spectrum::ZERO; film.len()];
        let (mut next, mut noise) = (0, None);
        loop {
            let wanted = settings.budget.limit_tasks(next + BLOCKS_AT_ONCE, blocks.count());
            let tasks = next..watch.limit_tasks(wanted, accumulator.passes(), blocks.count());
            let outcomes: Vec<Outcome> = tasks
                .clone()
                .into_par_iter()
                .map(|task| {
                    let (pass, block) = (task / blocks.count(), task % blocks.count());
                    match preview {
                        None => blocks.render(estimator, film, settings.seed, pass, block),
                        Some(preview) => blocks.show(estimator, preview, film, settings.seed, pass, block),
                    }
                })
                .collect();
            for (task, outcome) in tasks.clone().zip(&outcomes) {
                outcome.add_to(&mut pass);
                if (task + 1) % blocks.count() == 0 {
                    accumulator.add(&pass);
                    pass.fill(Spectrum::ZERO);
                }
            }
            if next / blocks.count() != tasks.end / blocks.count() {
                noise = accumulator.noise();
            }
            next = tasks.end;
            let (elapsed, passes) = (clock.elapsed(), accumulator.passes());
            if next.is_multiple_of(blocks.count()) && watch.is_mark(passes) {
                let show = || {
                    (watch.show)(Snapshot { pixels: accumulator.mean(), samples_per_pixel: passes, elapsed })
                };
                clock.hold(show);
            }
            let samples = (next as u64 * film.len() as u64) / blocks.count() as u64;
            (watch.progress)(Progress { samples, passes, elapsed, noise });
            if settings.budget.is_spent(next, blocks.count(), elapsed) {
                return (accumulator, noise, clock);
            }
        }
    }
}

/// The channels of a layer. Variances are left out where a single pass does not tell them.
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
