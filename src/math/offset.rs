//! Every epsilon of the renderer, each with its reason.

use super::Vec3;

/// Unit roundoff of f32: half a unit in the last place, relative.
pub const ROUNDOFF: f32 = f32::EPSILON * 0.5;

/// Bound on the relative error of `n` rounded f32 operations in a row (Higham 2002, lemma 3.1).
pub const fn gamma(n: u32) -> f32 {
    let e = n as f32 * ROUNDOFF;
    e / (1.0 - e)
}

/// Geometry must stay within this (m) of the recentring point: squares of lengths and areas then fit into f32
/// with room for the sums and products that hierarchies and samplers make of them.
pub const LARGEST_COORDINATE: f32 = 1e15;

/// A mean free path is resolved if it is as many rounding errors of positions: rays start up to four of them behind the
/// boundary that they leave, and what would collide before that collides there, where less of it comes out again. A half
/// space of albedo 0.9 is too dark by 0.4 % at this, by 6.5 % at a tenth of it.
pub const RESOLVED_STEPS: f32 = 100.0;

/// The angle (rad) at which a ray passes an emitter, as seen from its start, that positions tell from none: distances are
/// sampled as if no ray passed at less. At this, densities are off by the rounding of positions by a ten-thousandth, and it
/// is no more than a pixel is wide.
pub const RESOLVED_ANGLE: f32 = 1e-3;

/// Least mean free path (m) that densities hold: those of vertices in a medium are up to its inverse cubed (1/m^3), and
/// their products with others must stay below the largest number of f32.
pub const LEAST_MEAN_FREE_PATH: f32 = 5e-11;

/// Least mean free path (m) that has a use: what a medium gains over a shorter one, and transmittances over parts of it, leave
/// the normal numbers of f32.
pub const SHORTEST_MEAN_FREE_PATH: f32 = 1e-30;

/// Least sigma_t over the squared size of a scene (1/m^3): a density of that size times a transmittance of 1e-5 is the
/// smallest normal number of f32.
pub const LEAST_VOLUME_DENSITY: f64 = 1e-33;

/// How far past an edge a flat primitive still counts as hit, in its own barycentric units, per unit of
/// (1 + distance / size): neighbours overlap by their rounding errors, so no ray slips through the seam.
pub const SEAM: f32 = 4.0 * f32::EPSILON;

/// Box tests widen the far distance by this: the bound on the relative error of (plane - origin) / direction.
pub const BOX_WIDENING: f32 = 1.0 + 2.0 * gamma(3);

/// Direction components below this are taken as this in box tests: their true reciprocal could overflow, and
/// over any distance in a scene they move the ray by less than a rounding error.
pub const LEAST_COMPONENT: f32 = 1e-18;

/// Solid angles (sr) below this are sampled by area: the spherical map would lose its digits (f64: 1e-16
/// over this), and over so small an angle both densities are nearly the same.
pub const LEAST_SOLID_ANGLE: f64 = 1e-6;

/// A reference nearer to a rectangle's plane than this, relative to its size, counts as lying in it.
pub const IN_PLANE: f64 = 1e-6;

/// A reference nearer to a sphere's surface than this, relative to its squared radius, counts as inside: the
/// cone it sees the sphere in is a half space, and the distance to the nearest points mere rounding.
pub const ON_SPHERE: f32 = 1e-4;

/// Moves a computed surface point off its surface, to the side that `direction` leaves to, by the bound on
/// its rounding error (`error`, per axis) along the geometric normal: a ray from there cannot hit the surface
/// it starts on, at any scale and any distance from the origin.
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

/// `normal` turned to the side that `direction` leaves to.
#[inline]
pub fn side_of(normal: Vec3, direction: Vec3) -> Vec3 {
    normal * 1f32.copysign(direction.dot(normal))
}

/// How the end of a segment is moved off the surface that it lies on.
#[derive(Clone, Copy, Debug)]
pub struct Lift {
    normal: Vec3,
    /// How much the rounding of each coordinate counts.
    weight: Vec3,
}

impl Lift {
    /// In the open.
    pub const NONE: Self = Self { normal: Vec3::ZERO, weight: Vec3::ZERO };

    /// Off a surface with this unit `normal` on the segment's side. Of a `round` one all coordinates count in every
    /// direction, as its equation mixes them; else those along the normal.
    #[inline]
    pub fn off(normal: Vec3, round: bool) -> Self {
        Self { normal, weight: if round { Vec3::ONE } else { normal.abs() } }
    }

    /// Moves `end` of a segment from `origin`. What the ray tracer computes of the segment (its direction, the distance to
    /// the surface) is rounded in proportion to the coordinates of both ends, whereas [`leave_surface`] knows one end
    /// alone: without this the surface would shadow its own points.
    #[inline]
    pub fn clear(self, origin: Vec3, end: Vec3) -> Vec3 {
        end + self.normal * (gamma(32) * self.weight.dot(origin.abs() + end.abs()))
    }
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
