//! `rectangle`: [-1, 1]^2 in the xy plane, facing +z.

use super::{COMMON, Parallelograms, parallelogram::ObjectFace};
use crate::{
    description::{Params, Table, table},
    error::Result,
    math::DVec3,
};

const FACE: ObjectFace = [[-1.0, -1.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 1.0]];

/// Its parameters.
pub(super) const TABLE: Table = table! {
    "A rectangle: [-1, 1]^2 in the xy plane, facing +z.";
    ignored("face_normals", "its faces are flat");
    COMMON
};

pub(super) fn build(params: &Params<'_>, recentre: DVec3) -> Result<Parallelograms> {
    Parallelograms::build(params, recentre, &[FACE])
}
