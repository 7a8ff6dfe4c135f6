//! What a study found, as written to `study.json`: numbers only. The images lie beside it, named here.

use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// A whole study.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Outcome {
    /// Which program made it, with its version.
    pub made_by: String,
    /// The command that makes it again.
    pub command: String,
    /// Processor and threads that all contenders had.
    pub machine: String,
    /// When it was made, and what else the machine did; none in studies of earlier versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub conditions: Option<Conditions>,
    /// Confidence of every interval, such as 0.95.
    pub confidence: f64,
    /// One entry a scene.
    pub scenes: Vec<SceneOutcome>,
}

/// When a study was made, and what else its machine did.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Conditions {
    /// When its first run began: date and time of day, UTC.
    pub started: String,
    /// Load average over 1, 5 and 15 minutes before the first render; none where the system does not say.
    pub load_before: Option<[f64; 3]>,
    /// The same after the last.
    pub load_after: Option<[f64; 3]>,
}

/// What was found for one scene.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct SceneOutcome {
    /// As in file names.
    pub name: String,
    /// Pixels across.
    pub width: usize,
    /// Pixels down.
    pub height: usize,
    /// What errors are measured against.
    pub reference: Reference,
    /// Everybody who rendered it.
    pub contenders: Vec<ContenderOutcome>,
    /// What the reader should know: who could not render it and why, what is not known of the reference.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
}

/// The reference image.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Reference {
    /// Where it lies, beside `study.json`.
    pub image: PathBuf,
    /// How it was made: renderer, integrator, samples per pixel; or the file it was read from.
    pub how: String,
    /// Its own relMSE: the expected value of the measure between it and the truth; none if not known.
    pub own_relmse: Option<f64>,
    /// What that is known by.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub known_by: Option<String>,
    /// Largest distance between the means of the renderers that made it together, in standard errors; none of one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub apart: Option<f64>,
    /// Contenders rendered as it is, with other seeds: they agree only with themselves.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub like: Vec<String>,
}

/// How far two means are from each other.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
pub struct Apart {
    /// In standard errors of their difference, which is positive where the contender is brighter.
    pub errors: f64,
    /// By chance alone they are further apart than this once in a thousand studies.
    pub limit: f64,
}

impl Apart {
    /// True if the means may be equal.
    pub fn is_chance(&self) -> bool {
        self.errors.abs() <= self.limit
    }
}

/// What a contender did, as it says itself.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Chosen {
    /// By the first seed, at the last budget.
    pub what: String,
    /// Seeds that did otherwise.
    pub otherwise: u64,
    /// Seeds in all.
    pub seeds: u64,
}

impl Chosen {
    /// In a sentence.
    pub fn sentence(&self) -> String {
        let Self { what, otherwise, seeds } = self;
        match otherwise {
            0 => what.clone(),
            _ => format!("{what}; {otherwise} of {seeds} seeds chose otherwise"),
        }
    }
}

/// One way of rendering a scene, at growing budgets.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct ContenderOutcome {
    /// As shown: renderer, integrator, what is special about it.
    pub name: String,
    /// Seconds of reading and compiling that are in no point; none if not known.
    pub load_seconds: Option<f64>,
    /// Budgets in growing order.
    pub points: Vec<Point>,
    /// Of log relMSE over log seconds: -1 without bias; none from fewer than three points.
    pub slope: Option<Interval>,
    /// 1 / (relMSE x seconds) at the last budget [1/s].
    pub efficiency: Interval,
    /// Its efficiency over that of the scene's first contender, seeds paired; none for that one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ratio: Option<Interval>,
    /// Its strategies and the like, where it says: what a pilot chose, if there was one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub chosen: Option<Chosen>,
    /// The mean of its images, from that of the reference; none where an image held no numbers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub apart: Option<Apart>,
    /// Variance per pixel and channel of one render at the last budget, where it lies beside `study.json`.
    pub variance: PathBuf,
    /// What the reader should know: paths it leaves out, signs of bias, an error that is the reference's own.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
}

/// What one budget gave, over all seeds.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Point {
    /// Samples per pixel.
    pub samples: u64,
    /// Time of rendering (s), loading and compiling left out.
    pub seconds: Interval,
    /// Processor time for the same, of all threads, user and system (s); none where it is not known of every seed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cpu_seconds: Option<Interval>,
    /// Mean squared error (radiance^2).
    pub mse: Interval,
    /// mean((x - r)^2 / (r^2 + 0.01 m^2)), m the mean luminance of r.
    pub relmse: Interval,
    /// The same without the worst 0.1 % of values.
    pub trimmed_relmse: Interval,
    /// mean(|x - r| / (|r| + 0.01 m)).
    pub mape: Interval,
    /// mean(2 |x - r| / (|x| + |r| + 0.01 m)).
    pub smape: Interval,
    /// Mean of the image over that of the reference, less 1: what is left of it where seeds grow many is bias.
    pub difference: Interval,
    /// The image of the first seed, where it lies beside `study.json`.
    pub image: PathBuf,
}

/// A mean over seeds and the ends of its confidence interval. What is no finite number, because an image held NaN or
/// infinities, is `null` in JSON.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
pub struct Interval {
    /// The estimate.
    #[serde(with = "number")]
    pub mean: f64,
    /// Lower end.
    #[serde(with = "number")]
    pub low: f64,
    /// Upper end.
    #[serde(with = "number")]
    pub high: f64,
}

/// Numbers in JSON, which has no NaN and no infinity: both are `null`, and `null` is NaN.
pub(super) mod number {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    /// Writes one.
    pub(crate) fn serialize<S: Serializer>(value: &f64, to: S) -> Result<S::Ok, S::Error> {
        Some(*value).filter(|value| value.is_finite()).serialize(to)
    }

    /// Reads one.
    pub(crate) fn deserialize<'a, D: Deserializer<'a>>(from: D) -> Result<f64, D::Error> {
        Ok(Option::deserialize(from)?.unwrap_or(f64::NAN))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_come_back_bit_for_bit_and_nan_as_null() {
        let interval = Interval { mean: 0.1 + 0.2, low: f64::MIN_POSITIVE, high: f64::NAN };
        let text = serde_json::to_string(&interval).unwrap();
        assert!(text.ends_with("\"high\":null}"), "{text}");
        let read: Interval = serde_json::from_str(&text).unwrap();
        assert_eq!((read.mean, read.low, read.high.is_nan()), (interval.mean, interval.low, true));
    }
}
