//! All emitters of a scene: which one is chosen, where its light starts, how a point is joined to it.
//!
//! Two densities stand for the same emitter point: `start` by which light walks begin there, and `connect` by
//! which next-event estimation from a given reference picks it. Both contain the probability of choosing the
//! emitter and are per area [1/m^2] for shapes, discrete for points and single directions, per solid angle
//! [1/sr] for emitters at infinity, whose "point" is a direction.

use super::accel::Geometry;
use crate::{
    emitter::Emitter,
    math::{Frame, Spectrum, Vec3, measure, warp},
    medium::MediumIndex,
    sampling::{Discrete, Stream},
    shape::SurfacePoint,
};
use std::f32::consts::PI;

/// An emitter placed in its scene.
#[derive(Clone, Debug)]
pub struct Light {
    /// How it emits.
    pub emitter: Emitter,
    /// Where it stands: a point, or nothing for shapes and emitters at infinity.
    pub position: Vec3,
    /// The shape that emits.
    pub shape: Option<u32>,
    /// The medium its light starts in.
    pub medium: MediumIndex,
}

/// All emitters.
#[derive(Clone, Debug, Default)]
pub struct Lights {
    /// In file order.
    pub all: Vec<Light>,
    /// By power: where light walks start.
    starts: Discrete,
    /// Half by power, half uniform: which emitter a point is joined to. A distant strong emitter cannot keep
    /// a near weak one from being found.
    connections: Discrete,
    /// Index of the constant environment.
    pub environment: Option<u32>,
    /// Centre of a sphere around the scene.
    centre: Vec3,
    /// Its radius [m].
    radius: f32,
    /// What remains of light from infinity where it enters the scene: 1, or 0 in fog without end.
    from_infinity: Spectrum,
}

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
    /// Density of the direction [1/sr], or of the origin on the disk [1/m^2].
    pub forward: f32,
    /// Emitted radiance x cosine (or intensity) over both densities.
    pub throughput: Spectrum,
    /// True at infinity.
    pub infinite: bool,
    /// True if an eye walk could have met it.
    pub hittable: bool,
}

/// An emitter point sampled for (or met from) a reference point.
#[derive(Clone, Copy, Debug)]
pub struct Link {
    /// The point on a shape.
    pub point: Option<SurfacePoint>,
    /// Emitter point; for emitters at infinity the unit direction towards the emitter.
    pub position: Vec3,
    /// Radiance x cosine, intensity, or irradiance x (delta): what arrives per 1/d^2 [d = 1 at infinity].
    pub value: Spectrum,
    /// |cos| at the emitter; 1 where it is not a shape.
    pub cosine: f32,
    /// Density of this point by next-event estimation from the reference.
    pub connect: f32,
    /// Density of this point as the start of a light walk.
    pub start: f32,
    /// Density of the direction to the reference by a light walk [1/sr] ([1/m^2] at infinity).
    pub forward: f32,
    /// True at infinity.
    pub infinite: bool,
    /// True if an eye walk could have met it.
    pub hittable: bool,
}

/// The normal of the side that emits: geometric, turned to the side that the shading normal names.
#[inline]
fn front(point: &SurfacePoint) -> Vec3 {
    if point.normal.dot(point.shading.normal) < 0.0 { -point.normal } else { point.normal }
}

/// What leaves an emitter point in a given direction.
#[derive(Clone, Copy, Debug)]
pub struct Emission {
    /// Radiance x cosine [W/(m^2 sr)].
    pub value: Spectrum,
    /// Density of the direction by a light walk [1/sr] ([1/m^2] at infinity).
    pub forward: f32,
    /// |cos| at the emitter; 1 at infinity.
    pub cosine: f32,
}

