//! Where light walks start.

use super::{Geometry, Lights, front};
use crate::{
    emitter::{Area, DirectionalArea, Glow, Kind, PointKind},
    math::{Frame, Spectrum, Vec3, offset, warp},
    sampling::Stream,
    shape::SurfacePoint,
};

/// The first vertex of a light walk, its direction sampled.
#[derive(Clone, Copy, Debug)]
pub struct Start {
    /// The emitter.
    pub light: u32,
    /// Emitter point; for emitters at infinity the unit direction towards the emitter.
    pub position: Vec3,
    /// The point on a shape.
    pub point: Option<SurfacePoint>,
    /// Origin of the first ray (on the disk of starts for an emitter at infinity).
    pub origin: Vec3,
    /// Direction of the first ray.
    pub direction: Vec3,
    /// |cos| at the emitter; 1 where it is not a shape.
    pub cosine: f32,
    /// Start density of the point.
    pub start: f32,
    /// Density of the direction [1/sr], or of the origin on the disk [1/m^2]; 1 of the only direction there is.
    pub forward: f32,
    /// Emitted radiance x cosine (or intensity) over both densities.
    pub throughput: Spectrum,
    /// True at infinity.
    pub infinite: bool,
    /// True if an eye walk could have met it.
    pub hittable: bool,
    /// True where light leaves in one direction only: nothing can be joined to the emitter.
    pub dirac: bool,
    /// Of a point in a medium that shines, see [`crate::medium::Emission::rate`] [1/m].
    pub rate: Option<Spectrum>,
}

/// What leaves an emitter point in a given direction.
#[derive(Clone, Copy, Debug)]
pub struct Leaving {
    /// Radiance x cosine [W/(m^2 sr)], or radiance gained per metre [W/(m^3 sr)].
    pub value: Spectrum,
    /// Density of the direction by a light walk [1/sr] ([1/m^2] at infinity).
    pub forward: f32,
    /// |cos| at the emitter; 1 at infinity.
    pub cosine: f32,
}

impl Lights {
    /// Samples an emitter by power, a point on it and a direction; none where nothing leaves.
    pub fn sample_start(&self, geometry: &Geometry, stream: &mut Stream) -> Option<Start> {
        if self.starts.is_empty() {
            return None;
        }
        let (index, chosen) = self.starts.sample_precisely(stream.uniform_precisely());
        let chosen = chosen as f32;
        let start = match &self.all[index].emitter.kind {
            Kind::Area(area) => self.start_on_area(index, area, chosen, geometry, stream)?,
            Kind::DirectionalArea(area) => self.start_along_normal(index, area, chosen, geometry, stream)?,
            Kind::Point(point) => self.start_at_point(index, point, chosen, stream),
            Kind::Directional(sun) => {
                self.start_at_infinity(index, -sun.direction, chosen, sun.irradiance, stream)
            }
            Kind::Environment(sky) => {
                let towards = sky.sample(stream);
                let density = chosen * sky.density(towards);
                self.start_at_infinity(index, towards, density, sky.radiance(towards), stream)
            }
            Kind::Medium(glow) => self.start_within(index, glow, chosen, stream),
        };
        (start.throughput.is_finite() && start.throughput.max_element() > 0.0).then_some(start)
    }

    fn start_on_area(
        &self,
        index: usize,
        area: &Area,
        chosen: f32,
        geometry: &Geometry,
        stream: &mut Stream,
    ) -> Option<Start> {
        let shape = self.all[index].shape?;
        let point = geometry.sample_area(shape, stream);
        let front = front(&point);
        let direction = Frame::around(front).to_world(area.sample(stream)).normalize();
        let cosine = front.dot(direction);
        let (start, forward) = (chosen / geometry.area(shape), area.density(cosine));
        let throughput = area.radiance(point.uv, cosine) * (cosine / (start * forward));
        let begun = self.start_on(index, &point, direction, start);
        Some(Start { cosine, forward, throughput, ..begun })
    }

