//! Rendering: passes over blocks of pixels on all threads, until a sample or time budget is spent.
//!
//! Results depend on the seed alone: every walk draws from its own stream, blocks are fixed sets of pixels, and
//! their results are added up in block order whatever thread made them.

mod block;
pub mod budget;

use crate::{
    film::{Film, accumulator::Accumulator},
    math::Spectrum,
    scene::Scene,
    transport::{
        Estimator, Options,
        profile::{Bounded, ChromaticFog, Everything, Fog, Profile, ProfileName, Vacuum},
    },
};
use block::{Blocks, Outcome};
use budget::Budget;
use rayon::prelude::*;
use std::time::{Duration, Instant};

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
}

/// Blocks that are worked on between two looks at the clock: enough to keep any machine's threads busy, and
/// independent of their number.
const BLOCKS_AT_ONCE: usize = 64;

/// Renders `scene` onto `film`, telling `progress` now and then.
pub fn render(scene: &Scene, film: &Film, settings: &Settings, progress: &mut dyn FnMut(Progress)) -> Image {
    match settings.profile {
        ProfileName::Vacuum => render_as::<Vacuum>(scene, film, settings, progress),
        ProfileName::Fog => render_as::<Fog>(scene, film, settings, progress),
        ProfileName::Bounded => render_as::<Bounded>(scene, film, settings, progress),
        ProfileName::ChromaticFog => render_as::<ChromaticFog>(scene, film, settings, progress),
        ProfileName::Everything => render_as::<Everything>(scene, film, settings, progress),
    }
}

fn render_as<P: Profile>(
    scene: &Scene,
    film: &Film,
    settings: &Settings,
    progress: &mut dyn FnMut(Progress),
) -> Image {
    let started = Instant::now();
    let blocks = Blocks::new::<P>(film.len());
    let (per_pass, per_block) = (blocks.walks_per_pass(), blocks.walks_per_block());
    let estimator = Estimator::<P>::new(scene, settings.options, per_pass, per_block);
    let mut accumulator = Accumulator::new(film.len());
    let mut pass = vec![Spectrum::ZERO; film.len()];
    let (mut next, mut noise) = (0, None);
    loop {
        let tasks = next..settings.budget.limit_tasks(next + BLOCKS_AT_ONCE, blocks.count());
        let outcomes: Vec<Outcome> = tasks
            .clone()
            .into_par_iter()
            .map(|task| {
                blocks.render(&estimator, film, settings.seed, task / blocks.count(), task % blocks.count())
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
        let (elapsed, passes) = (started.elapsed(), accumulator.passes());
        let samples = (next as u64 * film.len() as u64) / blocks.count() as u64;
        progress(Progress { samples, passes, elapsed, noise });
        if settings.budget.is_spent(next, blocks.count(), elapsed) {
            break;
        }
    }
    Image {
        pixels: accumulator.mean(),
        samples_per_pixel: accumulator.passes(),
        elapsed: started.elapsed(),
        noise,
    }
}
