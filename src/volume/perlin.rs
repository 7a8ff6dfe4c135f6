//! Perlin's gradient noise, to the bits of the crate `noise`, in a seventh of its time: no branches but one look-up of a
//! gradient for each corner.

use crate::math::{DVec3, axes};
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

/// Bounds of boxes that touch more cubes along an axis are -1 and 1.
const MOST_CUBES: usize = 4;

/// More than what bounds lose to rounding.
const ROUNDING: f64 = 1e-12;

/// Coefficients of a polynomial of degree 6; and with one of them again, so that they fill registers.
const COUNT: usize = 7;
const LANES: usize = 8;

/// What the noise is made of along one axis of a cube, in a part of it: polynomials, by their Bernstein coefficients.
/// No value of a polynomial is outside of these (Farin 2002, Curves and Surfaces for CAGD, 5.1).
#[derive(Clone, Copy, Debug, Default)]
struct Axis {
    /// The cube's corner, modulo 256.
    corner: u8,
    /// Weights of the two corners.
    weights: [[f64; LANES]; 2],
    /// The same times the way from the corner.
    moved: [[f64; LANES]; 2],
}

/// By powers of x: 1 - fade and fade, and these times x and x - 1.
const WEIGHTS: [[f64; COUNT]; 2] =
    [[1.0, 0.0, 0.0, -10.0, 15.0, -6.0, 0.0], [0.0, 0.0, 0.0, 10.0, -15.0, 6.0, 0.0]];
const MOVED: [[f64; COUNT]; 2] =
    [[0.0, 1.0, 0.0, 0.0, -10.0, 15.0, -6.0], [0.0, 0.0, 0.0, -10.0, 25.0, -21.0, 6.0]];
/// 1 over the binomial coefficients of 6.
const SHARES: [f64; COUNT] = [1.0, 1.0 / 6.0, 1.0 / 15.0, 1.0 / 20.0, 1.0 / 15.0, 1.0 / 6.0, 1.0];

impl Axis {
    /// From `a` to `b`, in [0, 1], of the cube at `corner`.
    fn new(corner: f64, [a, b]: [f64; 2]) -> Self {
        let mut axis =
            Self { corner: corner as i64 as u8, weights: [[0.0; LANES]; 2], moved: [[0.0; LANES]; 2] };
        for lane in 0..LANES {
            let blossom = blossom(a, b, lane.min(COUNT - 1));
            for side in 0..2 {
                for n in 0..COUNT {
                    axis.weights[side][lane] += blossom[n] * WEIGHTS[side][n];
                    axis.moved[side][lane] += blossom[n] * MOVED[side][n];
                }
            }
        }
        axis
    }

    /// The cubes between two positions along an axis, and how many they are.
    fn all(low: f64, high: f64) -> ([Self; MOST_CUBES], usize) {
        let first = low.floor();
        let count = (high.floor() - first) as usize + 1;
        let mut all = [Self::default(); MOST_CUBES];
        for (step, axis) in all.iter_mut().enumerate().take(count) {
            let corner = first + step as f64;
            *axis = Self::new(corner, [(low - corner).max(0.0), (high - corner).min(1.0)]);
        }
        (all, count)
    }
}

/// Bernstein coefficient number `index` of every power of x between `a` and `b`: its symmetric multilinear form at so
/// many b and for the rest a. That is the coefficient of t^n in (1 + a t)^(6 - index) (1 + b t)^index over that in
/// (1 + t)^6.
#[inline(always)]
fn blossom(a: f64, b: f64, index: usize) -> [f64; COUNT] {
    let mut product = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    for factor in 0..COUNT - 1 {
        let root = if factor < index { b } else { a };
        for n in (1..COUNT).rev() {
            product[n] += root * product[n - 1];
        }
    }
    for n in 0..COUNT {
        product[n] *= SHARES[n];
    }
    product
}

/// The noise of a seed. It repeats after 256 cells.
#[derive(Clone, Debug)]
pub(super) struct Perlin([u8; 256]);

impl Perlin {
    /// The same for the same seed, always.
    pub(super) fn new(seed: u32) -> Self {
        let table = PermutationTable::new(seed);
        Self(std::array::from_fn(|i| table.hash(&[i as isize]) as u8))
    }

