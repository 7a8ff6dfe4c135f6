//! A scene at another time: what drifts in a wind is moved, all else stays as it was read and built.

use super::{
    Scene,
    lights::{Lights, emissive},
};
use crate::{emitter::Kind, error::Result, medium::Medium};

impl Scene {
    /// Moves the scene to `time` (s); false where nothing in it depends on time. Media that change are
    /// examined again, and so are the emitters, as the extent and the emission of media may have changed.
    pub fn set_time(&mut self, time: f64) -> Result<bool> {
        let mut changed = false;
        let behind = self.media_map.nowhere.iter().count();
        let given =
            self.media_map.overlaps.as_ref().map_or(self.media.len() - behind, |overlaps| overlaps.media());
        for medium in &mut self.media[..given] {
            if let Some(moved) = medium.at_time(time)? {
                *medium = moved;
                changed = true;
            }
        }
        if changed {
            let steady = std::mem::take(&mut self.lights).all.into_iter();
            self.media.truncate(given);
            let overlaps = self.media_map.overlaps.as_deref();
            let emissive = emissive(
                &self.media,
                self.locator(),
                overlaps,
                self.media_map.nowhere.is_some(),
                self.media_map.outside,
            );
            let lights =
                steady.filter(|light| !matches!(light.emitter.kind, Kind::Medium(_))).chain(emissive);
            let outside = &self.media[self.media_map.outside.0 as usize];
            self.lights = Lights::new(lights.collect(), &self.geometry, outside);
            let regions = self.media_map.overlaps.as_ref().map(|overlaps| overlaps.build(&self.media));
            self.media.extend(regions.into_iter().flatten());
            self.media.extend(self.media_map.nowhere.map(|_| Medium::vacuum()));
        }
        Ok(changed)
    }
}
