//! What a pilot foretells of all that it may choose: for `info --pilot`.

use crate::{
    render::pilot::{Foretold, Report},
    settings::options::Survival,
};
use serde_json::{Value, json};

/// How many are shown.
const SHOWN: usize = 12;

/// In a table, the best first.
pub fn table(report: &Report) -> String {
    let Report { candidates, samples, choice } = report;
    if candidates.is_empty() {
        let why = "none: for so few samples of this image it would take longer than a choice could gain";
        return format!("pilot       {why}");
    }
    let mut lines = vec![
        format!(
            "pilot       {samples:.0} samples; error: squared and relative, of a pixel sample; time: in segments of walks"
        ),
        format!("            {:>9} {:>8} {:>9}  candidate", "error", "time", "judgement"),
    ];
    lines.extend(candidates.iter().take(SHOWN).map(line));
    let learnt = if choice.effort.is_guided() { ", all of which follow a guide" } else { "" };
    lines.push(format!(
        "            {} candidates{learnt}; the least judgement wins: time x error, in which rare bright",
        candidates.len()
    ));
    lines.push(
        "            paths count alike for all, x 1.1 for each thing that is out of the common".to_owned(),
    );
    lines.join("\n")
}

fn line(foretold: &Foretold) -> String {
    let Foretold { error, time, judgement, .. } = foretold;
    format!("            {:>9.3} {time:>8.2} {judgement:>9.3}  {}", error.all(), name(foretold))
}

fn name(Foretold { choice, .. }: &Foretold) -> String {
    let effort = choice.effort;
    let mut words = vec![choice.strategies.names().join("+")];
    if effort.survival != Survival::default() {
        words.push(format!("survival {}", effort.survival.name()));
    }
    if effort.light_walks != 1.0 {
        words.push(format!("{} light subpaths a sample", effort.light_walks));
    }
    if effort.connections != 1 {
        words.push(format!("{} joins a vertex", effort.connections));
    }
    if effort.learnt_starts {
        words.push("learnt starts".to_owned());
    }
    words.join(", ")
}

/// The same for scripts.
pub fn json(report: &Report) -> Value {
    let one = |foretold: &Foretold| {
        let Foretold { choice, error, time, judgement } = foretold;
        let effort = choice.effort;
        json!({
            "strategies": choice.strategies.names(),
            "survival": effort.survival.name(),
            "light_walks": effort.light_walks,
            "connections": effort.connections,
            "learnt_starts": effort.learnt_starts,
            "error": error.all(),
            "error_in_few_tiles": error.few,
            "time": time,
            "judgement": judgement,
        })
    };
    json!({ "samples": report.samples, "candidates": report.candidates.iter().map(one).collect::<Vec<_>>() })
}
