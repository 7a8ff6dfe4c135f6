//! LDR-FLIP (Andersson et al., "FLIP: A Difference Evaluator for Alternating Images", HPG 2020): how large the
//! difference between two images appears when one is shown in place of the other, per pixel from 0 to 1. Section
//! numbers are those of the paper; the planes of images are row by row from the top.

use crate::{
    film::format::{XYZ_ROWS, to_xyz},
    math::{
        Spectrum, Vec3,
        colour::{lab, xyz_to_rgb},
        srgb::{Srgb as _, byte},
        vec3,
    },
};
use rayon::prelude::*;
use std::f32::consts::PI;

/// Exponent of colour differences (sec. 4.1.3).
const COLOUR_EXPONENT: f32 = 0.7;
/// Colour differences up to this part of the largest one are mapped to [0, `LOW_RANGE`] (sec. 4.1.4).
const LOW_PART: f32 = 0.4;
/// See [`LOW_PART`].
const LOW_RANGE: f32 = 0.95;
/// Width of the edges and points that the eye detects (degrees) (sec. 4.2).
const FEATURE_WIDTH: f32 = 0.082;
/// Exponent of feature differences (sec. 4.2).
const FEATURE_EXPONENT: f32 = 0.5;
/// The widest Gaussian of the contrast sensitivity functions, as b of [`Gaussian`] (degrees^2).
const WIDEST: f32 = 0.04;

/// A Gaussian of a contrast sensitivity function (sec. 4.1.1, table 1): a sqrt(pi / b) exp(-pi^2 x^2 / b).
struct Gaussian {
    a: f32,
    b: f32,
}

/// Those of luminance, red-green and blue-yellow, the channels of YCxCz.
const SENSITIVITY: [&[Gaussian]; 3] = [
    &[Gaussian { a: 1.0, b: 0.0047 }],
    &[Gaussian { a: 1.0, b: 0.0053 }],
    &[Gaussian { a: 34.1, b: 0.04 }, Gaussian { a: 13.5, b: 0.025 }],
];

/// FLIP of every pixel of `[image, reference]`, both sRGB-encoded from 0 to 1 and compared as 8-bit images.
pub(super) fn map(pixels: [&[Spectrum]; 2], width: usize, pixels_per_degree: f32) -> Vec<f32> {
    let [image, reference] = pixels.map(|pixels| Seen::new(pixels, width, pixels_per_degree));
    let largest = hyab(hunt(vec3(0.0, 1.0, 0.0)), hunt(vec3(0.0, 0.0, 1.0))).powf(COLOUR_EXPONENT);
    let pairs = image.pixels.iter().zip(&reference.pixels);
    let flip = pairs.map(|(image, reference)| {
        let colour = hyab(image.colour, reference.colour).powf(COLOUR_EXPONENT);
        let feature = (image.edge - reference.edge).abs().max((image.point - reference.point).abs());
        let feature = (feature / f32::sqrt(2.0)).powf(FEATURE_EXPONENT);
        redistributed(colour, largest).powf(1.0 - feature)
    });
    flip.collect()
}

/// What an eye sees of an image at a pixel.
struct Seen {
    pixels: Vec<SeenPixel>,
}

struct SeenPixel {
    /// Hunt-adjusted CIELAB of the colour after blurring by the eye.
    colour: Vec3,
    /// Strength of the edge here.
    edge: f32,
    /// Strength of the point here.
    point: f32,
}

impl Seen {
    fn new(encoded: &[Spectrum], width: usize, pixels_per_degree: f32) -> Self {
        let opponent: Vec<Vec3> = encoded.iter().map(|pixel| opponent(*pixel)).collect();
        let luminance: Vec<f32> = opponent.iter().map(|pixel| (pixel.x + 16.0) / 116.0).collect();
        let features = Features::new(&luminance, width, pixels_per_degree);
        let blurred = [0, 1, 2].map(|channel| {
            let plane: Vec<f32> = opponent.iter().map(|pixel| pixel[channel]).collect();
            blur(&plane, width, SENSITIVITY[channel], pixels_per_degree)
        });
        let pixel = |at: usize| SeenPixel {
            colour: hunt(linear(vec3(blurred[0][at], blurred[1][at], blurred[2][at]))),
            edge: features.edge[at],
            point: features.point[at],
        };
        Self { pixels: (0..encoded.len()).map(pixel).collect() }
    }
}

