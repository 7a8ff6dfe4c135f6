//! Conductance maps (P03T sec. 6.3): the similarity of neighbouring pixels, from 0 to 1. It is stored as resistance,
//! -ln of it: resistances in a row add.

use super::sight::{FirstSurface, Sight};
use crate::math::Vec3;

/// Differences that make a conductance of 1/e.
mod unit {
    /// Of normals: their distance, 17 degrees.
    pub(super) const NORMAL: f32 = 0.3;
    /// Of a point from the tangent plane of another, over their distance from the camera.
    pub(super) const DEPTH: f32 = 0.02;
    /// Of albedos.
    pub(super) const ALBEDO: f32 = 0.1;
    /// Of the opacity of media. Media fade slowly and need few pixels: a tenth of this unit gave four times the error
    /// among cubes in fog.
    pub(super) const OPACITY: f32 = 0.5;
    /// Of the nearness of media, relative.
    pub(super) const NEARNESS: f32 = 0.5;
}

/// The resistance between things that have nothing in common.
const APART: f32 = 100.0;

/// What pixels show, and the resistances between neighbours.
pub(super) struct Maps {
    width: usize,
    sights: Vec<Sight>,
    /// Between a pixel and that on its right; 0 at the border.
    across: Vec<f32>,
    /// Between a pixel and that below.
    down: Vec<f32>,
}

impl Maps {
    /// Those of an image of `width` pixels across.
    pub(super) fn new(width: usize, sights: Vec<Sight>) -> Self {
        let between = |step: usize, has: &dyn Fn(usize) -> bool| -> Vec<f32> {
            let next = |pixel: usize| {
                if has(pixel) { resistance(&sights[pixel], &sights[pixel + step]) } else { 0.0 }
            };
            (0..sights.len()).map(next).collect()
        };
        let across = between(1, &|pixel| (pixel + 1) % width != 0);
        let down = between(width, &|pixel| pixel + width < sights.len());
        Self { width, sights, across, down }
    }

    /// Pixels across.
    pub(super) fn width(&self) -> usize {
        self.width
    }

    /// Pixels.
    pub(super) fn len(&self) -> usize {
        self.sights.len()
    }

    /// The conductance between any two pixels, whatever lies between them.
    pub(super) fn likeness(&self, a: usize, b: usize) -> f32 {
        (-resistance(&self.sights[a], &self.sights[b])).exp()
    }

    /// The resistance between neighbours, the second on the right of the first or below it.
    pub(super) fn step(&self, from: usize, to: usize) -> f32 {
        let (first, second) = (from.min(to), from.max(to));
        if second - first == 1 && second % self.width != 0 { self.across[first] } else { self.down[first] }
    }

    /// Shows `visit` the pixels on the line between the middles of two pixels, without the first, each with the
    /// resistance of the step to it. Where the line passes a corner, this is the greater resistance of the two ways
    /// around (P03T fig. 6.5).
    pub(super) fn walk(&self, from: usize, to: usize, mut visit: impl FnMut(usize, f32)) {
        let place = |pixel: usize| [pixel % self.width, pixel / self.width].map(|x| x as i64);
        let ([x, y], [to_x, to_y]) = (place(from), place(to));
        let [wide, high] = [(to_x - x).abs(), (to_y - y).abs()];
        let [right, below] = [(to_x - x).signum(), (to_y - y).signum() * self.width as i64];
        let (mut pixel, mut i, mut j) = (from as i64, 0, 0);
        let step = |from: i64, to: i64| self.step(from as usize, to as usize);
        while (i, j) != (wide, high) {
            // Which side of the pixel the line leaves through.
            let side = (1 + 2 * i) * high - (1 + 2 * j) * wide;
            let next = pixel + if side <= 0 { right } else { 0 } + if side >= 0 { below } else { 0 };
            let resistance = match side {
                0 => {
                    let around = |corner| step(pixel, corner) + step(corner, next);
                    around(pixel + right).max(around(pixel + below))
                }
                _ => step(pixel, next),
            };
            (i, j) = (i + i64::from(side <= 0), j + i64::from(side >= 0));
            pixel = next;
            visit(pixel as usize, resistance);
        }
    }

    /// The conductance along the line between two pixels: the product of those of its steps.
    pub(super) fn along(&self, from: usize, to: usize) -> f32 {
        let mut sum = 0.0;
        self.walk(from, to, |_, resistance| sum += resistance);
        (-sum).exp()
    }
}

/// -ln of the product of the maps' conductances exp(-(difference / unit)^2). Surfaces behind a medium count by its
/// transparency.
fn resistance(a: &Sight, b: &Sight) -> f32 {
    let square = |difference: f32, unit: f32| (difference / unit).powi(2);
    let seen = 1.0 - a.opacity.min(b.opacity);
    let media = square(a.opacity - b.opacity, unit::OPACITY) + square(recession(a, b), unit::NEARNESS);
    let surfaces = match (a.first, b.first) {
        _ if a.emitter != b.emitter => APART,
        (None, None) => 0.0,
        (Some(first), Some(second)) => {
            square(bend([first.normal, a.last_normal], [second.normal, b.last_normal]), unit::NORMAL)
                + square(off_plane(&first, &second), unit::DEPTH)
                + square((a.albedo - b.albedo).length(), unit::ALBEDO)
        }
        _ => APART,
    };
    (media + seen * seen * surfaces.min(APART)).min(APART)
}

/// The greatest difference of normals.
fn bend(a: [Vec3; 2], b: [Vec3; 2]) -> f32 {
    (a[0] - b[0]).length().max((a[1] - b[1]).length())
}

/// How far one surface is from the tangent plane of the other, over the distance from the camera: on a plane nothing,
/// however steeply it is seen.
fn off_plane(a: &FirstSurface, b: &FirstSurface) -> f32 {
    let way = b.position - a.position;
    let off = way.dot(a.normal).abs().max(way.dot(b.normal).abs());
    off / a.distance.min(b.distance).max(f32::MIN_POSITIVE)
}

/// Difference of the first mean free paths, over the longer nearness, weighted by how much media hide.
fn recession(a: &Sight, b: &Sight) -> f32 {
    let nearest = a.nearness.max(b.nearness);
    if nearest > 0.0 { (a.opacity * a.nearness - b.opacity * b.nearness).abs() / nearest } else { 0.0 }
}
