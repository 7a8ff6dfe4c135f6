//! The pinhole camera: Mitsuba's `perspective`.

use super::{ALL, CLIP, Crop, FIELD_OF_VIEW, LENS, Projection, SensorRay, lens::Lens};
use crate::{
    description::{Params, Table, table},
    error::Result,
    math::{DVec3, Vec2, Vec3},
};

/// A pinhole with a rectangular film.
#[derive(Clone, Debug)]
pub struct Perspective(Lens);

impl Perspective {
    pub(super) const TABLE: Table = table! {
        "A pinhole camera that looks along +z.";
        ignored("focus_distance", "a pinhole has all in focus (a thinlens has not)");
        LENS, FIELD_OF_VIEW, CLIP, ALL
    };

    pub(super) fn build(params: &Params<'_>, recentre: DVec3, crop: Crop) -> Result<Self> {
        Lens::build(params, recentre, crop).map(Self)
    }

    /// The pinhole.
    pub fn position(&self) -> Vec3 {
        self.0.position
    }

    /// The ray through a film position.
    #[inline(always)]
    pub fn ray(&self, film: Vec2) -> SensorRay {
        let Self(lens) = self;
        let local = Lens::through(lens.plane(film));
        let ray = lens.clip.ray(lens.position, lens.frame.to_world(local), local.z);
        SensorRay { position: lens.position, ray, pdf: lens.pdf(local.z) }
    }

    /// How `point` is seen; none where it lies outside the clip distances.
    #[inline(always)]
    pub fn project(&self, point: Vec3) -> Option<Projection> {
        let local = self.0.to_local(point);
        let distance_squared = local.length_squared();
        self.0.clip.holds(local.z).then(|| self.see(local / distance_squared.sqrt(), distance_squared))
    }

    /// How the point at infinity in unit `direction` is seen; none behind the camera.
    #[inline(always)]
    pub fn project_direction(&self, direction: Vec3) -> Option<Projection> {
        let local = self.0.frame.to_local(direction);
        (local.z > 0.0).then(|| self.see(local, 1.0))
    }

    #[inline(always)]
    fn see(&self, local: Vec3, distance_squared: f32) -> Projection {
        let Self(lens) = self;
        Projection {
            film: lens.film(local.truncate() / local.z),
            ray: lens.clip.ray(lens.position, lens.frame.to_world(local), local.z),
            distance_squared,
            pdf: lens.pdf(local.z),
        }
    }
}
