//! Sums and square sums of the passes over an image: its mean, and how far the mean may be off.

use crate::math::{Spectrum, SpectrumExt, Vec3, relative::Relative, spectrum::LUMINANCE};

/// Adds up passes; each pass is one independent estimate of the whole image.
#[derive(Clone, Debug)]
pub struct Accumulator {
    sums: Vec<[f64; 3]>,
    luminance_squares: Vec<f64>,
    /// Sums of products of two channels, R R, R G, R B, G G, G B, B B; empty where not needed.
    products: Vec<[f64; 6]>,
    passes: u64,
}

impl Accumulator {
    /// Nothing seen yet, for an image of `pixels`.
    pub fn new(pixels: usize) -> Self {
        let (sums, luminance_squares) = (vec![[0.0; 3]; pixels], vec![0.0; pixels]);
        Self { sums, luminance_squares, products: Vec::new(), passes: 0 }
    }

    /// The same, with second moments and variances.
    pub fn with_products(pixels: usize) -> Self {
        Self { products: vec![[0.0; 6]; pixels], ..Self::new(pixels) }
    }

    /// Adds one pass.
    pub fn add(&mut self, pass: &[Spectrum]) {
        for ((sum, square), value) in self.sums.iter_mut().zip(&mut self.luminance_squares).zip(pass) {
            for (channel, v) in sum.iter_mut().zip(value.to_array()) {
                *channel += f64::from(v);
            }
            *square += f64::from(value.luminance()).powi(2);
        }
        for (products, value) in self.products.iter_mut().zip(pass) {
            let [r, g, b] = value.to_array().map(f64::from);
            let pass = [r * r, r * g, r * b, g * g, g * b, b * b];
            products.iter_mut().zip(pass).for_each(|(sum, product)| *sum += product);
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

    /// Mean over the passes of (`row` . rgb)^2: the second moment of a channel that combines R, G and B.
    pub fn second_moment(&self, row: Vec3) -> Vec<f32> {
        let scale = 1.0 / self.passes.max(1) as f64;
        self.products.iter().map(|products| (square_of(row, products) * scale) as f32).collect()
    }

    /// Estimated variance of the mean of `row` . rgb; none before the second pass.
    pub fn variance(&self, row: Vec3) -> Option<Vec<f32>> {
        let n = self.passes as f64;
        let [r, g, b] = row.to_array().map(f64::from);
        let of_pixel = |(sum, products): (&[f64; 3], &[f64; 6])| {
            let mean = (r * sum[0] + g * sum[1] + b * sum[2]) / n;
            ((square_of(row, products) / n - mean * mean) / (n - 1.0)).max(0.0) as f32
        };
        (self.passes > 1).then(|| self.sums.iter().zip(&self.products).map(of_pixel).collect())
    }

    /// Number of pixels.
    pub fn len(&self) -> usize {
        self.sums.len()
    }

    /// True for an image without pixels.
    pub fn is_empty(&self) -> bool {
        self.sums.is_empty()
    }

    /// Estimated variance of the luminance of one pass, summed over pixels; none before the second pass.
    pub fn luminance_variance(&self) -> Option<f64> {
        let n = self.passes as f64;
        let [r, g, b] = LUMINANCE.to_array().map(f64::from);
        let of_pixel = |(sum, square): (&[f64; 3], &f64)| {
            let sum = r * sum[0] + g * sum[1] + b * sum[2];
            ((square - sum * sum / n) / (n - 1.0)).max(0.0)
        };
        (self.passes > 1).then(|| self.sums.iter().zip(&self.luminance_squares).map(of_pixel).sum())
    }

    /// Estimated relative error of the mean: the root of the mean over pixels of var / (mean^2 + 0.01 m^2), by
    /// luminance, where m is that of the whole image; none before the second pass. Passes are taken for independent:
    /// where a sampler spreads their random numbers evenly, the error is less than this.
    pub fn noise(&self) -> Option<f64> {
        if self.passes < 2 {
            return None;
        }
        let n = self.passes as f64;
        let [r, g, b] = LUMINANCE.to_array().map(f64::from);
        let mean = |sum: &[f64; 3]| (r * sum[0] + g * sum[1] + b * sum[2]) / n;
        let means = self.sums.iter().map(mean).filter(|mean| mean.is_finite());
        let to = Relative::to_mean(means.sum::<f64>() / self.sums.len() as f64);
        let relative = self.sums.iter().zip(&self.luminance_squares).map(|(sum, square)| {
            let mean = mean(sum);
            to.square(((square / n - mean * mean) / (n - 1.0)).max(0.0), mean)
        });
        Some((relative.sum::<f64>() / self.sums.len() as f64).sqrt())
    }
}

/// (`row` . rgb)^2 from the products of r, g and b.
fn square_of(row: Vec3, products: &[f64; 6]) -> f64 {
    let [r, g, b] = row.to_array().map(f64::from);
    let factors = [r * r, 2.0 * r * g, 2.0 * r * b, g * g, 2.0 * g * b, b * b];
    factors.iter().zip(products).map(|(factor, product)| factor * product).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::vec3;

    #[test]
    fn moments_and_variances_of_known_passes() {
        let mut film = Accumulator::with_products(1);
        let row = vec3(1.0, 2.0, -1.0);
        assert_eq!(film.variance(row), None);
        // The row makes 0, 6 and 3 of them.
        for pass in [vec3(1.0, 0.0, 1.0), vec3(2.0, 3.0, 2.0), vec3(0.0, 2.0, 1.0)] {
            film.add(&[pass]);
        }
        assert_eq!(film.second_moment(row), [15.0]);
        // Sample variance 9, of the mean a third of it.
        assert!((film.variance(row).unwrap()[0] - 3.0).abs() < 1e-6);
        assert!(Accumulator::new(1).second_moment(row).is_empty());
    }

    #[test]
    fn mean_and_noise_of_known_passes() {
        let mut film = Accumulator::new(1);
        film.add(&[Spectrum::splat(1.0)]);
        assert_eq!(film.noise(), None);
        film.add(&[Spectrum::splat(3.0)]);
        assert_eq!(film.mean(), vec![Spectrum::splat(2.0)]);
        // Variance of the mean of {1, 3} is 1; relative to 2^2 + 0.01 2^2.
        let expected = (1.0f64 / 4.04).sqrt();
        assert!((film.noise().unwrap() - expected).abs() < 1e-5);
        assert!((film.luminance_variance().unwrap() - 2.0).abs() < 1e-5);
    }

    #[test]
    fn noise_does_not_depend_on_the_unit_of_radiance() {
        let noise = |unit: f32| {
            let mut film = Accumulator::new(3);
            for pass in [[0.0, 1.0, 5.0], [0.0, 3.0, 4.0], [0.1, 2.0, 6.0]] {
                film.add(&pass.map(|value| Spectrum::splat(unit * value)));
            }
            film.noise().unwrap()
        };
        let one = noise(1.0);
        assert!(one > 0.1 && [1e-3, 1e3].iter().all(|unit| (noise(*unit) / one - 1.0).abs() < 1e-5));
    }
}
