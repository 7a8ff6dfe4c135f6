//! Sums and square sums of the passes over an image: its mean, and how far the mean may be off.

use crate::math::{Spectrum, SpectrumExt};

/// Adds up passes; each pass is one independent estimate of the whole image.
#[derive(Clone, Debug)]
pub struct Accumulator {
    sums: Vec<[f64; 3]>,
    luminance_squares: Vec<f64>,
    passes: u64,
}

impl Accumulator {
    /// Nothing seen yet, for an image of `pixels`.
    pub fn new(pixels: usize) -> Self {
        Self { sums: vec![[0.0; 3]; pixels], luminance_squares: vec![0.0; pixels], passes: 0 }
    }

    /// Adds one pass.
    pub fn add(&mut self, pass: &[Spectrum]) {
        for ((sum, square), value) in self.sums.iter_mut().zip(&mut self.luminance_squares).zip(pass) {
            for (channel, v) in sum.iter_mut().zip(value.to_array()) {
                *channel += f64::from(v);
            }
            *square += f64::from(value.luminance()).powi(2);
        }
        self.passes += 1;
    }

    /// Passes added.
    pub fn passes(&self) -> u64 {
        self.passes
    }

    /// The mean of all passes.
    pub fn mean(&self) -> Vec<Spectrum> {
        let scale = 1.0 / self.passes.max(1) as f64;
        self.sums.iter().map(|s| Spectrum::from_array(s.map(|channel| (channel * scale) as f32))).collect()
    }

    /// Estimated relative error of the mean: the root of the mean over pixels of var / (mean^2 + 0.01), by
    /// luminance; none before the second pass.
    pub fn noise(&self) -> Option<f64> {
        if self.passes < 2 {
            return None;
        }
        let n = self.passes as f64;
        let relative = self.sums.iter().zip(&self.luminance_squares).map(|(sum, square)| {
            let mean = (0.212_671 * sum[0] + 0.715_160 * sum[1] + 0.072_169 * sum[2]) / n;
            let variance = ((square / n - mean * mean) / (n - 1.0)).max(0.0);
            variance / (mean * mean + 0.01)
        });
        Some((relative.sum::<f64>() / self.sums.len() as f64).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_and_noise_of_known_passes() {
        let mut film = Accumulator::new(1);
        film.add(&[Spectrum::splat(1.0)]);
        assert_eq!(film.noise(), None);
        film.add(&[Spectrum::splat(3.0)]);
        assert_eq!(film.mean(), vec![Spectrum::splat(2.0)]);
        // Variance of the mean of {1, 3} is 1; relative to 2^2 + 0.01.
        let expected = (1.0f64 / 4.01).sqrt();
        assert!((film.noise().unwrap() - expected).abs() < 1e-5);
    }
}
