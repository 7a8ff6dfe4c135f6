//! Where light subpaths start.

use super::{
    Aim, Disk, EmitterPoint, Geometry, Lights, Start, Starts,
    starts::{Densities, Learnt},
};
use crate::{
    emitter::{
        BeamEmitter, BeamModel, InfiniteEmitter, InfiniteModel, Kind, PointEmitter, PointModel,
        SurfaceEmission, SurfaceEmitter, SurfaceModel, VolumeEmitter,
    },
    math::{Spectrum, Vec3, warp},
    sampling::Stream,
    shape::{Ray, SurfacePoint},
};

/// The first vertex of a light subpath, its direction sampled.
#[derive(Clone, Copy, Debug)]
pub struct EmissionSample {
    /// The emitter.
    pub light: u32,
    /// Its point.
    pub point: EmitterPoint,
    /// The first ray; from infinity it starts on the disk that faces the emitter.
    pub ray: Ray,
    /// |cos| at the emitter; 1 where it is not a shape.
    pub cosine: f32,
    /// Density of the point: per area of a shape (1/m^2), per volume of a medium (1/m^3), per solid angle at infinity
    /// (1/sr); a probability where the emitter is a point or a direction.
    pub pdf: f32,
    /// Density of the direction (1/sr), or, of parallel light, that of the origin on the disk (1/m^2); 1 of the only direction there is.
    pub pdf_direction: f32,
    /// Both densities without what was learnt.
    pub unlearnt: Densities,
    /// Emitted radiance x cosine (or intensity) over both densities.
    pub throughput: Spectrum,
}

/// What leaves an emitter point in a given direction.
#[derive(Clone, Copy, Debug)]
pub struct Emitted {
    /// Radiance x cosine (W/(m^2 sr)), or radiance gained per metre (W/(m^3 sr)).
    pub value: Spectrum,
    /// Density of the direction by a light subpath (1/sr) ((1/m^2) at infinity).
    pub pdf_direction: f32,
    /// |cos| at the emitter; 1 at infinity.
    pub cosine: f32,
}

impl EmissionSample {
    /// Where light leaves: the point, or that on the disk.
    pub fn position(&self) -> Vec3 {
        self.point.position().unwrap_or(self.ray.origin)
    }
}

impl EmissionSample {
    /// Where and which way light leaves.
    pub fn start(&self) -> Start {
        Start::towards(self.light, &self.point, self.ray.origin, self.ray.direction)
    }

    /// Replaces the emitters' own densities by those of the mixture with what was `learnt`.
    fn mixed(self, lights: &Lights, learnt: &Starts) -> Self {
        let densities = learnt.densities(lights, &self.start(), self.unlearnt);
        let ratio = self.unlearnt.both() / densities.both();
        let throughput = if ratio.is_finite() { self.throughput * ratio } else { Spectrum::ZERO };
        Self { pdf: densities.point, pdf_direction: densities.direction, throughput, ..self }
    }
}

impl Lights {
    /// Samples an emitter by power, a point on it and a direction, mixed with what was `learnt`; none where nothing
    /// leaves. A learnt direction in which the point emits nothing has a throughput of 0, as the point was sampled.
    pub fn sample_emission(
        &self,
        geometry: &Geometry,
        learnt: Option<&Starts>,
        stream: &mut Stream,
    ) -> Option<EmissionSample> {
        if self.starts.is_empty() {
            return None;
        }
        let Some(learnt) = learnt else {
            let (index, chosen) = self.starts.sample_precisely(stream.uniform_precisely());
            return self.start(geometry, index, chosen as f32, None, stream);
        };
        let (index, chosen, by) = learnt.choose(self, stream);
        Some(self.start(geometry, index, chosen as f32, by, stream)?.mixed(self, learnt))
    }

    /// Samples a start on the emitter `index`, chosen with probability `chosen`, by its own distributions or by those
    /// that were `learnt`. The densities are the emitter's own in both cases.
    pub(super) fn start(
        &self,
        geometry: &Geometry,
        index: usize,
        chosen: f32,
        learnt: Option<&Learnt>,
        stream: &mut Stream,
    ) -> Option<EmissionSample> {
        let start = match &self.all[index].emitter.kind {
            Kind::Surface(surface) => {
                self.start_on_shape(index, surface, chosen, geometry, learnt, stream)?
            }
            Kind::Point(point) => self.start_at_point(index, point, chosen, learnt, stream),
            Kind::Infinite(sky) => self.start_at_infinity(index, sky, chosen, learnt, stream),
            Kind::Beam(beam) => self.start_of_beam(index, beam, chosen, learnt, stream),
            Kind::Medium(volume) => self.start_within(index, volume, chosen, learnt, stream),
        };
        let leaves = start.throughput.is_finite() && start.throughput.max_element() > 0.0;
        match learnt {
            None => leaves.then_some(start),
            Some(_) if leaves => Some(start),
            Some(_) => Some(EmissionSample { throughput: Spectrum::ZERO, ..start }),
        }
    }

