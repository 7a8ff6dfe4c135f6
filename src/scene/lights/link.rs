//! Emitter points as seen from a reference: sampled by next-event estimation or met by an eye walk.

use super::{Geometry, Lights, front};
use crate::{
    emitter::{Glow, Kind, PointKind},
    math::{Spectrum, Vec3, measure},
    sampling::Stream,
    shape::SurfacePoint,
};

/// An emitter point sampled for (or met from) a reference point.
#[derive(Clone, Copy, Debug)]
pub struct Link {
    /// The emitter.
    pub light: u32,
    /// The point on a shape.
    pub point: Option<SurfacePoint>,
    /// Emitter point; for emitters at infinity the unit direction towards the emitter.
    pub position: Vec3,
    /// Radiance x cosine, intensity, irradiance x (delta), or radiance gained per metre: what arrives per 1/d^2 [d = 1
    /// at infinity].
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
    /// Of a point in a medium that shines, see [`crate::medium::Emission::rate`] [1/m].
    pub rate: Option<Spectrum>,
}

impl Lights {
    /// Samples an emitter point for next-event estimation from `reference`; none where nothing can arrive.
    pub fn sample_link(&self, geometry: &Geometry, reference: Vec3, stream: &mut Stream) -> Option<Link> {
        if self.connections.is_empty() {
            return None;
        }
        let (index, chosen) = self.connections.sample_precisely(stream.uniform_precisely());
        self.link_to(geometry, index, chosen as f32, reference, stream)
    }

    /// Samples a point of the emitter `index`, which is chosen with probability `chosen`.
    pub fn link_to(
        &self,
        geometry: &Geometry,
        index: usize,
        chosen: f32,
        reference: Vec3,
        stream: &mut Stream,
    ) -> Option<Link> {
        let light = &self.all[index];
        match &light.emitter.kind {
            Kind::Area(_) => {
                let (point, density) = geometry.sample_toward(light.shape?, reference, stream)?;
                self.area_link(geometry, index, point, chosen * density, reference)
            }
            Kind::DirectionalArea(_) => None,
            Kind::Point(point) => self.point_link(index, point, chosen, reference),
            Kind::Directional(sun) => Some(self.infinite_link(index, -sun.direction, chosen, sun.irradiance)),
            Kind::Environment(sky) => {
                let towards = sky.sample(stream);
                let connect = chosen * sky.density(towards);
                (connect > 0.0).then(|| self.infinite_link(index, towards, connect, sky.radiance(towards)))
            }
            Kind::Medium(glow) => {
                let link = self.link_within(index as u32, glow.emission.sample(stream))?;
                let by_chance = self.connections.probability(index);
                Some(Link { connect: link.connect * (chosen / by_chance), ..link })
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
        let Kind::Area(area) = &self.all[index].emitter.kind else { return None };
        let (direction, _, _) = measure::between(point.position, reference)?;
        let cosine = front(&point).dot(direction);
        let value = area.radiance(point.uv, cosine) * cosine;
        (value.max_element() > 0.0 && connect > 0.0).then(|| Link {
            light: index as u32,
            point: Some(point),
            position: point.position,
            value,
            cosine,
            connect,
            start: self.starts.probability(index) / geometry.area(point.shape),
            forward: area.density(cosine),
            infinite: false,
            hittable: true,
            rate: None,
        })
    }

    fn point_link(&self, index: usize, point: &PointKind, chosen: f32, reference: Vec3) -> Option<Link> {
        let position = self.all[index].position;
        let (direction, _, _) = measure::between(position, reference)?;
        let value = point.intensity(direction);
        (value.max_element() > 0.0).then(|| Link {
            light: index as u32,
            point: None,
            position,
            value,
            cosine: 1.0,
            connect: chosen,
            start: self.starts.probability(index),
            forward: point.density(direction),
            infinite: false,
            hittable: false,
            rate: None,
        })
    }

    fn infinite_link(&self, index: usize, towards: Vec3, connect: f32, value: Spectrum) -> Link {
        Link {
            light: index as u32,
            point: None,
            position: towards,
            value,
            cosine: 1.0,
            connect,
            start: connect * self.starts.probability(index) / self.connections.probability(index),
            forward: self.disk_density(),
            infinite: true,
            hittable: self.all[index].emitter.is_hittable(),
            rate: None,
        }
    }

    /// The link to a point of a medium that shines, by whatever way it was found; none where it is dark there.
    pub fn link_within(&self, light: u32, position: Vec3) -> Option<Link> {
        let index = light as usize;
        let Kind::Medium(Glow { emission, .. }) = &self.all[index].emitter.kind else { return None };
        let (value, density) = (emission.at(position), emission.density(position));
        (value.max_element() > 0.0 && density > 0.0).then(|| Link {
            light,
            point: None,
            position,
            value,
            cosine: 1.0,
            connect: self.connections.probability(index) * density,
            start: self.starts.probability(index) * density,
            forward: Glow::DENSITY,
            infinite: false,
            hittable: true,
            rate: Some(emission.rate(position)),
        })
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
        let Kind::Environment(sky) = &self.all[index].emitter.kind else { return None };
        let connect = self.connections.probability(index) * sky.density(direction);
        (connect > 0.0).then(|| self.infinite_link(index, direction, connect, sky.radiance(direction)))
    }
}
