//! From a description to a medium. Parameters are read first; coefficients that vary are examined within the medium's
//! bounds once these are known.

use super::{
    DistanceMethod, Heterogeneous, Medium, MediumOverrides, MediumProperties,
    distance::DistanceSampler,
    emission::{EMISSION, EmissionDescription},
    heterogeneous::Fields,
};
use crate::{
    description::{
        Library, Location, Object, Params, Plugin, Registry, Table, Value, parameter::Parameter, rows, table,
    },
    error::{Error, Result},
    math::{Spectrum, Vec3},
    phase::{self, Phase},
    volume::{self, Place, Volume, VolumeModel as _},
};

/// How the parameters of a medium are read.
pub(super) type BuildMedium = fn(&Params<'_>, &Place) -> Result<MediumDescription>;

/// Every kind of medium.
pub const ROWS: Registry<Plugin<BuildMedium>> = Registry::new(
    "a medium",
    &[
        ("homogeneous", Plugin { table: HOMOGENEOUS, build: homogeneous }),
        ("heterogeneous", Plugin { table: HETEROGENEOUS, build: heterogeneous }),
    ],
);

/// A medium whose parameters have been read.
#[derive(Clone, Debug)]
pub struct MediumDescription {
    medium: Medium,
    location: Option<Location>,
    fields: Option<Fields>,
    emission: Option<EmissionDescription>,
}

/// Where a medium lies.
#[derive(Clone, Copy, Debug)]
pub struct MediumBounds {
    /// The box's corner with the smallest coordinates (m).
    pub low: Vec3,
    /// The one with the largest.
    pub high: Vec3,
    /// True if the medium ends at shapes within the box; it may reach further where it is around everything.
    pub is_bound: bool,
}

/// Reads the medium that `object` describes.
pub fn build(object: &Object, library: &Library, place: &Place) -> Result<MediumDescription> {
    let (params, build) = ROWS.read(object, library)?;
    check_coefficients(&params)?;
    let read = build(&params, place)?;
    params.finish()?;
    Ok(read)
}

impl MediumDescription {
    /// Vacuum.
    pub fn vacuum() -> Self {
        Self { medium: Medium::vacuum(), location: None, fields: None, emission: None }
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

    /// An error if it surrounds the scene without end although it varies: it would have to be examined to infinity.
    pub fn check_end(&self) -> Result<()> {
        let passed = self.medium.transmittance_from_infinity();
        let what = match (&self.fields, &self.medium.phase) {
            (Some(_), _) if passed == Spectrum::ZERO => "its albedo varies",
            (None, Phase::Sggx(flakes)) if passed != Spectrum::ONE && flakes.shares()[0] <= 0.0 => {
                "some of it has no flakes"
            }
            _ => return Ok(()),
        };
        let remedy = "close it by shapes, openings by a \"null\" surface with this medium as its interior";
        let found = "one that surrounds the whole scene";
        let place = self.location.as_ref().map_or(String::new(), ToString::to_string);
        Err(Error::new(place, format!("a medium with an end, as {what}"), found, remedy))
    }

    /// True if nothing arrives through it from infinity.
    pub fn extinguishes_without_end(&self) -> bool {
        self.medium.transmittance_from_infinity() == Spectrum::ZERO
    }

    /// The medium; `around` is where it lies, if its volumes do not say so themselves.
    pub fn finish(self, around: MediumBounds, overrides: &MediumOverrides) -> Result<Medium> {
        let has_flakes = self.medium.depends_on_direction();
        let medium = match self.fields {
            None => overridden(self.medium, overrides),
            Some(fields) => {
                let location = fields.location.clone();
                let varying = Heterogeneous::new(fields, [around.low, around.high], *overrides)?;
                if has_flakes && matches!(varying.tracker(), DistanceSampler::RayMarching(_)) {
                    let expected = "a tracker without steps in a medium of flakes (\"sggx\")";
                    let remedy = "leave it out, or choose \"null_collision\"";
                    return Err(Error::new(&location, expected, "the tracker \"march\"", remedy));
                }
                // Vacuum, however it was described: profiles leave it out.
                let is_nothing = varying.bounds().0 == Spectrum::ZERO && self.emission.is_none();
                if is_nothing { self.medium } else { self.medium.with(varying) }
            }
        };
        match self.emission {
            None => Ok(medium.with_varying_flakes()),
            Some(given) if has_flakes => {
                let remedy = "overlap it with a medium that emits";
                let expected =
                    "no emission in a medium of flakes (\"sggx\"), whose absorption depends on the direction";
                Err(Error::new(&given.location, expected, "one", remedy))
            }
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

/// What all media have.
const COMMON: &[Parameter] = rows! {
    volume("albedo", "", 1.0, Is(0.75), "Single-scattering albedo: sigma_s / sigma_t."),
    factor("scale", 1.0, "Scales `sigma_t`."),
    nested("phase", Optional, "The phase function; default: `isotropic`."),
    ignored("sample_emitters", "Tyndall looks at the scene itself"),
    ignored("has_spectral_extinction", "Tyndall looks at the scene itself"),
};

const HOMOGENEOUS: Table = table! {
    "A medium of constant extinction; albedo and phase function may vary.";
    volume("sigma_t", "1/m", f64::INFINITY, Is(1.0), "Extinction coefficient, sigma_s + sigma_a: one value everywhere.");
    COMMON, EMISSION
};

fn homogeneous(params: &Params<'_>, place: &Place) -> Result<MediumDescription> {
    let scale = scale(params)?;
    let Volume::Constant(sigma_t) = volume::parameter(params, "sigma_t", place)? else {
        let at = params.given("sigma_t").map_or(params.location(), |given| &given.location);
        let expected = "one value everywhere for \"sigma_t\" of a homogeneous medium";
        return Err(Error::new(at, expected, "a volume that varies", "make the medium heterogeneous"));
    };
    let sigma_t: Spectrum = sigma_t.eval::<Spectrum>(Vec3::ZERO) * scale;
    if !sigma_t.is_finite() {
        return Err(params.complain("sigma_t", "a finite product with scale", format!("{sigma_t}")));
    }
    let albedo = volume::parameter(params, "albedo", place)?;
    let emission = EmissionDescription::read(params, place, &albedo)?;
    let properties = |albedo| MediumProperties::of(sigma_t, albedo);
    let (properties, fields) = match albedo {
        Volume::Constant(albedo) => {
            let albedo: Spectrum = albedo.eval(Vec3::ZERO);
            match params.expected("albedo", f64::from(albedo.max_element())) {
                None => (properties(albedo), None),
                Some(expected) => return Err(params.complain("albedo", expected, format!("{albedo}"))),
            }
        }
        // Trackers of media that vary are told of it; of one value without end it is known in closed form.
        albedo => {
            (properties(Spectrum::ZERO), Some(Fields::new(Volume::endless(sigma_t), albedo, params, place)))
        }
    };
    let medium = Medium::homogeneous(properties, phase(params, place)?);
    Ok(MediumDescription { medium, location: Some(params.location().clone()), fields, emission })
}

const HETEROGENEOUS: Table = table! {
    "A medium that varies in space.";
    volume("sigma_t", "1/m", f64::INFINITY, Is(1.0), "Extinction coefficient; a constant fills the unit cube only, as in Mitsuba."),
    choice("tracker", &words::<6, _>(&DistanceMethod::NAMES), "auto", "Method of free-flight sampling; `auto` takes the cheapest unbiased one.").ours(),
    number("step", "m", above(0.0, f64::MAX), Said("by `march_error`"), "Step of the tracker `march`.").ours(),
    number("march_error", "", within(1e-7, 1.0), Is(1e-3), "Maximum error of transmittance of `march`.").ours();
    COMMON, EMISSION
};

fn heterogeneous(params: &Params<'_>, place: &Place) -> Result<MediumDescription> {
    let fields = Fields {
        scale: scale(params)?,
        tracker: params.choice("tracker", &DistanceMethod::NAMES)?,
        step: params.optional_float("step")?,
        march_error: params.float("march_error")?,
        ..Fields::new(
            volume::parameter(params, "sigma_t", place)?,
            volume::parameter(params, "albedo", place)?,
            params,
            place,
        )
    };
    let medium = Medium::homogeneous(MediumProperties::NOTHING, phase(params, place)?);
    let emission = EmissionDescription::read(params, place, &fields.albedo)?;
    let location = Some(params.location().clone());
    Ok(MediumDescription { medium, location, fields: Some(fields), emission })
}

fn scale(params: &Params<'_>) -> Result<f32> {
    params.float("scale").map(|scale| scale as f32)
}

/// The phase function.
fn phase(params: &Params<'_>, place: &Place) -> Result<Phase> {
    match params.children("phase", |child| phase::ROWS.has(child.object))?.as_slice() {
        [] => Ok(Phase::Isotropic(phase::Isotropic)),
        [one] => phase::build(one.object, params.library, place),
        [_, second, ..] => Err(Error::new(
            second.location,
            "one phase function in a medium",
            "a second one",
            "blend them with a blendphase, or remove one",
        )),
    }
}

/// Scattering and absorption have names of their own in other renderers.
fn check_coefficients(params: &Params<'_>) -> Result<()> {
    let given = |name: &str| params.object.properties.iter().find(|property| property.name == name);
    let Some(first) = given("sigma_s").or(given("sigma_a")) else { return Ok(()) };
    let number = |name| match given(name)?.value {
        Value::Float(x) => Some(x),
        Value::Integer(i) => Some(i as f64),
        _ => None,
    };
    let numbers = match (number("sigma_s"), number("sigma_a")) {
        (Some(s), Some(a)) if s + a > 0.0 => format!(": {} and {} here", s + a, s / (s + a)),
        _ => String::new(),
    };
    let remedy = format!("give sigma_t = sigma_s + sigma_a and albedo = sigma_s / sigma_t{numbers}");
    let found = format!("\"{}\"", first.name);
    Err(Error::new(&first.location, "\"sigma_t\" and \"albedo\", as in Mitsuba 3", found, remedy))
}
