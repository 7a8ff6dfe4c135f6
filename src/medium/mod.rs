//! Participating media: coefficients, phase functions, emission, and the sampling of flights where coefficients vary.

mod description;
pub mod distance;
mod emission;
mod extinction;
mod flakes;
mod heterogeneous;
mod homogeneous;
mod interval;
mod mixture;
mod overrides;
mod properties;
mod varying_flakes;

use crate::{
    error::Result,
    math::{Bounds, Channels, RaySegment, Spectrum, SpectrumExt, Vec3},
    phase::{self, Phase},
    sampling::Stream,
};
pub use description::{MediumBounds, MediumDescription, ROWS, build};
pub use distance::{Attenuation, DistanceMethod, DistanceSample};
pub use emission::{Emission, group};
use emission::{EmissionDescription, Within};
pub use extinction::Extinction;
pub use heterogeneous::Heterogeneous;
use homogeneous::Homogeneous;
pub use interval::MediumInterval;
use mixture::Mixture;
pub use overrides::MediumOverrides;
pub use properties::{MediumIndex, MediumProperties};
use std::sync::Arc;
use varying_flakes::VaryingFlakes;

/// A medium: the same everywhere, or varying in space. Which of the two it is matters only in this module: light
/// transport samples distances, and finds transmittances and properties, by the methods below.
#[derive(Clone, Debug)]
pub struct Medium {
    /// Directions after scattering.
    pub phase: Phase,
    /// Its emission.
    pub emission: Option<Arc<Emission>>,
    /// A homogeneous medium is its own bound. Profiles without heterogeneous media use only this; profiles with them
    /// look at `coefficients` first.
    bound: Homogeneous,
    coefficients: Coefficients,
    /// The description of the emission, to build it again for another time.
    given: Option<Box<(EmissionDescription, MediumBounds)>>,
}

/// The models of extinction and albedo.
#[derive(Clone, Debug)]
enum Coefficients {
    /// The same everywhere: the medium's bound.
    Homogeneous,
    /// Varying, below the medium's bound.
    Heterogeneous(Arc<Heterogeneous>),
    /// The sum of several media in one place.
    Mixture(Mixture),
    /// Any but a mixture, of flakes that vary.
    Flakes(Arc<VaryingFlakes>),
}

