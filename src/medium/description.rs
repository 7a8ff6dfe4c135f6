//! From a description to a medium: parameters are read first; where coefficients vary, what they are like within the
//! medium's bounds is examined once those are known.

use super::{
    DistanceMethod, Heterogeneous, Medium, MediumOverrides, MediumProperties, emission::EmissionDescription,
    heterogeneous::Fields,
};
use crate::{
    description::{Library, Location, Object, Params, Registry},
    error::{Error, Result},
    math::{Spectrum, Vec3},
    phase::{self, Phase},
    volume::{self, Place, Volume},
};

/// How the parameters of a medium are read.
pub type BuildMedium = fn(&Params<'_>, &Place) -> Result<MediumDescription>;

/// Every kind of medium.
pub const ROWS: Registry<BuildMedium> =
    Registry::new("a medium", &[("homogeneous", homogeneous), ("heterogeneous", heterogeneous)]);

/// A medium whose parameters have been read.
#[derive(Clone, Debug)]
pub struct MediumDescription {
    medium: Medium,
    fields: Option<Fields>,
    emission: Option<EmissionDescription>,
}

/// Where a medium lies.
#[derive(Clone, Copy, Debug)]
pub struct MediumBounds {
    /// The box's corner with the smallest coordinates [m].
    pub low: Vec3,
    /// The one with the largest.
    pub high: Vec3,
    /// True if the medium ends at shapes within the box; it may reach further where it is around everything.
    pub is_bound: bool,
}

/// Reads the medium that `object` describes.
pub fn build(object: &Object, library: &Library, place: &Place) -> Result<MediumDescription> {
    let build = ROWS.find(object)?;
    let params = Params::new(object, library);
    let read = build(&params, place)?;
    params.finish()?;
    Ok(read)
}

impl MediumDescription {
    /// Vacuum.
    pub fn vacuum() -> Self {
        Self { medium: Medium::vacuum(), fields: None, emission: None }
    }

    /// True if coefficients vary.
    pub fn varies(&self) -> bool {
        self.fields.is_some()
    }

    /// Where the file describes an emission that is bounded only by the medium itself.
    pub fn endless_emission(&self) -> Option<&Location> {
        let given = self.emission.as_ref()?;
        given.has_no_end(self.varies()).then_some(&given.location)
    }

    /// True if nothing arrives through it from infinity.
    pub fn extinguishes_without_end(&self) -> bool {
        self.medium.transmittance_from_infinity() == Spectrum::ZERO
    }

    /// The medium, which lies `around` where its volumes do not say so themselves.
    pub fn finish(self, around: MediumBounds, overrides: &MediumOverrides) -> Result<Medium> {
        let medium = match self.fields {
            None => overridden(self.medium, overrides),
            Some(fields) => {
                self.medium.with(Heterogeneous::new(fields, [around.low, around.high], *overrides)?)
            }
        };
        match self.emission {
            None => Ok(medium),
            Some(given) => medium.with_emission(given, around),
        }
    }
}

/// A homogeneous medium with `overrides` applied.
fn overridden(medium: Medium, overrides: &MediumOverrides) -> Medium {
    let MediumProperties { sigma_t, albedo, .. } = medium.bound();
    let absorbing = MediumProperties::of(sigma_t * (Spectrum::ONE - albedo), Spectrum::ZERO);
    if overrides.absorbing { Medium::homogeneous(absorbing, medium.phase) } else { medium }
}

/// `sigma_t` [1/m], `albedo`, `scale`, the phase function, with Mitsuba's defaults, and what it emits.
fn homogeneous(params: &Params<'_>, place: &Place) -> Result<MediumDescription> {
    let scale = scale(params)?;
    let sigma_t = params.color("sigma_t", 1.0)? * scale;
    if !sigma_t.is_finite() {
        return Err(params.complain("sigma_t", "a finite product with scale", format!("{sigma_t}")));
    }
    let albedo = params.color("albedo", 0.75)?;
    if albedo.max_element() > 1.0 {
        return Err(params.complain("albedo", "values from 0 to 1", format!("{albedo}")));
    }
    let medium = Medium::homogeneous(MediumProperties::of(sigma_t, albedo), common(params)?);
    Ok(MediumDescription { medium, fields: None, emission: EmissionDescription::read(params, place)? })
}

/// `sigma_t` [1/m] and `albedo` as volumes, `scale`, the phase function, and which tracker: `tracker`, `step` [m] or
/// `march_error` for ray marching; and what it emits.
fn heterogeneous(params: &Params<'_>, place: &Place) -> Result<MediumDescription> {
    let volume = |name, default| {
        let given = volume::parameter(params, name, place)?;
        Ok(given.unwrap_or_else(|| Volume::constant(default, place)))
    };
    let fields = Fields {
        sigma_t: volume("sigma_t", 1.0)?,
        scale: scale(params)?,
        albedo: volume("albedo", 0.75)?,
        tracker: params.choice("tracker", DistanceMethod::Auto, &DistanceMethod::NAMES)?,
        step: params.optional_float("step")?,
        march_error: params.float_within("march_error", 1e-3, 1e-7, 1.0)?,
        recentre: place.recentre,
        location: params.location().clone(),
    };
    if fields.step.is_some_and(|step| !(step > 0.0 && step < f64::INFINITY)) {
        return Err(params.complain("step", "a length above 0", format!("{:?}", fields.step)));
    }
    let medium = Medium::homogeneous(MediumProperties::NOTHING, common(params)?);
    Ok(MediumDescription {
        medium,
        fields: Some(fields),
        emission: EmissionDescription::read(params, place)?,
    })
}

fn scale(params: &Params<'_>) -> Result<f32> {
    params.float_within("scale", 1.0, 0.0, f64::from(f32::MAX)).map(|scale| scale as f32)
}

/// What all media have: the phase function, and parameters of Mitsuba's that have no meaning here.
fn common(params: &Params<'_>) -> Result<Phase> {
    params.accept_unused(&["sample_emitters", "has_spectral_extinction"], "the scene itself decides");
    match params.children(|child| phase::ROWS.has(child.object))?.as_slice() {
        [] => Ok(Phase::Isotropic(phase::Isotropic)),
        [one] => phase::build(one.object, params.library),
        [_, second, ..] => Err(Error::new(
            second.location,
            "one phase function in a medium",
            "a second one",
            "blend them with a blendphase, or remove one",
        )),
    }
}