/// Filters a plane by the sum of `gaussians`, normalized (sec. 4.1.1).
fn blur(plane: &[f32], width: usize, gaussians: &[Gaussian], pixels_per_degree: f32) -> Vec<f32> {
    let radius = (3.0 * (WIDEST / (2.0 * PI * PI)).sqrt() * pixels_per_degree).ceil() as i32;
    let kernels = gaussians.iter().map(|Gaussian { a, b }| {
        let kernel = kernel(radius, |x| (-(PI * x / pixels_per_degree).powi(2) / b).exp());
        let sum: f32 = kernel.iter().sum();
        (a * (PI / b).sqrt() * sum * sum, balanced(&kernel))
    });
    let kernels: Vec<(f32, Vec<f32>)> = kernels.collect();
    let total: f32 = kernels.iter().map(|(weight, _)| weight).sum();
    let mut blurred = vec![0.0; plane.len()];
    for (weight, kernel) in kernels {
        let part = convolve(plane, width, &kernel, &kernel);
        blurred.iter_mut().zip(part).for_each(|(sum, value)| *sum += weight / total * value);
    }
    blurred
}

/// Strengths of edges and points (sec. 4.2).
struct Features {
    edge: Vec<f32>,
    point: Vec<f32>,
}

impl Features {
    fn new(luminance: &[f32], width: usize, pixels_per_degree: f32) -> Self {
        let sigma = 0.5 * FEATURE_WIDTH * pixels_per_degree;
        let radius = (3.0 * sigma).ceil() as i32;
        let gaussian = |x: f32| (-0.5 * (x / sigma).powi(2)).exp();
        let across = balanced(&kernel(radius, gaussian));
        let strength = |along: Vec<f32>| -> Vec<f32> {
            let horizontal = convolve(luminance, width, &along, &across);
            let vertical = convolve(luminance, width, &across, &along);
            horizontal.iter().zip(vertical).map(|(x, y)| x.hypot(y)).collect()
        };
        Self {
            edge: strength(balanced(&kernel(radius, |x| -x * gaussian(x)))),
            point: strength(balanced(&kernel(radius, |x| ((x / sigma).powi(2) - 1.0) * gaussian(x)))),
        }
    }
}

/// `of` the distances from the centre (pixels).
fn kernel(radius: i32, of: impl Fn(f32) -> f32) -> Vec<f32> {
    (-radius..=radius).map(|x| of(x as f32)).collect()
}

/// Scaled so that the positive values add up to 1, and the negative ones to -1.
fn balanced(kernel: &[f32]) -> Vec<f32> {
    let sum = |sign: f32| kernel.iter().map(|value| (sign * value).max(0.0)).sum::<f32>();
    let (positive, negative) = (sum(1.0), sum(-1.0));
    kernel.iter().map(|value| value / if *value < 0.0 { negative } else { positive }).collect()
}

/// Convolves rows with one kernel and columns with another.
fn convolve(plane: &[f32], width: usize, rows: &[f32], columns: &[f32]) -> Vec<f32> {
    let height = plane.len() / width;
    let transposed = transpose(&convolve_rows(plane, width, rows), width);
    transpose(&convolve_rows(&transposed, height, columns), height)
}

/// Beyond the ends of a row its end pixels are repeated.
fn convolve_rows(plane: &[f32], width: usize, kernel: &[f32]) -> Vec<f32> {
    let radius = kernel.len() / 2;
    let mut sums = vec![0.0; plane.len()];
    sums.par_chunks_mut(width).zip(plane.par_chunks(width)).for_each(|(sums, row)| {
        let padded = (0..width + 2 * radius).map(|x| row[x.saturating_sub(radius).min(width - 1)]);
        let padded: Vec<f32> = padded.collect();
        for (sum, window) in sums.iter_mut().zip(padded.windows(kernel.len())) {
            *sum = window.iter().zip(kernel).map(|(value, weight)| value * weight).sum();
        }
    });
    sums
}

