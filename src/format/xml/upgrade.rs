//! Scenes for Mitsuba before version 2, whose names are upgraded as Mitsuba 3 does it.

use crate::description::{Location, Object, Property, TransformStep, Value};

/// The present name of the parameter called `name` of a `plugin`: words divided by `_` in place of capitals.
pub(super) fn name(name: &str, plugin: &str) -> String {
    match (plugin, divided(name).as_str()) {
        ("diffuse", "diffuse_reflectance") => "reflectance".to_owned(),
        (_, name) => name.to_owned(),
    }
}

/// Capitals after a small letter begin a word.
fn divided(name: &str) -> String {
    let mut divided = String::new();
    let (mut last, mut in_word) = (' ', false);
    for letter in name.chars() {
        if last.is_ascii_lowercase() && letter.is_ascii_uppercase() {
            divided.push('_');
            in_word = true;
        }
        in_word &= letter.is_ascii_uppercase();
        divided.push(if in_word { letter.to_ascii_lowercase() } else { letter });
        last = letter;
    }
    divided
}

/// The transform of texture coordinates that `object` writes as numbers, which it loses.
pub(super) fn texture_transform(object: &mut Object) -> Option<Property> {
    let first = object.properties.iter().find(|property| PARTS.contains(&property.name.as_str()))?;
    let location: Location = first.location.clone();
    let [u, v, width, height] = PARTS.map(|part| object.number(part));
    object.properties.retain(|property| !PARTS.contains(&property.name.as_str()));
    let offset = [u.unwrap_or(0.0), v.unwrap_or(0.0), 0.0];
    let scale = [width.unwrap_or(1.0), height.unwrap_or(1.0), 1.0];
    let steps = vec![TransformStep::Translate(offset), TransformStep::Scale(scale)];
    Some(Property { name: "to_uv".to_owned(), value: Value::Transform(steps), location })
}

/// Offset and scale of u and v.
const PARTS: [&str; 4] = ["uoffset", "voffset", "uscale", "vscale"];

#[cfg(test)]
mod tests {
    use super::*;

    /// What Mitsuba 3.9.1's `transform_upgrade` makes of them.
    #[test]
    fn names_are_those_of_mitsuba() {
        for (old, new) in [
            ("sigmaT", "sigma_t"),
            ("intIOR", "int_ior"),
            ("aIORb", "a_iorb"),
            ("toWorldAndBack", "to_world_and_back"),
            ("ABC", "ABC"),
            ("foo2Bar", "foo2Bar"),
            ("_Foo", "_Foo"),
            ("diffuseReflectance", "diffuse_reflectance"),
        ] {
            assert_eq!(name(old, "plastic"), new);
        }
        assert_eq!(name("diffuseReflectance", "diffuse"), "reflectance");
    }
}
