//! `cube`: [-1, 1]^3, facing outwards.

use super::{Parallelograms, parallelogram::ObjectFace};
use crate::{description::Params, error::Result, math::DVec3};

/// Corner, u and v edges and normal of each face, u and v as on Mitsuba's cube.
const FACES: [ObjectFace; 6] = [
    [[-1.0, -1.0, -1.0], [0.0, 0.0, 2.0], [2.0, 0.0, 0.0], [0.0, -1.0, 0.0]],
    [[1.0, 1.0, 1.0], [-2.0, 0.0, 0.0], [0.0, 0.0, -2.0], [0.0, 1.0, 0.0]],
    [[1.0, -1.0, 1.0], [0.0, 2.0, 0.0], [0.0, 0.0, -2.0], [1.0, 0.0, 0.0]],
    [[-1.0, -1.0, 1.0], [0.0, 2.0, 0.0], [2.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
    [[-1.0, -1.0, -1.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0], [-1.0, 0.0, 0.0]],
    [[-1.0, 1.0, -1.0], [0.0, -2.0, 0.0], [2.0, 0.0, 0.0], [0.0, 0.0, -1.0]],
];

/// Reads `to_world` and `flip_normals`.
pub fn build(params: &Params<'_>, recentre: DVec3) -> Result<Parallelograms> {
    params.accept_unused(&["face_normals"], "its faces are flat");
    Parallelograms::build(params, recentre, &FACES)
}
