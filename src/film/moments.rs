//! Mean and variance of images whose passes are independent.

use crate::math::{DVec3, Spectrum, SpectrumExt, spectrum::LUMINANCE};

/// Adds up passes, each an independent estimate of the whole image.
#[derive(Clone, Debug)]
pub struct Moments {
    sums: Vec<DVec3>,
    luminance_squares: Vec<f64>,
    passes: u64,
}

impl Moments {
    /// Nothing seen yet, for an image of `pixels`.
    pub fn new(pixels: usize) -> Self {
        Self { sums: vec![DVec3::ZERO; pixels], luminance_squares: vec![0.0; pixels], passes: 0 }
    }

    /// Adds one pass.
    pub fn add(&mut self, pass: &[Spectrum]) {
        for ((sum, square), value) in self.sums.iter_mut().zip(&mut self.luminance_squares).zip(pass) {
            *sum += value.as_dvec3();
            *square += f64::from(value.luminance()).powi(2);
        }
        self.passes += 1;
    }

    /// Number of pixels.
    pub fn len(&self) -> usize {
        self.sums.len()
    }

    /// True for an image without pixels.
    pub fn is_empty(&self) -> bool {
        self.sums.is_empty()
    }

    /// Passes added.
    pub fn passes(&self) -> u64 {
        self.passes
    }

    /// The mean of all passes.
    pub fn mean(&self) -> Vec<Spectrum> {
        let n = self.passes.max(1) as f64;
        self.sums.iter().map(|sum| (*sum / n).as_vec3()).collect()
    }

    /// Estimated variance of the luminance of one pass, summed over pixels; none before the second pass.
    pub fn luminance_variance(&self) -> Option<f64> {
        let n = self.passes as f64;
        let of_pixel = |(sum, square): (&DVec3, &f64)| {
            let sum = sum.dot(LUMINANCE.as_dvec3());
            ((square - sum * sum / n) / (n - 1.0)).max(0.0)
        };
        (self.passes > 1).then(|| self.sums.iter().zip(&self.luminance_squares).map(of_pixel).sum())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_and_variance_of_known_passes() {
        let mut film = Moments::new(1);
        film.add(&[Spectrum::splat(1.0)]);
        assert_eq!(film.luminance_variance(), None);
        film.add(&[Spectrum::splat(3.0)]);
        assert_eq!((film.mean(), film.passes()), (vec![Spectrum::splat(2.0)], 2));
        assert!((film.luminance_variance().unwrap() - 2.0).abs() < 1e-5);
    }
}
