//! From all that was built to a scene: touching shapes set apart, media located, emitters placed.

use super::{Builder, Placed, media::Surveyed, view::Camera};
use crate::scene::{
    Scene,
    accel::Geometry,
    contact::Apart,
    lights::{Disk, Light, Lights, emissive},
    media::{self as places, Extents, Known, Locator, MediaMap, Names, Overlaps, Placement},
    unseen::Unseen,
};
use crate::{
    emitter::Kind,
    error::Result,
    math::{DVec3, Vec3},
    medium::{Medium, MediumIndex, MediumOverrides},
    memory,
    shape::{Shape, ShapeModel as _},
};

/// What a primitive takes while the hierarchy is built (bytes): measured 380, and some more.
const MEMORY_PER_PRIMITIVE: u64 = 440;

/// A scene, and what is told of it besides.
pub(super) struct Finished {
    pub(super) scene: Scene,
    pub(super) shape_names: Vec<String>,
    pub(super) bsdf_names: Vec<String>,
    pub(super) apart: Apart,
}

impl Builder<'_> {
    /// Indexes the geometry and finds out which medium the camera and every emitter lie in.
    pub(super) fn finish(
        mut self,
        mut camera: Camera<'_>,
        medium_overrides: &MediumOverrides,
    ) -> Result<Finished> {
        self.check_memory()?;
        let geometry = self.geometry();
        camera.sensor.settle(geometry.shapes());
        let stated = self.surfaces.clone();
        let (geometry, surveyed) = self.survey(geometry, &mut camera)?;
        let Surveyed { known, survey, sensor_medium, sensor_media, overlaps, contradicts } = surveyed;
        let outside = known.infinity.most();
        let sky = self.emitters.iter().find(|placed| placed.emitter.is_infinite());
        self.names().warn_of_endless(outside, &self.media, sky.map(|placed| placed.location));
        let (surfaces, viewpoint) = (&stated, camera.sensor.position());
        let extents = Extents { geometry: &geometry, surfaces, viewpoint, outside, survey: &survey };
        let mut media = extents.finish(std::mem::take(&mut self.media), medium_overrides)?;
        places::check(&media[1..], &self.medium_locations, &extents, self.library)?;
        let lights = self.lights(&geometry, &known, &media, overlaps.as_deref(), contradicts, sensor_medium);
        media.extend(overlaps.as_ref().map(|overlaps| overlaps.build(&media)).into_iter().flatten());
        let nowhere = contradicts.then(|| {
            media.push(Medium::vacuum());
            MediumIndex(media.len() as u32 - 1)
        });
        let (surfaces, bsdfs, viewpoint) = (&self.surfaces, &self.bsdfs, camera.start);
        let unseen = Unseen { geometry: &geometry, surfaces, bsdfs, lights: &lights, viewpoint };
        let around = [MediumIndex::VACUUM, outside, sensor_medium];
        let open: Vec<MediumIndex> = around.into_iter().chain(sensor_media.iter().copied()).collect();
        let shut_in = match overlaps.is_some() || contradicts {
            true => vec![false; media.len()],
            false => unseen.shut_in(&media, &open),
        };

        // Parallel rays start all over a plane: in a shape here, out of it there.
        if !camera.sensor.is_parallel() {
            unseen.warn(&self.names(), camera.location);
        }
        self.names().warn_of_ties(&self.apart.contacts);
        let Self { surfaces, bsdfs, recentre, shape_names, bsdf_names, apart, .. } = self;
        let Camera { sensor, crop, .. } = camera;
        let scene = Scene {
            geometry,
            surfaces,
            bsdfs,
            media,
            lights,
            sensor,
            crop,
            media_map: MediaMap {
                outside,
                sensor: sensor_medium,
                sensor_media,
                known,
                overlaps,
                nowhere,
                shut_in,
            },
            recentre,
            softened: self.library.soften,
            moves: false,
        };
        Ok(Finished { scene, shape_names, bsdf_names, apart })
    }

    /// All emitters, emissive media among them, with the medium that each lies in.
    fn lights(
        &self,
        geometry: &Geometry,
        known: &Known,
        media: &[Medium],
        overlaps: Option<&Overlaps>,
        contradict: bool,
        ambient: MediumIndex,
    ) -> Lights {
        let outside = known.infinity.most();
        let locator = Locator { geometry, surfaces: &self.surfaces, known };
        let placement = Placement { locator, names: &self.names(), ambient };
        let emitters = self.emitters.iter().map(|placed| {
            let light = light(placed, self.recentre, &placement);
            let overlaps = overlaps.filter(|_| placed.emitter.position().is_some());
            let medium = overlaps.map(|overlaps| overlaps.at(light.medium, light.position, Vec3::X));
            Light { medium: medium.unwrap_or(light.medium), ..light }
        });
        let all = emitters.chain(emissive(media, locator, overlaps, contradict, outside)).collect();
        let around = if known.infinity.is_uniform() { outside } else { MediumIndex::VACUUM };
        Lights::new(all, geometry, &media[around.0 as usize])
    }

    /// An error unless memory holds the hierarchy over all shapes, as it is built.
    pub(super) fn check_memory(&self) -> Result<()> {
        let single = |shape: &Shape| shape.primitive_count() as u64;
        let primitives = self.shapes.iter().map(single).sum::<u64>() + self.bases.primitives();
        let size = format!("{primitives} triangles and other primitives");
        let remedy = "give meshes of fewer triangles, or more memory";
        memory::check("the scene", "shapes", &size, primitives.checked_mul(MEMORY_PER_PRIMITIVE), remedy)
    }

    /// All shapes, indexed, those that touch set apart.
    pub(super) fn geometry(&mut self) -> Geometry {
        let mut shapes = std::mem::take(&mut self.shapes);
        let before = self.before.filter(|_| self.has_old_shapes);
        // What is added later was not there before.
        self.has_old_shapes = false;
        if let Some((geometry, apart)) = before.and_then(|before| before.geometry(shapes.len())) {
            self.apart = apart.clone();
            return geometry.clone();
        }
        let positions = self.emitters.iter().filter_map(|placed| placed.emitter.position());
        let lamps: Vec<Vec3> = positions.map(|position| (position - self.recentre).as_vec3()).collect();
        self.apart.separate(&mut shapes, &self.natures, &lamps);
        Geometry::build(shapes)
    }

    /// What messages call media and shapes by.
    pub(super) fn names(&self) -> Names<'_> {
        Names {
            library: self.library,
            media: &self.medium_names,
            ids: &self.medium_ids,
            shapes: &self.shape_names,
            locations: &self.shape_locations,
            recentre: self.recentre,
        }
    }
}

/// An emitter with the medium that it lies in.
fn light(placed: &Placed<'_>, recentre: DVec3, placement: &Placement<'_>) -> Light {
    let Placed { emitter, shape, stated, location } = placed;
    let (emitter, shape) = (emitter.clone(), *shape);
    let position = emitter.position().map(|position| (position - recentre).as_vec3());
    let (medium, straddles) = match (*stated, shape, position) {
        (Some(medium), ..) => (medium, false),
        (None, Some(shape), _) => placement.of_shape(shape, location),
        (None, None, Some(position)) => match &emitter.kind {
            Kind::Beam(beam) => placement.of_disk(&Disk::of_beam(beam, position), location),
            _ => (placement.of_point(position, location), false),
        },
        (None, None, None) => placement.of_infinite(&emitter),
    };
    Light { emitter, position: position.unwrap_or(Vec3::ZERO), shape, medium, straddles, clearings: None }
}
