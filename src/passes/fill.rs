//! Pixels without a sample, filled from those around them: push and pull over ever coarser images (Gortler et al. 1996).

use crate::math::Spectrum;

/// Sets the pixels of a row-major image that are not `known` to means of known ones nearby; black where none is known.
pub(super) fn fill(pixels: &mut [Spectrum], known: &[bool], width: usize) {
    let sums = pixels.iter().zip(known);
    let sums =
        sums.map(|(pixel, known)| if *known { (*pixel, 1.0) } else { (Spectrum::ZERO, 0.0) }).collect();
    let filled = pulled(sums, width);
    for ((pixel, known), filled) in pixels.iter_mut().zip(known).zip(filled) {
        if !known {
            *pixel = filled;
        }
    }
}

/// Mean colours of an image of colours times weight, with weights; where the weight is 0, from a coarser image.
fn pulled(sums: Vec<(Spectrum, f32)>, width: usize) -> Vec<Spectrum> {
    let height = sums.len() / width.max(1);
    let is_full = sums.iter().all(|(_, weight)| *weight > 0.0);
    let mean = |(sum, weight): &(Spectrum, f32)| if *weight > 0.0 { *sum / *weight } else { Spectrum::ZERO };
    if is_full || sums.len() <= 1 {
        return sums.iter().map(mean).collect();
    }
    let (columns, rows) = (width.div_ceil(2), height.div_ceil(2));
    let coarse = |pixel: usize| pixel / width / 2 * columns + pixel % width / 2;
    let mut pushed = vec![(Spectrum::ZERO, 0.0); columns * rows];
    for (pixel, (sum, weight)) in sums.iter().enumerate() {
        let (all, total) = &mut pushed[coarse(pixel)];
        *all += *sum;
        *total += weight;
    }
    let coarser = pulled(pushed, columns);
    let of_pixel = |(pixel, one): (usize, &(Spectrum, f32))| {
        if one.1 > 0.0 { mean(one) } else { coarser[coarse(pixel)] }
    };
    sums.iter().enumerate().map(of_pixel).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknown_pixels_take_what_is_near_and_known_ones_stay() {
        for (width, height) in [(1, 1), (7, 3), (16, 16), (1, 9)] {
            let value = |pixel: usize| Spectrum::splat(if pixel % width < width / 2 { 1.0 } else { 3.0 });
            let known: Vec<bool> = (0..width * height).map(|pixel| pixel % 5 == 0).collect();
            let mut pixels: Vec<_> =
                (0..width * height).map(|p| if known[p] { value(p) } else { Spectrum::NAN }).collect();
            fill(&mut pixels, &known, width);
            assert!(pixels.iter().all(|p| (1.0..=3.0).contains(&p.x)), "{width} x {height}: {pixels:?}");
            assert!((0..known.len()).filter(|p| known[*p]).all(|p| pixels[p] == value(p)));
        }
        let mut none = [Spectrum::ONE; 4];
        fill(&mut none, &[false; 4], 2);
        assert_eq!(none, [Spectrum::ZERO; 4]);
    }
}
