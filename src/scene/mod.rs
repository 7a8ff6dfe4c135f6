//! A scene ready to render, and how it is made: read a description, build it, index it.

pub mod accel;
mod batch;
pub mod build;
pub mod contact;
pub mod keyframes;
pub mod lights;
pub mod media;
mod memo;
mod rebuild;
mod sections;
pub mod sensors;
pub mod shutter;
pub mod smoke;
mod surface;
mod targets;
#[cfg(test)]
mod tests;
mod time;
mod unseen;

use crate::{
    bsdf::{Bsdf, BsdfModel},
    emitter::Kind,
    math::{Bounds, DVec3, Detail, Spectrum, Uv, Vec3},
    medium::Medium,
    sensor::{Crop, Sensor},
    shape::{ShapeModel as _, SurfacePoint},
};
use accel::Geometry;
use lights::{Light, Lights};
use media::MediaMap;
pub use memo::{Kept, Memo};
pub(crate) use sections::TABLE;
pub use surface::Surface;

/// Everything transport needs to know.
pub struct Scene {
    /// All shapes.
    pub geometry: Geometry,
    /// One entry a shape.
    pub surfaces: Vec<Surface>,
    /// All BSDFs.
    pub bsdfs: Vec<Bsdf>,
    /// All media; the first is vacuum. Behind them, the regions of [`MediaMap::overlaps`].
    pub media: Vec<Medium>,
    /// Where they lie.
    pub media_map: MediaMap,
    /// All emitters.
    pub lights: Lights,
    /// The camera.
    pub sensor: Sensor,
    /// Its image.
    pub crop: Crop,
    /// Where the origin of all positions lies in the file's coordinates (m).
    pub recentre: DVec3,
    /// Its smooth glass and metal are as rough as this, which they should not be.
    pub softened: Option<f64>,
    /// It is seen at other times too, at which other things may scatter.
    pub moves: bool,
}

impl Scene {
    /// The box around all shapes, the camera and lamps without a surface.
    pub fn bounds(&self) -> Bounds {
        let is_lamp = |light: &&Light| matches!(light.emitter.kind, Kind::Point(_) | Kind::Beam(_));
        let lamps = self.lights.all.iter().filter(is_lamp).map(|light| light.position);
        let points = lamps.chain([self.sensor.position()]).map(Bounds::of);
        points.fold(self.geometry.bounds(), Bounds::union)
    }

    /// The properties of the surface of `shape`.
    #[inline]
    pub fn surface(&self, shape: u32) -> &Surface {
        &self.surfaces[shape as usize]
    }

    /// The BSDF of `shape`.
    #[inline]
    pub fn bsdf(&self, shape: u32) -> &Bsdf {
        &self.bsdfs[self.surfaces[shape as usize].bsdf as usize]
    }

    /// Calls `look` with the BSDF at `point`, and with where its textures are looked up.
    #[inline]
    pub fn at<R>(&self, point: &SurfacePoint, look: impl FnOnce(&Bsdf, Uv) -> R) -> R {
        let surface = self.surface(point.shape);
        let bsdf = &self.bsdfs[surface.bsdf as usize];
        if surface.detailed { self.knowing(point, bsdf, look) } else { look(bsdf, point.uv) }
    }

    /// The same for textures that need more than texture coordinates. A function of its own, so that other surfaces pay
    /// one test.
    #[cold]
    #[inline(never)]
    fn knowing<R>(&self, point: &SurfacePoint, bsdf: &Bsdf, look: impl FnOnce(&Bsdf, Uv) -> R) -> R {
        let (shape, frame) = (&self.geometry.shapes()[point.shape as usize], &point.shading);
        let (du, dv) = shape.partials(point.primitive as usize, point);
        let detail = Detail {
            uv: point.uv,
            position: point.position,
            normal: frame.to_local(point.normal),
            partials: [frame.to_local(du), frame.to_local(dv)],
            attributes: shape.attributes(),
            corners: shape.corners(point),
        };
        look(bsdf, Uv::Known(&detail))
    }

    /// The part of light that passes `point` undeflected along `direction`.
    #[inline]
    pub fn null_transmission(&self, point: &SurfacePoint, direction: Vec3) -> Spectrum {
        let cosine = point.shading.normal.dot(direction).abs();
        self.at(point, |bsdf, uv| bsdf.null_transmission(uv, cosine))
    }
}
