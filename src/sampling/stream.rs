//! Random numbers as a pure function of (seed, pixel or walk, sample, purpose).

use super::{inverse, points::Point};
use crate::math::{Vec2, vec2};
use rand::{Rng, SeedableRng};
use rand_distr::{Distribution, Exp1, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;

/// What a stream is for: two purposes at the same index never share numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// Camera subpaths.
    Camera = 1,
    /// Light subpaths.
    Light = 2,
    /// Measurements before the render (pilot walks, medium detection).
    Pilot = 3,
    /// Tests and tools.
    Study = 4,
    /// When a pass sees a scene that moves.
    Shutter = 5,
    /// Pixels of what light subpaths contribute.
    Splat = 6,
}

/// One sequence of uniform numbers: the coordinates of a point, if it has one, then independent numbers.
#[derive(Clone, Debug)]
pub struct Stream {
    generator: Xoshiro256PlusPlus,
    point: Point,
}

impl Stream {
    /// The stream of (`seed`, `index`, `sample`, `purpose`): the same four give the same numbers on every
    /// machine and any number of threads.
    #[inline]
    pub fn new(seed: u64, index: u64, sample: u64, purpose: Purpose) -> Self {
        let generator = Xoshiro256PlusPlus::seed_from_u64(key(seed, [index, sample, purpose as u64]));
        Self { generator, point: Point::NONE }
    }

    /// The stream of the same four, whose first numbers are spread evenly over the samples of one index: they are the
    /// coordinates of point `sample` of a sequence scrambled by (`seed`, `index`, `purpose`).
    pub fn sobol(seed: u64, index: u64, sample: u64, purpose: Purpose) -> Self {
        let point = Point::new(key(seed, [index, purpose as u64]), sample);
        Self { point, ..Self::new(seed, index, sample, purpose) }
    }

    /// The stream with these first two numbers, both in [0, 1); later ones depend on them alone.
    pub fn of(first: Vec2) -> Self {
        let bits = first.to_array().map(|x| (f64::from(x) * (1u64 << 32) as f64) as u32);
        let [index, sample] = bits.map(u64::from);
        Self { point: Point::of(bits), ..Self::new(0, index, sample, Purpose::Camera) }
    }

    /// 64 random bits, the first of which may be a coordinate's.
    #[inline]
    fn bits(&mut self) -> u64 {
        if self.point.is_spent() { self.generator.next_u64() } else { self.coordinate() }
    }

    /// The 32 bits of a coordinate, and as many independent ones below them.
    #[cold]
    #[inline(never)]
    fn coordinate(&mut self) -> u64 {
        u64::from(self.point.next()) << 32 | self.generator.next_u64() >> 32
    }

    /// Uniform in [0, 1), 24 bits.
    #[inline]
    pub fn uniform(&mut self) -> f32 {
        if !self.point.is_spent() {
            return self.even_uniform();
        }
        (self.generator.next_u64() >> 40) as f32 * SCALE
    }

    /// Of a coordinate alone.
    #[cold]
    #[inline(never)]
    fn even_uniform(&mut self) -> f32 {
        (self.point.next() >> 8) as f32 * SCALE
    }

