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
use media::{Boundary, MediaMap};
pub use memo::Memo;
pub(crate) use sections::TABLE;

/// The properties of a shape: its BSDF, emitter and media.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// Index of its BSDF.
    pub bsdf: u32,
    /// Index of its emitter.
    pub emitter: Option<u32>,
    /// The media on its sides.
    pub boundary: Boundary,
    /// Light can get to the other side.
    pub transmits: bool,
    /// Some of its scattering is not Dirac: the answer of its BSDF, stored because every vertex needs it.
    pub connectible: bool,
}

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
