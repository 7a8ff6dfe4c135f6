//! Random numbers as a pure function of (seed, pixel or walk, sample, purpose).

use crate::math::{Vec2, vec2};
use rand::{Rng, SeedableRng};
use rand_distr::{Distribution, Exp1, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;

/// What a stream is for: two purposes at the same index never share numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// Eye walks.
    Eye = 1,
    /// Light walks.
    Light = 2,
    /// Measurements before the render (pilot walks, medium detection).
    Pilot = 3,
    /// Tests and tools.
    Study = 4,
}

/// One independent sequence of uniform numbers.
#[derive(Clone, Debug)]
pub struct Stream(Xoshiro256PlusPlus);

impl Stream {
    /// The stream of (`seed`, `index`, `sample`, `purpose`): the same four give the same numbers on every
    /// machine and any number of threads.
    #[inline]
    pub fn new(seed: u64, index: u64, sample: u64, purpose: Purpose) -> Self {
        let key = [index, sample, purpose as u64].iter().fold(mix(seed), |key, part| mix(key ^ mix(*part)));
        Self(Xoshiro256PlusPlus::seed_from_u64(key))
    }

    /// Uniform in [0, 1), 24 bits.
    #[inline]
    pub fn uniform(&mut self) -> f32 {
        (self.0.next_u64() >> 40) as f32 * (1.0 / (1u64 << 24) as f32)
    }

    /// Uniform in [0, 1), 53 bits.
    #[inline]
    pub fn uniform_precisely(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
    }

    /// Uniform in the unit square, from one draw.
    #[inline]
    pub fn square(&mut self) -> Vec2 {
        const SCALE: f32 = 1.0 / (1u64 << 24) as f32;
        let bits = self.0.next_u64();
        vec2((bits >> 40) as f32 * SCALE, ((bits >> 8) & 0xff_ffff) as f32 * SCALE)
    }

    /// Exponential with mean 1, exact in both tails: an optical depth of 1e-7 or of 40 comes as often as it
    /// should, which -ln(1-u) of a 24-bit u does not give.
    #[inline]
    pub fn exponential(&mut self) -> f32 {
        let x: f64 = Exp1.sample(&mut self.0);
        x as f32
    }

    /// Standard normal.
    #[inline]
    pub fn normal(&mut self) -> f32 {
        let x: f64 = StandardNormal.sample(&mut self.0);
        x as f32
    }

    /// Uniform in 0..`n`; `n` > 0.
    #[inline]
    pub fn below(&mut self, n: usize) -> usize {
        ((u128::from(self.0.next_u64()) * n as u128) >> 64) as usize
    }
}

/// Stafford's variant 13 of the murmur finaliser (Steele et al. 2014, SplitMix).
#[inline]
fn mix(x: u64) -> u64 {
    let x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_keys_give_equal_numbers_and_any_other_key_others() {
        let draw = |seed, index, sample, purpose| Stream::new(seed, index, sample, purpose).uniform();
        let base = draw(1, 2, 3, Purpose::Eye);
        assert_eq!(base, draw(1, 2, 3, Purpose::Eye));
        for other in [draw(2, 2, 3, Purpose::Eye), draw(1, 3, 2, Purpose::Eye), draw(1, 2, 3, Purpose::Light)]
        {
            assert_ne!(base, other);
        }
    }

    #[test]
    fn exponential_has_both_tails() {
        let mut stream = Stream::new(0, 0, 0, Purpose::Study);
        let n = 4_000_000;
        let (mut tiny, mut large) = (0, 0);
        for _ in 0..n {
            let x = stream.exponential();
            tiny += usize::from(x < 1e-5);
            large += usize::from(x > 10.0);
        }
        let z = |count: usize, p: f64| (count as f64 - n as f64 * p) / (n as f64 * p).sqrt();
        assert!(z(tiny, 1e-5).abs() < 4.0, "{tiny}");
        assert!(z(large, (-10f64).exp()).abs() < 4.0, "{large}");
    }
}