    fn start_on_shape(
        &self,
        index: usize,
        surface: &SurfaceEmitter,
        chosen: f32,
        geometry: &Geometry,
        learnt: Option<&Learnt>,
        stream: &mut Stream,
    ) -> Option<EmissionSample> {
        let shape = self.all[index].shape?;
        let point = geometry.sample_area(shape, stream);
        let pdf = chosen / geometry.area(shape);
        let direction = learnt.and_then(|learnt| learnt.sample_direction(point.position, stream));
        let emission = match direction {
            Some(direction) => emission_towards(surface, &point, pdf, direction),
            None => surface.sample(&point, pdf, stream),
        };
        let SurfaceEmission { direction, cosine, pdf_sr, throughput } = emission;
        let (light, point, ray) = (index as u32, EmitterPoint::Surface(point), leaving(&point, direction));
        let unlearnt = Densities { point: pdf, direction: pdf_sr };
        Some(EmissionSample { light, point, ray, cosine, pdf, pdf_direction: pdf_sr, unlearnt, throughput })
    }

    fn start_at_point(
        &self,
        index: usize,
        point: &PointEmitter,
        pdf: f32,
        learnt: Option<&Learnt>,
        stream: &mut Stream,
    ) -> EmissionSample {
        let position = self.all[index].position;
        let direction = learnt.and_then(|learnt| learnt.sample_direction(position, stream));
        let direction = direction.unwrap_or_else(|| point.sample(stream));
        let pdf_direction = point.pdf_sr(direction);
        let throughput = point.intensity(direction) / (pdf * pdf_direction);
        let (point, ray) = (EmitterPoint::Point(position), endless(position, direction));
        start_of(index, point, ray, [pdf, pdf_direction], throughput)
    }

    fn start_at_infinity(
        &self,
        index: usize,
        sky: &InfiniteEmitter,
        chosen: f32,
        learnt: Option<&Learnt>,
        stream: &mut Stream,
    ) -> EmissionSample {
        let towards = learnt.and_then(|learnt| learnt.sample_towards(stream));
        let towards = towards.unwrap_or_else(|| sky.sample(stream));
        let (pdf, radiance) = (chosen * sky.pdf_sr(towards), sky.radiance(towards));
        let disk = self.disk_towards(towards);
        let (origin, part) = start_on(&disk, learnt, stream);
        let pdf_direction = disk.pdf_area();
        let throughput = radiance * (part * self.from_infinity / (pdf * pdf_direction));
        let (point, ray) = (EmitterPoint::Direction(towards), endless(origin, -towards));
        start_of(index, point, ray, [pdf, pdf_direction], throughput)
    }

    fn start_of_beam(
        &self,
        index: usize,
        beam: &BeamEmitter,
        pdf: f32,
        learnt: Option<&Learnt>,
        stream: &mut Stream,
    ) -> EmissionSample {
        let disk = Disk::of_beam(beam, self.all[index].position);
        let ((position, part), direction) = (start_on(&disk, learnt, stream), beam.direction());
        let pdf_direction = disk.pdf_area();
        let throughput = beam.irradiance() * (part / (pdf * pdf_direction));
        let point = EmitterPoint::Beam { position, direction };
        start_of(index, point, endless(position, direction), [pdf, pdf_direction], throughput)
    }

    /// In the medium's box; the caller, who knows the boundaries, checks whether it is in the medium.
    fn start_within(
        &self,
        index: usize,
        volume: &VolumeEmitter,
        chosen: f32,
        learnt: Option<&Learnt>,
        stream: &mut Stream,
    ) -> EmissionSample {
        let emission = &volume.emission;
        let position = emission.sample(stream);
        let direction = learnt.and_then(|learnt| learnt.sample_direction(position, stream));
        let ray = endless(position, direction.unwrap_or_else(|| warp::to_sphere(stream.square())));
        let (pdf, pdf_direction) = (chosen * emission.pdf_vol(position), VolumeEmitter::PDF_SR);
        let throughput = emission.at(position) / (pdf * pdf_direction);
        let point = EmitterPoint::Volume { position, rate: emission.rate(position) };
        start_of(index, point, ray, [pdf, pdf_direction], throughput)
    }

