//! Every epsilon of the renderer, each with its reason.

use super::Vec3;

/// Unit roundoff of f32: half a unit in the last place, relative.
pub const ROUNDOFF: f32 = f32::EPSILON * 0.5;

/// Bound on the relative error of `n` rounded f32 operations in a row (Higham 2002, lemma 3.1).
pub const fn gamma(n: u32) -> f32 {
    let e = n as f32 * ROUNDOFF;
    e / (1.0 - e)
}

/// Moves a computed surface point off its surface, to the side that `direction` leaves to, by the bound on
/// its rounding error (`error`, per axis) along the geometric normal: a ray from there cannot meet the
/// surface it starts on, at any scale and any distance from the origin.
#[inline]
pub fn leave_surface(position: Vec3, error: Vec3, normal: Vec3, direction: Vec3) -> Vec3 {
    let distance = normal.abs().dot(error);
    let offset = normal * distance.copysign(direction.dot(normal));
    let moved = position + offset;
    // The sum itself may round back towards the surface: go one step outwards on every axis that moved.
    Vec3::new(
        step_outwards(moved.x, offset.x),
        step_outwards(moved.y, offset.y),
        step_outwards(moved.z, offset.z),
    )
}

#[inline]
fn step_outwards(x: f32, offset: f32) -> f32 {
    if offset > 0.0 {
        x.next_up()
    } else if offset < 0.0 {
        x.next_down()
    } else {
        x
    }
}
