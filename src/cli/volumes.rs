//! `tyndall info` of a volume file: the grids in it, and what `smoke` would take of them.

use super::console::{Answer, say};
use crate::{
    error::Result,
    math::DVec3,
    scene::smoke::{Glow, Taken},
    volume::{
        files::{
            Label,
            roles::{self, Roles, Wanted},
            sequence::{Clock, Sequence, runs},
        },
        grid::{Catalogue, Contents},
    },
};
use serde_json::{Value, json};
use std::path::Path;

/// Lists the grids of the file at `path`.
pub(super) fn run(path: &Path, answer: &Answer) -> Result<()> {
    let sequence = Sequence::new(path, Clock { fps: Clock::FPS, first: None });
    let first = sequence.as_ref().map(|numbered| numbered.at(0.0)).transpose();
    let first = first.map_err(|problem| problem.at(path.display()))?;
    let mut file = Catalogue::open(first.as_deref().unwrap_or(path))?;
    let (mut lines, mut figures) = (vec![], vec![]);
    if let Some((numbered, first)) = sequence.as_ref().zip(first.as_ref()) {
        let frames = numbered.frames();
        lines.push(format!("frames      {}: {}", frames.len(), runs(&frames)));
        lines.push(format!("the first   {}", first.display()));
    }
    for number in 0..file.labels.len() {
        let contents = file.contents(number);
        let label = &file.labels[number];
        lines.push(format!("grid        {}", headline(label)));
        match &contents {
            Ok(contents) => lines.extend(describe(contents)),
            Err(error) => lines.push(format!("  not read  {}: {}", error.expected, error.found)),
        }
        figures.push(figures_of(label, contents.ok().as_ref()));
    }
    let use_of = use_of(&mut file);
    lines.push(format!("smoke       {}", use_of.0));
    lines.push(format!(
        "scene       tyndall render {0} renders it; tyndall new {0} writes a scene",
        path.display()
    ));
    say(&lines.join("\n"));
    let frames = sequence.map(|numbered| numbered.frames());
    answer.give(&json!({ "frames": frames, "grids": figures, "smoke": use_of.1 }))
}

/// What the plugin `smoke` takes without being told, in words and for scripts.
fn use_of(file: &mut Catalogue) -> (String, Value) {
    let roles = match Roles::of_file(&file.labels, Wanted::default()) {
        // What cannot be read has been said.
        Ok(roles) => file.held(roles.clone()).map_or(roles, |held| held.roles),
        Err(problem) => return (format!("nothing by itself: {}", problem.remedy), Value::Null),
    };
    let labels = &file.labels;
    let name = |number: &usize| labels[*number].name.as_str();
    let mut parts = vec![];
    parts.extend(file.is_z_up().then(|| "+z up".to_owned()));
    parts.extend(roles.density.iter().map(|number| format!("density from {}", quoted(name(number)))));
    parts.extend(roles.temperature.iter().map(|number| format!("light from {}", quoted(name(number)))));
    if !roles.color.is_empty() {
        let names: Vec<_> = roles.color.iter().map(|number| quoted(name(number))).collect();
        parts.push(format!("colour from {}", names.join(", ")));
    }
    if !roles.velocity.is_empty() {
        let names: Vec<_> = roles.velocity.iter().map(|number| quoted(name(number))).collect();
        parts.push(format!("carried along by {} while the shutter is open", names.join(", ")));
    }
    let figures = json!({
        "up": if file.is_z_up() { "z" } else { "y" },
        "density": roles.density.as_ref().map(name),
        "temperature": roles.temperature.as_ref().map(name),
        "color": roles.color.iter().map(name).collect::<Vec<_>>(),
        "velocity": roles.velocity.iter().map(name).collect::<Vec<_>>(),
    });
    (parts.join(", "), figures)
}

fn quoted(name: &str) -> String {
    if name.is_empty() { "the only grid".to_owned() } else { format!("\"{name}\"") }
}

/// Name, type and class.
fn headline(label: &Label) -> String {
    let class = if label.class.is_empty() { "no class" } else { &label.class };
    let velocity = if roles::is_velocity(label) { ", a velocity" } else { "" };
    format!("{}, {}, {class}{velocity}", quoted(&label.name), label.kind)
}

fn describe(contents: &Contents) -> Vec<String> {
    let Contents { active, range: [low, high], bytes, .. } = contents;
    let Some(([first, last], [from, to])) = contents.active_box.zip(contents.active_world()) else {
        return vec!["  voxels    none is active".to_owned()];
    };
    let size = [0, 1, 2].map(|axis| last[axis] - first[axis] + 1);
    let [x, y, z] = size;
    vec![
        format!("  voxels    {x} x {y} x {z}, from {first:?} to {last:?}; {active} are active"),
        format!(
            "  world     {} to {}, voxels of {}",
            numbers(from),
            numbers(to),
            numbers(contents.voxel_size())
        ),
        format!("  values    {} to {}", list(low), list(high)),
        format!("  memory    {}", size_in_words(*bytes)),
    ]
}

/// A place.
pub(super) fn numbers(v: DVec3) -> String {
    let [x, y, z] = v.to_array().map(|x| short(x, v.abs().max_element()));
    format!("[{x}, {y}, {z}]")
}

/// At most six digits after the point, and what is less than rounding beside `most` is 0.
fn short(x: f64, most: f64) -> f64 {
    let rounded = (x * 1e6).round() / 1e6;
    match x.abs() < 1e-12 * most {
        true => 0.0,
        false if rounded == 0.0 || !rounded.is_finite() => x,
        false => rounded,
    }
}

fn list(values: &[f32]) -> String {
    values.iter().map(f32::to_string).collect::<Vec<_>>().join(" ")
}

fn size_in_words(bytes: u64) -> String {
    let units = ["bytes", "kB", "MB", "GB"];
    let step = (0..3).rev().find(|step| bytes >= 1000_u64.pow(step + 1)).map_or(0, |step| step + 1);
    let amount = bytes as f64 / 1000_f64.powi(step as i32);
    if step == 0 { format!("{bytes} bytes") } else { format!("{amount:.1} {}", units[step as usize]) }
}

fn figures_of(label: &Label, contents: Option<&Contents>) -> Value {
    let mut figures = json!({ "name": label.name, "type": label.kind, "class": label.class });
    if let Some(contents) = contents {
        figures["active_voxels"] = contents.active.into();
        figures["box"] = json!(contents.active_box);
        figures["world"] = json!(contents.active_world().map(|ends| ends.map(|end| end.to_array())));
        figures["voxel_size"] = json!(contents.voxel_size().to_array());
        figures["least"] = json!(contents.range[0]);
        figures["greatest"] = json!(contents.range[1]);
        figures["memory"] = contents.bytes.into();
    }
    figures
}

/// What smoke of a scene was made of, for scripts.
pub(super) fn taken(taken: &Taken) -> Value {
    json!({
        "name": taken.name,
        "file": taken.file.display().to_string(),
        "up": if taken.is_z_up { "z" } else { "y" },
        "density": taken.density,
        "temperature": taken.glow.as_ref().map(|Glow { grid, scale, offset, most }| json!({
            "grid": grid,
            "scale": scale,
            "offset": offset,
            "greatest": most,
        })),
        "color": taken.color,
        "unused": taken.unused,
    })
}
