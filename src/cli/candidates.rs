//! What a pilot predicts for its candidates: for `info --pilot`.

use super::{plan, provenance};
use crate::learning::pilot::{DENOISED, Foretold, GUIDED, LEARNT, Report, WORTHWHILE};
use serde_json::{Value, json};

/// How many are shown.
const SHOWN: usize = 12;

/// In a table, the best first.
pub(super) fn table(report: &Report) -> String {
    let Report { candidates, samples, choice } = report;
    if candidates.is_empty() {
        return "pilot       none: nothing emits light, or too few samples are to come".to_owned();
    }
    if candidates.iter().all(|one| !one.judgement.is_finite()) {
        return format!(
            "pilot       {samples:.0} samples, none of which saw light: all strategies run alike"
        );
    }
    let mut lines = vec![
        format!(
            "pilot       {samples:.0} samples; error: squared relative error of a pixel sample; time: in segments of walks"
        ),
        format!("            {:>9} {:>8} {:>9}  candidate", "error", "time", "judgement"),
    ];
    lines.extend(candidates.iter().take(SHOWN).map(line));
    let learnt = if choice.effort.is_guided() { ", all of which use path guiding" } else { "" };
    lines.push(format!("            {} candidates{learnt}. The least judgement wins.", candidates.len()));
    lines.push(
        "            It is time x error, with the same allowance for rare bright paths in all.".to_owned(),
    );
    lines.push(format!(
        "            Longer walks beside light subpaths, equiangular sampling and aimed starts must be {WORTHWHILE} times better, learnt starts {LEARNT} times."
    ));
    lines.push(format!(
        "            A guide beside light subpaths has a pilot of its own and must be {GUIDED} times better."
    ));
    lines.push(format!(
        "            In images for a denoiser, light subpaths must be {DENOISED} times better: it removes less of their noise."
    ));
    lines.join("\n")
}

fn line(foretold: &Foretold) -> String {
    let Foretold { error, time, judgement, .. } = foretold;
    format!("            {:>9.3} {time:>8.2} {judgement:>9.3}  {}", error.all(), name(foretold))
}

fn name(Foretold { choice, .. }: &Foretold) -> String {
    let strategies = choice.strategies.names().join("+");
    [vec![strategies], plan::efforts(choice.effort)].concat().join(", ")
}

/// The same for scripts.
pub(super) fn json(report: &Report) -> Value {
    let one = |Foretold { choice, error, time, judgement }: &Foretold| {
        let mut one = provenance::by_pilot(*choice);
        one["error"] = error.all().into();
        one["error_in_few_tiles"] = error.few.into();
        one["time"] = (*time).into();
        one["judgement"] = (*judgement).into();
        one
    };
    json!({ "samples": report.samples, "candidates": report.candidates.iter().map(one).collect::<Vec<_>>() })
}
