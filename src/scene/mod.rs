//! A scene ready to render, and how it is made: read a description, build it, index it.

pub mod accel;
pub mod build;
pub mod contact;
pub mod keyframes;
pub mod lights;
pub mod media;
mod memo;
mod rebuild;
mod sections;
pub mod sensors;
pub mod smoke;
mod surface;
mod time;
mod unseen;

use crate::{
    bsdf::{Bsdf, BsdfModel},
    math::{DVec3, Spectrum, Vec3},
    medium::Medium,
    sensor::{Crop, Sensor},
    shape::SurfacePoint,
};
use accel::Geometry;
use lights::Lights;
use media::MediaMap;
pub use memo::Memo;
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
}

impl Scene {
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

    /// The part of light that passes `point` undeflected along `direction`.
    #[inline]
    pub fn null_transmission(&self, point: &SurfacePoint, direction: Vec3) -> Spectrum {
        let cosine = point.shading.normal.dot(direction).abs();
        self.bsdf(point.shape).null_transmission(point.uv, cosine)
    }
}
