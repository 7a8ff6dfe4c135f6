//! The compiled estimator: chosen once, outermost. What lies behind [`Compiled`] is compiled for every profile, so only
//! what walks through the scene belongs there; loops over passes, sums and files are compiled once.

use super::{
    Settings,
    block::{Blocks, Outcome, PIXELS_PER_BLOCK},
    faults::guarded,
    pilot::{self, Forecast},
    pixel_sample::{self, EyeSample, Splat, Walk},
    radiance::{self, Looks},
    sorted::{self, Sorter},
    strategy_images::{self, CellContribution, StrategyTable},
    timing::{self, Times},
    training,
    trial::Trial,
};
use crate::{
    film::Film,
    guide::Learnt,
    math::{Channels, Spectrum},
    sampling::Stream,
    scene::Scene,
    shape::Ray,
    transport::{
        Connections, Estimator, Heuristic, Interaction, Options,
        profile::{
            Bounded, ByCompared, ByCutoff, ByKind, ChromaticFog, Everything, Fire, Fog, Guided, Profile,
            ProfileName, Smoke, Vacuum,
        },
    },
};
use std::ops::Range;

/// What every estimator can do, whatever its profile: whole blocks and walks, so that the call costs nothing.
pub(super) trait Compiled: Send + Sync {
    /// How pixels are divided.
    fn blocks(&self) -> &Blocks;
    /// See [`Blocks::render`]; with a `sorter`, [`sorted::block`].
    fn render(
        &self,
        sorter: Option<&Sorter>,
        pass: usize,
        block: usize,
        wants: &dyn Fn(usize) -> bool,
    ) -> Outcome;
    /// See [`Blocks::shade`].
    fn shade(&self, pass: usize, block: usize, pixels: &[u32]) -> Outcome;
    /// See [`Estimator::transmittance`].
    fn transmittance(&self, primary: Ray, stream: &mut Stream) -> Spectrum;
    /// See [`Estimator::first_interaction`].
    fn first_interaction(&self, primary: Ray, stream: &mut Stream) -> Option<Interaction>;
    /// See [`strategy_images::block`].
    fn parts(&self, table: StrategyTable, pass: usize, block: usize) -> Vec<CellContribution>;
    /// See [`timing::block`].
    fn time(&self, table: StrategyTable, pass: usize, block: usize) -> Times;
    /// See [`pixel_sample::camera`].
    fn eye_sample(&self, pass: usize, block: usize, pixel: usize) -> EyeSample;
    /// See [`pixel_sample::splats`].
    fn splats(&self, pass: usize, block: usize, pixel: usize) -> Vec<Splat>;
    /// See [`pixel_sample::light_walk`].
    fn light_walk(&self, pass: usize, walk: u64) -> Walk;
}

/// An estimator of profile `P` with all it takes to use it.
pub(super) struct Ready<'a, P: Profile> {
    pub estimator: Estimator<'a, P>,
    pub blocks: Blocks,
    pub scene: &'a Scene,
    pub film: &'a Film,
    pub seed: u64,
}

impl<'a, P: Profile> Ready<'a, P> {
    /// By what was `learnt`, with blocks of so many pixels.
    pub fn new(
        scene: &'a Scene,
        film: &'a Film,
        settings: &Settings,
        learnt: Learnt,
        per_block: usize,
    ) -> Self {
        let Options { effort, connections, .. } = settings.options;
        let (pixels, heroes, sampler) = (film.len(), P::Channels::COUNT, settings.sampler);
        let blocks = match connections {
            Connections::Cached => Blocks::of_size(per_block, pixels, heroes, sampler, effort.light_walks),
            // Which light subpath a pixel has does not depend on what it is rendered with.
            Connections::All => Blocks::new(pixels, heroes, sampler, 1.0).paired(),
        };
        let (per_pass, per_block) = (blocks.walks_per_pass(), blocks.walks_per_block());
        let Settings { options, seed, .. } = *settings;
        let estimator = Estimator::<P>::new(scene, options, learnt, seed, per_pass, per_block);
        Self { estimator, blocks, scene, film, seed: settings.seed }
    }

    fn prepare(
        scene: &'a Scene,
        film: &'a Film,
        settings: &Settings,
        learnt: Learnt,
        per_block: usize,
    ) -> Box<dyn Compiled + 'a> {
        Box::new(Self::new(scene, film, settings, learnt, per_block))
    }
}

