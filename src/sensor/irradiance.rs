//! Irradiance on a shape: Mitsuba's `irradiancemeter`. Its aperture is the shape, its film the hemisphere above each
//! point.

use super::{ALL, Projection, SensorRay, Site};
use crate::{
    description::{Params, Table, table},
    error::{Error, Result},
    math::{Frame, Vec2, Vec3, warp},
    sampling::Stream,
    shape::{Shape, ShapeModel as _, SurfacePoint},
};

/// The surface of a shape, all points and all cosine-weighted directions of which count equally.
#[derive(Clone, Debug)]
pub struct Irradiance {
    shape: Shape,
    /// Its number among those of the scene.
    pub(super) index: usize,
}

impl Irradiance {
    pub(super) const TABLE: Table = table! {
        "The mean irradiance on the shape that it is in. Its film has one pixel. As in Mitsuba, light straight from emitters without a size (`point`, `spot`, `projector`, `directional`, `collimated`) does not count.";
        object("shape", "shape", "The shape that it measures, by reference. Only where it is not inside one.").ours();
        ALL
    };

    /// Reads which shape it is on.
    pub(super) fn build(params: &Params<'_>, site: &Site<'_>) -> Result<Self> {
        let remedy = "put it inside a shape of the scene, which is not in a group";
        let missing = |found| Error::new(params.location(), "an irradiancemeter on a shape", found, remedy);
        let child = params.child("shape")?.ok_or_else(|| missing("one beside the shapes"))?;
        let index = site.places.get(&child.object.location).copied();
        let index = index.ok_or_else(|| missing("another place"))?;
        Ok(Self::on(site.shapes[index].clone(), index))
    }

    /// On `shape`, which is that of this number.
    pub(super) fn on(shape: Shape, index: usize) -> Self {
        Self { shape, index }
    }

    /// The same, its shape as it now is among `shapes`.
    pub(super) fn settle(&mut self, shapes: &[Shape]) {
        self.shape = shapes[self.index].clone();
    }

    /// A point of the aperture: numbers in [-0.5, 0.5), 0 in the middle.
    #[inline]
    pub(super) fn sample_aperture(stream: &mut Stream) -> Vec2 {
        stream.square() - 0.5
    }

    /// That point of the shape, uniform by area, with a frame around the normal.
    fn at(&self, aperture: Vec2) -> (SurfacePoint, Frame) {
        let point = self.shape.sample_area(&mut Stream::of(aperture + 0.5));
        (point, Frame::around(point.shading.normal))
    }

    /// Some point of it.
    pub fn position(&self) -> Vec3 {
        self.at(Vec2::ZERO).0.position
    }

    /// The ray through a film position from a point of the shape.
    pub fn ray(&self, film: Vec2, aperture: Vec2) -> SensorRay {
        let (point, frame) = self.at(aperture);
        let local = warp::to_cosine_hemisphere(film);
        let ray = point.leaving(frame.to_world(local));
        SensorRay { position: point.position, ray, pdf: warp::cosine_hemisphere_pdf(local.z) }
    }

    /// How `point` is seen from a point of the shape; none where it lies behind that.
    pub fn project(&self, point: Vec3, aperture: Vec2) -> Option<Projection> {
        let (start, frame) = self.at(aperture);
        let distance_squared = point.distance_squared(start.position);
        let direction = (point - start.position).try_normalize()?;
        let mut seen = see(&start, &frame, direction, distance_squared)?;
        // Connections end here: the shape must not shadow its own points.
        seen.ray.origin = start.lift(direction).clear(point, seen.ray.origin);
        Some(seen)
    }

    /// How the point at infinity in unit `direction` is seen; none behind the shape.
    pub fn project_direction(&self, direction: Vec3, aperture: Vec2) -> Option<Projection> {
        let (start, frame) = self.at(aperture);
        see(&start, &frame, direction, 1.0)
    }
}

fn see(start: &SurfacePoint, frame: &Frame, direction: Vec3, distance_squared: f32) -> Option<Projection> {
    let local = frame.to_local(direction);
    let seen = || Projection {
        film: warp::from_disk(local.truncate()),
        ray: start.leaving(direction),
        distance_squared,
        pdf: warp::cosine_hemisphere_pdf(local.z),
    };
    (local.z > 0.0).then(seen)
}
