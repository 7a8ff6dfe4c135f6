//! Checks that every plugin of a scene exists and is of the kind that its tag or place says. This runs before anything
//! is built, so that a misspelt name is reported as that, with the nearest right one.

use super::tags::{MITSUBA, by_name, derive, inside, of_plugin, ours, table, whole_of};
use crate::{
    description::{Object, Position, Property, Value, parameter::Kind, substitutes, suggest},
    error::{Error, Result},
};
use std::collections::HashMap;

/// An error unless every plugin in `root` exists and is of the kind that its tag says. Builders report known plugins
/// that are out of place.
pub(crate) fn check(root: &Object) -> Result<()> {
    let mut known = HashMap::new();
    identified(root, &mut known);
    check_below(root, "scene", &known)
}

/// Objects by id.
type Known<'a> = HashMap<&'a str, &'a Object>;

/// Adds the objects of `object` that references may name, with their ids, to `known`.
fn identified<'a>(object: &'a Object, known: &mut Known<'a>) {
    for property in &object.properties {
        if let Value::Object(child) = &property.value {
            known.extend(child.id.as_deref().map(|id| (id, child)));
            identified(child, known);
        }
    }
}

fn check_below(object: &Object, tag: &str, known: &Known<'_>) -> Result<()> {
    for property in &object.properties {
        check_parameter(object, tag, property, known)?;
        let Value::Object(child) = &property.value else { continue };
        let derived = || derive(&child.plugin, &property.name, tag);
        let Some(child_tag) = child.tag.as_deref().or_else(derived) else {
            // Elsewhere builders know better what is allowed.
            match tag {
                "shape" | "sensor" | "film" | "bsdf" | "integrator" => return Err(unknown_in(child, tag)),
                _ => continue,
            }
        };
        match whole_of(&child.plugin) {
            Some(whole) if whole == object.plugin && child_tag == "volume" => {}
            Some(whole) => return Err(astray(child, whole)),
            None => check_tag(child, child_tag)?,
        }
        check_below(child, child_tag, known)?;
    }
    Ok(())
}

/// An error if keyframes, a reference or a word stand where the parameter cannot be one.
fn check_parameter(object: &Object, tag: &str, property: &Property, known: &Known<'_>) -> Result<()> {
    let (Value::Keyframes(_) | Value::Reference(_) | Value::String(_)) = &property.value else {
        return Ok(());
    };
    let row = table(tag, &object.plugin).and_then(|table| table.find(&property.name));
    match (&property.value, row.map(|row| row.kind)) {
        // A whole number has no values between two keys.
        (Value::Keyframes(_), Some(Kind::Integer(_))) => {
            let expected = format!("an integer for \"{}\", which cannot change in time", property.name);
            Err(Error::new(&property.location, expected, property.value.describe(), "give one number"))
        }
        (Value::Reference(id), Some(Kind::Object(wanted))) => check_reference(property, id, wanted, known),
        (Value::String(word), Some(Kind::Object(wanted))) => Err(mere_word(property, word, wanted, known)),
        (Value::String(word), None) => {
            let nests = |wanted: &&str| {
                table(tag, &object.plugin).is_some_and(|table| table.nested(wanted).is_some())
            };
            let of_plugin = |plugin: &str| of_plugin(plugin).into_iter().find(nests);
            let named = inside(tag).iter().find(|tag| **tag == by_name(&property.name)).copied();
            let meant = || known.get(word.as_str()).map_or(word, |object| &object.plugin);
            match named.or_else(|| of_plugin(meant())) {
                Some(wanted) => Err(mere_word(property, word, wanted, known)),
                None => Ok(()),
            }
        }
        _ => Ok(()),
    }
}

/// The error for a `word`, the name of a plugin or an id, in place of an object of the kind `wanted`.
fn mere_word(property: &Property, word: &str, wanted: &'static str, known: &Known<'_>) -> Error {
    let name = &property.name;
    let is_json = matches!(property.location.position, Position::Path(_));
    let is_wanted = |plugin: &str| of_plugin(plugin).contains(&wanted);
    let remedy = match (known.get(word).is_some_and(|object| is_wanted(&object.plugin)), is_json) {
        (true, true) => format!("write \"{name}\": {{\"type\": \"ref\", \"id\": \"{word}\"}}"),
        (true, false) => format!("write <ref name=\"{name}\" id=\"{word}\"/>"),
        (false, _) if !is_wanted(word) => {
            suggest(word, &format!("write {} there; known", kind(wanted)), &plugins_of(wanted))
        }
        (false, true) => format!("write \"{name}\": {{\"type\": \"{word}\"}}"),
        (false, false) => format!("write <{wanted} name=\"{name}\" type=\"{word}\"/>"),
    };
    Error::new(
        &property.location,
        format!("{} for \"{name}\"", kind(wanted)),
        property.value.describe(),
        remedy,
    )
}

