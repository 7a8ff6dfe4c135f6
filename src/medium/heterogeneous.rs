//! A medium whose extinction and albedo vary in space.

use super::{
    DistanceMethod, DistanceSample, Extinction, MediumOverrides, MediumProperties, Unforced,
    distance::{self, Attenuation, DistanceSampler},
    emission::Within,
};
use crate::{
    description::{Location, Params},
    error::{Error, Result},
    math::{Channels, DVec3, RaySegment, Spectrum, Vec3},
    sampling::Stream,
    volume::{Place, Volume, VolumeModel, check_non_negative},
};

/// What is given.
#[derive(Clone, Debug)]
pub struct Fields {
    /// Extinction before `scale`.
    pub sigma_t: Volume,
    /// Factor on it (1/m).
    pub scale: f32,
    /// sigma_s / sigma_t.
    pub albedo: Volume,
    /// As requested.
    pub tracker: DistanceMethod,
    /// Longest interval of ray marching (m), if requested.
    pub step: Option<f64>,
    /// Error of transmittance that ray marching may make where no step is requested.
    pub march_error: f64,
    /// The origin of positions in the file's coordinates (m).
    pub recentre: DVec3,
    /// Where the medium is in the file.
    pub location: Location,
}

impl Fields {
    /// The fields of the medium of `params`, with the default tracker.
    pub fn new(sigma_t: Volume, albedo: Volume, params: &Params<'_>, place: &Place) -> Self {
        let (recentre, location) = (place.recentre, params.location().clone());
        let (scale, tracker, step, march_error) = (1.0, DistanceMethod::Auto, None, 1e-3);
        Self { sigma_t, scale, albedo, tracker, step, march_error, recentre, location }
    }

    /// Extinction before its factor, the factor, and the albedo, all with `overrides` applied.
    fn overridden(&self, overrides: &MediumOverrides) -> (Volume, f32, Volume) {
        let Self { sigma_t, scale, albedo, .. } = self;
        if !overrides.absorbing {
            return (sigma_t.clone(), *scale, albedo.clone());
        }
        let range = albedo.range(Vec3::ZERO, Vec3::ZERO);
        let (absorbed, scale) = match albedo {
            // A factor changes neither the kind of the volume nor its trackers.
            Volume::Constant(_) if albedo.is_grey() => (sigma_t.clone(), scale * (1.0 - range[0].x)),
            albedo => (sigma_t.clone().absorbed(albedo.clone()), *scale),
        };
        (absorbed, scale, Volume::constant(0.0, &Place::new(self.recentre, 0.0)))
    }

    /// The fields at `time` (s); none where they are the same at all times.
    fn at_time(&self, time: f64) -> Option<Self> {
        let (sigma_t, albedo) = (self.sigma_t.at_time(time), self.albedo.at_time(time));
        if sigma_t.is_none() && albedo.is_none() {
            return None;
        }
        let (sigma_t, albedo) =
            (sigma_t.unwrap_or_else(|| self.sigma_t.clone()), albedo.unwrap_or_else(|| self.albedo.clone()));
        Some(Self { sigma_t, albedo, location: self.location.clone(), ..*self })
    }
}

/// Extinction, albedo, and how flights through them are sampled.
#[derive(Clone, Debug)]
pub struct Heterogeneous {
    extinction: Extinction,
    albedo: Volume,
    tracker: DistanceSampler,
    /// Its description, to build it again for another time.
    fields: Fields,
    around: [Vec3; 2],
    overrides: MediumOverrides,
}

