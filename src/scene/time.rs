//! A scene at another time: what drifts in a wind is moved, all else stays as it was read and built.

use super::{Scene, lights::Lights};
use crate::error::Result;

impl Scene {
    /// Moves the scene to `time` [s]; false where nothing in it depends on time. Media that change are looked at
    /// anew, and so is where light starts, for how far they reach and how they shine may have changed.
    pub fn set_time(&mut self, time: f64) -> Result<bool> {
        let mut changed = false;
        for medium in &mut self.media {
            if let Some(moved) = medium.at_time(time)? {
                *medium = moved;
                changed = true;
            }
        }
        if changed {
            let lights = std::mem::take(&mut self.lights);
            self.lights = Lights::new(lights.all, &self.geometry, &self.media[self.outside.0 as usize]);
        }
        Ok(changed)
    }
}
