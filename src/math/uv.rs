//! Texture coordinates, of which most surfaces make no use.

use glam::{Vec2, Vec3, vec2};
use std::f32::consts::FRAC_1_PI;

/// Where on a shape a texture is looked up. What takes long to compute is computed where a texture varies.
#[derive(Clone, Copy, Debug)]
pub enum Uv {
    /// u and v.
    At(Vec2),
    /// The unit direction from a sphere's centre, whose parallels u runs along, and v from pole to pole.
    OnSphere(Vec3),
}

impl Uv {
    /// u and v.
    #[inline]
    pub fn get(self) -> Vec2 {
        match self {
            Self::At(uv) => uv,
            Self::OnSphere(out) => on_sphere(out),
        }
    }
}

impl From<Vec2> for Uv {
    #[inline]
    fn from(uv: Vec2) -> Self {
        Self::At(uv)
    }
}

#[inline(never)]
fn on_sphere(out: Vec3) -> Vec2 {
    let turn = out.y.atan2(out.x) * (0.5 * FRAC_1_PI);
    vec2(if turn < 0.0 { turn + 1.0 } else { turn }, out.z.clamp(-1.0, 1.0).acos() * FRAC_1_PI)
}
