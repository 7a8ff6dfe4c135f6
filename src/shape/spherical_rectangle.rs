//! Rectangles seen from a point, sampled uniformly in solid angle (Urena, Fajardo & King 2013, "An
//! area-preserving parametrization for spherical rectangles"; its letters are kept). In f64: in f32 the solid
//! angle of a small rectangle, a sum of four angles less 2 pi, would be rounding error.

use crate::math::{
    DVec3, Vec2, Vec3,
    offset::{IN_PLANE, LEAST_SOLID_ANGLE},
    vec2,
};
use std::f64::consts::TAU;

/// A rectangle in its own frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct SphericalRectangle {
    corner: DVec3,
    x: DVec3,
    y: DVec3,
    z: DVec3,
    width: f64,
    height: f64,
}

/// A rectangle as one reference point sees it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    x0: f64,
    x1: f64,
    y0: f64,
    y1: f64,
    z0: f64,
    b0: f64,
    b1: f64,
    /// cos and sin of k = 2 pi - gamma_2 - gamma_3.
    k: [f64; 2],
    solid_angle: f64,
}

/// Product of two complex numbers: angles add up without their arc cosines.
fn multiply(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
}

/// cos and sin of an angle in [0, pi] given its cosine.
fn from_cosine(c: f64) -> [f64; 2] {
    [c, (1.0 - c * c).max(0.0).sqrt()]
}

impl SphericalRectangle {
    /// None where the edges are not at right angles.
    pub(super) fn new(corner: Vec3, edge_u: Vec3, edge_v: Vec3) -> Option<Self> {
        let (edge_u, edge_v) = (edge_u.as_dvec3(), edge_v.as_dvec3());
        let (width, height) = (edge_u.length(), edge_v.length());
        let (x, y) = (edge_u / width, edge_v / height);
        // The edges are f32: what they enclose is a right angle up to their rounding.
        if x.dot(y).abs() > 1e-6 {
            return None;
        }
        Some(Self { corner: corner.as_dvec3(), x, y, z: x.cross(y), width, height })
    }

    /// None where the reference lies (nearly) in the plane or the solid angle is tiny.
    #[inline]
    pub(super) fn seen_from(&self, reference: Vec3) -> Option<Seen> {
        let d = self.corner - reference.as_dvec3();
        let z = d.dot(self.z);
        if z.abs() < IN_PLANE * self.width.max(self.height) {
            return None;
        }
        let (x0, y0, z0) = (d.dot(self.x), d.dot(self.y), -z.abs());
        let seen = Seen::new(x0, x0 + self.width, y0, y0 + self.height, z0);
        (seen.solid_angle > LEAST_SOLID_ANGLE).then_some(seen)
    }
}

impl Seen {
    fn new(x0: f64, x1: f64, y0: f64, y1: f64, z0: f64) -> Self {
        // z components of the four edge planes' unit normals.
        let component = |e: f64| e / (z0 * z0 + e * e).sqrt();
        let (n0, n1, n2, n3) = (-component(y0), component(x1), component(y1), -component(x0));
        let g = [from_cosine(-n0 * n1), from_cosine(-n1 * n2), from_cosine(-n2 * n3), from_cosine(-n3 * n0)];
        let g23 = multiply(g[2], g[3]);
        let sum = multiply(multiply(g[0], g[1]), g23);
        // The four angles sum to S + 2 pi.
        let angle = sum[1].atan2(sum[0]);
        let solid_angle = if angle < 0.0 { angle + TAU } else { angle };
        Self { x0, x1, y0, y1, z0, b0: n0, b1: n2, k: [g23[0], -g23[1]], solid_angle }
    }

    /// Density of the directions to the samples (1/sr).
    pub(super) fn pdf_sr(&self) -> f32 {
        (1.0 / self.solid_angle) as f32
    }

    /// From the unit square to (u, v) on the rectangle.
    #[inline]
    pub(super) fn sample(&self, u: Vec2) -> Vec2 {
        let (x, y) = self.sample_plane(f64::from(u.x), f64::from(u.y));
        let fraction = |t: f64, low: f64, high: f64| (((t - low) / (high - low)) as f32).clamp(0.0, 1.0);
        vec2(fraction(x, self.x0, self.x1), fraction(y, self.y0, self.y1))
    }

    /// The paper's x_u and y_v, with f_u = n / d and c_u resolved so that two roots and two quotients remain.
    fn sample_plane(&self, u: f64, v: f64) -> (f64, f64) {
        let (s, c) = (u * self.solid_angle).sin_cos();
        let [cos_au, d] = multiply([c, s], self.k);
        let n = cos_au * self.b0 - self.b1;
        let z_squared = self.z0 * self.z0;
        // (1 - b0^2) without the subtraction.
        let rest = z_squared / (z_squared + self.y0 * self.y0);
        let root = (n * n - rest * d * d).max(0.0).sqrt();
        let xu = (-self.z0 * d * n.signum() / root).clamp(self.x0, self.x1);
        let squared = xu * xu + z_squared;
        let height = |y: f64| y / (squared + y * y).sqrt();
        let (h0, h1) = (height(self.y0), height(self.y1));
        let hv = h0 + v * (h1 - h0);
        let yv = hv * (squared / (1.0 - hv * hv).max(0.0)).sqrt();
        (xu, yv.clamp(self.y0, self.y1))
    }
}
