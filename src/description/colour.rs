//! What may be given where a colour is expected: numbers, rgb, spectra and the plugins for them, as linear
//! sRGB.
//!
//! Spectra become the colours that Mitsuba's rgb variants make of them, clamping included. Those variants
//! cannot evaluate the plugins `regular`, `irregular` and `blackbody`; here they are taken like the plain
//! spectra of the same values, which is also what the spectral variants show. `inverse_power` is Tyndall's own.

use super::{
    library::Library,
    object::{Object, Property, Value},
    parameter::{Default, Plugin, Table, table},
    params::Params,
    registry::Registry,
    spelling::{COLOR, spelling},
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
type ReadColour = fn(&Params<'_>, Role) -> Result<DVec3>;

const ROWS: Registry<Plugin<ReadColour>> = Registry::new(
    "a colour",
    &[
        ("uniform", Plugin { table: UNIFORM, build: uniform }),
        ("rawconstant", Plugin { table: RAW, build: raw }),
        ("srgb", Plugin { table: SRGB, build: srgb }),
        ("d65", Plugin { table: D65, build: d65 }),
        ("regular", Plugin { table: REGULAR, build: regular }),
        ("irregular", Plugin { table: IRREGULAR, build: irregular }),
        ("blackbody", Plugin { table: BLACKBODY, build: blackbody }),
        ("inverse_power", Plugin { table: INVERSE_POWER, build: inverse_power }),
    ],
);

/// True if `object` represents one colour. Of `d65` around a texture only the texture matters.
pub fn is_plugin(object: &Object) -> bool {
    let is_child = |p: &Property| matches!(p.value, Value::Object(_) | Value::Reference(_));
    let holds_texture = object.plugin == "d65" && object.properties.iter().any(is_child);
    ROWS.has(object) && !holds_texture
}

/// True if plugins called `name` represent one colour.
pub fn is_name(name: &str) -> bool {
    ROWS.get(name).is_some()
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
    let Some(plugin) = ROWS.get(&object.plugin).filter(|_| is_plugin(object)) else {
        let remedy = format!("give a number, rgb, a spectrum or one of {}", ROWS.names().join(", "));
        let found = format!("the plugin \"{}\"", object.plugin);
        return Err(Error::new(&object.location, "one colour", found, remedy));
    };
    let params = Params::new(object, library, &plugin.table);
    let color = of_plugin(&params, role)?;
    params.finish()?;
    Ok(color)
}

/// The same, from the parameters of such a plugin.
pub fn of_plugin(params: &Params<'_>, role: Role) -> Result<Spectrum> {
    let color = (ROWS.find(params.object)?.build)(params, role)?.as_vec3();
    if color.is_finite() && color.min_element() >= 0.0 {
        return Ok(color);
    }
    let remedy = format!("correct the {}", params.object.plugin);
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

/// One value at all wavelengths.
pub const UNIFORM: Table = table! {
    "The same at all wavelengths: grey.";
    number("value", "", ANY, Required, "The value."),
    ignored("wavelength_min", "only three colour channels are rendered"),
    ignored("wavelength_max", "only three colour channels are rendered"),
};

fn uniform(params: &Params<'_>, _: Role) -> Result<DVec3> {
    params.float("value").map(DVec3::splat)
}

/// Numbers for the channels.
pub const RAW: Table = table! {
    "A colour in linear sRGB, unchanged.";
    channels("value", "Linear sRGB."),
};

fn raw(params: &Params<'_>, _: Role) -> Result<DVec3> {
    params.channels("value")
}

/// A colour as three channels.
pub const SRGB: Table = table! {
    "A colour in linear sRGB.";
    vector("color", "", Required, "The channels."),
    boolean("unbounded", false, "True: channels may exceed 1."),
};

fn srgb(params: &Params<'_>, _: Role) -> Result<DVec3> {
    let unbounded = params.boolean("unbounded")?;
    let color = params.vector("color")?;
    if unbounded || color.max_element() <= 1.0 {
        return Ok(color);
    }
    Err(params.complain(
        "color",
        "an rgb colour from 0 to 1, or \"unbounded\" set to true",
        color.to_string(),
    ))
}

/// Daylight.
pub const D65: Table = table! {
    "The daylight illuminant D65, which is white: as a light, or around a texture of light.";
    vector("color", "", At([1.0; 3]), "Its colour."),
    number("scale", "", ANY, Is(1.0), "Scales it; no effect on a texture, as in Mitsuba."),
    nested("texture", Optional, "A texture, in place of `color`."),
};

/// Daylight is white.
fn d65(params: &Params<'_>, _: Role) -> Result<DVec3> {
    Ok(params.vector("color")? * params.float("scale")?)
}

const NEEDED: Default = Default::Said("required without `value`");

/// Values at equal steps of the wavelength.
pub const REGULAR: Table = table! {
    "A spectrum of values at equal steps of wavelength.";
    spectrum("value", "The spectrum, in place of the other parameters."),
    text("values", "numbers in a string", NEEDED, "Two or more, separated by commas or space."),
    number("wavelength_min", "nm", ANY, NEEDED, "Wavelength of the first value."),
    number("wavelength_max", "nm", ANY, NEEDED, "Wavelength of the last value."),
};

fn regular(params: &Params<'_>, role: Role) -> Result<DVec3> {
    if let Some(color) = inner_spectrum(params, role)? {
        return Ok(color);
    }
    let values = numbers(params, "values")?;
    let (low, high) = (params.float("wavelength_min")?, params.float("wavelength_max")?);
    if low >= high {
        return Err(params.complain("wavelength_max", "a wavelength above wavelength_min", high.to_string()));
    }
    let step = (high - low) / (values.len() - 1) as f64;
    let pairs = (0..).map(|i| low + step * f64::from(i)).zip(values).collect();
    Ok(pairs_of(params, role, pairs))
}

/// Values at any wavelengths.
pub const IRREGULAR: Table = table! {
    "A spectrum of values at given wavelengths.";
    spectrum("value", "The spectrum, in place of the other parameters."),
    text("wavelengths", "numbers in a string", NEEDED, "Two or more [nm], increasing."),
    text("values", "numbers in a string", NEEDED, "One value for each wavelength."),
};

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
    let pairs = params.optional_spectrum("value")?;
    Ok(pairs.map(|pairs| pairs_of(params, role, pairs.to_vec())))
}

/// Light of a black body.
pub const BLACKBODY: Table = table! {
    "Emission of a black body, by Planck's law.";
    number("temperature", "K", above(0.0, f64::MAX), Required, "Its temperature."),
    number("wavelength_min", "nm", ANY, Is(FIRST), "No emission below this wavelength."),
    number("wavelength_max", "nm", ANY, Is(LAST), "No emission above this wavelength."),
};

fn blackbody(params: &Params<'_>, role: Role) -> Result<DVec3> {
    let temperature = params.float("temperature")?;
    let (low, high) = (params.float("wavelength_min")?, params.float("wavelength_max")?);
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

/// What falls as a power of the wavelength.
pub const INVERSE_POWER: Table = table! {
    "A power of the wavelength: value (wavelength / lambda)^exponent; the coefficient of Rayleigh scattering falls as 1 / lambda^4 (P03 eq. 5; P03T 2.3.3).";
    number("value", "", within(0.0, MAX), Is(1.0), "The value at `wavelength`."),
    number("wavelength", "nm", within(1.0, 1e6), Is(550.0), "Wavelength of that value."),
    number("exponent", "", within(-8.0, 8.0), Is(4.0), "4 for Rayleigh scattering, about 1.3 for haze (Angstrom's exponent), 0 for grey."),
};

/// Each channel is the mean of the power over the wavelengths that it answers to, by the colour of the spectrum over
/// that of 1 at all wavelengths: an exponent of 0 gives exactly what `value` alone would. Of matter and 1 / lambda^4 the
/// channels are as at 656, 547 and 444 nm.
fn inverse_power(params: &Params<'_>, role: Role) -> Result<DVec3> {
    let [value, wavelength, exponent] =
        [params.float("value")?, params.float("wavelength")?, params.float("exponent")?];
    let (illuminant, one) = match role {
        Role::Light => (Illuminant::Equal, of_equal_light()),
        Role::Matter | Role::Index => (Illuminant::D65, DVec3::ONE),
    };
    let power = of_spectrum(illuminant, |lambda| (wavelength / lambda).powf(exponent));
    Ok(value * one * power / of_spectrum(illuminant, |_| 1.0))
}

/// Two or more finite numbers in a text, with commas or space between them.
fn numbers(params: &Params<'_>, name: &'static str) -> Result<Vec<f64>> {
    let text = params.string(name)?;
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
