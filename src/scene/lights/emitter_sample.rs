//! Emitter points as seen from a reference: sampled by next-event estimation or hit by a camera subpath.

use super::{Aim, Disk, EmitterPoint, Geometry, Lights, light_sampler::Taken};
use crate::{
    emitter::{BeamEmitter, BeamModel, Kind, PointEmitter, PointModel, Seen, SurfaceModel, VolumeEmitter},
    math::{Spectrum, Vec3, measure},
    sampling::Stream,
    settings::options::Sky,
    shape::SurfacePoint,
};

/// An emitter point sampled for (or hit from) a reference point.
#[derive(Clone, Copy, Debug)]
pub struct EmitterSample {
    /// The emitter.
    pub light: u32,
    /// Its point.
    pub point: EmitterPoint,
    /// Radiance x cosine, intensity, irradiance x (delta), or radiance gained per metre: what arrives per 1/d^2 [d = 1
    /// of parallel light].
    pub value: Spectrum,
    /// |cos| at the emitter; 1 where it is not a shape.
    pub cosine: f32,
    /// Density of this point by next-event estimation from the reference: per area of a shape (1/m^2), per volume of a
    /// medium (1/m^3), per solid angle at infinity (1/sr); a probability where the emitter is a point or a direction.
    pub pdf: f32,
    /// Density of this point as the start of a light subpath without learnt starts, in the same measure.
    pub pdf_start: f32,
    /// Density of the direction to the reference by a light subpath (1/sr) ((1/m^2) of parallel light).
    pub pdf_direction: f32,
}

impl Lights {
    /// Samples an emitter point for next-event estimation from `reference`; none where nothing can arrive.
    pub fn sample_emitter(
        &self,
        geometry: &Geometry,
        reference: Vec3,
        aim: Aim<'_>,
        stream: &mut Stream,
    ) -> Option<EmitterSample> {
        let connections = self.connections(aim.sky);
        if connections.is_empty() {
            return None;
        }
        let (index, cell) = match connections.sample(reference, stream) {
            Taken::Emitter(index, chosen) => {
                return self.sample_point_of(geometry, (index, chosen), reference, aim, stream);
            }
            Taken::Medium(index, cell) => (index, cell),
        };
        let Kind::Medium(volume) = &self.all[index].emitter.kind else { return None };
        let emission = &volume.emission;
        let position = match cell {
            Some(cell) => emission.sample_in(cell, stream),
            None => emission.sample(stream),
        };
        let pdf = connections.pdf_vol(index, emission, position, reference);
        self.volume_point(index, volume, position, pdf)
    }

    /// Samples a point of the emitter `index`, which is chosen with probability `chosen`.
    pub fn sample_point_of(
        &self,
        geometry: &Geometry,
        (index, chosen): (usize, f32),
        reference: Vec3,
        aim: Aim<'_>,
        stream: &mut Stream,
    ) -> Option<EmitterSample> {
        let light = &self.all[index];
        match &light.emitter.kind {
            Kind::Surface(_) => {
                let (point, pdf) = geometry.sample_toward(light.shape?, reference, stream)?;
                self.surface_sample(geometry, index, point, chosen * pdf, reference)
            }
            Kind::Point(point) => self.point_sample(index, point, chosen, reference),
            Kind::Infinite(sky) => {
                let (towards, seen) = self.aim_at_infinity(index, sky, reference, aim, stream);
                self.infinite_sample(index, towards, seen, chosen)
            }
            Kind::Beam(beam) => self.beam_sample(index, beam, chosen, reference),
            Kind::Medium(volume) => {
                let position = volume.emission.sample(stream);
                self.volume_point(index, volume, position, chosen * volume.emission.pdf_vol(position))
            }
        }
    }

    fn surface_sample(
        &self,
        geometry: &Geometry,
        index: usize,
        point: SurfacePoint,
        pdf: f32,
        reference: Vec3,
    ) -> Option<EmitterSample> {
        let Kind::Surface(surface) = &self.all[index].emitter.kind else { return None };
        let (direction, _, _) = measure::between(point.position, reference)?;
        let cosine = point.front().dot(direction);
        let value = surface.radiance(point.uv, cosine) * cosine;
        (value.max_element() > 0.0 && pdf > 0.0).then(|| EmitterSample {
            light: index as u32,
            point: EmitterPoint::Surface(point),
            value,
            cosine,
            pdf,
            pdf_start: self.starts.probability(index) / geometry.area(point.shape),
            pdf_direction: surface.pdf_sr(cosine),
        })
    }

