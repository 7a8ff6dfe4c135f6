//! Choice among finitely many things in proportion to given weights.

/// A discrete distribution, sampled by bisection of its cumulative sums.
#[derive(Clone, Debug, Default)]
pub struct Discrete {
    /// Cumulative sums divided by the total; the last is exactly 1.
    cumulative: Vec<f64>,
    total: f64,
}

impl Discrete {
    /// Memory that it takes (bytes).
    pub fn bytes(&self) -> usize {
        size_of_val(&self.cumulative[..])
    }

    /// Weights must be finite and >= 0. A distribution whose weights sum to 0 has nothing to sample.
    pub fn new(weights: impl IntoIterator<Item = f64>) -> Self {
        let mut total = 0.0;
        let mut cumulative: Vec<f64> = weights
            .into_iter()
            .map(|w| {
                total += w;
                total
            })
            .collect();
        for c in &mut cumulative {
            *c /= total;
        }
        Self { cumulative, total }
    }

    /// Sum of the weights as given.
    pub fn total(&self) -> f64 {
        self.total
    }

    /// True where there is nothing to sample.
    pub fn is_empty(&self) -> bool {
        self.total.is_nan() || self.total <= 0.0
    }

    /// Probability of `index`.
    #[inline]
    pub fn probability(&self, index: usize) -> f32 {
        self.probability_precisely(index) as f32
    }

    /// The same for distributions of many parts, where f32 is too coarse.
    #[inline]
    pub fn probability_precisely(&self, index: usize) -> f64 {
        let before = if index == 0 { 0.0 } else { self.cumulative[index - 1] };
        self.cumulative[index] - before
    }

    /// The index whose section of [0, 1) holds `u`, and its probability. Indices of weight 0 never come.
    #[inline]
    pub fn sample(&self, u: f32) -> (usize, f32) {
        let (index, probability) = self.sample_precisely(f64::from(u));
        (index, probability as f32)
    }

    /// The same for distributions of many parts, where f32 is too coarse.
    #[inline]
    pub fn sample_precisely(&self, u: f64) -> (usize, f64) {
        let index = self.cumulative.partition_point(|c| *c <= u).min(self.cumulative.len() - 1);
        (index, self.probability_precisely(index))
    }

    /// The index as by [`Self::sample_precisely`], and the position of `u` within its section, in [0, 1): uniform if
    /// `u` is.
    #[inline]
    pub fn sample_within(&self, u: f64) -> (usize, f32) {
        let (index, probability) = self.sample_precisely(u);
        let past = u - (self.cumulative[index] - probability);
        let within = if probability > 0.0 { (past / probability) as f32 } else { 0.0 };
        (index, within.clamp(0.0, 1.0 - f32::EPSILON))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sections_are_as_wide_as_the_weights() {
        let d = Discrete::new([1.0, 0.0, 3.0]);
        assert_eq!(d.sample(0.0), (0, 0.25));
        assert_eq!(d.sample(0.2499), (0, 0.25));
        assert_eq!(d.sample(0.25), (2, 0.75));
        assert_eq!(d.sample(0.999_999), (2, 0.75));
        assert_eq!((d.sample_within(0.125), d.sample_within(0.625)), ((0, 0.5), (2, 0.5)));
        assert!(Discrete::new([0.0]).is_empty() && Discrete::new([]).is_empty());
    }
}
