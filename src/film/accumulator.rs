//! Sums of the passes over an image: its mean and the error of the mean. They are the same to the last bit in whatever
//! order, and from whatever parts, passes are added.
//!
//! The error follows from two halves, the passes of even and of odd number. The halves are independent whatever the
//! sampler, while passes of one half may be spread evenly together.

use super::noise::Noise;
use crate::math::{
    Spectrum, SpectrumExt, Vec3, axes,
    exact_sums::{ExactSums, MOST_TERMS, Parts},
    spectrum::LUMINANCE,
};
use rayon::prelude::*;

/// Passes that an image can have at most.
pub const MOST_PASSES: u64 = MOST_TERMS;

/// Pixels that a thread adds at a time.
const CHUNK: usize = 4096;

/// Adds up passes; each pass is one estimate of the whole image.
#[derive(Clone, Debug)]
pub struct Accumulator {
    /// Sums of R, G, B; and the luminance of even passes less that of odd ones.
    pixels: Vec<ExactSums<4>>,
    /// Sums of products of two channels, R R, R G, R B, G G, G B, B B; empty where not needed.
    products: Vec<ExactSums<6>>,
    /// Pixels of the image: the first ones. Those of layers of it follow.
    image: usize,
    /// Of even and of odd number.
    passes: [u64; 2],
}

impl Accumulator {
    /// Nothing seen yet, for an image of `pixels`.
    pub fn new(pixels: usize) -> Self {
        let sums = vec![ExactSums::default(); pixels];
        Self { pixels: sums, products: Vec::new(), image: pixels, passes: [0; 2] }
    }

    /// The same for passes of several `planes`, one behind the other: the image and its layers.
    pub fn with_planes(mut self, planes: usize) -> Self {
        self.pixels.resize(self.image * planes, ExactSums::default());
        self
    }

    /// The same, with second moments and variances.
    pub fn with_products(pixels: usize) -> Self {
        Self { products: vec![ExactSums::default(); pixels], ..Self::new(pixels) }
    }

    /// Adds the pass `number`.
    pub fn add(&mut self, number: u64, pass: &[Spectrum]) {
        let half = (number % 2) as usize;
        let sign = [1.0, -1.0][half];
        let pixels = self.pixels.par_chunks_mut(CHUNK).zip(pass.par_chunks(CHUNK));
        pixels.for_each(|(pixels, values)| {
            for (pixel, value) in pixels.iter_mut().zip(values) {
                let [r, g, b] = value.to_array().map(f64::from);
                pixel.add([r, g, b, sign * f64::from(value.luminance())]);
            }
        });
        for (products, value) in self.products.iter_mut().zip(pass) {
            let [r, g, b] = value.as_dvec3().to_array();
            products.add([r * r, r * g, r * b, g * g, g * b, b * b]);
        }
        self.passes[half] += 1;
    }

    /// Adds all passes of `other`, of an image of as many pixels with sums of the same products.
    pub fn merge(&mut self, other: &Self) {
        self.pixels.iter_mut().zip(&other.pixels).for_each(|(sums, other)| sums.merge(other));
        self.products.iter_mut().zip(&other.products).for_each(|(sums, other)| sums.merge(other));
        self.passes.iter_mut().zip(other.passes).for_each(|(passes, other)| *passes += other);
    }

    /// Passes added.
    pub fn passes(&self) -> u64 {
        self.passes.iter().sum()
    }

    /// The mean of all passes.
    pub fn mean(&self) -> Vec<Spectrum> {
        self.mean_of(0)
    }

    /// The mean of a plane.
    pub fn mean_of(&self, plane: usize) -> Vec<Spectrum> {
        let scale = 1.0 / self.passes().max(1) as f64;
        let of_pixel = |sums: &ExactSums<4>| {
            let sums = sums.values();
            Spectrum::from_array(axes(|channel| (sums[channel] * scale) as f32))
        };
        self.pixels[plane * self.image..][..self.image].par_iter().map(of_pixel).collect()
    }

    /// Mean over the passes of (`row` . rgb)^2: the second moment of a channel that combines R, G and B.
    pub fn second_moment(&self, row: Vec3) -> Vec<f32> {
        let scale = 1.0 / self.passes().max(1) as f64;
        self.products.iter().map(|products| (square_of(row, products) * scale) as f32).collect()
    }

    /// Estimated variance of the mean of `row` . rgb; none before the second pass. Passes are taken for independent: where a
    /// sampler spreads their random numbers evenly, the variance is less.
    pub fn variance(&self, row: Vec3) -> Option<Vec<f32>> {
        let n = self.passes() as f64;
        let [r, g, b] = row.as_dvec3().to_array();
        let of_pixel = |(sums, products): (&ExactSums<4>, &ExactSums<6>)| {
            let sums = sums.values();
            let mean = (r * sums[0] + g * sums[1] + b * sums[2]) / n;
            ((square_of(row, products) / n - mean * mean) / (n - 1.0)).max(0.0) as f32
        };
        (n > 1.0).then(|| self.pixels.iter().zip(&self.products).map(of_pixel).collect())
    }

