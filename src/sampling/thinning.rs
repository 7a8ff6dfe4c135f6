//! A selection of many things, in proportion to their weights.

/// Keeps one item per step of the sum of weights: items of equal weight are kept at even intervals.
pub struct Thinning {
    step: f32,
    /// Sum of weights over `step`, since the last item that was kept.
    sum: f64,
}

impl Thinning {
    /// One for each `step` of the sum of all weights; `step` is above 0.
    pub fn by(step: f32) -> Self {
        Self { step, sum: 0.5 }
    }

    /// The weight that the next item stands for if it is kept: its `weight`, or the step if that is greater.
    pub fn keeps(&mut self, weight: f32) -> Option<f32> {
        self.sum += f64::from(weight / self.step);
        (self.sum >= 1.0).then(|| {
            self.sum = self.sum.fract();
            weight.max(self.step)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sum_of_what_is_kept_is_that_of_all() {
        let weights = || (0..10_000).map(|index| (index * 7919 % 1000) as f32 / 1000.0);
        let mut thinning = Thinning::by(5.0);
        let kept: Vec<f32> = weights().filter_map(|weight| thinning.keeps(weight)).collect();
        assert!(kept.len().abs_diff(1000) <= 1, "{}", kept.len());
        assert!((kept.iter().sum::<f32>() - weights().sum::<f32>()).abs() < 5.0);
        // Those that weigh more than a step are all kept, for themselves.
        let mut thinning = Thinning::by(1.0);
        assert!([3.0, 1.0, 2.5].iter().all(|weight| thinning.keeps(*weight) == Some(*weight)));
        assert_eq!(Thinning::by(1.0).keeps(0.0), None);
    }
}
