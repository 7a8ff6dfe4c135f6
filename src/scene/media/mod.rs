//! Which medium lies where: the one place that everything else asks.
//!
//! Walks carry their medium from where they start, and each boundary that they cross says what lies beyond
//! ([`Scene::medium_towards`]). Where a walk starts, [`Locator`] finds out by rays to what is known. Where boundaries
//! overlap, [`Overlaps`] says what is there. Faces in one place never reach this: they are set apart first (see
//! [`super::contact`]).

pub(super) mod boundary;
mod extents;
pub(super) mod locate;
pub(super) mod overlap;
mod placement;
mod range;
mod solid;

pub use boundary::Boundary;
pub(super) use boundary::direction;
pub(super) use extents::Extents;
pub use locate::Infinity;
pub(super) use locate::{Known, Locator, Survey};
pub use overlap::Overlaps;
pub(super) use overlap::{lies_in, open};
pub(super) use placement::{Names, Placement, media_before, place_camera};
pub(super) use range::check;
pub(super) use solid::Solid;

use super::{
    Scene,
    lights::{EmitterSample, Light},
};
use crate::{
    emitter::Kind,
    math::{Spectrum, Vec3},
    medium::MediumIndex,
    shape::{Ray, SurfacePoint},
};

/// What is known about where media lie.
pub struct MediaMap {
    /// The medium around everything; where that differs by direction, the one seen most.
    pub outside: MediumIndex,
    /// The medium around the camera.
    pub sensor: MediumIndex,
    /// All media that rays of the camera start in if these are several; else empty. Each start is located, and where nothing
    /// is known there, it is in `sensor`.
    pub sensor_media: Vec<MediumIndex>,
    /// What was found out beforehand.
    pub known: Known,
    /// What lies where boundaries of media overlap; none where none do.
    pub overlaps: Option<Box<Overlaps>>,
    /// The medium of walks beyond a boundary that contradicts theirs; only in scenes whose boundaries contradict each
    /// other.
    pub nowhere: Option<MediumIndex>,
    /// For each medium: no emitter, and nothing outside of it, is seen from anywhere in it.
    pub(super) shut_in: Vec<bool>,
}

impl MediaMap {
    /// What `medium` is without the overlapping boundaries.
    fn base(&self, medium: MediumIndex) -> MediumIndex {
        self.overlaps.as_ref().map_or(medium, |overlaps| overlaps.base(medium))
    }
}

impl Scene {
    /// True if fog lies around everything, so that walks in it need not come to an end.
    pub fn is_endless(&self) -> bool {
        self.media[self.media_map.outside.0 as usize].bound().sigma_t != Spectrum::ZERO
    }

    /// True if no ray out of `medium` gets to an emitter, or out at all, unless it is scattered at the surface around it.
    #[inline]
    pub fn is_shut_in(&self, medium: MediumIndex) -> bool {
        self.media_map.shut_in[medium.0 as usize]
    }

    /// The medium of a ray that leaves `point` in `direction`, for a walk that came from the direction `incoming` in
    /// `medium`.
    #[inline]
    pub fn medium_towards(
        &self,
        point: &SurfacePoint,
        incoming: Vec3,
        direction: Vec3,
        medium: MediumIndex,
    ) -> MediumIndex {
        if let Some(nowhere) = self.media_map.nowhere
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
        let here = self.surface(point.shape).boundary.side(point.normal.dot(incoming));
        here.is_some_and(|here| here != self.media_map.base(medium))
    }

    /// True unless boundaries contradict each other about a segment whose ends meet in the media `a` and `b`. Light
    /// that came around an open boundary, to where its sides state another medium, carries nothing. A path thus carries
    /// something in the same media or in none, whichever end it is followed from.
    #[inline]
    pub fn agree(&self, a: MediumIndex, b: MediumIndex) -> bool {
        self.media_map.nowhere.is_none_or(|nowhere| self.agree_beyond(nowhere, a, b))
    }

    #[cold]
    #[inline(never)]
    fn agree_beyond(&self, nowhere: MediumIndex, a: MediumIndex, b: MediumIndex) -> bool {
        a != nowhere && self.media_map.base(a) == self.media_map.base(b)
    }

