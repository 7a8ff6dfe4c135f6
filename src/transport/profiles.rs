//! Profiles: what a compiled estimator contains. Chosen once per render; what a scene does not have is not
//! tested for, it is not there.

use super::{
    Heuristic,
    mis::{self, Balance, Compared, Cutoff, MisSums},
    profile::Profile,
};
use crate::{
    bsdf::BsdfModel,
    math::{Channels, Spectrum},
    medium::{MediaProfile, Medium},
    scene::Scene,
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

/// All there is, weighed by the heuristic that `S` sums for.
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

/// What a scene needs of its profile.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Needs {
    /// Some medium has extinction.
    pub media: bool,
    /// Some extinction differs between channels.
    pub chromatic: bool,
    /// Some medium's coefficients vary in space.
    pub heterogeneous: bool,
    /// Some surface lets rays pass undeflected, even if only those from the camera.
    pub nulls: bool,
    /// The rays of some emitter, at infinity or not, or those of the sensor are parallel.
    pub infinite: bool,
    /// Some medium emits light.
    pub emissive: bool,
    /// Some medium's extinction depends on the direction of flight.
    pub flakes: bool,
}

impl Needs {
    /// What `scene` needs; `hide_emitters` as in [`super::Options`].
    pub fn of(scene: &Scene, hide_emitters: bool) -> Self {
        let nulls = scene.surfaces.iter().any(|surface| scene.bsdfs[surface.bsdf as usize].has_null());
        let overlap = scene.media_map.overlaps.is_some();
        let passed = hide_emitters && scene.surfaces.iter().any(|surface| surface.emitter.is_some());
        Self {
            media: scene.media.iter().any(|medium| medium.bound().sigma_t != Spectrum::ZERO),
            chromatic: scene.media.iter().any(Medium::is_chromatic),
            heterogeneous: overlap || scene.media.iter().any(|medium| medium.heterogeneous().is_some()),
            nulls: nulls || passed || overlap || scene.media_map.nowhere.is_some(),
            infinite: scene.lights.has_parallel() || scene.sensor.is_parallel(),
            emissive: scene.lights.has_media(),
            flakes: scene.media.iter().any(Medium::depends_on_direction),
        }
    }
}

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
    /// all of them. To compare run times of heuristics, run the balance heuristic on the profile of the
    /// others too.
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

    /// What the profile leaves out, in words.
    pub fn left_out(self) -> Vec<&'static str> {
        fn of<P: Profile>() -> Vec<&'static str> {
            let parts = [
                (P::MEDIA, "media"),
                (P::HETEROGENEOUS, "varying media"),
                (P::Channels::COUNT > 1, "chromatic extinction"),
                (P::NULLS, "index-matched boundaries"),
                (P::INFINITE, "infinite emitters"),
                (P::EMISSIVE, "emissive media"),
                (P::FLAKES, "microflakes"),
            ];
            parts.iter().filter(|(present, _)| !present).map(|(_, what)| *what).collect()
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
            for (needed, what) in [
                (needs.media, "media"),
                (needs.chromatic, "chromatic extinction"),
                (needs.heterogeneous, "varying media"),
                (needs.nulls, "index-matched boundaries"),
                (needs.infinite, "infinite emitters"),
                (needs.emissive, "emissive media"),
                (needs.flakes, "microflakes"),
            ] {
                assert!(!(needed && left_out.contains(&what)), "{needs:?} lacks {what}");
            }
        }
    }
}
