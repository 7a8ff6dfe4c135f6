//! Which XML tag a plugin goes with. XML always says; JSON leaves it to the plugin's name and place.

use super::integrator;
use crate::{
    bsdf,
    description::{Object, Position, Row, Value, suggest},
    emitter,
    error::{Error, Result},
    film::filter,
    medium, phase, shape, texture,
};

/// Tags of plugins.
pub(super) const TAGS: [&str; 13] = [
    "scene",
    "integrator",
    "sensor",
    "film",
    "sampler",
    "rfilter",
    "shape",
    "bsdf",
    "texture",
    "emitter",
    "medium",
    "phase",
    "volume",
];

/// Plugins of Mitsuba 3.9.1, so that scenes which Tyndall cannot render yet can still be converted.
const MITSUBA: [(&str, &[&str]); 12] = [
    (
        "integrator",
        &["aov", "depth", "direct", "moment", "path", "ptracer", "stokes", "volpath", "volpathmis"],
    ),
    (
        "sensor",
        &["batch", "distant", "irradiancemeter", "orthographic", "perspective", "radiancemeter", "thinlens"],
    ),
    ("film", &["hdrfilm", "specfilm"]),
    ("sampler", &["independent", "ldsampler", "multijitter", "orthogonal", "stratified"]),
    ("rfilter", &["box", "catmullrom", "gaussian", "lanczos", "mitchell", "tent"]),
    (
        "shape",
        &[
            "blender",
            "bsplinecurve",
            "cube",
            "cylinder",
            "disk",
            "ellipsoids",
            "ellipsoidsmesh",
            "instance",
            "linearcurve",
            "merge",
            "obj",
            "ply",
            "rectangle",
            "sdfgrid",
            "serialized",
            "shapegroup",
            "sphere",
        ],
    ),
    (
        "bsdf",
        &[
            "blendbsdf",
            "bumpmap",
            "circular",
            "conductor",
            "dielectric",
            "diffuse",
            "hair",
            "mask",
            "measured",
            "measured_polarized",
            "normalmap",
            "null",
            "plastic",
            "polarizer",
            "pplastic",
            "principled",
            "principledthin",
            "retarder",
            "roughconductor",
            "roughdielectric",
            "roughplastic",
            "thindielectric",
            "twosided",
        ],
    ),
    (
        "texture",
        &[
            "bitmap",
            "blackbody",
            "checkerboard",
            "d65",
            "irregular",
            "mesh_attribute",
            "rawconstant",
            "regular",
            "srgb",
            "uniform",
            "volume",
        ],
    ),
    (
        "emitter",
        &[
            "area",
            "constant",
            "directional",
            "directionalarea",
            "envmap",
            "point",
            "projector",
            "spot",
            "sunsky",
            "timed_sunsky",
        ],
    ),
    ("medium", &["heterogeneous", "homogeneous"]),
    ("phase", &["blendphase", "hg", "isotropic", "rayleigh", "sggx", "tabphase"]),
    ("volume", &["constvolume", "gridvolume"]),
];

/// Which tags may stand in which.
const INSIDE: [(&str, &[&str]); 13] = [
    ("scene", &["integrator", "sensor", "shape", "bsdf", "texture", "emitter", "medium", "phase", "volume"]),
    ("integrator", &["integrator"]),
    ("sensor", &["film", "sampler", "medium", "texture"]),
    ("film", &["rfilter", "texture"]),
    ("sampler", &[]),
    ("rfilter", &[]),
    ("shape", &["bsdf", "emitter", "sensor", "medium", "shape", "volume", "texture"]),
    ("bsdf", &["bsdf", "texture"]),
    ("texture", &["texture", "volume"]),
    ("emitter", &["texture", "medium"]),
    ("medium", &["phase", "volume"]),
    ("phase", &["phase", "volume", "texture"]),
    ("volume", &["volume", "texture"]),
];

fn names<T>(rows: &'static [Row<T>]) -> Vec<&'static str> {
    rows.iter().map(|row| row.name).collect()
}

/// Plugins that Tyndall itself builds under `tag`; none where there is no registry of them.
fn ours(tag: &str) -> Vec<&'static str> {
    match tag {
        "integrator" => names(integrator::ROWS),
        "rfilter" => names(filter::ROWS),
        "shape" => shape::ROWS.iter().map(|row| row.name).collect(),
        "bsdf" => names(bsdf::ROWS),
        "texture" => names(texture::ROWS),
        "emitter" => names(emitter::ROWS),
        "medium" => names(medium::ROWS),
        "phase" => names(phase::ROWS),
        _ => Vec::new(),
    }
}

/// All tags under which there is a plugin called `plugin`.
pub(super) fn of_plugin(plugin: &str) -> Vec<&'static str> {
    let known =
        |(tag, plugins): &(&'static str, &[&str])| plugins.contains(&plugin) || ours(tag).contains(&plugin);
    MITSUBA.iter().filter(|row| known(row)).map(|(tag, _)| *tag).collect()
}

/// The tag of a plugin called `plugin` that stands as `name` in a `parent`; none if that does not tell.
pub(super) fn derive(plugin: &str, name: &str, parent: &str) -> Option<&'static str> {
    let inside = INSIDE.iter().find(|(tag, _)| *tag == parent).map_or(&[][..], |(_, tags)| tags);
    let by_plugin = of_plugin(plugin);
    if let [only] = by_plugin.as_slice() {
        return Some(only);
    }
    let candidates = if by_plugin.is_empty() { inside.to_vec() } else { by_plugin };
    let fitting: Vec<_> = candidates.into_iter().filter(|tag| inside.contains(tag)).collect();
    let named = fitting.iter().find(|tag| **tag == by_name(name));
    named.or(if let [only] = fitting.as_slice() { Some(only) } else { None }).copied()
}

