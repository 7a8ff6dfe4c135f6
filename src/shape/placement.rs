//! Where a shape is: its transform, recentred, in f64.

use crate::{
    description::Params,
    error::Result,
    math::{DMat4, DVec3, Vec3, offset::LARGEST_COORDINATE},
};

/// `to_world`, then what takes the file's world to the scene's, in f64.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placement {
    /// Object to recentred world space.
    pub matrix: DMat4,
    /// True if `flip_normals` is set.
    pub flip_normals: bool,
    /// -1 where the instance that it is a copy for mirrors it: edges then turn the other way about, and normals do not. Else 1.
    pub handedness: f64,
}

impl Placement {
    /// Reads `to_world`, after which `world` counts, and `flip_normals`.
    pub(super) fn read(params: &Params<'_>, world: DMat4) -> Result<Self> {
        let matrix = world * params.transform("to_world")?;
        let handedness = world.determinant().signum();
        Ok(Self { matrix, flip_normals: params.boolean("flip_normals")?, handedness })
    }

    /// The shape's own transform turns right hands into left hands.
    pub(super) fn is_mirrored(&self) -> bool {
        self.matrix.determinant() * self.handedness < 0.0
    }

    /// Points, as such.
    pub(super) fn point(&self, p: DVec3) -> DVec3 {
        self.matrix.project_point3(p)
    }

    /// Differences of points.
    pub(super) fn vector(&self, v: DVec3) -> DVec3 {
        self.matrix.transform_vector3(v)
    }

    /// Normals: what stays perpendicular to transformed vectors.
    pub(super) fn normal(&self, n: DVec3) -> DVec3 {
        self.matrix.inverse().transpose().transform_vector3(n).normalize_or_zero()
    }
}

/// Finite, and not so far away that squares of distances overflow.
pub(super) fn is_in_range(p: Vec3) -> bool {
    p.abs().max_element() < LARGEST_COORDINATE && p.is_finite()
}

/// How a corner moves so that the planes through it, each a unit normal and a distance (m), move by these: exactly where at
/// most three are independent, else as far as the planes allow.
pub(super) fn shift(planes: &[(DVec3, f64)]) -> DVec3 {
    const SWEEPS: usize = 64;
    let mut moved = DVec3::ZERO;
    for _ in 0..SWEEPS {
        for (normal, distance) in planes {
            moved += normal * (distance - normal.dot(moved));
        }
    }
    moved
}
