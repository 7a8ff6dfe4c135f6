//! Blocks as instruments see them: the light subpaths of a block, then the camera subpath of each of its pixels.

use super::blocks::CameraStart;
use crate::transport::observer::Observer;

/// Sees a block.
pub trait BlockObserver {
    /// Sees light subpath number `walk` of the pass.
    fn light(&mut self, walk: u64) -> &mut dyn Observer;

    /// All light subpaths are traced.
    fn lit(&mut self) {}

    /// Sees the camera subpath of `pixel`, which begins at `start`.
    fn camera(&mut self, pixel: usize, start: &CameraStart) -> &mut dyn Observer;

    /// The camera subpath of `pixel` has ended.
    fn ended(&mut self, _pixel: usize) {}
}
