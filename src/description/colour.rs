//! What may be given where a colour is expected: numbers, rgb, spectra and the plugins for them, as linear
//! sRGB.
//!
//! Spectra become the colours that Mitsuba's rgb variants make of them, clamping included. Those variants
//! cannot evaluate the plugins `regular`, `irregular` and `blackbody`; here they are taken like the plain
//! spectra of the same values, which is also what the spectral variants show.

use super::{
    Library, Object, Params, Property, Value,
    params::{COLOR, spelling},
};
use crate::{
    error::{Error, Result},
    math::{
        DVec3, Spectrum,
        cie::{FIRST, LAST},
        colour::{Illuminant, black_body, interpolated, of_equal_light, of_spectrum},
    },
};

/// What a colour is of: spectra become different colours for each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// A property of matter from 0 to 1, seen in daylight: reflectances, albedos, all that textures hold, and
    /// (as in Mitsuba) extinction.
    Matter,
    /// A property of matter without a limit: indices of refraction.
    Index,
    /// Light itself.
    Light,
}

/// How a plugin that represents a colour is read.
struct Plugin {
    name: &'static str,
    read: fn(&Params<'_>, Role) -> Result<DVec3>,
}

const PLUGINS: [Plugin; 7] = [
    Plugin { name: "uniform", read: uniform },
    Plugin { name: "rawconstant", read: raw },
    Plugin { name: "srgb", read: srgb },
    Plugin { name: "d65", read: d65 },
    Plugin { name: "regular", read: regular },
    Plugin { name: "irregular", read: irregular },
    Plugin { name: "blackbody", read: blackbody },
];

/// True if `object` represents one colour. Of `d65` around a texture only the texture matters.
pub fn is_plugin(object: &Object) -> bool {
    let is_child = |p: &Property| matches!(p.value, Value::Object(_) | Value::Reference(_));
    let holds_texture = object.plugin == "d65" && object.properties.iter().any(is_child);
    PLUGINS.iter().any(|plugin| plugin.name == object.plugin) && !holds_texture
}

/// The colour that `property` gives, >= 0.
pub fn read(property: &Property, library: &Library, role: Role) -> Result<Spectrum> {
    let place = Place { property, library };
    let rgb = match &property.value {
        Value::Float(x) => DVec3::splat(*x),
        Value::Integer(i) => DVec3::splat(*i as f64),
        Value::Rgb(rgb) => DVec3::from(*rgb),
        Value::Spectrum(pairs) => place.spectrum(pairs, role),
        Value::Object(object) => return of_object(object, library, role),
        Value::Reference(id) => {
            return of_object(library.resolve(id, &property.location)?, library, role);
        }
        other => return Err(place.wrong(other.describe())),
    };
    place.checked(rgb)
}

/// The colour that the plugin `object` represents, >= 0.
pub fn of_object(object: &Object, library: &Library, role: Role) -> Result<Spectrum> {
    let params = Params::new(object, library);
    let color = of_plugin(&params, role)?;
    params.finish()?;
    Ok(color)
}

/// The same, from its parameters.
pub fn of_plugin(params: &Params<'_>, role: Role) -> Result<Spectrum> {
    let object = params.object;
    let names: Vec<_> = PLUGINS.iter().map(|plugin| plugin.name).collect();
    let Some(plugin) = PLUGINS.iter().find(|plugin| is_plugin(object) && plugin.name == object.plugin) else {
        let remedy = format!("give a number, rgb, a spectrum or one of {}", names.join(", "));
        let found = format!("the plugin \"{}\"", object.plugin);
        return Err(Error::new(params.location(), "one colour", found, remedy));
    };
    let color = (plugin.read)(params, role)?.as_vec3();
    if color.is_finite() && color.min_element() >= 0.0 {
        return Ok(color);
    }
    let remedy = format!("correct the {}", object.plugin);
    Err(Error::new(params.location(), "a colour with finite entries >= 0", format!("{color}"), remedy))
}

/// A property that should be a colour.
struct Place<'a> {
    property: &'a Property,
    library: &'a Library,
}

impl Place<'_> {
    fn wrong(&self, found: String) -> Error {
        let Property { name, location, .. } = self.property;
        Error::new(location, format!("{COLOR} for \"{name}\""), found, spelling(self.property, COLOR))
    }

    fn checked(&self, rgb: DVec3) -> Result<Spectrum> {
        let color = rgb.as_vec3();
        if color.is_finite() && rgb.min_element() >= 0.0 {
            return Ok(color);
        }
        let Property { name, location, .. } = self.property;
        let remedy = format!("change \"{name}\" to values from 0 to {:e}", f32::MAX);
        Err(Error::new(location, format!("{COLOR} for \"{name}\""), format!("{:?}", rgb.to_array()), remedy))
    }

    /// A single pair is a constant: grey as a property of matter, but light of that kind is not white.
    fn spectrum(&self, pairs: &[(f64, f64)], role: Role) -> DVec3 {
        match (pairs, role) {
            ([(_, value)], Role::Light) => of_equal_light() * *value,
            ([(_, value)], _) => DVec3::splat(*value),
            _ => sampled(pairs, role, |text| self.library.warn(&self.property.location, text)),
        }
    }
}

/// The colour of a sampled spectrum, clamped to the range of `role` with a warning.
fn sampled(pairs: &[(f64, f64)], role: Role, warn: impl Fn(&str)) -> DVec3 {
    let illuminant = if role == Role::Light { Illuminant::Equal } else { Illuminant::D65 };
    let rgb = of_spectrum(illuminant, |wavelength| interpolated(pairs, wavelength));
    let most = if role == Role::Matter { 1.0 } else { f64::INFINITY };
    let clamped = rgb.clamp(DVec3::ZERO, DVec3::splat(most));
    if clamped != rgb {
        warn(&format!("the spectrum is outside the range of its colour: {rgb} is clamped to {clamped}"));
    }
    clamped
}