fn transpose(plane: &[f32], width: usize) -> Vec<f32> {
    (0..width).flat_map(|column| plane.iter().skip(column).step_by(width)).copied().collect()
}

/// Linear sRGB of white.
fn white() -> Vec3 {
    Vec3::from_array(XYZ_ROWS.map(|row| row.element_sum()))
}

/// YCxCz of an encoded pixel, rounded to 8 bits (sec. 4.1.1).
fn opponent(encoded: Spectrum) -> Vec3 {
    let rounded = encoded.to_array().map(|c| (f32::from(byte(c)) / 255.0).srgb_decoded());
    let Vec3 { x, y, z } = to_xyz(Spectrum::from_array(rounded)) / white();
    vec3(116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z))
}

/// Linear sRGB of YCxCz, within the cube of colours (sec. 4.1.2).
fn linear(opponent: Vec3) -> Vec3 {
    let y = (opponent.x + 16.0) / 116.0;
    let xyz = vec3(y + opponent.y / 500.0, y, y - opponent.z / 200.0) * white();
    xyz_to_rgb(xyz.as_dvec3()).as_vec3().clamp(Vec3::ZERO, Vec3::ONE)
}

/// CIELAB of linear sRGB, chroma scaled by lightness for the Hunt effect (sec. 4.1.3).
fn hunt(linear: Vec3) -> Vec3 {
    let Vec3 { x: lightness, y: a, z: b } = lab(to_xyz(linear) / white());
    vec3(lightness, 0.01 * lightness * a, 0.01 * lightness * b)
}

/// Distance of colours (sec. 4.1.3).
fn hyab(a: Vec3, b: Vec3) -> f32 {
    let difference = a - b;
    difference.x.abs() + difference.y.hypot(difference.z)
}

/// Mapped to [0, 1], most of it to small differences (sec. 4.1.4).
fn redistributed(colour: f32, largest: f32) -> f32 {
    let knee = LOW_PART * largest;
    if colour < knee {
        return colour * LOW_RANGE / knee;
    }
    LOW_RANGE + (colour - knee) / (largest - knee) * (1.0 - LOW_RANGE)
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDTH: usize = 32;
    const HEIGHT: usize = 24;

    fn image(of: impl Fn(usize, usize) -> [usize; 3]) -> Vec<Spectrum> {
        let pixel = |at| Spectrum::from_array(of(at % WIDTH, at / WIDTH).map(|c| (c % 256) as f32 / 255.0));
        (0..WIDTH * HEIGHT).map(pixel).collect()
    }

    /// Figures of the authors' program (flip-evaluator 1.7) for images that wrap around from white to black, have edges
    /// and points, and differ in all three channels. Its matrices have other digits than ours.
    #[test]
    fn maps_are_those_of_the_reference_implementation() {
        let reference = image(|x, y| [8 * x, 10 * y, x * y]);
        let on = |is: bool, much: usize| if is { much } else { 0 };
        let test =
            image(|x, y| [8 * x + on(x % 5 == 0, 12), 10 * y + on((x + y) % 7 == 0, 30), x * y + 3 * y]);
        const AT: [usize; 6] = [0, 17, 200, 333, 500, 767];
        let expected = [
            (67.0, 0.267_484, [0.190_451, 0.052_680, 0.244_141, 0.277_990, 0.273_218, 0.082_036]),
            (30.0, 0.355_860, [0.275_298, 0.026_491, 0.339_279, 0.302_407, 0.351_996, 0.348_634]),
        ];
        for (pixels_per_degree, mean, values) in expected {
            let flip = map([&test, &reference], WIDTH, pixels_per_degree);
            let found = flip.iter().sum::<f32>() / flip.len() as f32;
            assert!((found - mean).abs() < 1e-3, "{found}, not {mean}");
            for (at, value) in AT.into_iter().zip(values) {
                assert!((flip[at] - value).abs() < 1e-3, "{}, not {value} at {at}", flip[at]);
            }
        }
    }
}