/// An error if the `property` refers to a known object that is not of the kind `wanted`.
fn check_reference(property: &Property, id: &str, wanted: &'static str, known: &Known<'_>) -> Result<()> {
    let Some(target) = known.get(id) else { return Ok(()) };
    let tags = of_plugin(&target.plugin);
    if tags.is_empty() || tags.contains(&wanted) {
        return Ok(());
    }
    let expected = format!("{} for \"{}\"", kind(wanted), property.name);
    let found = format!("a reference to \"{id}\", {} (\"{}\")", kind(tags[0]), target.plugin);
    let mut there: Vec<&str> = known.keys().copied().collect();
    there.retain(|id| of_plugin(&known[id].plugin).contains(&wanted));
    there.sort_unstable();
    let remedy = match there.is_empty() {
        true => format!("write {} there, or define one with an id and refer to it", kind(wanted)),
        false => suggest(id, &format!("refer to {}", kind(wanted)), &there),
    };
    Err(Error::new(&property.location, expected, found, remedy))
}

fn check_tag(object: &Object, tag: &str) -> Result<()> {
    let (tags, ours) = (of_plugin(&object.plugin), ours(tag));
    if ours.contains(&object.plugin.as_str()) || (ours.is_empty() && tags.contains(&tag)) {
        return Ok(());
    }
    let known = plugins_of(tag);
    let instead = substitutes::of_plugin(&object.plugin, Some(tag));
    if tags.contains(&tag) {
        let found = format!("\"{}\", which only Mitsuba has", object.plugin);
        let remedy = format!("{}; Tyndall has: {}", instead.unwrap_or("replace it"), known.join(", "));
        return Err(Error::new(&object.location, format!("{} of Tyndall", kind(tag)), found, remedy));
    }
    match tags.first().filter(|_| instead.is_none()) {
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

/// The error for a part that is elsewhere than in its `whole`.
fn astray(part: &Object, whole: &str) -> Error {
    let remedy = format!("put it into a {whole}");
    Error::new(&part.location, format!("a {} in a {whole}", part.plugin), "it elsewhere", remedy)
}

fn unknown(object: &Object, tag: Option<&str>, known: &[&str]) -> Error {
    let expected = tag.map_or("the type of a plugin".into(), |tag| format!("the type of {}", kind(tag)));
    let found = format!("\"{}\"", object.plugin);
    let remedy = match substitutes::of_plugin(&object.plugin, tag) {
        // All that a scene can hold is no help.
        Some(instead) if tag.is_none() => instead.to_owned(),
        Some(instead) => format!("{instead}; known: {}", known.join(", ")),
        None => suggest(&object.plugin, "known", known),
    };
    Error::new(&object.location, expected, found, remedy)
}

/// What can be rendered of the kinds that have no registry.
fn renderable(tag: &str) -> &'static [&'static str] {
    match tag {
        "film" => &["hdrfilm"],
        _ => MITSUBA.iter().find(|(known, _)| *known == tag).map_or(&[], |(_, plugins)| plugins),
    }
}

/// A tag as a sentence needs it.
pub(crate) fn kind(tag: &str) -> &str {
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

/// The error for an unknown plugin in a `parent`.
pub(crate) fn unknown_in(object: &Object, parent: &str) -> Error {
    unknown(object, None, &known_in(parent))
}

/// All plugins that are allowed in a `parent`.
fn known_in(parent: &str) -> Vec<&'static str> {
    inside(parent).iter().flat_map(|tag| plugins_of(tag)).collect()
}

/// All plugins of the kind `tag` that can be rendered.
pub(crate) fn plugins_of(tag: &str) -> Vec<&'static str> {
    match ours(tag) {
        ours if ours.is_empty() => renderable(tag).to_vec(),
        ours => ours,
    }
}
