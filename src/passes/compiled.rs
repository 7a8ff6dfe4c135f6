//! The compiled estimator: chosen once, outermost. Code behind [`Compiled`] is compiled for every profile, so only code
//! that walks through the scene belongs there. Observers, and loops over passes, checkpoints and files, are compiled
//! once.

use super::{
    Settings,
    blocks::{Blocks, CameraStart, Division},
    observe::BlockObserver,
    pass::Outcome,
    ready::Ready,
};
use crate::{
    film::{
        Film,
        sharing::{FilmSamples, Sharing},
    },
    guide::Learnt,
    math::Spectrum,
    sampling::Stream,
    scene::{Scene, lights::Starts},
    shape::Ray,
    transport::{
        Heuristic, Interaction, Options,
        observer::Observer,
        profiles::{
            Bounded, ByCompared, ByCutoff, ByKind, ChromaticBounded, ChromaticFog, Everything, Fire, Fog,
            Guided, ProfileName, Smoke, Vacuum,
        },
    },
};

/// What every estimator can do, whatever its profile. Calls are for whole blocks and walks, so that dispatch costs
/// nothing.
pub trait Compiled: Send + Sync {
    /// The scene that it renders.
    fn scene(&self) -> &Scene;
    /// The film that it renders to.
    fn film(&self) -> &Film;
    /// Which samples its pixels take.
    fn film_samples(&self) -> FilmSamples;
    /// How pixels are divided.
    fn blocks(&self) -> &Blocks;
    /// How many channels may sample distances.
    fn heroes(&self) -> usize;
    /// The learnt starts of light subpaths.
    fn starts(&self) -> Option<&Starts>;
    /// Where the camera subpath of `pixel` in `pass` starts.
    fn camera_start(&self, pass: usize, pixel: usize) -> CameraStart;
    /// The same as if pixels did not share their samples.
    fn own_start(&self, pass: usize, pixel: usize) -> CameraStart;
    /// How pixels share the camera samples of `pass`; none if they have their own.
    fn sharing(&self, pass: usize) -> Option<Sharing<'_>>;
    /// One sample of every pixel of `block` that `wants` one.
    fn render(&self, pass: usize, block: usize, wants: &dyn Fn(usize) -> bool) -> Outcome;
    /// One sample of each of `pixels`, connected to the light subpaths of `block`, which need not be their own; where
    /// every pixel has one light subpath, to this.
    fn shade(&self, pass: usize, block: usize, pixels: &[u32]) -> Outcome;
    /// Shows a block to `observer`: the light subpaths, and one sample of every pixel that `wants` one.
    fn observe(
        &self,
        pass: usize,
        block: usize,
        wants: &dyn Fn(usize) -> bool,
        observer: &mut dyn BlockObserver,
    );
    /// Shows light subpath number `walk` of `pass` to `observer`.
    fn light_walk(&self, pass: usize, walk: u64, observer: &mut dyn Observer);
    /// See [`crate::transport::Estimator::transmittance`].
    fn transmittance(&self, primary: Ray, stream: &mut Stream) -> Spectrum;
    /// See [`crate::transport::Estimator::first_interaction`].
    fn first_interaction(&self, primary: Ray, stream: &mut Stream) -> Option<Interaction>;
}

/// The estimator of the profile that `settings` name, or of the one that their heuristic is compiled for. It uses what
/// was `learnt`, and has blocks of so many pixels.
pub fn choose<'a>(
    scene: &'a Scene,
    film: &'a Film,
    settings: &Settings,
    learnt: Learnt,
    per_block: usize,
) -> Box<dyn Compiled + 'a> {
    let Options { algorithm, heuristic, effort, .. } = settings.options;
    let prepare = match (heuristic, settings.profile) {
        (Heuristic::Power | Heuristic::Maximum | Heuristic::Uniform, _) => Ready::<ByCompared>::prepare,
        (Heuristic::Cutoff { .. }, _) => Ready::<ByCutoff>::prepare,
        (Heuristic::Balance, profile) if effort.is_guided() || algorithm.ends_in_first_pass() => {
            match profile {
                ProfileName::Vacuum => Ready::<Guided<Vacuum>>::prepare,
                ProfileName::Fog => Ready::<Guided<Fog>>::prepare,
                ProfileName::Bounded | ProfileName::Smoke => Ready::<Guided<Smoke>>::prepare,
                ProfileName::ChromaticFog => Ready::<Guided<ChromaticFog>>::prepare,
                // Each compiled for itself would save 2 % at most.
                _ => Ready::<Guided<Everything>>::prepare,
            }
        }
        (Heuristic::Balance, ProfileName::Vacuum) => Ready::<Vacuum>::prepare,
        (Heuristic::Balance, ProfileName::Fog) => Ready::<Fog>::prepare,
        (Heuristic::Balance, ProfileName::Bounded) => Ready::<Bounded>::prepare,
        (Heuristic::Balance, ProfileName::Smoke) => Ready::<Smoke>::prepare,
        (Heuristic::Balance, ProfileName::Fire) => Ready::<Fire>::prepare,
        (Heuristic::Balance, ProfileName::ChromaticFog) => Ready::<ChromaticFog>::prepare,
        (Heuristic::Balance, ProfileName::ChromaticBounded) => Ready::<ChromaticBounded>::prepare,
        (Heuristic::Balance, ProfileName::Everything) => Ready::<Everything>::prepare,
    };
    prepare(scene, film, settings, learnt, Division::Image(per_block))
}

/// The same, with the share of each kind of strategy in the weights of contributions.
pub fn by_kind<'a>(
    scene: &'a Scene,
    film: &'a Film,
    settings: &Settings,
    learnt: Learnt,
    per_block: usize,
) -> Box<dyn Compiled + 'a> {
    Ready::<ByKind>::prepare(scene, film, settings, learnt, Division::Sample(per_block))
}
