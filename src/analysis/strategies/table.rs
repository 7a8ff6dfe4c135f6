//! The numbers of a study of strategies, for people and for spreadsheets.

use super::{CellReport, Report, SubsetReport};
use crate::analysis::study::outcome::Interval;

/// A ratio and its interval, by two digits after the point or two that say something.
pub(super) fn times(ratio: Interval) -> String {
    let text = |x: f64| {
        let digits = if x > 0.0 { (1.0 - x.log10().floor()).clamp(2.0, 9.0) } else { 2.0 };
        format!("{x:.0$}", digits as usize)
    };
    format!("{}x [{}, {}]", text(ratio.mean), text(ratio.low), text(ratio.high))
}

/// The report as text.
pub fn table(report: &Report) -> String {
    let [width, height] = report.size;
    let mut lines = vec![
        format!(
            "{}: {} passes over {width} x {height} pixels, mean luminance {:.4}, {} of all threads a pass",
            report.strategies.join(","),
            report.passes,
            report.luminance,
            seconds(report.seconds),
        ),
        String::new(),
        format!(
            "{:>6} {:>3} {:>3}  {:<12}{:>10}{:>10}{:>10}{:>10}{:>10}",
            "length", "s", "t", "strategy", "energy", "alone", "variance", "time", "tries"
        ),
    ];
    lines.extend(report.cells.iter().filter(|cell| cell.tries > 0.0 || cell.energy > 0.0).map(line));
    let walks = |name: &str, time: f64, vertices: f64| {
        format!("{:15}{name:<12}{:30}{:>10}{vertices:>10.3}", "", "", percent(Some(time)))
    };
    lines.push(walks("eye walks", report.eye_walks, report.eye_vertices));
    lines.push(walks("light walks", report.light_walks, report.light_vertices));
    lines.push(
        format!("{:15}{:<32}{:>10}", "", "covariances", percent(report.covariances)).trim_end().to_owned(),
    );
    lines.push(String::new());
    lines.extend(EXPLANATION.iter().map(|text| (*text).to_owned()));
    let rows = report.rows.iter().map(|row| format!("{} {:.3}", length(row.length), row.exposure));
    lines.push(format!("exposure of the rows of both sheets: {}", rows.collect::<Vec<_>>().join(", ")));
    if !report.subsets.is_empty() {
        lines.push(String::new());
        lines.push(SUBSETS.to_owned());
    }
    lines.extend(report.subsets.iter().map(subset));
    lines.extend(report.advice.iter().map(|advice| format!("advice: {advice}")));
    lines.join("\n")
}

const SUBSETS: &str = "with less: relMSE x seconds of all strategies over that of fewer; more than 1 is better (rare bright \
     paths that the short renders did not meet are not in it)";

const EXPLANATION: [&str; 3] = [
    "energy: share of the mean luminance. alone: the unweighted contribution of the strategy, relative to all light on paths of its length.",
    "variance: of its weighted part in one pass, over that of the image (luminance, summed over pixels; covariances apart).",
    "time: share of the time of all threads spent on its connections. tries: number of connections per pixel and pass; \
     of walks, number of vertices.",
];

fn line(cell: &CellReport) -> String {
    let number = |n: Option<u32>| n.map_or(String::new(), |n| n.to_string());
    let alone = cell.alone.map_or(String::new(), |alone| format!("{alone:.3}"));
    format!(
        "{:>6} {:>3} {:>3}  {:<12}{:>10}{alone:>10}{:>10}{:>10}{:>10.3}",
        length(cell.length),
        number(cell.s),
        number(cell.t),
        cell.kind,
        percent(Some(cell.energy)),
        percent(cell.variance),
        percent(Some(cell.time)),
        cell.tries,
    )
}

fn length(length: Option<u32>) -> String {
    length.map_or("longer".to_owned(), |length| length.to_string())
}

fn percent(share: Option<f64>) -> String {
    share.map_or(String::new(), |share| format!("{:.2} %", 100.0 * share))
}

fn seconds(seconds: f64) -> String {
    if seconds < 1.0 { format!("{:.1} ms", 1e3 * seconds) } else { format!("{seconds:.2} s") }
}

fn subset(subset: &SubsetReport) -> String {
    let what = match (&subset.lacks, subset.gain) {
        (Some(lacks), _) => format!("cannot make: {lacks}"),
        (None, Some(gain)) => times(gain),
        (None, None) => "no noise to compare".to_owned(),
    };
    let name = match subset.strategies.as_str() {
        "hit,next-event" => " (pt)",
        "lens" => " (lt)",
        _ => "",
    };
    format!("  without {:<27} {what}", format!("{}{name}", subset.without))
}

/// One row a strategy.
pub(super) fn csv(report: &Report) -> String {
    let mut lines = vec!["name,length,s,t,kind,energy,alone,variance,variance_alone,time,tries".to_owned()];
    lines.extend(report.cells.iter().map(|cell| {
        let whole = |n: Option<u32>| n.map_or(String::new(), |n| n.to_string());
        let real = |x: Option<f64>| x.map_or(String::new(), |x| x.to_string());
        [
            cell.name.clone(),
            length(cell.length),
            whole(cell.s),
            whole(cell.t),
            cell.kind.to_owned(),
            cell.energy.to_string(),
            real(cell.alone),
            real(cell.variance),
            real(cell.variance_alone),
            cell.time.to_string(),
            cell.tries.to_string(),
        ]
        .join(",")
    }));
    lines.join("\n") + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_ratios_keep_their_digits() {
        assert_eq!(times(Interval { mean: 1.304, low: 12.0, high: 0.0 }), "1.30x [12.00, 0.00]");
        assert_eq!(times(Interval { mean: 0.0034, low: 0.15, high: 0.96 }), "0.0034x [0.15, 0.96]");
    }
}
