//! Indices of refraction by number or name, as Mitsuba knows them.

use crate::description::{Params, Value, nearest};
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

/// `int_ior` (`inside` where not given) and `ext_ior` (air).
pub fn interfaces(params: &Params<'_>, inside: &str) -> Result<Interfaces> {
    Ok(Interfaces::new(index(params, "int_ior", inside)?, index(params, "ext_ior", "air")?))
}

/// Indices beyond these limits are no materials, and their squares would leave f32's range in time.
const LIMITS: (f64, f64) = (1e-3, 1e3);

fn index(params: &Params<'_>, name: &'static str, default: &str) -> Result<f64> {
    let given = params.object.properties.iter().find(|property| property.name == name);
    match given.map(|property| &property.value) {
        Some(Value::String(_)) | None => named(params, name, default),
        Some(_) => params.float_within(name, 1.0, LIMITS.0, LIMITS.1),
    }
}

fn named(params: &Params<'_>, name: &'static str, default: &str) -> Result<f64> {
    let word = params.optional_string(name)?.unwrap_or(default).to_lowercase();
    NAMED.iter().find(|(material, _)| *material == word).map(|(_, index)| *index).ok_or_else(|| {
        let names: Vec<_> = NAMED.iter().map(|(material, _)| *material).collect();
        let mut error = params.complain(name, "an index of refraction or a material", format!("\"{word}\""));
        error.remedy = format!("{}known: {}", nearest(&word, &names), names.join(", "));
        error
    })
}
