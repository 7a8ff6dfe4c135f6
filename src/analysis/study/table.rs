//! What a study found, as text: a table to look at and rows for other programs.

use super::{trust, unit::Unit};
use crate::analysis::study::outcome::{Chosen, ContenderOutcome, Interval, Outcome, SceneOutcome};
use std::fmt::Write as _;

/// First row of `study.csv`.
pub const CSV_HEADER: &str =
    "scene,contender,samples,seed,seconds,mse,relmse,trimmed_relmse,mape,smape,difference,cpu_seconds\n";

/// Rows of `study.csv`: one a budget and seed.
pub fn csv_rows(scene: &str, contender: &str, units: &[Unit]) -> String {
    let mut rows = String::new();
    let (scene, contender) = (quoted(scene), quoted(contender));
    for (unit, m) in units.iter().flat_map(|unit| unit.points.iter().map(move |m| (unit, m))) {
        let numbers = [m.seconds, m.mse, m.relmse, m.trimmed_relmse, m.mape, m.smape, m.difference];
        let numbers = numbers.map(|number| number.to_string()).join(",");
        let cpu = m.cpu_seconds.map_or(String::new(), |seconds| seconds.to_string());
        let _ = writeln!(rows, "{scene},{contender},{},{},{numbers},{cpu}", m.samples, unit.seed);
    }
    rows
}

/// A field of a CSV file (RFC 4180).
fn quoted(text: &str) -> String {
    match text.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", text.replace('"', "\"\"")),
        false => text.to_owned(),
    }
}

/// The last budgets of all contenders, scene by scene.
pub fn text(outcome: &Outcome) -> String {
    let percent = 100.0 * outcome.confidence;
    outcome.scenes.iter().map(|scene| scene_text(scene, percent)).collect::<Vec<_>>().join("\n")
}

fn scene_text(scene: &SceneOutcome, percent: f64) -> String {
    let SceneOutcome { name, width, height, reference, .. } = scene;
    let mut text = format!("{name}, {width} x {height}; intervals of {percent} %\n");
    let _ = writeln!(text, "reference: {}", reference.how);
    trust::sentences(scene, short).iter().for_each(|sentence| text += &format!("{sentence}\n"));
    let rows: Vec<[String; 10]> =
        std::iter::once(HEADER.map(str::to_owned)).chain(scene.contenders.iter().filter_map(row)).collect();
    for row in &rows {
        let widths = (0..row.len()).map(|i| rows.iter().map(|row| row[i].chars().count()).max().unwrap_or(0));
        let cells = row.iter().zip(widths).enumerate();
        let line: Vec<String> = cells
            .map(
                |(i, (cell, width))| {
                    if i == 0 { format!("{cell:width$}") } else { format!("{cell:>width$}") }
                },
            )
            .collect();
        let _ = writeln!(text, "{}", line.join("  "));
    }
    scene.notes.iter().for_each(|note| text += &format!("note: {note}\n"));
    scene.contenders.iter().for_each(|contender| text += &notes(contender));
    text
}

/// What there is to know of a contender, below its name.
fn notes(ContenderOutcome { name, chosen, notes, .. }: &ContenderOutcome) -> String {
    let chosen = chosen.as_ref().map(Chosen::sentence);
    let all: String = chosen.iter().chain(notes).map(|note| format!("  {note}\n")).collect();
    if all.is_empty() { all } else { format!("{name}:\n{all}") }
}

const HEADER: [&str; 10] = [
    "contender",
    "spp",
    "seconds",
    "CPU seconds",
    "relMSE",
    "trimmed",
    "slope",
    "1/(relMSE s)",
    "times the first",
    "mean off by",
];

fn row(contender: &ContenderOutcome) -> Option<[String; 10]> {
    let last = contender.points.last()?;
    Some([
        contender.name.clone(),
        last.samples.to_string(),
        format!("{:.3}", last.seconds.mean),
        last.cpu_seconds.map_or("-".into(), |seconds| format!("{:.3}", seconds.mean)),
        with_ends(last.relmse, short),
        short(last.trimmed_relmse.mean),
        contender.slope.map_or("-".into(), |slope| with_ends(slope, |x| format!("{x:.2}"))),
        with_ends(contender.efficiency, short),
        contender.ratio.map_or("1".into(), |ratio| with_ends(ratio, short)),
        format!("{:+.2} %", 100.0 * last.difference.mean),
    ])
}

fn with_ends(interval: Interval, shown: fn(f64) -> String) -> String {
    format!("{} [{}, {}]", shown(interval.mean), shown(interval.low), shown(interval.high))
}

/// Three digits.
fn short(x: f64) -> String {
    match x.abs() {
        0.0 => "0".into(),
        0.01..100.0 => format!("{x:.*}", (2.0 - x.abs().log10().floor()) as usize),
        100.0..1e5 => format!("{x:.0}"),
        _ => format!("{x:.2e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits() {
        for (x, text) in [
            (0.0, "0"),
            (1.0, "1.00"),
            (0.012345, "0.0123"),
            (99.94, "99.9"),
            (-3.0, "-3.00"),
            (1234.0, "1234"),
            (1e-5, "1.00e-5"),
            (2e7, "2.00e7"),
            (f64::NAN, "NaN"),
        ] {
            assert_eq!(short(x), text);
        }
    }

    #[test]
    fn fields_with_commas_are_quoted() {
        assert_eq!(quoted("a b"), "a b");
        assert_eq!(quoted("a, \"b\""), "\"a, \"\"b\"\"\"");
    }
}
