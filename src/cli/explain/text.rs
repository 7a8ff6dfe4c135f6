//! Explanations for the terminal.

use super::{KINDS, everything, is_ours, plugins, rows, star};
use crate::description::{
    Table,
    parameter::{Default, Kind, Parameter, plain},
};

/// What keyframes are.
pub(super) const KEYFRAMES: &str =
    "In place of any value of numbers: what it is at some times [s]. Not in Mitsuba.";

/// What `--progress json` prints.
pub(super) const PROGRESS: &str = "\
the lines of JSON that --progress json prints on standard error, ten a second at most and one at the end
  {\"done\": 0.25, \"samples_per_pixel\": 16, \"noise\": 0.031, \"within\": null, \"seconds\": 2.1, \"image\": null}
  done               the part of the way to the nearest limit, from 0 to 1
  samples_per_pixel  samples so far
  noise              the relative error of the image so far (root of relMSE); null while it is unknown
  within             the share of the pixels within --error; null without it
  seconds            the time since the render began
  image              the frame or batch at hand; null if there is one image
  study says what it is doing (\"doing\") in place of samples and noise; strategies and pixel print \"done\" alone.
  With --quiet, all other lines are warnings and errors. If standard error is closed, the render ends as on Ctrl-C.";
/// How they are written, and what they mean.
pub(super) const KEYFRAMES_WRITTEN: &str = r#"
JSON: "radiance": { "type": "keyframes", "value": [[0, 1], [2.5, 3]], "interpolation": "smooth" }
XML:  <keyframes name="radiance"> <float time="0" value="1"/> <float time="2.5" value="3"/> </keyframes>

  value          pairs of a time and the value then: numbers, vectors, colours, transforms, or
                 strings of numbers. All have the same form, and transforms the same steps
  interpolation  linear, smooth; default linear. Smooth eases in and out, and stays between the keys

Before the first key and after the last one, theirs hold. Steps of a transform change in their own
numbers: a rotation by 0 and then by 720 degrees turns twice. Names of files, counts, "true" and
"false" stay as they are.

"tyndall render SCENE --frames 0..47 --fps 24" renders what is between 0 and 2 s.
"#;

/// One line a plugin.
pub(super) fn kind(tag: &str) -> String {
    let heading = KINDS.iter().find(|(known, _)| *known == tag).map_or(tag, |(_, heading)| heading);
    let names = plugins(tag).into_iter().map(|(name, table)| (marked(tag, name), table.about));
    format!("{heading} ({tag}, * not in Mitsuba)\n{}", columns(names.collect()))
}

/// All plugins of a kind, each with its parameters.
pub(super) fn listing(tag: &str) -> String {
    let of = |(name, table): (&'static str, &'static Table)| {
        let used = columns(rows(table).0.into_iter().map(line).collect());
        format!("{}\n  {}\n{used}", marked(tag, name), wrapped(table.about, 2))
    };
    plugins(tag).into_iter().map(of).collect::<Vec<_>>().join("\n")
}

/// A plugin and all of its parameters.
pub(super) fn plugin(tag: &str, name: &str, table: &'static Table) -> String {
    let (used, ignored) = rows(table);
    let kind = if tag == name { String::new() } else { format!(" ({tag})") };
    let about = wrapped(&format!("{}{kind}: {}", marked(tag, name), table.about), 0);
    let mut text = format!("{about}\n{}", columns(used.into_iter().map(line).collect()));
    if !ignored.is_empty() {
        let rows = ignored.into_iter().map(|row| (row.name.to_owned(), row.about));
        text += &format!("\nAccepted, without effect:\n{}", columns(rows.collect()));
    }
    if tag != "scene" {
        text += &format!("\nIn a scene, with every plain default written out:\n  {}\n", example(name, table));
    }
    text
}

/// All plugins that have a parameter, if any has.
pub(super) fn parameter(name: &str) -> Option<String> {
    let holders = everything().filter_map(|(tag, plugin, table)| {
        let row = table.find(name)?;
        let text = match row.is_ignored() {
            true => format!("accepted, without effect: {}", row.about),
            false => format!("{}; {}. {}", allowed(row), default(row), row.about),
        };
        Some((format!("{plugin} ({tag})"), text))
    });
    let holders: Vec<_> = holders.collect();
    (!holders.is_empty()).then(|| format!("{name}, a parameter of\n{}", columns(holders)))
}

/// A parameter, and what is said of it.
fn line(row: &Parameter) -> (String, String) {
    let written = format!("{}{}", written(row), star(row.ours));
    (written, format!("{}; {}. {}", allowed(row), default(row), row.about))
}

fn marked(tag: &str, name: &str) -> String {
    format!("{name}{}", star(is_ours(tag, name)))
}

/// A parameter's name; of what is nested under any name, its kind.
fn written(row: &Parameter) -> String {
    if row.kind == Kind::Nested { format!("({})", row.name) } else { row.name.to_owned() }
}

/// Names, and beside each a text.
fn columns(lines: Vec<(String, impl AsRef<str>)>) -> String {
    let width = lines.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    let line = |(name, text): &(String, _)| {
        format!("  {name:width$}  {}\n", wrapped(AsRef::as_ref(text), width + 4))
    };
    lines.iter().map(line).collect()
}

/// In lines of at most 100 characters, all but the first of which begin with `indent` spaces.
fn wrapped(text: &str, indent: usize) -> String {
    let (mut lines, mut column) = (String::new(), indent);
    for word in text.split(' ') {
        if column > indent && column + word.len() >= 100 {
            lines += &format!("\n{:indent$}", "");
            column = indent;
        } else if column > indent {
            lines.push(' ');
        }
        lines += word;
        column += word.len() + 1;
    }
    lines
}

/// What may be given.
pub(super) fn allowed(row: &Parameter) -> String {
    let range = row.range();
    let bounded = if range.is_bounded() { range.to_string() } else { String::new() };
    let text = match row.kind {
        Kind::Number(_) => format!("number{range}"),
        Kind::NumberOrName(_) => format!("number{range}, or the name of a material"),
        Kind::Integer(_) => format!("integer{range}"),
        Kind::Boolean => "true or false".into(),
        Kind::Text(what) => format!("text: {what}"),
        Kind::Choice(words) => words.join(", "),
        Kind::Vector => "three numbers".into(),
        Kind::Channels => "a number or three".into(),
        Kind::Transform => "transform".into(),
        Kind::Colour(..) => format!("colour{bounded}"),
        Kind::Texture(..) => format!("colour or texture{bounded}"),
        Kind::Volume(..) => format!("colour or volume{bounded}"),
        Kind::Spectrum => "spectrum".into(),
        Kind::File => "file".into(),
        Kind::Object(tag) => tag.into(),
        Kind::Nested => "nested, under any name".into(),
        Kind::Ignored { .. } => "anything".into(),
    };
    if row.unit.is_empty() { text } else { format!("{text} [{}]", row.unit) }
}

/// What counts where it is not given.
pub(super) fn default(row: &Parameter) -> String {
    match row.default {
        Default::Required => "required".into(),
        Default::Optional => "optional".into(),
        Default::Is(x) => format!("default {}", plain(rounded(x))),
        Default::Yes(b) => format!("default {b}"),
        Default::Word(word) => format!("default {word}"),
        Default::At([x, y, z]) => format!("default {x}, {y}, {z}"),
        Default::Said(text) => format!("default: {}", text.replace('`', "")),
    }
}

/// To six digits: thirds have endless ones.
fn rounded(x: f64) -> f64 {
    format!("{x:.5e}").parse().unwrap_or(x)
}

/// The plugin as JSON.
pub(super) fn example(name: &str, table: &Table) -> String {
    let value = |row: &Parameter| match (row.default, row.kind) {
        (Default::Is(x), _) => Some(plain(rounded(x))),
        (Default::Yes(b), _) => Some(b.to_string()),
        (Default::Word(word), _) => Some(format!("\"{word}\"")),
        (Default::At(v), _) => Some(format!("{v:?}").replace(".0", "")),
        (Default::Required, Kind::File | Kind::Text(_)) => Some("\"...\"".into()),
        (Default::Required, Kind::Nested) => Some("{ ... }".into()),
        (Default::Required, _) => Some("...".into()),
        (Default::Optional | Default::Said(_), _) => None,
    };
    let given = table.rows().filter_map(|row| Some(format!(", \"{}\": {}", row.name, value(row)?)));
    format!("\"my_{name}\": {{ \"type\": \"{name}\"{} }}", given.collect::<String>())
}
