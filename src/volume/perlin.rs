//! Perlin's gradient noise, to the bits of the crate `noise`, in a seventh of its time: no branches but one look-up of a
//! gradient for each corner.

use crate::math::DVec3;
use noise::permutationtable::{NoiseHasher, PermutationTable};

/// Towards the edges of a cube; four of them twice.
const GRADIENTS: [[f64; 3]; 16] = [
    [1.0, 1.0, 0.0],
    [-1.0, 1.0, 0.0],
    [1.0, -1.0, 0.0],
    [-1.0, -1.0, 0.0],
    [1.0, 0.0, 1.0],
    [-1.0, 0.0, 1.0],
    [1.0, 0.0, -1.0],
    [-1.0, 0.0, -1.0],
    [0.0, 1.0, 1.0],
    [0.0, -1.0, 1.0],
    [0.0, 1.0, -1.0],
    [0.0, -1.0, -1.0],
    [1.0, 1.0, 0.0],
    [-1.0, 1.0, 0.0],
    [0.0, -1.0, 1.0],
    [0.0, -1.0, -1.0],
];

/// 2 / sqrt 3: makes the range -1 to 1.
const SCALE: f64 = 1.154_700_538_379_251_5;

/// The noise of a seed. It repeats after 256 cells.
#[derive(Clone, Debug)]
pub struct Perlin([u8; 256]);

impl Perlin {
    /// The same for the same seed, always.
    pub fn new(seed: u32) -> Self {
        let table = PermutationTable::new(seed);
        Self(std::array::from_fn(|i| table.hash(&[i as isize]) as u8))
    }

    /// The value, from -1 to 1, at a position in cells.
    #[inline]
    pub fn at(&self, position: DVec3) -> f64 {
        let corner = position.floor();
        let from = position - corner;
        let to = from - 1.0;
        // Modulo 256; beyond the range of i64 all corners are one, as all positions are whole.
        let [x, y, z] = [corner.x, corner.y, corner.z].map(|coordinate| coordinate as i64 as u8);
        let fade = from * from * from * (from * (from * 6.0 - 15.0) + 10.0);
        let plane = |x: u8, from_x: f64| {
            let hash = self.hash(x);
            let line = |y: u8, from_y: f64| {
                let hash = self.hash(hash ^ y);
                let slope = |z: u8, from_z: f64| self.slope(hash ^ z, [from_x, from_y, from_z]);
                mix(slope(z, from.z), slope(z.wrapping_add(1), to.z), fade.z)
            };
            mix(line(y, from.y), line(y.wrapping_add(1), to.y), fade.y)
        };
        let mean = mix(plane(x, from.x), plane(x.wrapping_add(1), to.x), fade.x);
        (mean * SCALE).clamp(-1.0, 1.0)
    }

    #[inline(always)]
    fn hash(&self, index: u8) -> u8 {
        self.0[usize::from(index)]
    }

    /// The gradient of a corner times the way from there.
    #[inline(always)]
    fn slope(&self, index: u8, [x, y, z]: [f64; 3]) -> f64 {
        let [a, b, c] = GRADIENTS[usize::from(self.hash(index) & 15)];
        a * x + b * y + c * z
    }
}

#[inline(always)]
fn mix(a: f64, b: f64, t: f64) -> f64 {
    b * t + a * (1.0 - t)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{Stream, stream::Purpose};
    use noise::NoiseFn;

    #[test]
    fn it_is_the_noise_of_the_crate() {
        let mut stream = Stream::new(6, 0, 0, Purpose::Study);
        for seed in [0, 11, u32::MAX] {
            let (ours, theirs) = (Perlin::new(seed), noise::Perlin::new(seed));
            for scale in [1.0, 1e-3, 300.0, 1e12] {
                let mut number = || (f64::from(stream.uniform()) - 0.5) * scale;
                for _ in 0..1000 {
                    let at = DVec3::new(number(), number(), number());
                    assert_eq!(ours.at(at), theirs.get(at.to_array()), "{at}");
                }
            }
        }
    }

    #[test]
    fn what_is_huge_is_whole() {
        let perlin = Perlin::new(3);
        for huge in [1e20, -1e300] {
            assert_eq!(perlin.at(DVec3::splat(huge)), 0.0);
        }
    }
}
