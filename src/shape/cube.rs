//! `cube`: [-1, 1]^3, facing outwards.

use super::{
    model::COMMON,
    parallelogram::{ObjectFace, Parallelograms},
};
use crate::{
    description::{Params, Table, table},
    error::Result,
    math::DMat4,
};

/// Corner, u and v edges and normal of each face, u and v as on Mitsuba's cube.
const FACES: [ObjectFace; 6] = [
    [[-1.0, -1.0, -1.0], [0.0, 0.0, 2.0], [2.0, 0.0, 0.0], [0.0, -1.0, 0.0]],
    [[1.0, 1.0, 1.0], [-2.0, 0.0, 0.0], [0.0, 0.0, -2.0], [0.0, 1.0, 0.0]],
    [[1.0, -1.0, 1.0], [0.0, 2.0, 0.0], [0.0, 0.0, -2.0], [1.0, 0.0, 0.0]],
    [[-1.0, -1.0, 1.0], [0.0, 2.0, 0.0], [2.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
    [[-1.0, -1.0, -1.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0], [-1.0, 0.0, 0.0]],
    [[-1.0, 1.0, -1.0], [0.0, -2.0, 0.0], [2.0, 0.0, 0.0], [0.0, 0.0, -1.0]],
];

/// Its parameters.
pub(super) const TABLE: Table = table! {
    "A box: [-1, 1]^3, facing outwards.";
    ignored("face_normals", "its faces are flat");
    COMMON
};

pub(super) fn build(params: &Params<'_>, world: DMat4) -> Result<Parallelograms> {
    Parallelograms::build(params, world, &FACES)
}
