//! What light subpaths contribute to pixels. Memory is bounded by the number of pixels, not of vertices: walks in thick
//! white media have millions of vertices, and the camera may see each.

use crate::math::{DVec3, Spectrum};

/// Number of splats kept one by one, in the order in which they came: 16 MB, a thousand for each light subpath of a
/// block.
const FEW: usize = 1 << 20;

/// Values and their pixels, or pixels of planes, as the caller numbers them.
#[derive(Debug, Default)]
pub struct Splats {
    values: Vec<(u32, Spectrum)>,
    /// How many were left when those of each pixel were last added up.
    left: usize,
}

impl Splats {
    /// One more.
    #[inline]
    pub fn push(&mut self, pixel: u32, value: Spectrum) {
        if self.values.len() >= FEW.max(2 * self.left) {
            self.add_up();
        }
        self.values.push((pixel, value));
    }

    /// All of them.
    pub fn into_values(self) -> Vec<(u32, Spectrum)> {
        self.values
    }

    #[cold]
    fn add_up(&mut self) {
        self.values.sort_by_key(|(pixel, _)| *pixel);
        let of_pixel = |values: &[(u32, Spectrum)]| {
            let sum: DVec3 = values.iter().map(|(_, value)| value.as_dvec3()).sum();
            (values[0].0, sum.as_vec3())
        };
        self.values = self.values.chunk_by(|a, b| a.0 == b.0).map(of_pixel).collect();
        self.left = self.values.len();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn millions_take_the_memory_of_pixels_and_none_is_lost() {
        let mut splats = Splats::default();
        let count = 5 * FEW as u32;
        for i in 0..count {
            splats.push(i % 3, Spectrum::new(1.0, 1e-3, if i < 3 { 1e6 } else { 1e-6 }));
        }
        assert!(splats.values.capacity() <= 2 * FEW);
        let values = splats.into_values();
        for pixel in 0..3 {
            let sum: DVec3 =
                values.iter().filter(|(of, _)| *of == pixel).map(|(_, value)| value.as_dvec3()).sum();
            let hits = f64::from((count - pixel).div_ceil(3));
            for (found, expected) in
                sum.to_array().into_iter().zip([hits, 1e-3 * hits, 1e6 + 1e-6 * (hits - 1.0)])
            {
                assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
            }
        }
    }

    #[test]
    fn few_stay_as_they_came() {
        let mut splats = Splats::default();
        let given: Vec<(u32, Spectrum)> = (0..1000).map(|i| (i % 7, Spectrum::splat(i as f32))).collect();
        given.iter().for_each(|(pixel, value)| splats.push(*pixel, *value));
        assert_eq!(splats.into_values(), given);
    }
}
