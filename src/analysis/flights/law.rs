//! How long flights by constant steps are (P03T fig. A.12): delta / (1 - exp(-sigma_s delta)), longer than the mean
//! free path 1 / sigma_s by about half a step.

use super::tally::Estimate;
use crate::sampling::{Stream, stream::Purpose};
use serde::Serialize;

/// The law and a measurement of it, for one length of step.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Law {
    /// Length of a step (m).
    pub step: f64,
    /// Flights that were measured.
    pub flights: u64,
    /// Mean length of flights until they are scattered (m).
    pub measured: Estimate,
    /// The same by the law (m).
    pub expected: f64,
    /// The law less the mean free path (m).
    pub error: f64,
    /// How many standard errors the measured length is above the law.
    pub z: f64,
    /// How many it is above the mean free path.
    pub z_of_mean_free_path: f64,
}

/// The mean length of exponential flights, by closed form and measured.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct FreePath {
    /// The method that flies so.
    pub method: &'static str,
    /// Mean length (m).
    pub measured: Estimate,
    /// 1 / sigma (m).
    pub expected: f64,
    /// How many standard errors the measured length is above that.
    pub z: f64,
}

impl FreePath {
    /// Flies `flights` times by `sigma` (1/m) without a border; none in nothing.
    pub fn measure(method: &'static str, sigma: f64, flights: u64, seed: u64, index: u64) -> Option<Self> {
        if sigma <= 0.0 {
            return None;
        }
        let mut stream = Stream::new(seed, index, u64::MAX - 1, Purpose::Study);
        let measured = mean((0..flights).map(|_| f64::from(stream.exponential()) / sigma));
        let expected = 1.0 / sigma;
        Some(Self { method, measured, expected, z: measured.z(&Estimate::exact(expected)) })
    }
}

/// Mean of at least two values, and its standard error.
fn mean(values: impl Iterator<Item = f64>) -> Estimate {
    let (mut n, mut sum, mut squares) = (0.0, 0.0, 0.0);
    for value in values {
        n += 1.0;
        sum += value;
        squares += value * value;
    }
    let mean: f64 = sum / n;
    let variance = (squares / n - mean * mean).max(0.0);
    Estimate { mean, standard_error: (variance / (n - 1.0)).sqrt() }
}

/// Steps that one measurement may take.
const MOST_STEPS: f64 = 5e7;

/// Mean length of a flight in steps of `step` (m) with scattering `sigma_s` (1/m), both > 0.
pub fn mean_length(step: f64, sigma_s: f64) -> f64 {
    -step / (-sigma_s * step).exp_m1()
}

/// By how much that is above 1 / sigma_s (m).
pub fn error(step: f64, sigma_s: f64) -> f64 {
    let x = sigma_s * step;
    // Where the difference would cancel, its series: x/2 + x^2/12 mean free paths.
    if x < 1e-3 { (0.5 * x + x * x / 12.0) / sigma_s } else { mean_length(step, sigma_s) - 1.0 / sigma_s }
}

impl Law {
    /// True if [`Law::measure`] has something to measure.
    pub fn is_measurable(step: f64, sigma_s: f64) -> bool {
        Self::affordable(step, sigma_s).1 >= 2
    }

    /// The probability that a step ends in a scattering, and how many flights may be measured.
    fn affordable(step: f64, sigma_s: f64) -> (f64, u64) {
        let probability = -(-sigma_s * step).exp_m1();
        (probability, (MOST_STEPS * probability) as u64)
    }

    /// Flies at most `flights` times without a border; none where nothing scatters.
    pub fn measure(step: f64, sigma_s: f64, flights: u64, seed: u64, index: u64) -> Option<Self> {
        let (probability, affordable) = Self::affordable(step, sigma_s);
        if affordable < 2 {
            return None;
        }
        let flights = flights.min(affordable).max(2);
        let mut stream = Stream::new(seed, index, u64::MAX, Purpose::Study);
        let mut flight = || {
            let mut steps = 1.0;
            while stream.uniform_precisely() >= probability {
                steps += 1.0;
            }
            step * steps
        };
        let measured = mean((0..flights).map(|_| flight()));
        let expected = mean_length(step, sigma_s);
        let [z, z_of_mean_free_path] = [expected, 1.0 / sigma_s].map(|x| measured.z(&Estimate::exact(x)));
        let error = error(step, sigma_s);
        Some(Self { step, flights, measured, expected, error, z, z_of_mean_free_path })
    }
}
