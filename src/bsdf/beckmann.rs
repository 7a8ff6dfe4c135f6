//! The slopes of a Beckmann surface that a direction sees (Heitz & d'Eon 2014; Jakob 2014).
//!
//! Of roughness 1, slopes along and across the direction are normal, with variance 1/2 each; a slope s towards it is seen in
//! proportion to its cosine times what the facet covers: (z + width s) exp(-s^2), where that is positive.

use crate::math::erf::{LAST, erf_inv};
use crate::math::{Vec2, vec2};
use std::f32::consts::PI;

/// Beyond this cotangent all facets are seen, as far as f32 can tell.
const ALL_SEEN: f32 = 4.0;

/// Newton's steps end when the probability of a lesser slope is met so closely.
const CLOSE: f32 = 1e-6;

/// More steps than have been seen to be needed: 4.
const MOST_STEPS: usize = 8;

/// A direction, stretched so that the roughness is 1: its z > 0 and its `width` >= 0 across that.
#[derive(Clone, Copy, Debug)]
pub(super) struct View {
    pub z: f32,
    pub width: f32,
}

impl View {
    /// The projected area of all facets that are seen, per area of the surface.
    #[inline]
    pub(super) fn area(self) -> f32 {
        let cotangent = self.z / self.width;
        if cotangent > ALL_SEEN {
            return self.z;
        }
        self.share(1.0 + libm::erff(cotangent), (-cotangent * cotangent).exp())
    }

    /// Area of facets by differences of the error function and of exp(-s^2).
    #[inline]
    fn share(self, of_erf: f32, of_exp: f32) -> f32 {
        0.5 * (self.z * of_erf + self.width / PI.sqrt() * of_exp)
    }

    /// A slope that is seen, towards the direction and across.
    #[inline]
    pub(super) fn sample(self, u: Vec2) -> Vec2 {
        vec2(self.towards(u.x), erf_inv(2.0 * u.y - 1.0))
    }

    /// The slope below which the part `u` of the area lies, by Newton's method for its error function b: there the area
    /// is convex, so that every step but the first comes from above.
    fn towards(self, u: f32) -> f32 {
        let cotangent = self.z / self.width;
        let (erf, exp) = (libm::erff(cotangent), (-cotangent * cotangent).exp());
        let area = self.share(1.0 + erf, exp);
        let even = self.z / (self.z + 0.55 * self.width);
        let start = even * u + (1.0 - even) * u.sqrt();
        let mut b = start * (1.0 + erf) - erf;
        let mut slope = erf_inv(b);
        for _ in 0..MOST_STEPS {
            let excess = self.share(b + erf, exp - (-slope * slope).exp()) - u * area;
            if excess.abs() < CLOSE * area {
                break;
            }
            b = (b - 2.0 * excess / (self.z + self.width * slope)).clamp(-erf, LAST);
            slope = erf_inv(b);
        }
        slope.max(-cotangent)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The part of the area below `slope` by quadrature.
    fn part(view: View, slope: f64) -> f64 {
        let (z, width) = (f64::from(view.z), f64::from(view.width));
        let least = (-z / width).max(-6.0);
        let below = |end: f64| {
            let n = 4_000;
            let at = |i: i32| least + (end - least) * (f64::from(i) + 0.5) / f64::from(n);
            let height = |s: f64| (z + width * s) * (-s * s).exp();
            (0..n).map(at).map(height).sum::<f64>() * (end - least) / f64::from(n)
        };
        below(slope) / below(6.0)
    }

    /// From grazing to straight on, and in both tails.
    #[test]
    fn slopes_part_the_area_as_asked() {
        for z in [1e-30, 1e-4, 0.05, 0.3, 0.6, 0.9, 0.99, 0.9999, 1.0f32] {
            let view = View { z, width: (1.0 - z * z).sqrt() };
            for u in [0.0, 1e-7, 1e-4, 0.01, 0.1, 0.3, 0.5, 0.8, 0.99, 0.9999, LAST] {
                let slope = view.sample(vec2(u, 0.5)).x;
                let found = part(view, f64::from(slope));
                assert!((found - f64::from(u)).abs() < 5e-6, "{view:?} {u}: slope {slope}, {found}");
            }
        }
    }
}
