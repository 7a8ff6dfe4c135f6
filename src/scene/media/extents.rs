//! How far the media of a scene reach: the boxes in which coefficients that vary without bounds of their own
//! are examined.

use super::locate::Survey;
use crate::{
    error::Result,
    math::{Bounds, Vec3},
    medium::{Medium, MediumBounds, MediumDescription, MediumIndex, MediumOverrides},
    scene::{accel::Geometry, surface::Surface},
};

/// Boxes reach beyond shapes by this part of their size: the boundary itself lies within.
const MARGIN: f32 = 1e-3;

/// Boxes around the media of a scene.
pub(crate) struct Extents<'a> {
    /// All shapes.
    pub geometry: &'a Geometry,
    /// Their properties.
    pub surfaces: &'a [Surface],
    /// A point that the scene's own box holds: the camera.
    pub viewpoint: Vec3,
    /// The medium around everything.
    pub outside: MediumIndex,
    /// How far rays in each medium were seen to get: shapes that hold one need not close it.
    pub survey: &'a Survey,
}

impl Extents<'_> {
    /// Finishes all media.
    pub(crate) fn finish(
        &self,
        media: Vec<MediumDescription>,
        medium_overrides: &MediumOverrides,
    ) -> Result<Vec<Medium>> {
        let finish = |(index, description): (usize, MediumDescription)| {
            let (is_bound, Bounds { low, high }) = self.of(MediumIndex(index as u32));
            if self.outside.0 as usize == index {
                description.check_end()?;
            }
            let medium = description.finish(MediumBounds { low, high, is_bound }, medium_overrides)?;
            Ok(medium.numbered(MediumIndex(index as u32)))
        };
        media.into_iter().enumerate().map(finish).collect()
    }

    /// The box around the shapes that hold `medium`; around the whole scene where it also lies outside of some: false.
    pub(crate) fn of(&self, medium: MediumIndex) -> (bool, Bounds) {
        let boundaries = || self.surfaces.iter().zip(self.geometry.shapes());
        let holds = |surface: &Surface| surface.boundary.interior == Some(medium);
        let leaks = |surface: &Surface| surface.boundary.exterior == Some(medium);
        let inside = boundaries().filter(|(surface, _)| holds(surface)).map(|(_, shape)| shape.bounds());
        let everywhere = medium == self.outside || boundaries().any(|(surface, _)| leaks(surface));
        match inside.reduce(Bounds::union).map(widened) {
            Some(bounds) if !everywhere && self.ends_within(medium, bounds) => (true, bounds),
            _ => (false, self.scene()),
        }
    }

    fn ends_within(&self, medium: MediumIndex, bounds: Bounds) -> bool {
        let seen = self.survey.extents.get(medium.0 as usize).copied().flatten();
        seen.is_none_or(|seen| bounds.contains(seen))
    }

    /// The box around everything, the camera too.
    pub(crate) fn scene(&self) -> Bounds {
        let (shapes, camera) = (self.geometry.bounds(), Bounds::of(self.viewpoint));
        widened(if shapes.is_finite() { shapes.union(camera) } else { camera })
    }
}

fn widened(bounds: Bounds) -> Bounds {
    let size = bounds.size().max_element();
    bounds.grown(Vec3::splat(MARGIN * if size > 0.0 { size } else { 1.0 }))
}
