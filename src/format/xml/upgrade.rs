//! Scenes for Mitsuba before version 2. Names are upgraded as in Mitsuba 3. What Mitsuba 3 refuses and 0.6 knew (tags,
//! plugins, coefficients of scattering and absorption) keeps its meaning in 0.6.

mod medium;

use crate::{
    description::{Location, Object, Property, TransformStep, Value},
    error::Result,
};

/// Tags with their replacements.
const TAGS: [(&str, &str); 4] =
    [("animation", "keyframes"), ("camera", "sensor"), ("lookAt", "lookat"), ("luminaire", "emitter")];

/// Plugins with their replacements.
const PLUGINS: [(&str, &str); 6] = [
    ("halton", "ldsampler"),
    ("hammersley", "ldsampler"),
    ("lambertian", "diffuse"),
    ("ldrfilm", "hdrfilm"),
    ("tiledhdrfilm", "hdrfilm"),
    ("volpath_simple", "volpath"),
];

/// Parameters without effect, by the plugins that have them (none: all), and why.
const IDLE: [(&[&str], &[&str], &str); 10] = [
    (&["bdpt"], &["light_image", "sample_direct"], "the pilot chooses among the strategies"),
    (&["ptracer"], &["brute_force", "granularity"], "Tyndall divides the work itself"),
    (
        &["obj", "ply", "serialized"],
        &["max_smooth_angle", "collapse", "srgb", "load_materials"],
        "normals and materials are as in Mitsuba 3",
    ),
    (&["hdrfilm"], &["attach_log", "label"], "images carry a report of their own"),
    (&["hdrfilm"], &["high_quality_edges"], "\"sample_border\" does that"),
    (
        &["hdrfilm"],
        &["exposure", "gamma", "key", "burn", "tonemap_method"],
        "the image is linear, and the PNG beside it has a view transform of its own",
    ),
    (
        &["ldsampler", "sobol", "stratified"],
        &["dimension", "scramble"],
        "Tyndall has its own random sequences",
    ),
    (&["bitmap", "envmap"], &["cache", "max_anisotropy"], "images are kept in memory"),
    (
        &["homogeneous", "heterogeneous"],
        &["method", "strategy", "sampling_density"],
        "Tyndall chooses how flights are sampled",
    ),
    (&[], &["strict_normals"], "Tyndall has one way with shading normals"),
];

/// The present tag for `tag`.
pub(super) fn tag(tag: &str) -> &str {
    TAGS.iter().find(|(old, _)| *old == tag).map_or(tag, |(_, new)| new)
}

/// The present plugin for `plugin`.
pub(super) fn plugin(plugin: &str) -> &str {
    PLUGINS.iter().find(|(old, _)| *old == plugin).map_or(plugin, |(_, new)| new)
}

/// Upgrades what `object` holds, which was written as a `written`; its names are upgraded already.
pub(super) fn object(object: &mut Object, written: &str) -> Result<()> {
    if written == "ldrfilm" {
        // It held images for screens.
        object.properties.retain(|property| property.name != "file_format");
    }
    if written != object.plugin {
        let text = format!("\"{written}\" is read as \"{}\"", object.plugin);
        object.properties.push(note(text, &object.location));
    }
    object.properties.iter_mut().for_each(|property| words(property, &object.plugin));
    drop_idle(object);
    if let Some(to_uv) = texture_transform(object) {
        object.properties.push(to_uv);
    }
    medium::upgrade(object)
}

fn note(text: String, location: &Location) -> Property {
    Property { name: String::new(), value: Value::Note(text), location: location.clone() }
}

/// Replaces parameters without effect by notes.
fn drop_idle(object: &mut Object) {
    let Object { plugin, properties, .. } = object;
    for property in properties {
        let name = property.name.as_str();
        let row = IDLE.iter().find(|(plugins, names, _)| {
            names.contains(&name) && (plugins.is_empty() || plugins.contains(&plugin.as_str()))
        });
        if let Some((_, _, why)) = row {
            *property = note(format!("\"{name}\" is not used: {why}"), &property.location);
        }
    }
}

/// Words that are written otherwise today.
fn words(property: &mut Property, plugin: &str) {
    match (plugin, property.name.as_str(), &mut property.value) {
        ("hdrfilm", "pixel_format", Value::String(word)) => *word = divided(word),
        ("bitmap", "filter_type", Value::String(word)) if ["ewa", "trilinear"].contains(&word.as_str()) => {
            "bilinear".clone_into(word);
        }
        // 1 says that values are linear, other numbers that they are encoded.
        ("bitmap", "gamma", Value::Float(gamma)) => {
            let raw = Value::Boolean(*gamma == 1.0);
            *property = Property { name: "raw".into(), value: raw, location: property.location.clone() };
        }
        _ => {}
    }
}

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
fn texture_transform(object: &mut Object) -> Option<Property> {
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
