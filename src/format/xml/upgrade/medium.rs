//! Coefficients of media as Mitsuba 0.6 knew them.

use super::note;
use crate::{
    description::{Object, Property, Value, suggest},
    error::{Error, Result},
};

/// Materials by name: scattering and absorption (1/mm) as measured by Jensen et al. 2001 ("A Practical Model for
/// Subsurface Light Transport", fig. 5).
const MATERIALS: [(&str, [f64; 3], [f64; 3]); 12] = [
    ("apple", [2.29, 2.39, 1.97], [0.0030, 0.0034, 0.046]),
    ("chicken1", [0.15, 0.21, 0.38], [0.0015, 0.077, 0.19]),
    ("chicken2", [0.19, 0.25, 0.32], [0.0018, 0.088, 0.20]),
    ("cream", [7.38, 5.47, 3.15], [0.0002, 0.0028, 0.0163]),
    ("ketchup", [0.18, 0.07, 0.03], [0.061, 0.97, 1.45]),
    ("marble", [2.19, 2.62, 3.00], [0.0021, 0.0041, 0.0071]),
    ("potato", [0.68, 0.70, 0.55], [0.0024, 0.0090, 0.12]),
    ("skimmilk", [0.70, 1.22, 1.90], [0.0014, 0.0025, 0.0142]),
    ("skin1", [0.74, 0.88, 1.01], [0.032, 0.17, 0.48]),
    ("skin2", [1.09, 1.59, 1.79], [0.013, 0.070, 0.145]),
    ("spectralon", [11.6, 20.4, 14.9], [0.0; 3]),
    ("wholemilk", [2.55, 3.21, 3.77], [0.0011, 0.0024, 0.014]),
];

/// Mitsuba 0.6 takes a scene's unit of length for so many mm.
const UNIT: f64 = 100.0;

/// Gives `object`, if it is a medium, today's coefficients.
pub(super) fn upgrade(object: &mut Object) -> Result<()> {
    match object.plugin.as_str() {
        "homogeneous" => {
            material(object)?;
            coefficients(object)
        }
        "heterogeneous" => {
            density(object);
            Ok(())
        }
        _ => Ok(()),
    }
}

fn take(object: &mut Object, name: &str) -> Option<Property> {
    let at = object.properties.iter().position(|property| property.name == name)?;
    Some(object.properties.remove(at))
}

/// The coefficients of a material by its name.
fn material(object: &mut Object) -> Result<()> {
    let Some(Property { value: Value::String(name), location, .. }) = take(object, "material") else {
        return Ok(());
    };
    let row = MATERIALS.iter().find(|(known, ..)| name.eq_ignore_ascii_case(known));
    let Some((_, scattering, absorption)) = row else {
        let names = MATERIALS.map(|(name, ..)| name);
        let remedy = format!("give sigma_t and albedo, or use another; {}", suggest(&name, "known", &names));
        return Err(Error::new(
            location,
            "a material with known coefficients",
            format!("\"{name}\""),
            remedy,
        ));
    };
    let text = format!(
        "\"{name}\" stands for coefficients that were measured in 1/mm: as in Mitsuba 0.6, a unit of length of the scene \
         is taken for {UNIT} mm"
    );
    object.properties.push(note(text, &location));
    for (name, values) in [("sigma_s", scattering), ("sigma_a", absorption)] {
        let value = Value::Rgb(values.map(|per_mm| per_mm * UNIT));
        object.properties.push(Property { name: name.into(), value, location: location.clone() });
    }
    Ok(())
}

