//! Indices of refraction by number or name, as Mitsuba knows them.

use crate::description::{
    Params, Value, nearest,
    parameter::{self, Parameter},
};
use crate::error::Result;
use crate::math::fresnel::Interfaces;

/// Mitsuba's names: indices at about 589 nm and room temperature (Hecht, Optics, 4th ed.).
const NAMED: &[(&str, f64)] = &[
    ("vacuum", 1.0),
    ("helium", 1.000_036),
    ("hydrogen", 1.000_132),
    ("air", 1.000_277),
    ("carbon dioxide", 1.000_45),
    ("water", 1.333),
    ("acetone", 1.36),
    ("ethanol", 1.361),
    ("carbon tetrachloride", 1.461),
    ("glycerol", 1.472_9),
    ("benzene", 1.501),
    ("silicone oil", 1.520_45),
    ("bromine", 1.661),
    ("water ice", 1.31),
    ("fused quartz", 1.458),
    ("pyrex", 1.47),
    ("acrylic glass", 1.49),
    ("polypropylene", 1.49),
    ("bk7", 1.504_6),
    ("sodium chloride", 1.544),
    ("amber", 1.55),
    ("pet", 1.575),
    ("diamond", 2.419),
];

/// The row of the index within, `material` where not given.
pub(super) const fn inside(material: &'static str) -> Parameter {
    parameter::number_or_name("int_ior", LIMITS, material, "Index of refraction inside, or a material.")
}

/// The row of the index outside.
pub(super) const OUTSIDE: Parameter =
    parameter::number_or_name("ext_ior", LIMITS, "air", "Index of refraction outside, or a material.");

/// `int_ior` and `ext_ior`.
pub(super) fn interfaces(params: &Params<'_>) -> Result<Interfaces> {
    Ok(Interfaces::new(index(params, "int_ior")?, index(params, "ext_ior")?))
}

/// Indices beyond these limits are no materials, and their squares would leave f32's range in time.
pub(super) const LIMITS: parameter::Range = parameter::within(1e-3, 1e3);

fn index(params: &Params<'_>, name: &'static str) -> Result<f64> {
    match params.given(name).map(|property| &property.value) {
        Some(Value::String(_)) | None => named(params, name),
        Some(_) => params.float(name),
    }
}

fn named(params: &Params<'_>, name: &'static str) -> Result<f64> {
    let word = params.string(name)?.to_lowercase();
    NAMED.iter().find(|(material, _)| *material == word).map(|(_, index)| *index).ok_or_else(|| {
        let names: Vec<_> = NAMED.iter().map(|(material, _)| *material).collect();
        let mut error = params.complain(name, "an index of refraction or a material", format!("\"{word}\""));
        error.remedy = format!("{}known: {}", nearest(&word, &names), names.join(", "));
        error
    })
}