    /// All sums, plane by plane and pixel by pixel: those of R, G, B and the difference of the halves; then the products, if there are any.
    pub fn sums(&self) -> impl Iterator<Item = Parts> + '_ {
        self.pixels.iter().flat_map(ExactSums::parts).chain(self.products.iter().flat_map(ExactSums::parts))
    }

    /// From what [`Accumulator::sums`] gave for `passes` of even and of odd number over `planes` of `pixels` each; none
    /// if the number of sums does not fit.
    pub fn from_sums(pixels: usize, planes: usize, passes: [u64; 2], sums: &[Parts]) -> Option<Self> {
        let image = pixels;
        let (own, products) = sums.split_at_checked(pixels.checked_mul(planes)?.checked_mul(4)?)?;
        let (products, rest) = products.as_chunks();
        let fits = rest.is_empty() && (products.is_empty() || products.len() == pixels);
        let pixels = own.as_chunks().0.iter().map(ExactSums::from_parts).collect();
        fits.then(|| Self {
            pixels,
            products: products.iter().map(ExactSums::from_parts).collect(),
            image,
            passes,
        })
    }

    /// True if it has sums of products.
    pub fn has_products(&self) -> bool {
        !self.products.is_empty()
    }

    /// Number of pixels.
    pub fn len(&self) -> usize {
        self.image
    }

    /// The same of all planes together.
    pub fn len_of_planes(&self) -> usize {
        self.pixels.len()
    }

    /// True for an image without pixels.
    pub fn is_empty(&self) -> bool {
        self.image == 0
    }

    /// Estimated relative error of the mean of an image `width` pixels across, whose pixels see this much of emitters;
    /// none before each half has a pass and some light is found.
    pub fn noise(&self, width: usize, seen: &dyn Fn(usize) -> f64) -> Option<Noise> {
        let [even, odd] = self.passes.map(|passes| passes as f64);
        if even == 0.0 || odd == 0.0 {
            return None;
        }
        let [r, g, b] = LUMINANCE.as_dvec3().to_array();
        let halves = |sums: &ExactSums<4>| {
            let [sum_r, sum_g, sum_b, contrast] = sums.values();
            let sum = r * sum_r + g * sum_g + b * sum_b;
            ((sum + contrast) / (2.0 * even), (sum - contrast) / (2.0 * odd))
        };
        let halves: Vec<(f64, f64)> = self.pixels[..self.image].par_iter().map(halves).collect();
        Noise::of_halves(width, &halves, seen)
    }
}

/// (`row` . rgb)^2 from the products of r, g and b.
fn square_of(row: Vec3, products: &ExactSums<6>) -> f64 {
    let [r, g, b] = row.as_dvec3().to_array();
    let factors = [r * r, 2.0 * r * g, 2.0 * r * b, g * g, 2.0 * g * b, b * b];
    factors.iter().zip(products.values()).map(|(factor, product)| factor * product).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        math::vec3,
        sampling::{Stream, stream::Purpose},
    };

    #[test]
    fn moments_and_variances_of_known_passes() {
        let mut film = Accumulator::with_products(1);
        let row = vec3(1.0, 2.0, -1.0);
        assert_eq!(film.variance(row), None);
        // The row makes 0, 6 and 3 of them.
        for (number, pass) in
            [vec3(1.0, 0.0, 1.0), vec3(2.0, 3.0, 2.0), vec3(0.0, 2.0, 1.0)].iter().enumerate()
        {
            film.add(number as u64, &[*pass]);
        }
        assert_eq!(film.second_moment(row), [15.0]);
        // Sample variance 9, of the mean a third of it.
        assert!((film.variance(row).unwrap()[0] - 3.0).abs() < 1e-6);
        assert!(Accumulator::new(1).second_moment(row).is_empty());
    }

    #[test]
    fn mean_and_noise_of_known_passes() {
        let mut film = Accumulator::new(1);
        film.add(0, &[Spectrum::splat(1.0)]);
        assert_eq!(film.noise(1, &|_| 0.0), None);
        film.add(1, &[Spectrum::splat(3.0)]);
        assert_eq!(film.mean(), vec![Spectrum::splat(2.0)]);
        // Variance of the mean of {1, 3} is 1; relative to 2^2 + 0.01 2^2.
        let expected = (1.0f64 / 4.04).sqrt();
        assert!((film.noise(1, &|_| 0.0).unwrap().error - expected).abs() < 1e-5);
        // A third pass: the halves' means are 3 and 3.
        film.add(2, &[Spectrum::splat(5.0)]);
        assert!(film.noise(1, &|_| 0.0).unwrap().error < 1e-7);
    }

    /// Over many pixels it is the error of the mean, for any numbers of passes in the halves.
    #[test]
    fn noise_is_unbiased() {
        for passes in [[1u64, 1], [8, 8], [5, 4]] {
            let pixels = 40_000;
            let mut film = Accumulator::new(pixels);
            for (half, count) in passes.iter().enumerate() {
                for pass in 0..*count {
                    let mut stream = Stream::new(3, half as u64, pass, Purpose::Study);
                    let values: Vec<_> =
                        (0..pixels).map(|_| Spectrum::splat(1.0 + 0.1 * stream.normal())).collect();
                    film.add(2 * pass + half as u64, &values);
                }
            }
            // Where the halves are not equal, this is a little more than the variance of the mean.
            let variance = 0.01 * passes.iter().map(|passes| 0.25 / *passes as f64).sum::<f64>();
            let relative = film.noise(200, &|_| 0.0).unwrap().error.powi(2) / (variance / 1.01);
            let z = (relative - 1.0) / (2.0 / pixels as f64).sqrt();
            assert!(z.abs() < 4.0, "{passes:?}: {z}");
        }
    }

    #[test]
    fn noise_does_not_depend_on_the_unit_of_radiance() {
        let noise = |unit: f32| {
            let mut film = Accumulator::new(3);
            for (number, pass) in [[0.0, 1.0, 5.0], [0.0, 3.0, 4.0], [0.1, 2.0, 6.0]].iter().enumerate() {
                film.add(number as u64, &pass.map(|value| Spectrum::splat(unit * value)));
            }
            film.noise(1, &|_| 0.0).unwrap().error
        };
        let one = noise(1.0);
        assert!(one > 0.1 && [1e-3, 1e3].iter().all(|unit| (noise(*unit) / one - 1.0).abs() < 1e-5));
    }
}
