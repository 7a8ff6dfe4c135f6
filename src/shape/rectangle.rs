//! `rectangle`: [-1, 1]^2 in the xy plane, facing +z.

use super::{Parallelograms, parallelogram::ObjectFace};
use crate::{description::Params, error::Result, math::DVec3};

const FACE: ObjectFace = [[-1.0, -1.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 1.0]];

/// Reads `to_world` and `flip_normals`.
pub fn build(params: &Params<'_>, recentre: DVec3) -> Result<Parallelograms> {
    params.accept_unused(&["face_normals"], "its faces are flat");
    Parallelograms::build(params, recentre, &[FACE])
}
