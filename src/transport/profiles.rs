//! Profiles: what a compiled estimator contains. Chosen once per render; what a scene does not have is not
//! tested for, it is not there.

use super::{
    Heuristic,
    mis::{self, Balance, Compared, Cutoff, MisSums},
    needs::{Need, Needs},
    profile::Profile,
};
use crate::{
    math::{Channels, Spectrum},
    medium::MediaProfile,
};
use std::marker::PhantomData;

macro_rules! profile {
    ($(#[$doc:meta])* $name:ident, $text:literal, channels: $channels:ty, media: $media:literal, nulls: $nulls:literal,
     heterogeneous: $heterogeneous:literal, infinite: $infinite:literal, emissive: $emissive:literal) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        pub struct $name;
        impl MediaProfile for $name {
            type Channels = $channels;
            const HETEROGENEOUS: bool = $heterogeneous;
            const FLAKES: bool = false;
        }
        impl Profile for $name {
            type MisSums = Balance<$channels>;
            const MEDIA: bool = $media;
            const NULLS: bool = $nulls;
            const INFINITE: bool = $infinite;
            const EMISSIVE: bool = $emissive;
            const NAME: &'static str = $text;
        }
    };
}

profile! {
    /// Surfaces only.
    Vacuum, "vacuum", channels: f32, media: false, nulls: false,
    heterogeneous: false, infinite: true, emissive: false
}
profile! {
    /// Grey media behind surfaces that scatter, all light from within the scene: a closed room in fog.
    Fog, "fog", channels: f32, media: true, nulls: false,
    heterogeneous: false, infinite: false, emissive: false
}
profile! {
    /// Grey media with index-matched boundaries, under any emitter.
    Bounded, "bounded", channels: f32, media: true, nulls: true,
    heterogeneous: false, infinite: true, emissive: false
}
profile! {
    /// Grey media, some of which vary in space.
    Smoke, "smoke", channels: f32, media: true, nulls: true,
    heterogeneous: true, infinite: true, emissive: false
}
profile! {
    /// Grey emissive media, and may vary in space.
    Fire, "fire", channels: f32, media: true, nulls: true,
    heterogeneous: true, infinite: true, emissive: true
}
profile! {
    /// Homogeneous media of any colour under emitters within the scene, no index-matched boundaries.
    ChromaticFog, "chromatic-fog", channels: Spectrum, media: true, nulls: false,
    heterogeneous: false, infinite: false, emissive: false
}

profile! {
    /// Homogeneous media of any colour with index-matched boundaries, under any emitter: milk, water and tea in the open.
    ChromaticBounded, "chromatic-bounded", channels: Spectrum, media: true, nulls: true,
    heterogeneous: false, infinite: true, emissive: false
}

/// Every feature, weighted by the heuristic of the sums `S`.
#[derive(Clone, Copy, Debug)]
pub struct Everything<S = Balance<Spectrum>>(PhantomData<S>);

impl<S: MisSums<Channels = Spectrum>> MediaProfile for Everything<S> {
    type Channels = Spectrum;
    const HETEROGENEOUS: bool = true;
    const FLAKES: bool = true;
}

impl<S: MisSums<Channels = Spectrum>> Profile for Everything<S> {
    type MisSums = S;
    const MEDIA: bool = true;
    const NULLS: bool = true;
    const INFINITE: bool = true;
    const EMISSIVE: bool = true;
    const NAME: &'static str = "everything";
}

/// A profile with a guide besides.
#[derive(Clone, Copy, Debug)]
pub struct Guided<P>(PhantomData<P>);

impl<P: Profile> MediaProfile for Guided<P> {
    type Channels = P::Channels;
    const HETEROGENEOUS: bool = P::HETEROGENEOUS;
    const FLAKES: bool = P::FLAKES;
}

impl<P: Profile> Profile for Guided<P> {
    type MisSums = P::MisSums;
    const MEDIA: bool = P::MEDIA;
    const NULLS: bool = P::NULLS;
    const INFINITE: bool = P::INFINITE;
    const EMISSIVE: bool = P::EMISSIVE;
    const GUIDED: bool = true;
    const NAME: &'static str = P::NAME;
}

/// [`Everything`] by the power, the maximum or the uniform heuristic.
pub type ByCompared = Everything<Compared<Spectrum>>;
/// [`Everything`] by the cutoff heuristic, which keeps more.
pub type ByCutoff = Everything<Cutoff<Spectrum>>;

