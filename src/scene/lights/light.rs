//! One emitter of a scene.

use super::clearings::Clearings;
use crate::{emitter::Emitter, math::Vec3, medium::MediumIndex};
use std::sync::Arc;

/// An emitter placed in its scene.
#[derive(Clone, Debug)]
pub struct Light {
    /// How it emits.
    pub emitter: Emitter,
    /// Its position: a point, the centre of a disk, or nothing for shapes and emitters at infinity.
    pub position: Vec3,
    /// The shape that emits.
    pub shape: Option<u32>,
    /// The medium its light starts in.
    pub medium: MediumIndex,
    /// Its light starts in several media: that of each ray is located, and `medium` is where nothing is known.
    pub straddles: bool,
    /// Of an emissive medium, where its box is certainly filled; none where that is not known.
    pub clearings: Option<Arc<Clearings>>,
}