impl Lights {
    /// Arranges `all` emitters of a scene within a sphere around `geometry`, in a surrounding medium with
    /// transmittance `from_infinity` (0 or 1) along an infinite way.
    pub fn new(all: Vec<Light>, geometry: &Geometry, from_infinity: Spectrum) -> Self {
        let (low, high) = geometry.bounds();
        let (centre, radius) = if low.is_finite() && high.is_finite() {
            (0.5 * (low + high), (0.5 * (high - low).length() * (1.0 + 1e-3)).max(f32::MIN_POSITIVE))
        } else {
            (Vec3::ZERO, 1.0)
        };
        let weight = |light: &Light| {
            let area = light.shape.map_or(0.0, |shape| geometry.area(shape));
            let arriving = if light.emitter.is_infinite() { from_infinity.max_element() } else { 1.0 };
            let power = light.emitter.power(area, radius);
            f64::from(power) * f64::from(light.emitter.sampling_weight() * arriving)
        };
        let powers: Vec<f64> = all.iter().map(weight).collect();
        let (total, count) = (powers.iter().sum::<f64>(), powers.iter().filter(|p| **p > 0.0).count());
        let mixed = |p: &f64| if *p > 0.0 { p / total + 1.0 / count as f64 } else { 0.0 };
        let connections = Discrete::new(powers.iter().map(mixed));
        let environment = all.iter().position(|l| matches!(l.emitter, Emitter::Constant(_)));
        Self {
            starts: Discrete::new(powers.iter().copied()),
            connections,
            environment: environment.map(|index| index as u32),
            all,
            centre,
            radius,
            from_infinity,
        }
    }

    /// True where nothing emits.
    pub fn is_empty(&self) -> bool {
        self.starts.is_empty()
    }

    /// True if some emitter is at infinity.
    pub fn has_infinite(&self) -> bool {
        self.all.iter().any(|light| light.emitter.is_infinite())
    }

    /// Density of starts on the disk that faces an emitter at infinity [1/m^2].
    #[inline]
    fn disk_density(&self) -> f32 {
        1.0 / (PI * self.radius * self.radius)
    }

    /// Samples an emitter by power, a point on it and a direction; none where nothing leaves.
    pub fn sample_start(&self, geometry: &Geometry, stream: &mut Stream) -> Option<Start> {
        let (index, chosen) = self.starts.sample(stream.uniform());
        let light = &self.all[index];
        let start = match &light.emitter {
            Emitter::Area(area) => {
                let shape = light.shape?;
                let point = geometry.sample_area(shape, stream);
                let front = front(&point);
                let direction = Frame::around(front).to_world(area.sample(stream)).normalize();
                let cosine = front.dot(direction);
                let (start, forward) = (chosen / geometry.area(shape), area.density(cosine));
                let throughput = area.radiance(cosine) * (cosine / (start * forward));
                let origin =
                    crate::math::offset::leave_surface(point.position, point.error, point.normal, direction);
                Start {
                    point: Some(point),
                    cosine,
                    throughput,
                    ..self.start_at(index, point.position, origin, direction, start, forward)
                }
            }
            Emitter::Point(point) => {
                let (direction, forward) = (warp::to_sphere(stream.square()), warp::SPHERE_DENSITY);
                let throughput = point.intensity / (chosen * forward);
                Start {
                    throughput,
                    ..self.start_at(index, light.position, light.position, direction, chosen, forward)
                }
            }
            Emitter::Spot(spot) => {
                let direction = spot.sample(stream);
                let forward = spot.density(direction);
                let throughput = spot.intensity(direction) / (chosen * forward);
                Start {
                    throughput,
                    ..self.start_at(index, light.position, light.position, direction, chosen, forward)
                }
            }
            Emitter::Directional(sun) => {
                self.start_at_infinity(index, -sun.direction, chosen, sun.irradiance, stream)
            }
            Emitter::Constant(sky) => {
                let towards = warp::to_sphere(stream.square());
                self.start_at_infinity(index, towards, chosen * warp::SPHERE_DENSITY, sky.radiance, stream)
            }
        };
        (start.throughput.is_finite() && start.throughput.max_element() > 0.0).then_some(start)
    }

    fn start_at(
        &self,
        index: usize,
        position: Vec3,
        origin: Vec3,
        direction: Vec3,
        start: f32,
        forward: f32,
    ) -> Start {
        Start {
            light: index as u32,
            position,
            point: None,
            origin,
            direction,
            cosine: 1.0,
            start,
            forward,
            throughput: Spectrum::ZERO,
            infinite: false,
            hittable: self.all[index].emitter.is_hittable(),
        }
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
        let frame = Frame::around(towards);
        let origin = self.centre + frame.to_world(disk.extend(self.radius));
        let forward = self.disk_density();
        let throughput = radiance * self.from_infinity / (start * forward);
        Start {
            infinite: true,
            throughput,
            ..self.start_at(index, towards, origin, -towards, start, forward)
        }
    }

