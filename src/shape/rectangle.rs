//! `rectangle`: [-1, 1]^2 in the xy plane, facing +z.

use super::{
    model::COMMON,
    parallelogram::{ObjectFace, Parallelograms},
};
use crate::{
    description::{Params, Table, table},
    error::Result,
    math::DMat4,
};

const FACE: ObjectFace = [[-1.0, -1.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 1.0]];

/// Its parameters.
pub(super) const TABLE: Table = table! {
    "A rectangle: [-1, 1]^2 in the xy plane, facing +z.";
    ignored("face_normals", "its faces are flat");
    COMMON
};

pub(super) fn build(params: &Params<'_>, world: DMat4) -> Result<Parallelograms> {
    Parallelograms::build(params, world, &[FACE])
}