impl<P: Profile> Compiled for Ready<'_, P> {
    fn blocks(&self) -> &Blocks {
        &self.blocks
    }
    fn render(
        &self,
        sorter: Option<&Sorter>,
        pass: usize,
        block: usize,
        wants: &dyn Fn(usize) -> bool,
    ) -> Outcome {
        guarded(pass, |failed, at| {
            let wants = |pixel: usize| wants(pixel) && !failed.contains(&(pixel as u32));
            match sorter {
                None => self.blocks.render(self, pass, block, &wants, at),
                Some(sorter) => sorted::block(self, sorter, [pass, block], &wants, at),
            }
        })
    }
    fn shade(&self, pass: usize, block: usize, pixels: &[u32]) -> Outcome {
        guarded(pass, |failed, at| {
            let whole: Vec<u32> = pixels.iter().copied().filter(|pixel| !failed.contains(pixel)).collect();
            self.blocks.shade(self, pass, block, &whole, at)
        })
    }
    fn transmittance(&self, primary: Ray, stream: &mut Stream) -> Spectrum {
        self.estimator.transmittance(primary, stream)
    }
    fn first_interaction(&self, primary: Ray, stream: &mut Stream) -> Option<Interaction> {
        self.estimator.first_interaction(primary, stream)
    }
    fn parts(&self, table: StrategyTable, pass: usize, block: usize) -> Vec<CellContribution> {
        strategy_images::block(self, table, pass, block)
    }
    fn time(&self, table: StrategyTable, pass: usize, block: usize) -> Times {
        timing::block(self, table, pass, block)
    }
    fn eye_sample(&self, pass: usize, block: usize, pixel: usize) -> EyeSample {
        pixel_sample::camera(self, pass, block, pixel)
    }
    fn splats(&self, pass: usize, block: usize, pixel: usize) -> Vec<Splat> {
        pixel_sample::light(self, pass, block, pixel).splats
    }
    fn light_walk(&self, pass: usize, walk: u64) -> Walk {
        pixel_sample::light_walk(self, pass, walk)
    }
}

/// The estimator of the profile that `settings` name, or of the one that their heuristic is compiled for, by what was `learnt`,
/// with blocks of so many pixels.
pub(super) fn choose<'a>(
    scene: &'a Scene,
    film: &'a Film,
    settings: &Settings,
    learnt: Learnt,
    per_block: usize,
) -> Box<dyn Compiled + 'a> {
    let Options { heuristic, effort, strategies, .. } = settings.options;
    let prepare = match (heuristic, settings.profile) {
        (Heuristic::Power | Heuristic::Maximum | Heuristic::Uniform, _) => Ready::<ByCompared>::prepare,
        (Heuristic::Cutoff { .. }, _) => Ready::<ByCutoff>::prepare,
        (Heuristic::Balance, profile) if effort.is_guided() || strategies.gather => match profile {
            ProfileName::Vacuum => Ready::<Guided<Vacuum>>::prepare,
            ProfileName::Fog => Ready::<Guided<Fog>>::prepare,
            ProfileName::Bounded | ProfileName::Smoke => Ready::<Guided<Smoke>>::prepare,
            _ => Ready::<Guided<Everything>>::prepare,
        },
        (Heuristic::Balance, ProfileName::Vacuum) => Ready::<Vacuum>::prepare,
        (Heuristic::Balance, ProfileName::Fog) => Ready::<Fog>::prepare,
        (Heuristic::Balance, ProfileName::Bounded) => Ready::<Bounded>::prepare,
        (Heuristic::Balance, ProfileName::Smoke) => Ready::<Smoke>::prepare,
        (Heuristic::Balance, ProfileName::Fire) => Ready::<Fire>::prepare,
        (Heuristic::Balance, ProfileName::ChromaticFog) => Ready::<ChromaticFog>::prepare,
        (Heuristic::Balance, ProfileName::Everything) => Ready::<Everything>::prepare,
    };
    prepare(scene, film, settings, learnt, per_block)
}

/// What so many passes by `settings` over so many pixels foretell.
pub(super) fn pilot(
    scene: &Scene,
    film: &Film,
    settings: &Settings,
    passes: usize,
    pixels: usize,
) -> Forecast {
    let learnt = training::learn_for(scene, film, settings);
    let ready = Ready::<ByKind>::new(scene, film, settings, learnt, pilot::PIXELS_PER_BLOCK);
    Forecast::fly(&ready, passes, pixels)
}

/// What `tasks` by `settings` say of walks that begin and go on by what was `learnt` before; none if it `is_over` before.
pub(super) fn trial(
    scene: &Scene,
    film: &Film,
    settings: &Settings,
    learnt: Learnt,
    tasks: Range<usize>,
    for_guide: bool,
    is_over: &(dyn Fn() -> bool + Sync),
) -> Option<Trial> {
    let ready = Ready::<ByKind>::new(scene, film, settings, learnt, PIXELS_PER_BLOCK);
    Trial::run(&ready, tasks, for_guide, is_over)
}

/// What camera subpaths of `tasks` by `settings` see of places that they come to.
pub(super) fn look(
    scene: &Scene,
    film: &Film,
    settings: &Settings,
    learnt: Learnt,
    tasks: Range<usize>,
) -> Looks {
    let ready = Ready::<ByKind>::new(scene, film, settings, learnt, PIXELS_PER_BLOCK);
    radiance::look(&ready, tasks)
}
