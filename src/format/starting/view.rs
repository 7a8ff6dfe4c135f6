//! From where smoke is seen: all of it, and not much else.

use crate::math::DVec3;

/// The camera is so far to the right of the front, and above (degrees).
const YAW: f64 = 25.0;
const PITCH: f64 = 7.0;

/// Half of what the longer side of the image spans (degrees), and the part of it that smoke may fill.
const HALF_FOV: f64 = 18.0;
const FILLED: f64 = 0.8;

/// Pixels of the image, about, and what its sides are multiples of.
const PIXELS: f64 = 160_000.0;
const STEP: f64 = 8.0;

/// The least and the greatest ratio of its width to its height.
const ASPECTS: [f64; 2] = [2.0 / 3.0, 16.0 / 9.0];

/// A camera. +y is up.
pub(super) struct View {
    /// Where it stands.
    pub origin: DVec3,
    /// What it looks at.
    pub target: DVec3,
    /// Pixels across and down.
    pub size: [u32; 2],
    /// From the middle of the image to its right edge, and to the upper one, at a distance of 1.
    half: [DVec3; 2],
    forward: DVec3,
}

impl View {
    /// The longer side of the image spans this (degrees).
    pub(super) const FOV: f64 = 2.0 * HALF_FOV;

    /// A view of the box from `low` to `high`.
    pub(super) fn of([low, high]: [DVec3; 2]) -> Self {
        let (target, extent) = (0.5 * (low + high), 0.5 * (high - low));
        let (yaw, pitch) = (YAW.to_radians(), PITCH.to_radians());
        let forward = -DVec3::new(yaw.sin() * pitch.cos(), pitch.sin(), yaw.cos() * pitch.cos());
        let right = forward.cross(DVec3::Y).normalize();
        let up = right.cross(forward);
        let reach = |axis: DVec3| axis.abs().dot(extent);
        let aspect = (reach(right) / reach(up)).clamp(ASPECTS[0], ASPECTS[1]);
        let tangent = HALF_FOV.to_radians().tan();
        let half = [right * tangent * aspect.min(1.0), up * tangent / aspect.max(1.0)];
        // How far away it must be for a corner to be seen.
        let far = |corner: DVec3| {
            let sides = half.map(|side| side.dot(corner).abs() / side.length_squared());
            sides[0].max(sides[1]) / FILLED - forward.dot(corner)
        };
        let distance = corners(extent).map(far).fold(0.0, f64::max);
        let side = |pixels: f64| ((pixels / STEP).round() * STEP) as u32;
        let height = (PIXELS / aspect).sqrt();
        let size = [side(aspect * height), side(height)];
        Self { origin: target - distance * forward, target, size, half, forward }
    }

    /// Unit directions through `count` x `count` points of the image.
    pub(super) fn directions(&self, count: u32) -> impl Iterator<Item = DVec3> {
        let place = move |i: u32| (f64::from(2 * i) + 1.0) / f64::from(count) - 1.0;
        let through =
            move |i, j| (self.forward + place(i) * self.half[0] + place(j) * self.half[1]).normalize();
        (0..count).flat_map(move |j| (0..count).map(move |i| through(i, j)))
    }
}

/// Those of a box around the origin, of which one is `extent`.
fn corners(extent: DVec3) -> impl Iterator<Item = DVec3> {
    let sign = |n: u32, axis: u32| if n >> axis & 1 == 0 { -1.0 } else { 1.0 };
    (0..8).map(move |n| extent * DVec3::new(sign(n, 0), sign(n, 1), sign(n, 2)))
}