    /// Uniform in [0, 1), 53 bits.
    #[inline]
    pub fn uniform_precisely(&mut self) -> f64 {
        (self.bits() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
    }

    /// Uniform in the unit square: two coordinates, or one independent draw.
    #[inline]
    pub fn square(&mut self) -> Vec2 {
        if !self.point.is_spent() {
            return self.even_square();
        }
        let bits = self.generator.next_u64();
        vec2((bits >> 40) as f32 * SCALE, ((bits >> 8) & 0xff_ffff) as f32 * SCALE)
    }

    #[cold]
    #[inline(never)]
    fn even_square(&mut self) -> Vec2 {
        let x = self.uniform();
        vec2(x, self.uniform())
    }

    /// Exponential with mean 1, exact in both tails: an optical depth of 1e-7 or of 40 comes as often as it
    /// should, which -ln(1-u) of a 24-bit u does not give.
    #[inline(always)]
    pub fn exponential(&mut self) -> f32 {
        if !self.point.is_spent() {
            return self.even_exponential();
        }
        let x: f64 = Exp1.sample(&mut self.generator);
        x as f32
    }

    #[cold]
    #[inline(never)]
    fn even_exponential(&mut self) -> f32 {
        inverse::exponential(self.coordinate()) as f32
    }

    /// Standard normal.
    #[inline]
    pub fn normal(&mut self) -> f32 {
        if !self.point.is_spent() {
            return self.even_normal();
        }
        let x: f64 = StandardNormal.sample(&mut self.generator);
        x as f32
    }

    #[cold]
    #[inline(never)]
    fn even_normal(&mut self) -> f32 {
        inverse::normal(self.coordinate()) as f32
    }

    /// Uniform in 0..`n`; `n` > 0.
    #[inline]
    pub fn below(&mut self, n: usize) -> usize {
        ((u128::from(self.bits()) * n as u128) >> 64) as usize
    }
}

/// Steps of 24 bits.
const SCALE: f32 = 1.0 / (1u64 << 24) as f32;

/// Combines many numbers into one. The rotation of `seed` distinguishes it from the first part: without it the two
/// could change places.
#[inline]
fn key<const N: usize>(seed: u64, parts: [u64; N]) -> u64 {
    parts.iter().fold(mix(seed.rotate_left(32)), |key, part| mix(key ^ mix(*part)))
}

/// Stafford's variant 13 of the murmur finaliser (Steele et al. 2014, SplitMix).
#[inline]
pub(super) fn mix(x: u64) -> u64 {
    let x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{sampling::points::DIMENSIONS, testing};
    use std::collections::HashSet;

    #[test]
    fn equal_keys_give_equal_numbers_and_any_other_key_others() {
        let draw = |seed, index, sample, purpose| Stream::new(seed, index, sample, purpose).uniform();
        let base = draw(1, 2, 3, Purpose::Camera);
        assert_eq!(base, draw(1, 2, 3, Purpose::Camera));
        for other in
            [draw(2, 2, 3, Purpose::Camera), draw(1, 3, 2, Purpose::Camera), draw(1, 2, 3, Purpose::Light)]
        {
            assert_ne!(base, other);
        }
    }

    #[test]
    fn no_two_of_small_seeds_indices_and_samples_give_the_same_numbers() {
        let mut seen = HashSet::new();
        for (i, j, k) in (0..16).flat_map(|i| (0..16).flat_map(move |j| (0..16).map(move |k| (i, j, k)))) {
            assert!(seen.insert(key(i, [j, k])), "{i} {j} {k}");
        }
    }

    #[test]
    fn exponential_has_both_tails() {
        type Of = fn(u64) -> Stream;
        let streams: [(Of, u64); 2] = [
            (|index| Stream::new(0, index, 0, Purpose::Study), 1 << 22),
            (|index| Stream::sobol(0, index / 8, index % 8, Purpose::Study), u64::from(DIMENSIONS)),
        ];
        let n = 1 << 22;
        for (stream, draws) in streams {
            let (mut tiny, mut large) = (0, 0);
            for index in 0..n / draws {
                let mut stream = stream(index);
                for _ in 0..draws {
                    let x = stream.exponential();
                    tiny += usize::from(x < 1e-5);
                    large += usize::from(x > 10.0);
                }
            }
            let z = |count: usize, p: f64| (count as f64 - n as f64 * p) / (n as f64 * p).sqrt();
            assert!(z(tiny, 1e-5).abs() < 4.0, "{tiny}");
            assert!(z(large, (-10f64).exp()).abs() < 4.0, "{large}");
        }
    }

    /// Every coordinate is uniform over the keys, down to bits that only scrambling makes; and so is the pair of it with
    /// the next.
    #[test]
    fn every_coordinate_is_uniform() {
        const CELLS: usize = 64;
        let (n, d) = (40_000u64, DIMENSIONS as usize);
        let (mut high, mut low) = (vec![[0; CELLS]; d], vec![[0; CELLS]; d]);
        let mut pair = vec![[0; CELLS]; d];
        for index in 0..n {
            let mut stream = Stream::sobol(9, index, index % 77, Purpose::Study);
            let mut before = 0;
            for axis in 0..d {
                let bits = stream.bits();
                high[axis][(bits >> 58) as usize] += 1;
                low[axis][(bits >> 36) as usize % CELLS] += 1;
                pair[axis][before << 3 | (bits >> 61) as usize] += 1;
                before = (bits >> 61) as usize;
            }
        }
        let expected = [n as f64 / CELLS as f64; CELLS];
        for axis in 0..d {
            for (what, counts) in [("high", &high[axis]), ("low", &low[axis]), ("pair", &pair[axis])] {
                let p = testing::chi_square(counts, &expected);
                assert!(
                    axis == 0 && what == "pair" || p > testing::significance(3 * d),
                    "{axis} {what}: {p}"
                );
            }
        }
    }

    /// The mean squared error of an integral over two coordinates, by the mean of consecutive samples, against that of
    /// independent ones: far less for neighbours, which make the points of squares, and for most other pairs.
    #[test]
    fn integrals_over_two_coordinates_are_far_better() {
        let (n, keys) = (256, 24);
        let drawn: Vec<Vec<Vec<f32>>> = (0..keys)
            .map(|key| {
                let draw = |sample| {
                    let mut stream = Stream::sobol(3, key, sample, Purpose::Study);
                    (0..DIMENSIONS).map(|_| stream.uniform()).collect()
                };
                (0..n).map(draw).collect()
            })
            .collect();
        // x y has mean 1/4 and variance 7/144.
        let independent = 7.0 / 144.0 / n as f64;
        let mut ratios = Vec::new();
        for a in 0..DIMENSIONS as usize {
            for b in 0..a {
                let error = |points: &Vec<Vec<f32>>| {
                    let sum: f64 = points.iter().map(|p| f64::from(p[a]) * f64::from(p[b])).sum();
                    (sum / n as f64 - 0.25).powi(2)
                };
                let even = drawn.iter().map(error).sum::<f64>() / keys as f64;
                let (ratio, most) = (even / independent, if b + 1 == a { 0.1 } else { 1.0 });
                assert!(ratio < most, "{a}, {b}: {ratio}");
                ratios.push(ratio);
            }
        }
        let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
        assert!(mean < 0.03, "{mean}");
    }

    /// What follows the coordinates is independent: a stream goes on for ever.
    #[test]
    fn streams_go_on_beyond_their_point() {
        let mut stream = Stream::sobol(1, 2, 3, Purpose::Camera);
        let mut other = Stream::sobol(1, 2, 3 + (1 << 16), Purpose::Camera);
        let drawn: Vec<_> = (0..3 * DIMENSIONS).map(|_| stream.uniform()).collect();
        assert!(drawn.iter().all(|u| (0.0..1.0).contains(u)));
        assert!(drawn.iter().all(|u| *u != other.uniform()));
        // Squares cut in two by the end of the point are squares still.
        let mut stream = Stream::sobol(1, 2, 3, Purpose::Camera);
        stream.uniform();
        (0..DIMENSIONS).for_each(|_| assert!(stream.square().min_element() >= 0.0));
    }
}