impl Heterogeneous {
    /// Examines `fields` within their own bounds, or the box `around` where they have none, and chooses a tracker.
    pub fn new(fields: Fields, around: [Vec3; 2], overrides: MediumOverrides) -> Result<Self> {
        let location = &fields.location;
        let [low, high] = fields.sigma_t.fills().unwrap_or(around);
        check(&fields, [low, high])?;
        let (volume, scale, albedo) = fields.overridden(&overrides);
        let choice = match (overrides.tracker, fields.tracker) {
            (Some(forced), _) => forced,
            // The absorption that is left may be a kind of volume to which the requested tracker does not apply.
            (None, requested) if overrides.absorbing && !requested.applies_to(&volume) => {
                DistanceMethod::Auto
            }
            (None, requested) => requested,
        };
        if !choice.applies_to(&volume) {
            return Err(inapplicable(choice, &volume, location));
        }
        let (step, error) = match overrides {
            MediumOverrides { step: None, march_error: None, .. } => (fields.step, fields.march_error),
            MediumOverrides { step, march_error, .. } => (step, march_error.unwrap_or(fields.march_error)),
        };
        let extinction = Extinction { volume, scale, low, high };
        let tracker = distance::choose(&extinction, choice, step, error);
        Ok(Self { extinction, albedo, tracker, fields, around, overrides })
    }

    /// The same at `time` (s); none where it is the same at all times.
    pub fn at_time(&self, time: f64) -> Result<Option<Self>> {
        let fields = self.fields.at_time(time);
        fields.map(|fields| Self::new(fields, self.around, self.overrides)).transpose()
    }

    /// Bounds on extinction (1/m) and albedo.
    pub fn bounds(&self) -> (Spectrum, Spectrum) {
        let Extinction { low, high, .. } = self.extinction;
        (self.extinction.bound(), self.albedo.range(low, high)[1].min(Spectrum::ONE))
    }

    /// True if extinction differs between channels.
    pub fn is_chromatic(&self) -> bool {
        !self.extinction.volume.is_grey()
    }

    /// Where it is, and how strong.
    pub fn extinction(&self) -> &Extinction {
        &self.extinction
    }

    /// The tracker that its description requests.
    pub fn requested(&self) -> DistanceMethod {
        self.fields.tracker
    }

    /// The tracker that overrides the requested one, if any.
    pub fn forced(&self) -> Option<DistanceMethod> {
        self.overrides.tracker
    }

    /// Optical depth for a picture that need not be exact but must not be noisy: in closed form where there is one,
    /// the deterministic stand-in where there is none and the tracker is random.
    pub fn quick_depth<L: Channels>(&self, segment: &RaySegment) -> L {
        distance::quick_depth(&self.tracker, &self.extinction, segment)
    }

    /// How its flights are sampled.
    pub fn tracker(&self) -> &DistanceSampler {
        &self.tracker
    }

    /// Its properties at a world position.
    #[inline]
    pub fn at<L: Channels>(&self, position: Vec3) -> MediumProperties {
        let sigma_t = self.extinction.at::<L>(position).to_spectrum();
        MediumProperties::of(sigma_t, self.albedo.eval::<Spectrum>(position))
    }

    /// Absorption, for the emission there.
    pub(super) fn within(&self) -> Within {
        Within::Varying(Box::new((self.extinction.clone(), self.albedo.clone())))
    }

    /// See [`DistanceSampler::depth`].
    #[inline]
    pub fn depth<L: Channels>(&self, segment: &RaySegment) -> L {
        self.tracker.depth(&self.extinction, segment)
    }

    /// See [`DistanceSampler::attenuation`].
    #[inline]
    pub fn attenuation<L: Channels>(
        &self,
        segment: &RaySegment,
        stream: &mut Stream,
    ) -> Option<Attenuation<L>> {
        self.tracker.attenuation(&self.extinction, segment, stream)
    }

    /// See [`DistanceSampler::ratio`].
    #[inline]
    pub fn ratio<L: Channels>(&self, segment: &RaySegment, depth: L, hero: usize, stream: &mut Stream) -> L {
        self.tracker.ratio(&self.extinction, segment, depth, hero, stream)
    }

    /// See [`DistanceSampler::sample_distance`].
    #[inline]
    pub fn sample_distance<L: Channels>(
        &self,
        segment: &RaySegment,
        hero: usize,
        remaining: f32,
        stream: &mut Stream,
    ) -> DistanceSample<L> {
        self.tracker.sample_distance(&self.extinction, segment, hero, remaining, stream)
    }