    fn start_along_normal(
        &self,
        index: usize,
        area: &DirectionalArea,
        chosen: f32,
        geometry: &Geometry,
        stream: &mut Stream,
    ) -> Option<Start> {
        let shape = self.all[index].shape?;
        let point = geometry.sample_area(shape, stream);
        let start = chosen / geometry.area(shape);
        let throughput = area.exitance_at(point.uv) / start;
        let begun = self.start_on(index, &point, point.shading.normal, start);
        Some(Start { throughput, dirac: true, ..begun })
    }

    fn start_at_point(&self, index: usize, point: &PointKind, chosen: f32, stream: &mut Stream) -> Start {
        let direction = point.sample(stream);
        let forward = point.density(direction);
        let throughput = point.intensity(direction) / (chosen * forward);
        let begun = self.start_at(index, self.all[index].position, direction, chosen);
        Start { forward, throughput, ..begun }
    }

    fn start_at_infinity(
        &self,
        index: usize,
        towards: Vec3,
        start: f32,
        radiance: Spectrum,
        stream: &mut Stream,
    ) -> Start {
        let disk = warp::to_disk(stream.square()) * self.radius;
        let origin = self.centre + Frame::around(towards).to_world(disk.extend(self.radius));
        let forward = self.disk_density();
        let throughput = radiance * self.from_infinity / (start * forward);
        let begun = self.start_at(index, towards, -towards, start);
        Start { infinite: true, origin, forward, throughput, ..begun }
    }

    /// In the medium's box; whether it is in the medium, who knows its boundaries has to ask.
    fn start_within(&self, index: usize, glow: &Glow, chosen: f32, stream: &mut Stream) -> Start {
        let emission = &glow.emission;
        let position = emission.sample(stream);
        let direction = warp::to_sphere(stream.square());
        let start = chosen * emission.density(position);
        let throughput = emission.at(position) / (start * Glow::DENSITY);
        let begun = self.start_at(index, position, direction, start);
        Start { forward: Glow::DENSITY, throughput, rate: Some(emission.rate(position)), ..begun }
    }

    fn start_on(&self, index: usize, point: &SurfacePoint, direction: Vec3, start: f32) -> Start {
        let origin = offset::leave_surface(point.position, point.error, point.normal, direction);
        Start { point: Some(*point), origin, ..self.start_at(index, point.position, direction, start) }
    }

    fn start_at(&self, index: usize, position: Vec3, direction: Vec3, start: f32) -> Start {
        Start {
            light: index as u32,
            position,
            point: None,
            origin: position,
            direction,
            cosine: 1.0,
            start,
            forward: 1.0,
            throughput: Spectrum::ZERO,
            infinite: false,
            hittable: self.all[index].emitter.is_hittable(),
            dirac: false,
            rate: None,
        }
    }

    /// What the emitter point of a light walk sends towards unit `towards`: a link without a reference; none
    /// where it does not emit that way or cannot be met.
    pub fn emission(&self, start: &Start, towards: Vec3) -> Option<Leaving> {
        match (&self.all[start.light as usize].emitter.kind, &start.point) {
            (Kind::Area(area), Some(point)) => {
                let cosine = front(point).dot(towards);
                let (value, forward) = (area.radiance(point.uv, cosine) * cosine, area.density(cosine));
                (value.max_element() > 0.0).then_some(Leaving { value, forward, cosine })
            }
            (Kind::Environment(sky), _) => Some(Leaving {
                value: sky.radiance(start.position) * self.from_infinity,
                forward: self.disk_density(),
                cosine: 1.0,
            }),
            (Kind::Medium(glow), _) => {
                let (value, forward) = (glow.emission.at(start.position), Glow::DENSITY);
                Some(Leaving { value, forward, cosine: 1.0 })
            }
            _ => None,
        }
    }

    /// Next-event density over start density of the point a light walk started from, as seen from its second
    /// vertex: the ratio by which strategy s = 1 stands for s = 2 in the weights.
    #[inline]
    pub fn connect_over_start(&self, geometry: &Geometry, start: &Start, reference: Vec3) -> f32 {
        let index = start.light as usize;
        let chosen = self.connections.probability(index);
        match &start.point {
            Some(point) => chosen * geometry.density_toward(point.shape, reference, point) / start.start,
            None => chosen / self.starts.probability(index),
        }
    }
}
