//! Which compiled estimator does a piece of work: chosen once, outermost.

use super::Settings;
use crate::transport::{
    Heuristic,
    profile::{
        Bounded, ByCutoff, ByMaximum, ByPower, ByUniform, ChromaticFog, Everything, Fire, Fog, Profile,
        ProfileName, Smoke, Vacuum,
    },
};

/// Work that is compiled for every profile.
pub trait Work {
    /// What comes of it.
    type Output;

    /// Does it with estimators of profile `P`.
    fn by<P: Profile>(self) -> Self::Output;
}

/// Does `work` with the profile that `settings` name, or the one that their heuristic is compiled for.
pub fn choose<W: Work>(settings: &Settings, work: W) -> W::Output {
    match (settings.options.heuristic, settings.profile) {
        (Heuristic::Power, _) => work.by::<ByPower>(),
        (Heuristic::Maximum, _) => work.by::<ByMaximum>(),
        (Heuristic::Cutoff { .. }, _) => work.by::<ByCutoff>(),
        (Heuristic::Uniform, _) => work.by::<ByUniform>(),
        (Heuristic::Balance, ProfileName::Vacuum) => work.by::<Vacuum>(),
        (Heuristic::Balance, ProfileName::Fog) => work.by::<Fog>(),
        (Heuristic::Balance, ProfileName::Bounded) => work.by::<Bounded>(),
        (Heuristic::Balance, ProfileName::Smoke) => work.by::<Smoke>(),
        (Heuristic::Balance, ProfileName::Fire) => work.by::<Fire>(),
        (Heuristic::Balance, ProfileName::ChromaticFog) => work.by::<ChromaticFog>(),
        (Heuristic::Balance, ProfileName::Everything) => work.by::<Everything>(),
    }
}