/// A medium as a profile sees it.
enum Model<'a> {
    Homogeneous(&'a Homogeneous),
    Heterogeneous(&'a Heterogeneous),
    Mixture(&'a Mixture),
    Flakes(&'a VaryingFlakes),
}

/// Which media an estimator is compiled for. What it does not support is not tested for.
pub trait MediaProfile: Copy + Send + Sync + 'static {
    /// Extinction per channel.
    type Channels: Channels;
    /// Some medium's coefficients vary in space.
    const HETEROGENEOUS: bool;
    /// Some medium's extinction depends on the direction of flight: what flakes show of themselves.
    const FLAKES: bool;
}

/// Light that crosses an interval in which collisions are forced (see [`Medium::unforced`]).
#[derive(Clone, Copy, Debug)]
pub struct Unforced<L> {
    /// Transmittance, or an unbiased estimate of it.
    pub transmittance: L,
    /// The optical depth by which forced collisions are drawn.
    pub depth: f32,
    /// The transmittance over exp(-`depth`).
    pub ratio: L,
}

impl Medium {
    /// Nothing: no extinction.
    pub fn vacuum() -> Self {
        Self::homogeneous(MediumProperties::NOTHING, Phase::Isotropic(phase::Isotropic))
    }

    /// The same everywhere.
    fn homogeneous(properties: MediumProperties, phase: Phase) -> Self {
        let (bound, coefficients) = (Homogeneous(properties), Coefficients::Homogeneous);
        Self { phase, emission: None, bound, coefficients, given: None }
    }

    /// The medium with coefficients that vary.
    fn with(self, varying: Heterogeneous) -> Self {
        let (sigma_t, albedo) = varying.bounds();
        let bound = Homogeneous(MediumProperties { sigma_t, albedo, ..self.bound() });
        Self { bound, coefficients: Coefficients::Heterogeneous(Arc::new(varying)), ..self }
    }

    /// The same medium with its flakes as they vary, if they do.
    fn with_varying_flakes(self) -> Self {
        match &self.phase {
            Phase::Sggx(flakes) if flakes.varies() => {
                let varying = Arc::new(VaryingFlakes::new(&self, flakes));
                Self { coefficients: Coefficients::Flakes(varying), ..self }
            }
            _ => self,
        }
    }

    /// Several media in one place: their coefficients add. Each emits for itself.
    pub fn mixture(media: Vec<Self>) -> Self {
        let mixture = Mixture(media.into());
        let (sigma_t, albedo) = mixture.bound();
        let bound = Homogeneous(MediumProperties { sigma_t, albedo, ..MediumProperties::NOTHING });
        Self { bound, coefficients: Coefficients::Mixture(mixture), ..Self::vacuum() }
    }

    /// The medium as number `index` of its scene.
    pub fn numbered(self, index: MediumIndex) -> Self {
        let bound = Homogeneous(MediumProperties { medium: index, ..self.bound() });
        Self { bound, ..self }
    }

    /// The medium as it is at `time` (s); none where it is the same at all times.
    pub fn at_time(&self, time: f64) -> Result<Option<Self>> {
        let varying = self.heterogeneous().map(|varying| varying.at_time(time)).transpose()?.flatten();
        let given = self.given.as_ref().and_then(|given| given.0.at_time(time));
        let phase = self.phase.at_time(time);
        if varying.is_none() && given.is_none() && phase.is_none() {
            return Ok(None);
        }
        let same = Self { phase: phase.unwrap_or_else(|| self.phase.clone()), ..self.clone() };
        let medium = match varying {
            Some(varying) => same.with(varying).with_varying_flakes(),
            None => same,
        };
        let Some(before) = &self.given else { return Ok(Some(medium)) };
        medium.with_emission(given.unwrap_or_else(|| before.0.clone()), before.1).map(Some)
    }

    /// The medium with an emission.
    fn with_emission(self, given: EmissionDescription, around: MediumBounds) -> Result<Self> {
        let within = self.heterogeneous().map_or(Within::Uniform(self.bound()), Heterogeneous::within);
        let emission = Emission::new(given.clone(), within, &around)?.map(Arc::new);
        Ok(Self { emission, given: Some(Box::new((given, around))), ..self })
    }

    /// The model of a medium that varies; none for others. For reports.
    pub fn heterogeneous(&self) -> Option<&Heterogeneous> {
        match &self.coefficients {
            Coefficients::Heterogeneous(varying) => Some(varying),
            Coefficients::Flakes(flakes) => flakes.mean().heterogeneous(),
            Coefficients::Homogeneous | Coefficients::Mixture(_) => None,
        }
    }

    /// Only profiles with media that vary ask whether this one does.
    #[inline(always)]
    fn model<M: MediaProfile>(&self) -> Model<'_> {
        if M::HETEROGENEOUS { self.any_model() } else { Model::Homogeneous(&self.bound) }
    }

    #[inline(always)]
    fn any_model(&self) -> Model<'_> {
        match &self.coefficients {
            Coefficients::Homogeneous => Model::Homogeneous(&self.bound),
            Coefficients::Heterogeneous(varying) => Model::Heterogeneous(varying),
            Coefficients::Mixture(mixture) => Model::Mixture(mixture),
            Coefficients::Flakes(flakes) => Model::Flakes(flakes),
        }
    }

    /// The properties of a homogeneous medium; of a heterogeneous one, a bound on them anywhere.
    #[inline]
    pub fn bound(&self) -> MediumProperties {
        self.bound.0
    }

    /// True if extinction differs between channels, so that flights need a hero channel.
    pub fn is_chromatic(&self) -> bool {
        match self.any_model() {
            Model::Homogeneous(bound) => !bound.0.sigma_t.is_grey(),
            Model::Heterogeneous(varying) => varying.is_chromatic(),
            Model::Mixture(mixture) => mixture.0.iter().any(Self::is_chromatic),
            Model::Flakes(flakes) => flakes.mean().is_chromatic(),
        }
    }

    /// The box outside of which there is nothing of it; none where it has no end of its own.
    pub fn extent(&self) -> Option<Bounds> {
        let bounds = |extinction: &Extinction| Bounds { low: extinction.low, high: extinction.high };
        self.heterogeneous().map(|varying| bounds(varying.extinction()))
    }

    /// Transmittance of light from infinity: 1 where the medium varies, for then it ends somewhere.
    #[inline]
    pub fn transmittance_from_infinity(&self) -> Spectrum {
        if self.extent().is_some() { Spectrum::ONE } else { self.bound.transmittance_from_infinity() }
    }

    /// Its properties at a world position, where `component` of several media that overlap has collided.
    #[inline]
    pub fn properties_at<M: MediaProfile>(&self, component: usize, position: Vec3) -> MediumProperties {
        match self.model::<M>() {
            Model::Homogeneous(bound) => bound.0,
            Model::Heterogeneous(varying) => {
                MediumProperties { medium: self.bound.0.medium, ..varying.at::<M::Channels>(position) }
            }
            Model::Mixture(mixture) => mixture.properties_at::<M>(component, position),
            Model::Flakes(flakes) => {
                MediumProperties { medium: self.bound.0.medium, ..flakes.properties_at::<M>(position) }
            }
        }
    }

    /// Deterministic optical depth per channel, the same from either end: as the weights use it.
    ///
    /// LW96 eq. 7: P_surface = e^-depth.
    #[inline(always)]
    pub fn optical_depth<M: MediaProfile>(&self, interval: &MediumInterval) -> M::Channels {
        let interval = &self.stretched::<M>(interval);
        match self.model::<M>() {
            Model::Homogeneous(bound) => bound.optical_depth(interval.length()),
            Model::Heterogeneous(varying) => varying.depth(&interval.segment),
            Model::Mixture(mixture) => mixture.optical_depth::<M>(interval),
            Model::Flakes(flakes) => flakes.optical_depth::<M>(interval),
        }
    }

    /// Attenuation along an interval; none where an estimate of transmittance is 0.
    #[inline(always)]
    pub fn attenuation<M: MediaProfile>(
        &self,
        interval: &MediumInterval,
        stream: &mut Stream,
    ) -> Option<Attenuation<M::Channels>> {
        let interval = &self.stretched::<M>(interval);
        match self.model::<M>() {
            Model::Homogeneous(bound) => {
                let depth: M::Channels = bound.optical_depth(interval.length());
                Some(Attenuation { depth, transmittance: depth.exp_neg() })
            }
            Model::Heterogeneous(varying) => varying.attenuation(&interval.segment, stream),
            Model::Mixture(mixture) => mixture.attenuation::<M>(interval, stream),
            Model::Flakes(flakes) => flakes.attenuation::<M>(interval, stream),
        }
    }

    /// The transmittance of every channel over the hero's, or an unbiased random estimate of that.
    #[inline]
    pub fn transmittance_ratio<M: MediaProfile>(
        &self,
        interval: &MediumInterval,
        depth: M::Channels,
        hero: usize,
        stream: &mut Stream,
    ) -> M::Channels {
        let interval = &self.stretched::<M>(interval);
        match self.model::<M>() {
            Model::Homogeneous(_) => depth.flight_ratio(M::Channels::splat(1.0), hero),
            Model::Heterogeneous(varying) => varying.ratio(&interval.segment, depth, hero, stream),
            Model::Mixture(mixture) => mixture.transmittance_ratio::<M>(interval, hero, stream),
            Model::Flakes(flakes) => flakes.transmittance_ratio::<M>(interval, hero, stream),
        }
    }

    /// Distance (m) along a ray at which the optical depth may be `remaining`; no surface beyond it matters. The ray
    /// starts `skipped` metres behind a boundary. Infinite where the distance has to be searched for.
    #[inline(always)]
    pub fn reach<M: MediaProfile>(&self, skipped: f32, hero: usize, remaining: f32) -> f32 {
        match self.model::<M>() {
            Model::Homogeneous(_) if self.has_flakes::<M>() => f32::INFINITY,
            Model::Homogeneous(bound) => bound.collision::<M::Channels>(skipped, hero, remaining),
            Model::Heterogeneous(_) | Model::Mixture(_) | Model::Flakes(_) => f32::INFINITY,
        }
    }

    /// The part of `skipped` metres behind a boundary that lies before the hero's optical depth `spent`; meaningless
    /// where coefficients vary.
    #[inline]
    pub fn skipped_before<M: MediaProfile>(&self, skipped: f32, hero: usize, spent: f32) -> f32 {
        skipped.min(self.bound.free_path::<M::Channels>(hero, spent))
    }

    /// A distance by the `hero` channel: where its optical depth is `remaining` (an exponential variate; random
    /// methods draw their own).
    ///
    /// LW96 eq. 6: p_medium = sigma_t e^-depth.
    #[inline(always)]
    pub fn sample_distance<M: MediaProfile>(
        &self,
        interval: &MediumInterval,
        hero: usize,
        remaining: f32,
        stream: &mut Stream,
    ) -> DistanceSample<M::Channels> {
        let stretched = &self.stretched::<M>(interval);
        let sample = match self.model::<M>() {
            Model::Homogeneous(bound) => bound.sample_distance(stretched, hero, remaining),
            Model::Heterogeneous(varying) => {
                varying.sample_distance(&stretched.segment, hero, remaining, stream)
            }
            Model::Mixture(mixture) => mixture.sample_distance::<M>(stretched, hero, stream),
            Model::Flakes(flakes) => flakes.sample_distance::<M>(stretched, hero, stream),
        };
        self.shrunk::<M>(interval, sample)
    }

    /// Light that crosses an interval of optical depth `depth` while collisions in it are forced.
    pub fn unforced<M: MediaProfile>(
        &self,
        interval: &MediumInterval,
        depth: M::Channels,
        hero: usize,
        stream: &mut Stream,
    ) -> Unforced<M::Channels> {
        let interval = &self.stretched::<M>(interval);
        match self.model::<M>() {
            Model::Homogeneous(_) => Unforced {
                transmittance: depth.exp_neg(),
                depth: depth.hero(hero),
                ratio: depth.flight_ratio(M::Channels::splat(1.0), hero),
            },
            Model::Heterogeneous(varying) => varying.unforced(&interval.segment, depth, hero, stream),
            Model::Mixture(mixture) => mixture.unforced::<M>(interval, hero, stream),
            Model::Flakes(flakes) => flakes.unforced::<M>(interval, hero, stream),
        }
    }

    /// The depth of [`Self::unforced`].
    fn forced_depth<M: MediaProfile>(&self, interval: &MediumInterval, hero: usize) -> f32 {
        let depth = self.optical_depth::<M>(interval);
        let interval = &self.stretched::<M>(interval);
        match self.model::<M>() {
            Model::Homogeneous(_) => depth.hero(hero),
            Model::Heterogeneous(varying) => varying.forced_depth(&interval.segment, depth, hero),
            Model::Mixture(mixture) => mixture.forced_depth::<M>(interval, hero),
            Model::Flakes(flakes) => flakes.forced_depth::<M>(interval, hero),
        }
    }

    /// A collision where the depth of [`Self::unforced`] is `remaining`, no more than that of the interval; none where
    /// there is nothing to collide with. The ratio is over a density of exp(-`remaining`) times the hero's sigma_t.
    pub fn force_collision<M: MediaProfile>(
        &self,
        interval: &MediumInterval,
        hero: usize,
        remaining: f32,
        stream: &mut Stream,
    ) -> Option<DistanceSample<M::Channels>> {
        let stretched = &self.stretched::<M>(interval);
        let sample = match self.model::<M>() {
            Model::Homogeneous(bound) => bound.force_collision(stretched, hero, remaining),
            Model::Heterogeneous(varying) => {
                varying.force_collision(&stretched.segment, hero, remaining, stream)?
            }
            Model::Mixture(mixture) => mixture.force_collision::<M>(stretched, hero, remaining, stream)?,
            Model::Flakes(flakes) => flakes.force_collision::<M>(stretched, hero, remaining, stream)?,
        };
        Some(self.shrunk::<M>(interval, sample))
    }

    /// Optical depth for a picture that need not be exact but must not be noisy.
    pub fn quick_depth(&self, segment: &RaySegment) -> Spectrum {
        let segment = &self.stretched_segment(segment);
        match self.any_model() {
            Model::Homogeneous(bound) => bound.optical_depth(segment.length),
            Model::Heterogeneous(varying) => varying.quick_depth(segment),
            Model::Mixture(mixture) => mixture.quick_depth(segment),
            Model::Flakes(flakes) => flakes.quick_depth(segment),
        }
    }
}