fn uniform(params: &Params<'_>, _: Role) -> Result<DVec3> {
    params.accept_unused(&["wavelength_min", "wavelength_max"], "only three colour channels are rendered");
    required(params, "value").map(DVec3::splat)
}

/// One number or three.
fn raw(params: &Params<'_>, _: Role) -> Result<DVec3> {
    let vector = match params.object.properties.iter().find(|p| p.name == "value").map(|p| &p.value) {
        Some(Value::Vector(_) | Value::Rgb(_)) => params.optional_vector("value")?,
        _ => None,
    };
    vector.map_or_else(|| uniform(params, Role::Matter), Ok)
}

fn srgb(params: &Params<'_>, _: Role) -> Result<DVec3> {
    let unbounded = params.boolean("unbounded", false)?;
    let color = params.optional_vector("color")?.ok_or_else(|| params.missing("color", "an rgb colour"))?;
    if unbounded || color.max_element() <= 1.0 {
        return Ok(color);
    }
    Err(params.complain(
        "color",
        "an rgb colour from 0 to 1, or \"unbounded\" set to true",
        color.to_string(),
    ))
}

/// Daylight is white.
fn d65(params: &Params<'_>, _: Role) -> Result<DVec3> {
    let color = params.optional_vector("color")?.unwrap_or(DVec3::ONE);
    Ok(color * params.float("scale", 1.0)?)
}

fn regular(params: &Params<'_>, role: Role) -> Result<DVec3> {
    if let Some(color) = inner_spectrum(params, role)? {
        return Ok(color);
    }
    let values = numbers(params, "values")?;
    let (low, high) = (required(params, "wavelength_min")?, required(params, "wavelength_max")?);
    if low >= high {
        return Err(params.complain("wavelength_max", "a wavelength above wavelength_min", high.to_string()));
    }
    let step = (high - low) / (values.len() - 1) as f64;
    let pairs = (0..).map(|i| low + step * f64::from(i)).zip(values).collect();
    Ok(pairs_of(params, role, pairs))
}

fn irregular(params: &Params<'_>, role: Role) -> Result<DVec3> {
    if let Some(color) = inner_spectrum(params, role)? {
        return Ok(color);
    }
    let (wavelengths, values) = (numbers(params, "wavelengths")?, numbers(params, "values")?);
    if wavelengths.len() != values.len() {
        let expected = format!("as many numbers as wavelengths ({})", wavelengths.len());
        return Err(params.complain("values", expected, values.len().to_string()));
    }
    if let Some(pair) = wavelengths.windows(2).find(|pair| pair[0] >= pair[1]) {
        let found = format!("{} after {}", pair[1], pair[0]);
        return Err(params.complain("wavelengths", "increasing numbers", found));
    }
    Ok(pairs_of(params, role, wavelengths.into_iter().zip(values).collect()))
}

fn pairs_of(params: &Params<'_>, role: Role, pairs: Vec<(f64, f64)>) -> DVec3 {
    sampled(&pairs, role, |text| params.library.warn(params.location(), text))
}

/// The other way to give the values: as a spectrum of their own.
fn inner_spectrum(params: &Params<'_>, role: Role) -> Result<Option<DVec3>> {
    let Some(property) = params.property("value") else { return Ok(None) };
    match &property.value {
        Value::Spectrum(pairs) if pairs.len() > 1 => Ok(Some(pairs_of(params, role, pairs.clone()))),
        other => Err(params.complain("value", "a spectrum of wavelength:value pairs", other.describe())),
    }
}

fn blackbody(params: &Params<'_>, role: Role) -> Result<DVec3> {
    let temperature = required(params, "temperature")?;
    let (low, high) = (params.float("wavelength_min", FIRST)?, params.float("wavelength_max", LAST)?);
    if temperature <= 0.0 {
        return Err(params.complain("temperature", "a temperature > 0 [K]", temperature.to_string()));
    }
    if low >= high {
        return Err(params.complain("wavelength_max", "a wavelength above wavelength_min", high.to_string()));
    }
    if role != Role::Light {
        let remedy = "use it as radiance, irradiance or intensity";
        return Err(Error::new(
            params.location(),
            "a property of matter",
            "a blackbody, which is light",
            remedy,
        ));
    }
    let within = |wavelength| (low..=high).contains(&wavelength);
    let value = |w: f64| if within(w) { black_body(temperature, w) } else { 0.0 };
    Ok(of_spectrum(Illuminant::Equal, value).max(DVec3::ZERO))
}

fn required(params: &Params<'_>, name: &'static str) -> Result<f64> {
    params.optional_float(name)?.ok_or_else(|| params.missing(name, "a number"))
}

/// Two or more finite numbers in a text, with commas or space between them.
fn numbers(params: &Params<'_>, name: &'static str) -> Result<Vec<f64>> {
    let text = params.optional_string(name)?.ok_or_else(|| params.missing(name, "numbers in a string"))?;
    let words = text.split(|c: char| c == ',' || c.is_whitespace()).filter(|word| !word.is_empty());
    let numbers: Option<Vec<f64>> =
        words.map(|word| word.parse().ok().filter(|x: &f64| x.is_finite())).collect();
    match numbers {
        Some(numbers) if numbers.len() > 1 => Ok(numbers),
        _ => Err(params.complain(name, "two or more finite numbers", format!("\"{text}\""))),
    }
}

#[cfg(test)]
mod tests;