    fn point_sample(
        &self,
        index: usize,
        point: &PointEmitter,
        chosen: f32,
        reference: Vec3,
    ) -> Option<EmitterSample> {
        let position = self.all[index].position;
        let (direction, _, _) = measure::between(position, reference)?;
        let value = point.intensity(direction);
        (value.max_element() > 0.0).then(|| EmitterSample {
            light: index as u32,
            point: EmitterPoint::Point(position),
            value,
            cosine: 1.0,
            pdf: chosen,
            pdf_start: self.starts.probability(index),
            pdf_direction: point.pdf_sr(direction),
        })
    }

    fn infinite_sample(&self, index: usize, towards: Vec3, seen: Seen, chosen: f32) -> Option<EmitterSample> {
        (seen.aimed_sr > 0.0).then(|| EmitterSample {
            light: index as u32,
            point: EmitterPoint::Direction(towards),
            value: seen.radiance,
            cosine: 1.0,
            pdf: chosen * seen.aimed_sr,
            pdf_start: self.starts.probability(index) * seen.pdf_sr,
            pdf_direction: self.disk_towards(towards).pdf_area(),
        })
    }

    /// The one point of a beam whose light comes to `reference`.
    fn beam_sample(
        &self,
        index: usize,
        beam: &BeamEmitter,
        chosen: f32,
        reference: Vec3,
    ) -> Option<EmitterSample> {
        let disk = Disk::of_beam(beam, self.all[index].position);
        let (position, value) = (disk.onto(reference)?, beam.irradiance());
        (value.max_element() > 0.0).then(|| EmitterSample {
            light: index as u32,
            point: EmitterPoint::Beam { position, direction: beam.direction() },
            value,
            cosine: 1.0,
            pdf: chosen,
            pdf_start: self.starts.probability(index),
            pdf_direction: disk.pdf_area(),
        })
    }

    /// A point of an emissive medium that a camera subpath from `reference` has found; none where nothing is emitted
    /// there.
    pub fn volume_hit(&self, light: u32, position: Vec3, reference: Vec3, sky: Sky) -> Option<EmitterSample> {
        let index = light as usize;
        let Kind::Medium(volume) = &self.all[index].emitter.kind else { return None };
        let pdf = self.connections(sky).pdf_vol(index, &volume.emission, position, reference);
        self.volume_point(index, volume, position, pdf)
    }

    fn volume_point(
        &self,
        index: usize,
        VolumeEmitter { emission, .. }: &VolumeEmitter,
        position: Vec3,
        pdf: f32,
    ) -> Option<EmitterSample> {
        let (value, by_power) = (emission.at(position), emission.pdf_vol(position));
        (value.max_element() > 0.0 && by_power > 0.0).then(|| EmitterSample {
            light: index as u32,
            point: EmitterPoint::Volume { position, rate: emission.rate(position) },
            value,
            cosine: 1.0,
            pdf,
            pdf_start: self.starts.probability(index) * by_power,
            pdf_direction: VolumeEmitter::PDF_SR,
        })
    }

    /// What a camera subpath from `reference` found by hitting `point` of an emitting shape; none where it
    /// does not emit towards the reference.
    pub fn surface_hit(
        &self,
        geometry: &Geometry,
        light: u32,
        point: &SurfacePoint,
        reference: Vec3,
        sky: Sky,
    ) -> Option<EmitterSample> {
        let index = light as usize;
        let chosen = self.connections(sky).probability(index, reference);
        let pdf = chosen * geometry.pdf_area_toward(point.shape, reference, point);
        // Next-event estimation may be unable to find this point from there (a density of 0): the walk can.
        let mut sample =
            self.surface_sample(geometry, index, *point, pdf.max(f32::MIN_POSITIVE), reference)?;
        sample.pdf = pdf;
        Some(sample)
    }

    /// What a camera subpath from `reference` found by leaving the scene in unit `direction`; none where nothing is
    /// there.
    pub fn infinity_hit(&self, direction: Vec3, reference: Vec3, aim: Aim<'_>) -> Option<EmitterSample> {
        let index = self.environment? as usize;
        let environment = self.all[index].emitter.environment()?;
        let chosen = self.connections(aim.sky).probability(index, reference);
        let seen = self.seen_towards(index, environment, reference, direction, aim);
        self.infinite_sample(index, direction, seen, chosen)
    }
}