    /// Samples an emitter point for next-event estimation from `reference`; none where nothing can arrive.
    pub fn sample_link(&self, geometry: &Geometry, reference: Vec3, stream: &mut Stream) -> Option<Link> {
        let (index, chosen) = self.connections.sample(stream.uniform());
        let light = &self.all[index];
        match &light.emitter {
            Emitter::Area(_) => {
                let (point, density) = geometry.sample_toward(light.shape?, reference, stream)?;
                self.area_link(geometry, index, point, chosen * density, reference)
            }
            Emitter::Point(point) => {
                self.point_link(index, chosen, reference, |_| (point.intensity, warp::SPHERE_DENSITY))
            }
            Emitter::Spot(spot) => self.point_link(index, chosen, reference, |direction| {
                (spot.intensity(direction), spot.density(direction))
            }),
            Emitter::Directional(sun) => {
                Some(self.infinite_link(index, -sun.direction, chosen, sun.irradiance))
            }
            Emitter::Constant(sky) => {
                let towards = warp::to_sphere(stream.square());
                Some(self.infinite_link(index, towards, chosen * warp::SPHERE_DENSITY, sky.radiance))
            }
        }
    }

    fn area_link(
        &self,
        geometry: &Geometry,
        index: usize,
        point: SurfacePoint,
        connect: f32,
        reference: Vec3,
    ) -> Option<Link> {
        let Emitter::Area(area) = &self.all[index].emitter else { return None };
        let (direction, _, _) = measure::between(point.position, reference)?;
        let cosine = front(&point).dot(direction);
        let value = area.radiance(cosine) * cosine;
        (value.max_element() > 0.0 && connect > 0.0).then(|| Link {
            point: Some(point),
            position: point.position,
            value,
            cosine,
            connect,
            start: self.starts.probability(index) / geometry.area(point.shape),
            forward: area.density(cosine),
            infinite: false,
            hittable: true,
        })
    }

    fn point_link(
        &self,
        index: usize,
        chosen: f32,
        reference: Vec3,
        emission: impl Fn(Vec3) -> (Spectrum, f32),
    ) -> Option<Link> {
        let position = self.all[index].position;
        let (direction, _, _) = measure::between(position, reference)?;
        let (value, forward) = emission(direction);
        (value.max_element() > 0.0).then(|| Link {
            point: None,
            position,
            value,
            cosine: 1.0,
            connect: chosen,
            start: self.starts.probability(index),
            forward,
            infinite: false,
            hittable: false,
        })
    }

    fn infinite_link(&self, index: usize, towards: Vec3, connect: f32, value: Spectrum) -> Link {
        Link {
            point: None,
            position: towards,
            value,
            cosine: 1.0,
            connect,
            start: connect * self.starts.probability(index) / self.connections.probability(index),
            forward: self.disk_density(),
            infinite: true,
            hittable: self.all[index].emitter.is_hittable(),
        }
    }

    /// The link that an eye walk at `reference` made by meeting `point` of an emitting shape; none where it
    /// does not emit towards the reference.
    pub fn met(
        &self,
        geometry: &Geometry,
        light: u32,
        point: &SurfacePoint,
        reference: Vec3,
    ) -> Option<Link> {
        let index = light as usize;
        let connect =
            self.connections.probability(index) * geometry.density_toward(point.shape, reference, point);
        // Next-event estimation may be unable to find this point from there (a density of 0): the walk can.
        let mut link = self.area_link(geometry, index, *point, connect.max(f32::MIN_POSITIVE), reference)?;
        link.connect = connect;
        Some(link)
    }

    /// The link that an eye walk made by leaving the scene in unit `direction`; none where nothing is there.
    pub fn met_at_infinity(&self, direction: Vec3) -> Option<Link> {
        let index = self.environment? as usize;
        let Emitter::Constant(sky) = &self.all[index].emitter else { return None };
        let connect = self.connections.probability(index) * warp::SPHERE_DENSITY;
        (connect > 0.0).then(|| self.infinite_link(index, direction, connect, sky.radiance))
    }

    /// What the emitter point of a light walk sends towards unit `towards`: a link without a reference; none
    /// where it does not emit that way or cannot be met.
    pub fn emission(&self, start: &Start, towards: Vec3) -> Option<Emission> {
        match (&self.all[start.light as usize].emitter, &start.point) {
            (Emitter::Area(area), Some(point)) => {
                let cosine = front(point).dot(towards);
                let (value, forward) = (area.radiance(cosine) * cosine, area.density(cosine));
                (value.max_element() > 0.0).then_some(Emission { value, forward, cosine })
            }
            (Emitter::Constant(sky), _) => Some(Emission {
                value: sky.radiance * self.from_infinity,
                forward: self.disk_density(),
                cosine: 1.0,
            }),
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
