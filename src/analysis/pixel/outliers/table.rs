//! The brightest contributions as text.

use super::{Outlier, Outliers, PathVertex};
use crate::analysis::pixel::{EmitterText, SurfaceText};

/// A few lines for each.
pub fn table(found: &Outliers) -> String {
    let Outliers { samples, first_sample, seed, mean, size: [width, height], outliers, .. } = found;
    let from = if *first_sample > 0 { format!(" from {first_sample} on") } else { String::new() };
    let first = format!(
        "{samples} samples{from} of {width} x {height} pixels, seed {seed}: mean luminance {mean:.3e}"
    );
    let none = outliers.is_empty().then(|| "no contribution stands out".to_owned());
    let told = outliers.iter().enumerate().map(|(index, one)| described(index + 1, one));
    [first].into_iter().chain(none).chain(told).collect::<Vec<_>>().join("\n")
}

fn described(number: usize, one: &Outlier) -> String {
    let Outlier { pixel: [x, y], sample, path, .. } = one;
    let path = path.iter().map(PathVertex::name).collect::<Vec<_>>().join(" - ");
    format!(
        "\n{number}. pixel {x} {y}, sample {sample}: {}\n   {}\n   {path}",
        one.size(),
        one.how().join(", ")
    )
}

impl Outlier {
    /// How bright it is.
    pub(super) fn size(&self) -> String {
        let part = |share: Option<f64>, of: &str| share.map(|share| format!("{} of {of}", percent(share)));
        let parts = [part(self.pixel_share, "its pixel"), part(self.error_share, "the squared error")];
        let times = format!("{} times the mean", digits(self.times_mean));
        [Some(times)].into_iter().chain(parts).flatten().collect::<Vec<_>>().join(", ")
    }

    /// Which strategy made it, and what came of that.
    pub(super) fn how(&self) -> [String; 3] {
        let Self { strategy, s, t, weight, value, .. } = self;
        let [r, g, b] = value.map(|value| digits(f64::from(value)));
        [
            format!("{strategy} (s = {s}, t = {t})"),
            format!("weight {}", digits(f64::from(*weight))),
            format!("value {r} {g} {b}"),
        ]
    }
}

impl PathVertex {
    /// What it is, in a few words.
    pub(super) fn name(&self) -> String {
        let dirac = if self.dirac { " (Dirac)" } else { "" };
        let medium = self.medium.as_deref().unwrap_or_default();
        match (&self.emitter, &self.surface) {
            (Some(emitter), _) => format!("emitter {}", lamp(emitter)),
            (None, Some(SurfaceText { shape, bsdf, .. })) => {
                format!("surface {} of {bsdf}{dirac}", shape.name)
            }
            (None, None) if self.kind == "medium" => format!("medium {medium}{dirac}"),
            (None, None) => self.kind.to_owned(),
        }
    }
}

fn lamp(EmitterText { kind, shape, medium, .. }: &EmitterText) -> String {
    let on = shape.as_ref().map(|shape| &shape.name).or(medium.as_ref());
    on.map_or((*kind).to_owned(), |on| format!("{kind} of {on}"))
}

fn percent(share: f64) -> String {
    format!("{} %", digits(100.0 * share))
}

/// Three significant digits.
pub(super) fn digits(value: f64) -> String {
    let rounded = format!("{value:.2e}").parse().unwrap_or(value);
    if rounded == 0.0 || (1e-3..1e6).contains(&rounded.abs()) {
        rounded.to_string()
    } else {
        format!("{rounded:e}")
    }
}