    /// The medium in which light leaves the emitter's point `sample` in unit `towards`, to arrive in `medium`. It
    /// differs from the medium of the way back only where boundaries contradict each other.
    #[inline]
    pub fn medium_of(&self, sample: &EmitterSample, towards: Vec3, medium: MediumIndex) -> MediumIndex {
        // A walk meets the emission of a medium only in that medium.
        let is_met_within = self.media_map.nowhere.is_none() || sample.point.is_volume();
        if is_met_within { medium } else { self.start_medium(sample, towards) }
    }

    #[cold]
    #[inline(never)]
    fn start_medium(&self, sample: &EmitterSample, towards: Vec3) -> MediumIndex {
        match sample.point.ray_origin(towards) {
            Some(origin) => self.emission_medium(sample.light, origin, towards),
            None => self.media_map.known.infinity.towards(-towards),
        }
    }

    /// The medium of a ray in `direction` after it has passed `point` from within `medium`. Opaque surfaces are passed
    /// where they are hidden, as if they were not there.
    #[inline]
    pub fn medium_beyond(&self, point: &SurfacePoint, direction: Vec3, medium: MediumIndex) -> MediumIndex {
        if !self.surface(point.shape).transmits {
            return medium;
        }
        self.medium_towards(point, -direction, direction, medium)
    }

    /// The medium at `position`, which lies on no surface; a region where several overlap. None where the scene does not say.
    pub fn medium_at(&self, position: Vec3) -> Option<MediumIndex> {
        let found = self.locator().along(position, Vec3::X)?;
        let overlaps = self.media_map.overlaps.as_ref();
        Some(overlaps.map_or(found, |overlaps| overlaps.at(found, position, Vec3::X)))
    }

    /// The medium of a ray that leaves `origin`, which lies on no surface, in unit `direction`.
    pub fn medium_along(&self, origin: Vec3, direction: Vec3) -> MediumIndex {
        self.locator().along(origin, direction).unwrap_or(MediumIndex::VACUUM)
    }

    pub(super) fn locator(&self) -> Locator<'_> {
        Locator { geometry: &self.geometry, surfaces: &self.surfaces, known: &self.media_map.known }
    }

    /// The medium that `ray` from the camera starts in.
    #[inline]
    pub fn sensor_medium(&self, ray: &Ray) -> MediumIndex {
        if self.media_map.sensor_media.is_empty() { self.media_map.sensor } else { self.located(ray) }
    }

    #[cold]
    #[inline(never)]
    fn located(&self, Ray { origin, direction, .. }: &Ray) -> MediumIndex {
        let found = self.locator().along(*origin, *direction).unwrap_or(self.media_map.sensor);
        let overlaps = self.media_map.overlaps.as_ref();
        overlaps.map_or(found, |overlaps| overlaps.at(found, *origin, *direction))
    }

    /// The medium that light of an emitter is in when it leaves from `origin` in `direction`.
    #[inline]
    pub fn emission_medium(&self, light: u32, origin: Vec3, direction: Vec3) -> MediumIndex {
        let light = &self.lights.all[light as usize];
        // Where media overlap, a walk carries what lies beneath them.
        if self.media_map.overlaps.is_some() && matches!(light.emitter.kind, Kind::Medium(_)) {
            return self.locator().along(origin, direction).unwrap_or(self.media_map.outside);
        }
        if !light.straddles {
            return light.medium;
        }
        if light.emitter.is_infinite() {
            return self.locator().at_infinity(origin, direction);
        }
        self.locator().along(origin, direction).unwrap_or(light.medium)
    }

    /// True if `position` lies in the emissive medium `light`, as far as a ray from there towards `direction` can show.
    #[inline]
    pub fn is_lit(&self, light: u32, position: Vec3, direction: Vec3) -> bool {
        let Light { clearings, medium, .. } = &self.lights.all[light as usize];
        let known = clearings.as_ref().and_then(|clearings| clearings.holds(position, &self.geometry));
        known.unwrap_or_else(|| self.is_within(*medium, position, direction))
    }

    #[inline(never)]
    fn is_within(&self, medium: MediumIndex, position: Vec3, direction: Vec3) -> bool {
        let base = self.locator().along(position, direction).unwrap_or(self.media_map.outside);
        lies_in(self.media_map.overlaps.as_deref(), base, medium, position, direction)
    }

    /// The media that `medium` is: those of a region where several may overlap, else itself.
    #[inline]
    pub fn components<'a>(&'a self, medium: &'a MediumIndex) -> &'a [MediumIndex] {
        let region = self.media_map.overlaps.as_ref().and_then(|overlaps| overlaps.members_of(*medium));
        region.unwrap_or(std::slice::from_ref(medium))
    }
}