    /// The emission of a light subpath's emitter point towards unit `towards`, if camera subpaths can hit it; none
    /// where it does not emit that way.
    pub fn emission(&self, start: &EmissionSample, towards: Vec3) -> Option<Emitted> {
        match (&self.all[start.light as usize].emitter.kind, &start.point) {
            (Kind::Surface(surface), EmitterPoint::Surface(point)) => {
                let cosine = point.front().dot(towards);
                let value = surface.radiance(point.uv, cosine) * cosine;
                let pdf_direction = surface.pdf_sr(cosine);
                (value.max_element() > 0.0).then_some(Emitted { value, pdf_direction, cosine })
            }
            (Kind::Infinite(sky), EmitterPoint::Direction(direction)) => {
                let value = sky.radiance(*direction) * self.from_infinity;
                Some(Emitted { value, pdf_direction: self.disk_towards(*direction).pdf_area(), cosine: 1.0 })
            }
            (Kind::Medium(volume), EmitterPoint::Volume { position, .. }) => {
                let value = volume.emission.at(*position);
                Some(Emitted { value, pdf_direction: VolumeEmitter::PDF_SR, cosine: 1.0 })
            }
            _ => None,
        }
    }

    /// Next-event density over start density of a light subpath's emitter point, as seen from its second vertex. This
    /// ratio turns the density of s = 2 into that of s = 1 in the weights.
    #[inline]
    pub fn connect_over_start(
        &self,
        geometry: &Geometry,
        start: &EmissionSample,
        reference: Vec3,
        aim: Aim<'_>,
    ) -> f32 {
        let (index, connections) = (start.light as usize, self.connections(aim.sky));
        let chosen = || connections.probability(index, reference);
        match (&start.point, &self.all[index].emitter.kind) {
            (EmitterPoint::Surface(point), _) => {
                chosen() * geometry.pdf_area_toward(point.shape, reference, point) / start.pdf
            }
            (EmitterPoint::Volume { position, .. }, Kind::Medium(volume)) => {
                connections.pdf_vol(index, &volume.emission, *position, reference) / start.pdf
            }
            (EmitterPoint::Direction(towards), Kind::Infinite(infinite)) => {
                let seen = self.seen_towards(index, infinite, reference, *towards, aim);
                chosen() * seen.aimed_sr / start.pdf
            }
            _ => chosen() / self.starts.probability(index) * (start.unlearnt.point / start.pdf),
        }
    }
}

/// A point of `disk`, whose light travels one way only, and the part of it that leaves there: 1, or 0 where light that
/// aims at a portal passes the disk by.
fn start_on(disk: &Disk, learnt: Option<&Learnt>, stream: &mut Stream) -> (Vec3, f32) {
    if let Some(point) = learnt.and_then(|learnt| learnt.aim_on(disk, stream)) {
        return (disk.at(point), if point.length_squared() <= 1.0 { 1.0 } else { 0.0 });
    }
    let point = learnt.and_then(|learnt| learnt.sample_disk(-disk.direction(), stream));
    (disk.at(point.unwrap_or_else(|| warp::to_disk(stream.square()))), 1.0)
}

/// What leaves `point` of a shape, which has density `pdf_area`, in unit `direction`.
fn emission_towards(
    surface: &SurfaceEmitter,
    point: &SurfacePoint,
    pdf_area: f32,
    direction: Vec3,
) -> SurfaceEmission {
    let cosine = point.front().dot(direction);
    let pdf_sr = surface.pdf_sr(cosine);
    let throughput = surface.radiance(point.uv, cosine) * (cosine / (pdf_area * pdf_sr));
    SurfaceEmission { direction, cosine, pdf_sr, throughput }
}

/// A start that is not on a shape, with the densities of point and direction.
fn start_of(
    index: usize,
    point: EmitterPoint,
    ray: Ray,
    [pdf, pdf_direction]: [f32; 2],
    throughput: Spectrum,
) -> EmissionSample {
    let unlearnt = Densities { point: pdf, direction: pdf_direction };
    EmissionSample { light: index as u32, point, ray, cosine: 1.0, pdf, pdf_direction, unlearnt, throughput }
}

/// The ray that leaves `point` in unit `direction`.
fn leaving(point: &SurfacePoint, direction: Vec3) -> Ray {
    endless(point.leaving(direction).origin, direction)
}

fn endless(origin: Vec3, direction: Vec3) -> Ray {
    Ray { origin, direction, t_max: f32::INFINITY }
}
