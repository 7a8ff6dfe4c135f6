//! Means over independent seeds and how far they may be off.
//!
//! Few seeds, often with heavy tails: what can be negative gets Student's t; what is positive gets it for the logarithm
//! of its mean, so that the estimate stays the mean (which is what the expected error is) while the interval is longer
//! upwards and never reaches zero. What is made of several means is drawn anew from the seeds.

use super::outcome::Interval;
use crate::sampling::{Stream, stream::Purpose};
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

/// Resamples of a bootstrap.
const DRAWS: u64 = 4_000;

/// Mean and its standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mean {
    /// The mean.
    pub value: f64,
    /// Its standard error.
    pub error: f64,
    /// Degrees of freedom.
    pub freedom: f64,
}

impl Mean {
    /// Of independent `values`, two at least.
    pub fn of(values: &[f64]) -> Self {
        let n = values.len() as f64;
        let value = values.iter().sum::<f64>() / n;
        let squares: f64 = values.iter().map(|x| (x - value).powi(2)).sum();
        Self { value, error: (squares / (n - 1.0) / n).sqrt(), freedom: n - 1.0 }
    }
}

/// What |t| exceeds with probability 1 - `confidence`; NaN without freedom.
pub fn quantile(freedom: f64, confidence: f64) -> f64 {
    StudentsT::new(0.0, 1.0, freedom).map_or(f64::NAN, |t| t.inverse_cdf(0.5 + 0.5 * confidence))
}

/// Of values of either sign.
pub fn plain(values: &[f64], confidence: f64) -> Interval {
    let Mean { value: mean, error, freedom } = Mean::of(values);
    let reach = quantile(freedom, confidence) * error;
    Interval { mean, low: mean - reach, high: mean + reach }
}

/// Of values that are not negative: log(mean) +- t error / mean.
pub fn positive(values: &[f64], confidence: f64) -> Interval {
    let Mean { value: mean, error, freedom } = Mean::of(values);
    if mean == 0.0 {
        return Interval { mean, low: mean, high: mean };
    }
    let factor = (quantile(freedom, confidence) * error / mean).exp();
    Interval { mean, low: mean / factor, high: mean * factor }
}

/// Of what `estimate` makes of seeds (their indices, of which there are `count`), by drawing seeds with replacement;
/// the same seeds give the same interval. Its ends lie further out than the plain percentiles, by as much as Student's t
/// for so few lies beyond the normal distribution (Hesterberg 2015, "What teachers should know about the bootstrap",
/// sec. 3.1.2).
pub fn bootstrap(count: usize, confidence: f64, estimate: impl Fn(&[usize]) -> f64) -> Interval {
    let all: Vec<usize> = (0..count).collect();
    let draw = |index| {
        let mut stream = Stream::new(0, index, 0, Purpose::Study);
        let picks: Vec<usize> = (0..count).map(|_| stream.below(count)).collect();
        estimate(&picks)
    };
    let mut found: Vec<f64> = (0..DRAWS).map(draw).collect();
    found.sort_by(f64::total_cmp);
    let n = count as f64;
    let beyond = Normal::standard().sf((n / (n - 1.0)).sqrt() * quantile(n - 1.0, confidence));
    let at = |share: f64| found[(share * (found.len() - 1) as f64).round() as usize];
    Interval { mean: estimate(&all), low: at(beyond), high: at(1.0 - beyond) }
}

/// Slope of the straight line of least squares through points (log x, log y); none where they do not tell: fewer than
/// three, or not all positive and finite.
pub fn slope(points: &[(f64, f64)]) -> Option<f64> {
    let logs: Vec<(f64, f64)> = points.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    if logs.len() < 3 || !logs.iter().all(|(x, y)| x.is_finite() && y.is_finite()) {
        return None;
    }
    let n = logs.len() as f64;
    let (x, y) = logs.iter().fold((0.0, 0.0), |(a, b), (x, y)| (a + x / n, b + y / n));
    let spread: f64 = logs.iter().map(|p| (p.0 - x).powi(2)).sum();
    let slope = logs.iter().map(|p| (p.0 - x) * (p.1 - y)).sum::<f64>() / spread;
    slope.is_finite().then_some(slope)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-3 * b.abs()
    }

    #[test]
    fn known_intervals() {
        // t for 95 % and 3 degrees of freedom is 3.1824 (any table); mean 2.5, standard error sqrt(5/12).
        let values = [1.0, 2.0, 3.0, 4.0];
        let reach = 3.1824 * (5.0f64 / 12.0).sqrt();
        let found = plain(&values, 0.95);
        assert!(close(found.low, 2.5 - reach) && close(found.high, 2.5 + reach), "{found:?}");
        let found = positive(&values, 0.95);
        assert!(close(found.high / 2.5, (reach / 2.5).exp()) && close(2.5 / found.low, found.high / 2.5));
        assert_eq!(positive(&[0.0, 0.0], 0.95), Interval { mean: 0.0, low: 0.0, high: 0.0 });
        assert!(plain(&[1.0, f64::NAN], 0.95).mean.is_nan() && plain(&[1.0], 0.95).low.is_nan());
    }

    /// Draws of a mean of few values are discrete, but most of them lie within its standard error.
    #[test]
    fn a_bootstrap_of_the_mean_is_as_wide_as_its_error() {
        let values: Vec<f64> = (0..100).map(f64::from).collect();
        let mean = |picks: &[usize]| picks.iter().map(|i| values[*i]).sum::<f64>() / picks.len() as f64;
        let found = bootstrap(values.len(), 0.95, mean);
        // The variance of 0 to 99 is 833.25, that of their mean a hundredth of it.
        let reach = 1.96 * 8.3325f64.sqrt();
        assert_eq!(found.mean, 49.5);
        assert!(
            (found.high - 49.5 - reach).abs() < 0.8 && (49.5 - found.low - reach).abs() < 0.8,
            "{found:?}"
        );
        assert_eq!(bootstrap(100, 0.95, mean), found);
    }

    #[test]
    fn slopes_of_powers() {
        let power = |p: f64| -> Vec<(f64, f64)> {
            [1.0, 2.0, 4.0, 9.0].iter().map(|x: &f64| (*x, x.powf(p))).collect()
        };
        assert!((slope(&power(-1.0)).unwrap() + 1.0).abs() < 1e-12);
        assert!((slope(&power(0.5)).unwrap() - 0.5).abs() < 1e-12);
        assert_eq!(slope(&power(-1.0)[..2]), None);
        assert_eq!(slope(&[(1.0, 0.0), (2.0, 1.0), (3.0, 1.0)]), None);
        assert_eq!(slope(&[(1.0, 1.0); 4]), None);
    }
}
