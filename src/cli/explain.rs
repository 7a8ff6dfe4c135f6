//! `tyndall explain`: what scenes can hold, out of the tables that they are read by.

mod schema;
#[cfg(test)]
mod tests;
mod text;
mod words;

use super::console;
use crate::{
    description::{Table, nearest, parameter::Parameter},
    error::{Error, Result},
    format::tags,
    scene, volume,
};
use clap::Args;

/// Explain what scenes can hold.
#[derive(Args, Clone, Debug, PartialEq)]
pub struct Explain {
    /// Plugin (spot), kind of plugins (emitter), parameter (cutoff_angle), word (fog, rotate), keyframes or progress [default: list all]
    #[arg(value_name = "PLUGIN")]
    pub topic: Option<String>,

    /// Print a JSON Schema of scenes instead, by which editors complete and check them
    #[arg(long, conflicts_with = "topic")]
    pub schema: bool,
}

/// Kinds of plugins by their tags, as headings.
const KINDS: [(&str, &str); 13] = [
    ("scene", "Scene"),
    ("sensor", "Cameras"),
    ("film", "Film"),
    ("rfilter", "Reconstruction filters"),
    ("sampler", "Samplers"),
    ("integrator", "Integrators"),
    ("shape", "Shapes"),
    ("bsdf", "BSDFs"),
    ("emitter", "Emitters"),
    ("texture", "Textures and colours"),
    ("medium", "Media"),
    ("volume", "Volumes"),
    ("phase", "Phase functions"),
];

/// What is no plugin and may stand in place of values.
const KEYFRAMES: &str = "keyframes";
/// What is no part of scenes.
const PROGRESS: &str = "progress";

/// Prints what was asked for.
pub(super) fn run(arguments: &Explain) -> Result<()> {
    let text = match &arguments.topic {
        _ if arguments.schema => format!("{:#}", schema::of_scenes()),
        None => {
            let kinds = KINDS.map(|(tag, _)| text::kind(tag)).join("\n");
            let progress = text::PROGRESS.lines().next().unwrap_or_default();
            let words = words::heads();
            format!("{kinds}\n{words}\n\n{KEYFRAMES}: {}\n{PROGRESS}: {progress}", text::KEYFRAMES)
        }
        Some(topic) => explained(topic)?,
    };
    console::print(text.trim_end());
    Ok(())
}

/// All plugins of the kind `tag`, each with its parameters.
pub(super) fn listing(tag: &str) -> String {
    text::listing(tag)
}

/// A word, a plugin, a kind of plugins, or a parameter; several where they share the name.
fn explained(topic: &str) -> Result<String> {
    let word = words::word(topic);
    let mut texts: Vec<String> = Vec::new();
    if topic == KEYFRAMES {
        texts.push(format!("{KEYFRAMES}: {}\n{}", text::KEYFRAMES, text::KEYFRAMES_WRITTEN));
    }
    if topic == PROGRESS {
        texts.push(format!("{PROGRESS}: {}", text::PROGRESS));
    }
    for (tag, plugin, table) in everything() {
        if plugin == topic {
            texts.push(text::plugin(tag, plugin, table));
        }
    }
    if texts.is_empty() && KINDS.iter().any(|(tag, _)| *tag == topic) {
        texts.push(text::kind(topic));
    }
    if texts.is_empty() {
        texts.extend(text::parameter(topic));
    }
    texts.splice(0..0, word);
    if texts.is_empty() { Err(unknown(topic)) } else { Ok(texts.join("\n")) }
}

fn unknown(topic: &str) -> Error {
    let mut known: Vec<&str> =
        KINDS.iter().map(|(tag, _)| *tag).chain([KEYFRAMES, PROGRESS]).chain(words::names()).collect();
    for (_, plugin, table) in everything() {
        known.push(plugin);
        known.extend(table.rows().map(|row| row.name));
    }
    let remedy = format!("{}\"tyndall explain\" lists all plugins", nearest(topic, &known));
    Error::new(
        "explain",
        "a plugin, a kind of plugins, a parameter or a word",
        format!("\"{topic}\""),
        remedy,
    )
}

/// Plugins of a kind, with their tables.
fn plugins(tag: &str) -> Vec<(&'static str, &'static Table)> {
    let mut all = tags::tables(tag);
    match tag {
        "scene" => all.push(("scene", &scene::TABLE)),
        "volume" => all.extend(volume::PARTS.iter().map(|(part, _, table)| (*part, table))),
        _ => {}
    }
    all
}

/// Every plugin with its kind and table.
fn everything() -> impl Iterator<Item = (&'static str, &'static str, &'static Table)> {
    KINDS.iter().flat_map(|(tag, _)| plugins(tag).into_iter().map(move |(name, table)| (*tag, name, table)))
}

/// True if Mitsuba has no such plugin.
fn is_ours(tag: &str, plugin: &str) -> bool {
    let of_mitsuba = tags::MITSUBA.iter().find(|(known, _)| *known == tag);
    plugin != "scene" && of_mitsuba.is_some_and(|(_, plugins)| !plugins.contains(&plugin))
}

/// " *" for what Mitsuba does not have.
fn star(is_ours: bool) -> &'static str {
    if is_ours { "*" } else { "" }
}

/// Rows that count, and those that are accepted without effect.
fn rows(table: &'static Table) -> (Vec<&'static Parameter>, Vec<&'static Parameter>) {
    table.rows().partition(|row| !row.is_ignored())
}