    /// The value, from -1 to 1, at a position in cells.
    #[inline]
    pub(super) fn at(&self, position: DVec3) -> f64 {
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

    /// Bounds of the value in the box from `low` to `high`, in cells: of all cubes that it touches, if they are few.
    pub(super) fn range(&self, low: DVec3, high: DVec3) -> [f64; 2] {
        if !(high.floor() - low.floor()).cmplt(DVec3::splat(MOST_CUBES as f64)).all() {
            return [-1.0, 1.0];
        }
        let [(xs, x_count), (ys, y_count), (zs, z_count)] = axes(|i| Axis::all(low[i], high[i]));
        let mut range = [f64::INFINITY, f64::NEG_INFINITY];
        for x in &xs[..x_count] {
            for y in &ys[..y_count] {
                for z in &zs[..z_count] {
                    let [least, most] = self.range_in_cube(x, y, z);
                    range = [range[0].min(least), range[1].max(most)];
                }
            }
        }
        [range[0] * SCALE - ROUNDING, range[1] * SCALE + ROUNDING].map(|end| end.clamp(-1.0, 1.0))
    }

    /// The least and the greatest Bernstein coefficient of the unscaled noise in a part of a cube, where it is a
    /// polynomial: sums of products of three polynomials, one an axis.
    fn range_in_cube(&self, x: &Axis, y: &Axis, z: &Axis) -> [f64; 2] {
        let [near, far] = [0, 1].map(|side| self.plane(x.corner.wrapping_add(side), y, z));
        let (mut least, mut most) = ([f64::INFINITY; LANES], [f64::NEG_INFINITY; LANES]);
        for column in 0..COUNT {
            for row in 0..COUNT {
                for (lane, (least, most)) in least.iter_mut().zip(&mut most).enumerate() {
                    let value = x.weights[0][column] * near.0[row][lane]
                        + x.moved[0][column] * near.1[row][lane]
                        + x.weights[1][column] * far.0[row][lane]
                        + x.moved[1][column] * far.1[row][lane];
                    *least = if value < *least { value } else { *least };
                    *most = if value > *most { value } else { *most };
                }
            }
        }
        [least.into_iter().fold(f64::INFINITY, f64::min), most.into_iter().fold(f64::NEG_INFINITY, f64::max)]
    }

    /// At the corners of a cube with the same `x`: the coefficients in y and z of what its weight along x multiplies, and of what
    /// that times the way from there does.
    #[inline(always)]
    fn plane(&self, x: u8, y: &Axis, z: &Axis) -> ([[f64; LANES]; COUNT], [[f64; LANES]; COUNT]) {
        let hash = self.hash(x);
        let (mut plain, mut moved) = ([[0.0; LANES]; COUNT], [[0.0; LANES]; COUNT]);
        for side in 0..2 {
            let hash = self.hash(hash ^ y.corner.wrapping_add(side as u8));
            let gradient = |side: u8| self.gradient(hash ^ z.corner.wrapping_add(side));
            let ([ax, ay, az], [bx, by, bz]) = (gradient(0), gradient(1));
            let (mut along, mut across, mut up) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
            for lane in 0..LANES {
                along[lane] = ax * z.weights[0][lane] + bx * z.weights[1][lane];
                across[lane] = ay * z.weights[0][lane] + by * z.weights[1][lane];
                up[lane] = az * z.moved[0][lane] + bz * z.moved[1][lane];
            }
            for row in 0..COUNT {
                for lane in 0..LANES {
                    plain[row][lane] += y.weights[side][row] * up[lane] + y.moved[side][row] * across[lane];
                    moved[row][lane] += y.weights[side][row] * along[lane];
                }
            }
        }
        (plain, moved)
    }

    #[inline(always)]
    fn gradient(&self, index: u8) -> [f64; 3] {
        GRADIENTS[usize::from(self.hash(index) & 15)]
    }

    #[inline(always)]
    fn hash(&self, index: u8) -> u8 {
        self.0[usize::from(index)]
    }

    /// The gradient of a corner times the way from there.
    #[inline(always)]
    fn slope(&self, index: u8, [x, y, z]: [f64; 3]) -> f64 {
        let [a, b, c] = self.gradient(index);
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

    /// No value in a box is outside its bounds, and those are not far from the extremes of many.
    #[test]
    fn bounds_hold_and_are_narrow() {
        let mut stream = Stream::new(7, 0, 0, Purpose::Study);
        let perlin = Perlin::new(4);
        let mut widths = [[0.0; 2]; 3];
        for index in 0..600 {
            let mut vector = || DVec3::from_array(std::array::from_fn(|_| f64::from(stream.uniform())));
            let size = vector() * [0.25, 0.5, 2.0][index % 3];
            let low = (vector() - 0.5) * 600.0;
            let [least, most] = perlin.range(low, low + size);
            let mut found = [1.0f64, -1.0];
            for _ in 0..1000 {
                let value = perlin.at(low + vector() * size);
                assert!(least <= value && value <= most, "{least} {value} {most}");
                found = [found[0].min(value), found[1].max(value)];
            }
            widths[index % 3][0] += most - least;
            widths[index % 3][1] += found[1] - found[0];
        }
        let excess = widths.map(|[bounds, found]| bounds / found);
        assert!(excess[0] < 1.3 && excess[1] < 1.4 && excess[2] < 1.6, "{excess:?}");
        assert_eq!(perlin.range(DVec3::ZERO, DVec3::splat(10.0)), [-1.0, 1.0]);
        assert_eq!(perlin.range(DVec3::splat(-1e300), DVec3::splat(1e300)), [-1.0, 1.0]);
    }

    #[test]
    fn what_is_huge_is_whole() {
        let perlin = Perlin::new(3);
        for huge in [1e20, -1e300] {
            assert_eq!(perlin.at(DVec3::splat(huge)), 0.0);
        }
    }
}
