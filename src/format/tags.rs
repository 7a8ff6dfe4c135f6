//! Which XML tag a plugin goes with. XML always says; JSON leaves it to the plugin's name and place.

use crate::{
    bsdf,
    description::Table,
    emitter,
    film::filter,
    medium, phase, sensor,
    settings::{film, integrator, sampler},
    shape, texture, volume,
};

/// Tags of plugins.
pub(crate) const TAGS: [&str; 13] = [
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
pub(crate) const MITSUBA: [(&str, &[&str]); 12] = [
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

/// Which tags may be nested in which.
pub(crate) const INSIDE: [(&str, &[&str]); 13] = [
    ("scene", &["integrator", "sensor", "shape", "bsdf", "texture", "emitter", "medium", "phase", "volume"]),
    ("integrator", &["integrator"]),
    ("sensor", &["sensor", "film", "sampler", "medium", "texture", "shape"]),
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

/// Tags that may be nested in a `parent`.
pub(crate) fn inside(parent: &str) -> &'static [&'static str] {
    INSIDE.iter().find(|(tag, _)| *tag == parent).map_or(&[], |(_, tags)| tags)
}

/// Plugins that Tyndall itself builds under `tag`, with their tables.
pub(crate) fn tables(tag: &str) -> Vec<(&'static str, &'static Table)> {
    match tag {
        "sensor" => sensor::ROWS.tables().chain([(sensor::BATCH, &sensor::BATCH_TABLE)]).collect(),
        "film" => film::ROWS.tables().collect(),
        "integrator" => integrator::ROWS.tables().collect(),
        "sampler" => sampler::ROWS.tables().collect(),
        "rfilter" => filter::ROWS.tables().collect(),
        "shape" => shape::ROWS.tables().chain(shape::COMPOSED.tables()).collect(),
        "bsdf" => bsdf::ROWS.tables().collect(),
        "texture" => texture::ROWS.tables().collect(),
        "emitter" => emitter::ROWS.tables().collect(),
        "medium" => medium::ROWS.tables().collect(),
        "phase" => phase::ROWS.tables().collect(),
        "volume" => volume::ROWS.tables().collect(),
        _ => Vec::new(),
    }
}

/// The table of the one called `plugin`.
pub(crate) fn table(tag: &str, plugin: &str) -> Option<&'static Table> {
    tables(tag).into_iter().find_map(|(name, table)| (name == plugin).then_some(table))
}

/// Their names; none where there is a choice of one only.
pub(crate) fn ours(tag: &str) -> Vec<&'static str> {
    let tables = if tag == "film" { Vec::new() } else { tables(tag) };
    tables.into_iter().map(|(name, _)| name).collect()
}

/// The plugin that `plugin` is a part of; none where it is complete by itself.
pub(crate) fn whole_of(plugin: &str) -> Option<&'static str> {
    volume::PARTS.iter().find(|(part, ..)| *part == plugin).map(|(_, whole, _)| *whole)
}

/// All tags under which there is a plugin called `plugin`.
pub(crate) fn of_plugin(plugin: &str) -> Vec<&'static str> {
    if whole_of(plugin).is_some() {
        return vec!["volume"];
    }
    let known =
        |(tag, plugins): &(&'static str, &[&str])| plugins.contains(&plugin) || ours(tag).contains(&plugin);
    MITSUBA.iter().filter(|row| known(row)).map(|(tag, _)| *tag).collect()
}

/// The tag of a plugin called `plugin` that is the child `name` of a `parent`; none if that does not
/// determine it.
pub(crate) fn derive(plugin: &str, name: &str, parent: &str) -> Option<&'static str> {
    let inside = inside(parent);
    let by_plugin = of_plugin(plugin);
    if let [only] = by_plugin.as_slice() {
        // "fog" is an integrator, but within a shape it is meant to be a medium.
        let is_medium = by_name(name) == "medium" && inside.contains(&"medium") && !inside.contains(only);
        return Some(if is_medium { "medium" } else { only });
    }
    let candidates = if by_plugin.is_empty() { inside.to_vec() } else { by_plugin };
    let fitting: Vec<_> = candidates.into_iter().filter(|tag| inside.contains(tag)).collect();
    let named = fitting.iter().find(|tag| **tag == by_name(name));
    named.or(if let [only] = fitting.as_slice() { Some(only) } else { None }).copied()
}

/// The tag that a name refers to: itself, with or without a number, or the parameter that it is.
pub(crate) fn by_name(name: &str) -> &str {
    match name {
        "interior" | "exterior" => "medium",
        "sigma_t" | "albedo" => "volume",
        _ => name.trim_end_matches(|c: char| c.is_ascii_digit()).trim_end_matches('_'),
    }
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
        assert_eq!(derive("haze", "interior", "shape"), Some("medium"));
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
