//! Which media lie where: surveys boundaries, orders overlapping ones and closes open ones.

use super::{Builder, view::Camera};
use crate::{
    bsdf::{self, Bsdf},
    error::Result,
    math::Vec3,
    medium::MediumIndex,
    scene::{
        Surface,
        accel::Geometry,
        contact::{Nature, Rank},
        media::{Boundary, Known, Locator, Overlaps, Survey, media_before, open, place_camera},
    },
};
use std::collections::BTreeSet;

/// What is known about where media lie.
pub(super) struct Surveyed {
    pub known: Known,
    pub survey: Survey,
    pub sensor_medium: MediumIndex,
    /// See [`MediaMap::sensor_media`](crate::scene::media::MediaMap::sensor_media).
    pub sensor_media: Vec<MediumIndex>,
    pub overlaps: Option<Box<Overlaps>>,
    /// Boundaries contradict each other even after that.
    pub contradicts: bool,
}

impl Builder<'_> {
    /// Surveys where media lie, how far they reach, and which one the camera is in. Overlapping boundaries are put in
    /// order, open ones closed.
    pub(super) fn survey(
        &mut self,
        geometry: Geometry,
        camera: &mut Camera<'_>,
    ) -> Result<(Geometry, Surveyed)> {
        let (mut geometry, is_stated) = (geometry, camera.stated.is_some());
        let (mut known, survey) = self.look_around(&geometry, camera);
        let mut overlaps = Overlaps::find(&geometry, &self.surfaces, &survey);
        let mut left = None;
        if !overlaps.is_empty() {
            (known, left) = self.without(&overlaps, &geometry, camera);
        }
        let open = open(&geometry, &self.surfaces, left.as_ref().unwrap_or(&survey));
        if !open.is_empty() {
            geometry = self.close(geometry, &open, &mut overlaps)?;
            (known, left) = self.without(&overlaps, &geometry, camera);
            self.names().warn_of_lids(&open);
        }
        let contradictions = left.as_ref().unwrap_or(&survey);
        self.names().warn_of_contradictions(contradictions);
        let contradicts = !contradictions.shapes().is_empty();
        overlaps.find_regions(self.media.len(), &self.bases(camera));
        // The pinhole itself may lie on a boundary, and what is before the near plane is not seen.
        let Camera { start, size, stated, location, .. } = *camera;
        let (names, surfaces) = (self.names(), &self.surfaces);
        let overlapping = (!overlaps.is_empty()).then_some(&overlaps);
        let locator = Locator { geometry: &geometry, surfaces, known: &known };
        let sensor_media = match is_stated {
            true => Vec::new(),
            false => media_before(&locator, overlapping, &camera.sensor, size),
        };
        let across = (!sensor_media.is_empty()).then(|| {
            names.warn_of_camera_across(&sensor_media, &overlaps, location);
            locator.along(start, Vec3::X).unwrap_or(MediumIndex::VACUUM)
        });
        let alone = || place_camera(&geometry, surfaces, &mut known, start, &names, location);
        let place = || across.unwrap_or_else(alone);
        let sensor_medium = overlaps.at(stated.unwrap_or_else(place), start, Vec3::X);
        let overlaps = (!overlaps.is_empty()).then(|| Box::new(overlaps));
        Ok((geometry, Surveyed { known, survey, sensor_medium, sensor_media, overlaps, contradicts }))
    }

    /// What is known without the overlapping boundaries, and the contradictions that remain.
    fn without(
        &mut self,
        overlaps: &Overlaps,
        geometry: &Geometry,
        camera: &mut Camera<'_>,
    ) -> (Known, Option<Survey>) {
        overlaps.take_from(&mut self.surfaces);
        self.forget_what_overlaps(overlaps, camera);
        let (known, left) = self.look_around(geometry, camera);
        (known, Some(left))
    }

    /// Closes `open` shapes by lids that light passes, and counts them among the boundaries that overlap.
    fn close(&mut self, geometry: Geometry, open: &[u32], overlaps: &mut Overlaps) -> Result<Geometry> {
        self.shapes = geometry.into_shapes();
        let null = self.add_bsdf(Bsdf::Null(bsdf::Null), "null".to_owned());
        for &shape in open {
            let lids = self.shapes[shape as usize].lids();
            overlaps.add(&self.shapes[shape as usize], &lids, &self.surfaces, shape);
            for lid in lids {
                self.shapes.push(lid);
                self.shape_names.push(format!("lid of {}", self.shape_names[shape as usize]));
                self.shape_locations.push(self.shape_locations[shape as usize].clone());
                self.natures.push(Nature { rank: Rank::Null, bsdf: null, one_sided: false, is_lid: true });
                self.surfaces.push(Surface {
                    bsdf: null,
                    emitter: None,
                    boundary: Boundary::default(),
                    transmits: true,
                    connectible: false,
                    detailed: false,
                });
            }
        }
        self.check_memory()?;
        Ok(self.geometry())
    }

    fn look_around(&self, geometry: &Geometry, camera: &Camera<'_>) -> (Known, Survey) {
        let points = self.stated_points(camera.start, camera.stated);
        Known::survey(geometry, &self.surfaces, points, camera.stated.unwrap_or(MediumIndex::VACUUM))
    }

    /// Forgets media stated by the camera or emitters where overlapping boundaries put the same media.
    fn forget_what_overlaps(&mut self, overlaps: &Overlaps, camera: &mut Camera<'_>) {
        let recentre = self.recentre;
        let forget = |stated: &mut Option<MediumIndex>, position: Option<Vec3>| {
            let added = overlaps.added(position);
            *stated = stated.filter(|medium| !added.contains(medium));
        };
        forget(&mut camera.stated, Some(camera.start));
        for placed in &mut self.emitters {
            let position = placed.emitter.position().map(|position| (position - recentre).as_vec3());
            forget(&mut placed.stated, position);
        }
    }

    /// The media that lie outside all overlapping boundaries.
    fn bases(&self, camera: &Camera<'_>) -> BTreeSet<u32> {
        let sides =
            self.surfaces.iter().flat_map(|surface| [surface.boundary.interior, surface.boundary.exterior]);
        let stated = self.emitters.iter().map(|placed| placed.stated);
        let named = sides.chain(stated).chain([camera.stated, Some(MediumIndex::VACUUM)]);
        named.flatten().map(|medium| medium.0).collect()
    }

    /// Camera and emitters at points whose medium the file states; the camera is at `start`.
    fn stated_points(&self, start: Vec3, medium: Option<MediumIndex>) -> Vec<(Vec3, MediumIndex)> {
        let emitters = self.emitters.iter().filter_map(|placed| {
            Some(((placed.emitter.position()? - self.recentre).as_vec3(), placed.stated?))
        });
        medium.map(|medium| (start, medium)).into_iter().chain(emitters).collect()
    }
}