/// Extinction and albedo of scattering and absorption; where there is no such pair, the builder says what to do.
fn coefficients(object: &mut Object) -> Result<()> {
    let given = |name: &str| object.properties.iter().find(|property| property.name == name);
    let (Some(s), Some(a)) = (given("sigma_s"), given("sigma_a")) else { return Ok(()) };
    if given("sigma_t").or(given("albedo")).is_some() {
        return Ok(());
    }
    let Some((sigma_t, albedo)) = sum(&s.value, &a.value) else {
        let found = format!("{} and {}", s.value.describe(), a.value.describe());
        let remedy = "give both as numbers or both as rgb, or give sigma_t and albedo";
        return Err(Error::new(&s.location, "sigma_s and sigma_a that can be added", found, remedy));
    };
    let location = s.location.clone();
    object.properties.retain(|property| !["sigma_s", "sigma_a"].contains(&property.name.as_str()));
    for (name, value) in [("sigma_t", sigma_t), ("albedo", albedo)] {
        object.properties.push(Property { name: name.into(), value, location: location.clone() });
    }
    Ok(())
}

/// The sum of two values, and the first as a part of it; none for spectra at different wavelengths.
fn sum(first: &Value, second: &Value) -> Option<(Value, Value)> {
    let share = |a: f64, b: f64| if a + b == 0.0 { 0.0 } else { a / (a + b) };
    if let (Value::Spectrum(a), Value::Spectrum(b)) = (first, second) {
        let matches = a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.0 == b.0);
        let all = |of: fn(f64, f64) -> f64| a.iter().zip(b).map(|(a, b)| (a.0, of(a.1, b.1))).collect();
        return matches.then(|| (Value::Spectrum(all(|a, b| a + b)), Value::Spectrum(all(share))));
    }
    let (a, b) = (channels(first)?, channels(second)?);
    let all = |of: fn(f64, f64) -> f64| Value::Rgb([0, 1, 2].map(|i| of(a[i], b[i])));
    Some((all(|a, b| a + b), all(share)))
}

fn channels(value: &Value) -> Option<[f64; 3]> {
    match value {
        Value::Float(x) => Some([*x; 3]),
        Value::Integer(i) => Some([*i as f64; 3]),
        Value::Rgb(rgb) => Some(*rgb),
        Value::Spectrum(pairs) => {
            if let [(0.0, x)] = pairs.as_slice() {
                Some([*x; 3])
            } else {
                None
            }
        }
        _ => None,
    }
}

/// The density is the extinction. Its grid, and that of the albedo, fill the box that their files state.
fn density(object: &mut Object) {
    let Some(density) = object.properties.iter_mut().find(|property| property.name == "density") else {
        return;
    };
    "sigma_t".clone_into(&mut density.name);
    for property in &mut object.properties {
        let Value::Object(grid) = &mut property.value else { continue };
        let is_grid = grid.plugin == "gridvolume";
        if is_grid && grid.properties.iter().all(|property| property.name != "use_grid_bbox") {
            let (name, value) = ("use_grid_bbox".to_owned(), Value::Boolean(true));
            grid.properties.push(Property { name, value, location: grid.location.clone() });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scattering_and_absorption_become_extinction_and_albedo() {
        let rgb = |v| Value::Rgb(v);
        assert_eq!(
            sum(&Value::Float(0.25), &rgb([0.25, 0.75, 0.0])),
            Some((rgb([0.5, 1.0, 0.25]), rgb([0.5, 0.25, 1.0])))
        );
        assert_eq!(sum(&Value::Integer(0), &Value::Float(0.0)), Some((rgb([0.0; 3]), rgb([0.0; 3]))));
        let spectrum = |pairs: &[(f64, f64)]| Value::Spectrum(pairs.to_vec());
        let pair = [(400.0, 1.0), (700.0, 2.0)];
        assert_eq!(
            sum(&spectrum(&pair), &spectrum(&[(400.0, 3.0), (700.0, 0.0)])),
            Some((spectrum(&[(400.0, 4.0), (700.0, 2.0)]), spectrum(&[(400.0, 0.25), (700.0, 1.0)])))
        );
        assert_eq!(sum(&spectrum(&pair), &spectrum(&[(400.0, 3.0), (600.0, 0.0)])), None);
        assert_eq!(sum(&spectrum(&pair), &Value::Float(1.0)), None);
    }
}
