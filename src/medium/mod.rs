//! Participating media: coefficients and a phase function.

mod homogeneous;

use crate::{
    description::{Library, Object, Row, build_by_row},
    error::Result,
};
pub use homogeneous::Homogeneous;

/// Index of a medium in its scene. Vacuum is a medium like any other, with nothing in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct MediumIndex(pub u32);

impl MediumIndex {
    /// Every scene's medium 0.
    pub const VACUUM: Self = Self(0);
}

/// Every kind of medium.
pub const ROWS: &[Row<Homogeneous>] = &[Row { name: "homogeneous", build: Homogeneous::build }];

/// Builds the medium that `object` describes.
pub fn build(object: &Object, library: &Library) -> Result<Homogeneous> {
    build_by_row(object, library, "medium", ROWS)
}

/// True if `object` is a medium.
pub fn is_medium(object: &Object) -> bool {
    ROWS.iter().any(|row| row.name == object.plugin)
}
