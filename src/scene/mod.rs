//! A scene ready to render, and how it is made: read a description, build it, index it.

pub mod accel;
mod again;
pub mod boundary;
pub mod build;
mod extents;
pub mod keyframes;
pub mod lights;
mod locate;
mod memo;
mod overlap;
mod placement;
mod range;
mod sections;
pub mod smoke;
mod time;
mod unseen;

use crate::{
    bsdf::{Bsdf, BsdfModel},
    emitter::Kind,
    math::{DVec3, Spectrum, Vec3},
    medium::{Medium, MediumIndex},
    sensor::Sensor,
    shape::{Ray, SurfacePoint},
};
use accel::Geometry;
use boundary::Boundary;
use lights::{EmitterSample, Light, Lights};
pub use locate::Infinity;
use locate::{Known, Locator};
pub use memo::Memo;
pub use overlap::Overlaps;
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
    /// The boundary may share faces with another shape's (see [`boundary::touching`]).
    pub touching: bool,
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
    /// All media; the first is vacuum. Behind them, the regions of [`Self::overlaps`].
    pub media: Vec<Medium>,
    /// All emitters.
    pub lights: Lights,
    /// The camera.
    pub sensor: Sensor,
    /// The medium around everything; where that differs by direction, the one seen most.
    pub outside: MediumIndex,
    /// What is known about where media lie.
    pub known: Known,
    /// The medium around the camera.
    pub sensor_medium: MediumIndex,
    /// What lies where boundaries of media overlap; none where none do.
    pub overlaps: Option<Box<Overlaps>>,
    /// What walks carry from where a boundary says that they are in another medium than they are in; only in scenes whose
    /// boundaries contradict each other.
    pub nowhere: Option<MediumIndex>,
    /// Where the origin of all positions lies in the file's coordinates [m].
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

    /// The medium that a ray is in when it leaves `point` in `direction`, which came from the direction `incoming`, in
    /// `medium`.
    #[inline]
    pub fn medium_towards(
        &self,
        point: &SurfacePoint,
        incoming: Vec3,
        direction: Vec3,
        medium: MediumIndex,
    ) -> MediumIndex {
        if let Some(nowhere) = self.nowhere
            && self.is_elsewhere(point, incoming, medium)
        {
            return nowhere;
        }
        self.surface(point.shape).boundary.side(point.normal.dot(direction)).unwrap_or(medium)
    }

    /// True if `point` states another medium than `medium` on the side of `incoming`.
    #[cold]
    #[inline(never)]
    fn is_elsewhere(&self, point: &SurfacePoint, incoming: Vec3, medium: MediumIndex) -> bool {
        let Surface { boundary, touching, .. } = *self.surface(point.shape);
        let here = boundary.side(point.normal.dot(incoming));
        !touching && here.is_some_and(|here| here != self.base(medium))
    }

    /// What `medium` is without the boundaries that overlap.
    fn base(&self, medium: MediumIndex) -> MediumIndex {
        self.overlaps.as_ref().map_or(medium, |overlaps| overlaps.base(medium))
    }

    /// True unless boundaries contradict each other about the two ends of a segment that meet in the media `a` and `b`.
    /// Light that came around an open boundary to where its sides say that it is not carries nothing: whichever end a path
    /// is followed from, it carries something in the same media or in none.
    #[inline]
    pub fn agree(&self, a: MediumIndex, b: MediumIndex) -> bool {
        self.nowhere.is_none_or(|nowhere| self.agree_beyond(nowhere, a, b))
    }

    #[cold]
    #[inline(never)]
    fn agree_beyond(&self, nowhere: MediumIndex, a: MediumIndex, b: MediumIndex) -> bool {
        a != nowhere && self.base(a) == self.base(b)
    }

    /// The medium in which light of an emitter's point `sample` sets out in the unit direction `towards`, to arrive in
    /// `medium`: only where boundaries contradict each other may it be another than the way back says.
    #[inline]
    pub fn medium_of(&self, sample: &EmitterSample, towards: Vec3, medium: MediumIndex) -> MediumIndex {
        // A walk meets the emission of a medium only in that medium.
        let is_met_within = self.nowhere.is_none() || sample.point.is_volume();
        if is_met_within { medium } else { self.start_medium(sample, towards) }
    }

    #[cold]
    #[inline(never)]
    fn start_medium(&self, sample: &EmitterSample, towards: Vec3) -> MediumIndex {
        match sample.point.ray_origin(towards) {
            Some(origin) => self.emission_medium(sample.light, origin, towards),
            None => self.known.infinity.towards(-towards),
        }
    }

    /// The medium that `ray` is in, which has passed `point` from within `medium`. Where two boundaries share a
    /// face, a ray hits only one of the two, and which one is chance; the next boundary says which medium the
    /// ray is in now. Opaque surfaces are passed where they are hidden, as if they were not there.
    #[inline]
    pub fn medium_beyond(&self, point: &SurfacePoint, ray: &Ray, medium: MediumIndex) -> MediumIndex {
        let Surface { touching, transmits, .. } = *self.surface(point.shape);
        if !transmits {
            return medium;
        }
        if touching && let Some(found) = self.locator().ahead(ray) {
            return found;
        }
        self.medium_towards(point, -ray.direction, ray.direction, medium)
    }

    fn locator(&self) -> Locator<'_> {
        Locator { geometry: &self.geometry, surfaces: &self.surfaces, known: &self.known }
    }

    /// The medium that light of an emitter is in when it leaves from `origin` in `direction`.
    #[inline]
    pub fn emission_medium(&self, light: u32, origin: Vec3, direction: Vec3) -> MediumIndex {
        let light = &self.lights.all[light as usize];
        // Where media overlap, a walk carries what lies beneath them.
        if self.overlaps.is_some() && matches!(light.emitter.kind, Kind::Medium(_)) {
            return self.locator().along(origin, direction).unwrap_or(self.outside);
        }
        if !light.straddles {
            return light.medium;
        }
        if light.emitter.is_infinite() {
            return self.locator().at_infinity(origin, direction);
        }
        self.locator().along(origin, direction).unwrap_or(light.medium)
    }

    /// True if `position` lies in the emissive medium that `light` is, as far as a ray from there towards `direction` can
    /// show.
    #[inline]
    pub fn is_lit(&self, light: u32, position: Vec3, direction: Vec3) -> bool {
        let Light { clearings, medium, .. } = &self.lights.all[light as usize];
        let known = clearings.as_ref().and_then(|clearings| clearings.holds(position, &self.geometry));
        known.unwrap_or_else(|| self.is_within(*medium, position, direction))
    }

    #[inline(never)]
    fn is_within(&self, medium: MediumIndex, position: Vec3, direction: Vec3) -> bool {
        let base = self.locator().along(position, direction).unwrap_or(self.outside);
        overlap::lies_in(self.overlaps.as_deref(), base, medium, position, direction)
    }

    /// The media that `medium` is: those of a region where several may overlap, else itself.
    #[inline]
    pub fn components<'a>(&'a self, medium: &'a MediumIndex) -> &'a [MediumIndex] {
        let region = self.overlaps.as_ref().and_then(|overlaps| overlaps.members_of(*medium));
        region.unwrap_or(std::slice::from_ref(medium))
    }

    /// The part of light that passes `point` undeflected along `direction`.
    #[inline]
    pub fn null_transmission(&self, point: &SurfacePoint, direction: Vec3) -> Spectrum {
        let cosine = point.shading.normal.dot(direction).abs();
        self.bsdf(point.shape).null_transmission(point.uv, cosine)
    }
}