/// [`Everything`] by the balance heuristic, with sums by kind of strategies, and with a guide once there is one.
pub type ByKind = Guided<Everything<mis::ByKind<Spectrum>>>;

/// The profiles by name, for choice at run time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProfileName {
    /// [`Vacuum`].
    Vacuum,
    /// [`Fog`].
    Fog,
    /// [`Bounded`].
    Bounded,
    /// [`Smoke`].
    Smoke,
    /// [`Fire`].
    Fire,
    /// [`ChromaticFog`].
    ChromaticFog,
    /// [`ChromaticBounded`].
    ChromaticBounded,
    /// [`Everything`].
    Everything,
}

impl ProfileName {
    /// The leanest profile that has all a scene needs.
    pub fn leanest(needs: Needs) -> Self {
        match needs {
            Needs { flakes: true, .. } => Self::Everything,
            Needs { emissive: true, chromatic: false, .. } => Self::Fire,
            Needs { emissive: true, .. } => Self::Everything,
            Needs { heterogeneous: true, chromatic: false, .. } => Self::Smoke,
            Needs { heterogeneous: true, .. } => Self::Everything,
            Needs { media: false, nulls: false, .. } => Self::Vacuum,
            Needs { chromatic: false, nulls: false, infinite: false, .. } => Self::Fog,
            Needs { chromatic: false, .. } => Self::Bounded,
            Needs { nulls: false, infinite: false, .. } => Self::ChromaticFog,
            Needs { .. } => Self::ChromaticBounded,
        }
    }

    /// The profile that runs where this one and `heuristic` are requested: only the balance heuristic is compiled for
    /// every profile. To compare run times of heuristics, run the balance heuristic on [`Everything`] too.
    pub fn weighing(self, heuristic: Heuristic) -> Self {
        if heuristic == Heuristic::Balance { self } else { Self::Everything }
    }

    /// Name in scene files and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Vacuum => Vacuum::NAME,
            Self::Fog => Fog::NAME,
            Self::Bounded => Bounded::NAME,
            Self::Smoke => Smoke::NAME,
            Self::Fire => Fire::NAME,
            Self::ChromaticFog => ChromaticFog::NAME,
            Self::ChromaticBounded => ChromaticBounded::NAME,
            Self::Everything => <Everything>::NAME,
        }
    }

    /// What the profile leaves out.
    pub fn left_out(self) -> Vec<Need> {
        fn of<P: Profile>() -> Vec<Need> {
            let has = |need: &Need| match need {
                Need::Media => P::MEDIA,
                Need::Heterogeneous => P::HETEROGENEOUS,
                Need::Chromatic => P::Channels::COUNT > 1,
                Need::Nulls => P::NULLS,
                Need::Infinite => P::INFINITE,
                Need::Emissive => P::EMISSIVE,
                Need::Flakes => P::FLAKES,
            };
            Need::ALL.into_iter().filter(|need| !has(need)).collect()
        }
        match self {
            Self::Vacuum => of::<Vacuum>(),
            Self::Fog => of::<Fog>(),
            Self::Bounded => of::<Bounded>(),
            Self::Smoke => of::<Smoke>(),
            Self::Fire => of::<Fire>(),
            Self::ChromaticFog => of::<ChromaticFog>(),
            Self::ChromaticBounded => of::<ChromaticBounded>(),
            Self::Everything => of::<Everything>(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_leanest_profile_has_all_that_is_needed() {
        for bits in 0..128u32 {
            let has = |bit: u32| bits >> bit & 1 == 1;
            let needs = Needs {
                media: has(0),
                chromatic: has(1) && has(0),
                heterogeneous: has(4) && has(0),
                nulls: has(2),
                infinite: has(3),
                emissive: has(5),
                flakes: has(6),
            };
            let left_out = ProfileName::leanest(needs).left_out();
            for (needed, need) in [
                (needs.media, Need::Media),
                (needs.chromatic, Need::Chromatic),
                (needs.heterogeneous, Need::Heterogeneous),
                (needs.nulls, Need::Nulls),
                (needs.infinite, Need::Infinite),
                (needs.emissive, Need::Emissive),
                (needs.flakes, Need::Flakes),
            ] {
                assert!(!(needed && left_out.contains(&need)), "{needs:?} lacks {need:?}");
            }
        }
    }
}