/// The tag that a name stands for: itself, with or without a number, or the parameter that it is.
fn by_name(name: &str) -> &str {
    match name {
        "interior" | "exterior" => "medium",
        "sigma_t" | "albedo" => "volume",
        _ => name.trim_end_matches(|c: char| c.is_ascii_digit()).trim_end_matches('_'),
    }
}

/// Every plugin in `root` must be one, and of the kind that its tag says. What is known but of no use where it
/// stands is for builders to tell, and so are volumes.
pub(super) fn check(root: &Object) -> Result<()> {
    check_below(root, "scene")
}

fn check_below(object: &Object, tag: &str) -> Result<()> {
    for property in &object.properties {
        let Value::Object(child) = &property.value else { continue };
        let derived = || derive(&child.plugin, &property.name, tag);
        let Some(child_tag) = child.tag.as_deref().or_else(derived) else {
            // Elsewhere it may be a density, and those are for builders to know.
            match tag {
                "shape" | "sensor" | "film" | "bsdf" | "integrator" => return Err(unknown_in(child, tag)),
                _ => continue,
            }
        };
        if child_tag == "volume" {
            continue;
        }
        check_tag(child, child_tag)?;
        check_below(child, child_tag)?;
    }
    Ok(())
}

fn check_tag(object: &Object, tag: &str) -> Result<()> {
    let (tags, ours) = (of_plugin(&object.plugin), ours(tag));
    if ours.contains(&object.plugin.as_str()) || (ours.is_empty() && tags.contains(&tag)) {
        return Ok(());
    }
    let known = if ours.is_empty() { renderable(tag).to_vec() } else { ours };
    if tags.contains(&tag) {
        let found = format!("\"{}\", which only Mitsuba has", object.plugin);
        let remedy = format!("replace it; Tyndall has: {}", known.join(", "));
        return Err(Error::new(&object.location, format!("{} of Tyndall", kind(tag)), found, remedy));
    }
    match tags.first() {
        None => Err(unknown(object, Some(tag), &known)),
        Some(right) => {
            let found = format!("\"{}\", which is {}", object.plugin, kind(right));
            let remedy = match object.location.position {
                Position::Text { .. } => {
                    format!("write <{right} type=\"{}\">, or name {}", object.plugin, kind(tag))
                }
                Position::Path(_) => format!("correct \"$tag\", or name {}", kind(tag)),
            };
            Err(Error::new(&object.location, format!("the type of {}", kind(tag)), found, remedy))
        }
    }
}

fn unknown(object: &Object, tag: Option<&str>, known: &[&str]) -> Error {
    let expected = tag.map_or("the type of a plugin".into(), |tag| format!("the type of {}", kind(tag)));
    let found = format!("\"{}\"", object.plugin);
    Error::new(&object.location, expected, found, suggest(&object.plugin, "known", known))
}

/// What can be rendered of the kinds that have no registry.
fn renderable(tag: &str) -> &'static [&'static str] {
    match tag {
        "sensor" => &["perspective"],
        "film" => &["hdrfilm"],
        _ => MITSUBA.iter().find(|(known, _)| *known == tag).map_or(&[], |(_, plugins)| plugins),
    }
}

/// A tag as a sentence needs it.
pub(super) fn kind(tag: &str) -> &str {
    match tag {
        "integrator" => "an integrator",
        "sensor" => "a sensor",
        "film" => "a film",
        "sampler" => "a sampler",
        "rfilter" => "a reconstruction filter",
        "shape" => "a shape",
        "bsdf" => "a bsdf",
        "texture" => "a texture",
        "emitter" => "an emitter",
        "medium" => "a medium",
        "phase" => "a phase function",
        "volume" => "a volume",
        other => other,
    }
}

/// The error for a plugin in a `parent` that nobody knows.
pub(super) fn unknown_in(object: &Object, parent: &str) -> Error {
    unknown(object, None, &known_in(parent))
}

/// All plugins that may stand in a `parent`.
fn known_in(parent: &str) -> Vec<&'static str> {
    let inside = INSIDE.iter().find(|(tag, _)| *tag == parent).map_or(&[][..], |(_, tags)| tags);
    let known = |tag: &&'static str| match ours(tag) {
        ours if ours.is_empty() => renderable(tag).to_vec(),
        ours => ours,
    };
    inside.iter().flat_map(known).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_place_decides_where_the_name_does_not() {
        assert_eq!(derive("sphere", "a", "scene"), Some("shape"));
        assert_eq!(derive("tent", "filter", "film"), Some("rfilter"));
        assert_eq!(derive("clay", "bsdf_2", "scene"), Some("bsdf"));
        assert_eq!(derive("clay", "wall", "scene"), None);
        assert_eq!(derive("smoke", "interior", "shape"), Some("medium"));
        assert_eq!(derive("turbulence", "sigma_t", "medium"), Some("volume"));
        assert_eq!(derive("odd", "film", "shape"), None);
    }

    #[test]
    fn every_tag_is_in_both_tables() {
        for tag in TAGS {
            assert!(tag == "scene" || MITSUBA.iter().any(|(known, _)| *known == tag), "{tag}");
            assert!(INSIDE.iter().any(|(known, _)| *known == tag), "{tag}");
        }
    }
}