    /// See [`super::Medium::unforced`].
    pub fn unforced<L: Channels>(
        &self,
        segment: &RaySegment,
        depth: L,
        hero: usize,
        stream: &mut Stream,
    ) -> Unforced<L> {
        let found = self.attenuation(segment, stream);
        let transmittance = found.map_or(L::splat(0.0), |found| found.transmittance);
        let depth = self.forced_depth(segment, depth, hero);
        Unforced { transmittance, depth, ratio: transmittance.scaled(depth.min(DEEPEST).exp()) }
    }

    /// See [`DistanceSampler::forced_depth`].
    pub fn forced_depth<L: Channels>(&self, segment: &RaySegment, depth: L, hero: usize) -> f32 {
        self.tracker.forced_depth(&self.extinction, segment, depth, hero)
    }

    /// See [`DistanceSampler::force`].
    pub fn force_collision<L: Channels>(
        &self,
        segment: &RaySegment,
        hero: usize,
        remaining: f32,
        stream: &mut Stream,
    ) -> Option<DistanceSample<L>> {
        self.tracker.force(&self.extinction, segment, hero, remaining, stream)
    }
}

/// A ratio of transmittances is evaluated no deeper than this: sampled exponential depths are less.
pub(super) const DEEPEST: f32 = 80.0;

/// A bound may lie this far above what it bounds, relative to it: volumes widen theirs by their rounding.
const ROUNDING: f32 = 1e-6;

/// Extinction and albedo must be possible ones everywhere in the box from `low` to `high`.
fn check(fields: &Fields, [low, high]: [Vec3; 2]) -> Result<()> {
    let Fields { sigma_t, scale, albedo, location, .. } = fields;
    let most = |volume: &Volume| volume.range(low, high)[1].max_element();
    let (extinction, white) = (most(sigma_t) * scale, most(albedo));
    let checks = [
        (extinction < f32::INFINITY, extinction, "sigma_t", "a finite product with scale"),
        (white <= 1.0 + ROUNDING, white, "albedo", "values from 0 to 1"),
    ];
    if let Some((_, most, name, expected)) = checks.iter().find(|(fine, ..)| !fine) {
        let found = format!("a volume whose parts allow up to {most}");
        let remedy = format!("make \"{name}\" of the medium less");
        return Err(Error::new(location, format!("{expected} for \"{name}\""), found, remedy));
    }
    let place = Place::new(fields.recentre, 0.0);
    for volume in [sigma_t, albedo] {
        check_non_negative(volume, low, high).map_err(|negative| negative.error(location, &place))?;
    }
    Ok(())
}

fn inapplicable(choice: DistanceMethod, volume: &Volume, location: &Location) -> Error {
    let fitting: Vec<_> = DistanceMethod::NAMES
        .iter()
        .filter(|(_, other)| other.applies_to(volume))
        .map(|(name, _)| *name)
        .collect();
    let expected = match choice {
        DistanceMethod::RegularTracking => "a gridvolume for sigma_t, which the exact tracker needs",
        _ => "a sigma_t with an integral in closed form",
    };
    let remedy = format!("choose a tracker that works here: {}", fitting.join(", "));
    Error::new(location, expected, format!("the tracker \"{}\"", choice.name()), remedy)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        description::Value,
        testing::{nowhere, object},
    };

    /// Noise from 0 to `amplitude` as albedo.
    fn with_albedo(amplitude: f64) -> Result<Heterogeneous> {
        let place = Place::new(DVec3::ZERO, 0.0);
        let noise = object("noise", &[("amplitude", Value::Float(amplitude))]);
        let fields = Fields {
            sigma_t: Volume::constant(1.0, &place),
            scale: 1.0,
            albedo: crate::volume::build(&noise, &crate::description::Library::default(), &place)?,
            tracker: DistanceMethod::Auto,
            step: None,
            march_error: 1e-3,
            recentre: place.recentre,
            location: nowhere(),
        };
        Heterogeneous::new(fields, [Vec3::ZERO, Vec3::ONE], MediumOverrides::default())
    }

    #[test]
    fn an_albedo_that_reaches_1_is_no_error_and_one_that_exceeds_it_is() {
        assert!(with_albedo(1.0).is_ok());
        let error = with_albedo(1.1).unwrap_err();
        assert!(error.found.contains("1.1"), "{error}");
    }
}
