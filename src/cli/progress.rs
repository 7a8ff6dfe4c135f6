//! The progress bar of a render.

use super::console;
use crate::{
    film::noise::Noise,
    render::{Precision, Progress, Settings},
};
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::{Value, json};

/// A progress bar that shows the nearest of the limits.
pub(super) struct Bar {
    bar: ProgressBar,
    settings: Settings,
    precision: Option<Precision>,
    pixels: usize,
    label: Option<String>,
}

/// Steps of the bar.
const STEPS: f64 = 1e6;

impl Bar {
    /// That of an image of so many `pixels`; `label` says which one.
    pub(super) fn new(
        settings: Settings,
        precision: Option<Precision>,
        pixels: usize,
        label: Option<&str>,
    ) -> Self {
        let bar = console::bar(STEPS as u64);
        if let Ok(style) = ProgressStyle::with_template("{prefix}{bar:30} {percent:>3} %  {msg}  {eta} left")
        {
            bar.set_style(style);
        }
        bar.set_prefix(label.map_or(String::new(), |label| format!("{label}  ")));
        Self { bar, settings, precision, pixels, label: label.map(str::to_owned) }
    }

    /// Shows how far the render is.
    pub(super) fn show(&self, progress: &Progress) {
        let state = match (self.precision, progress.noise) {
            (Some(Precision { error, .. }), _) => {
                let share = 100.0 * progress.within.unwrap_or(0.0);
                format!("{share:.1} % of the pixels within {}", percent(error))
            }
            (None, Some(noise)) => noise_text(noise),
            (None, None) => "noise not known yet".to_owned(),
        };
        self.tell(progress, &state);
    }

    /// The same of a progressive picture of so many `pixels`.
    pub(super) fn show_pixels(&self, progress: &Progress, pixels: usize) {
        let shaded = progress.samples as f64 / (progress.passes.max(1) as f64 * pixels as f64);
        self.tell(progress, &format!("{:.1} % of the pixels", 100.0 * shaded));
    }

    fn tell(&self, progress: &Progress, state: &str) {
        self.bar.set_message(format!("{} samples/pixel  {state}", progress.passes));
        self.bar.set_position((STEPS * self.done(progress)) as u64);
        console::update(progress.is_last, || self.line(progress));
    }

    /// The same for other programs.
    fn line(&self, progress: &Progress) -> Value {
        json!({
            "done": self.done(progress),
            "samples_per_pixel": progress.passes,
            "noise": progress.noise.map(|noise| noise.error),
            "within": progress.within,
            "seconds": progress.elapsed.as_secs_f64(),
            "image": self.label,
        })
    }

    /// The part of the way to the limit that is nearest.
    fn done(&self, progress: &Progress) -> f64 {
        let budget = &self.settings.budget;
        let samples =
            budget.samples_per_pixel.map(|spp| progress.samples as f64 / (spp as f64 * self.pixels as f64));
        let time = budget.time_used(progress.elapsed);
        let within = self.precision.and(progress.within);
        [samples, time, within].into_iter().flatten().fold(0.0, f64::max).min(1.0)
    }

    /// Removes it.
    pub(super) fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

/// A number of samples per pixel, with two decimal places unless it is whole.
pub(super) fn samples_text(samples: f64) -> String {
    match samples {
        _ if samples.fract() == 0.0 => samples.to_string(),
        _ if samples < 0.01 => "less than 0.01".to_owned(),
        _ => format!("{samples:.2}"),
    }
}

/// The noise of an image, and how far to trust it where that is not far.
pub(super) fn noise_text(noise: Noise) -> String {
    let error = percent(noise.error);
    match noise.uncertainty() {
        fine if fine < WELL_KNOWN => format!("noise {error}"),
        fair if fair < HARDLY_KNOWN => format!("noise {error} \u{b1} {}", percent(fair * noise.error)),
        _ => {
            let times = perhaps(noise.carriers);
            format!("noise {error} (few bright samples carry it: it may be {times} as high)")
        }
    }
}

/// How much higher the noise may be that n pixels carry. The square of the estimate is the true one times chi^2 / n: one
/// estimate in 20 is at least 16 (n = 1), 4.4 (2) or 2.4 (4) times too small.
fn perhaps(carriers: f64) -> &'static str {
    match carriers {
        one if one < 1.5 => "ten times",
        few if few < 3.0 => "four times",
        _ => "twice",
    }
}

/// Uncertainties of the noise, relative to it, below which it is said without one, and above which with a warning.
const WELL_KNOWN: f64 = 0.1;
const HARDLY_KNOWN: f64 = 0.25;

/// A relative error, in percent with two digits.
pub(super) fn percent(relative: f64) -> String {
    let digits = if relative >= 0.1 {
        0
    } else if relative >= 0.01 {
        1
    } else {
        2
    };
    format!("{:.digits$} %", 100.0 * relative)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        film::sharing::FilmSamples,
        passes::budget::Budget,
        sampling::Sampler,
        transport::{Options, profiles::ProfileName},
    };
    use std::time::Duration;

    #[test]
    fn the_fewer_carry_the_noise_the_less_it_says() {
        let said = |carriers| noise_text(Noise { error: 0.01, carriers });
        assert_eq!(said(1.0), "noise 1.0 % (few bright samples carry it: it may be ten times as high)");
        assert!(said(2.0).contains("four times") && said(3.9).contains("twice"));
        assert_eq!(said(1000.0), "noise 1.0 %");
    }

    #[test]
    fn the_nearest_limit_counts() {
        let budget = Budget { time: Some(Duration::from_secs(10)), ..Budget::samples(4) };
        let profile = ProfileName::Everything;
        let (options, sampler) = (Options::default(), Sampler::Independent);
        let film_samples = FilmSamples::default();
        let settings = Settings { options, sampler, film_samples, budget, seed: 0, profile };
        let bar = Bar::new(settings, None, 100, None);
        let at = |samples, seconds| {
            let elapsed = Duration::from_secs(seconds);
            bar.done(&Progress { samples, passes: 0, elapsed, noise: None, within: None, is_last: false })
        };
        assert_eq!([at(100, 1), at(100, 5), at(0, 20)], [0.25, 0.5, 1.0]);
    }
}
