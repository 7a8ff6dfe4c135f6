//! What error is measured by, and over what it is drawn.

use crate::analysis::study::outcome::{ContenderOutcome, Interval, Point, SceneOutcome};

/// A measure of error.
pub(super) struct Measure {
    /// In the page's own names.
    pub key: &'static str,
    /// As shown.
    pub name: &'static str,
    /// What it is, in a line.
    pub meaning: &'static str,
    /// Its values.
    pub of: fn(&Point) -> Interval,
    /// How it falls over time without bias, on logarithmic scales: squares fall by -1, absolute values by half of it.
    pub slope: f64,
}

/// All of them, the one to begin with first.
pub(super) const MEASURES: [Measure; 5] = [
    Measure {
        key: "relmse",
        name: "relMSE",
        meaning: "mean of (x − r)² / (r² + 0.01 m²), m the mean luminance of r",
        of: |point| point.relmse,
        slope: -1.0,
    },
    Measure {
        key: "trimmed",
        name: "trimmed relMSE",
        meaning: "relMSE without the worst 0.1 % of values: where it is much smaller, fireflies decide",
        of: |point| point.trimmed_relmse,
        slope: -1.0,
    },
    Measure { key: "mse", name: "MSE", meaning: "mean of (x − r)²", of: |point| point.mse, slope: -1.0 },
    Measure {
        key: "mape",
        name: "MAPE",
        meaning: "mean of |x − r| / (|r| + 0.01 m), m the mean luminance of r",
        of: |point| point.mape,
        slope: -0.5,
    },
    Measure {
        key: "smape",
        name: "SMAPE",
        meaning: "mean of 2 |x − r| / (|x| + |r| + 0.01 m), m the mean luminance of r",
        of: |point| point.smape,
        slope: -0.5,
    },
];

/// What error is drawn over.
pub(super) struct Axis {
    /// In the page's own names.
    pub key: &'static str,
    /// As shown.
    pub name: &'static str,
    /// Its values; none where a contender does not say.
    pub of: fn(&Point) -> Option<f64>,
}

/// All of them, the one to begin with first.
pub(super) const AXES: [Axis; 3] = [
    Axis { key: "seconds", name: "seconds", of: |point| Some(point.seconds.mean) },
    Axis { key: "cpu", name: "CPU seconds", of: |point| Some(point.cpu_seconds?.mean) },
    Axis { key: "samples", name: "samples per pixel", of: |point| Some(point.samples as f64) },
];

impl Axis {
    /// Those that some contender of `scene` has values on.
    pub(super) fn all_of(scene: &SceneOutcome) -> Vec<&'static Self> {
        let has = |axis: &&Self| scene.contenders.iter().any(|contender| axis.is_known(contender));
        AXES.iter().filter(has).collect()
    }

    /// True if `contender` has a value on it at every budget: a curve with gaps would mislead.
    pub(super) fn is_known(&self, contender: &ContenderOutcome) -> bool {
        contender.points.iter().all(|point| (self.of)(point).is_some())
    }
}
