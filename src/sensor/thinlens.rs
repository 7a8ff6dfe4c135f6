//! A camera with depth of field: Mitsuba's `thinlens`.

use super::{ALL, CLIP, Crop, FIELD_OF_VIEW, LENS, Projection, SensorRay, lens::Lens};
use crate::{
    description::{Params, Table, table},
    error::Result,
    math::{DVec3, Vec2, Vec3, warp},
    sampling::Stream,
};

/// A round lens without thickness. Every film position has its image on the plane of focus, and all rays from
/// there through the lens count equally.
#[derive(Clone, Debug)]
pub struct ThinLens {
    lens: Lens,
    /// Radius of the lens (m).
    radius: f32,
    /// Distance of the plane of focus, along the axis (m).
    focus: f32,
}

impl ThinLens {
    pub(super) const TABLE: Table = table! {
        "A camera with depth of field.";
        number("aperture_radius", "m", above(0.0, MAX), Required, "Radius of the lens."),
        number("focus_distance", "m", above(0.0, MAX), Said("`far_clip`"), "Distance of the plane in focus, along the axis.");
        LENS, FIELD_OF_VIEW, CLIP, ALL
    };

    pub(super) fn build(params: &Params<'_>, recentre: DVec3, crop: Crop) -> Result<Self> {
        let lens = Lens::build(params, recentre, crop)?;
        let radius = params.float("aperture_radius")?;
        let focus = params.optional_float("focus_distance")?.unwrap_or(f64::from(lens.clip.far));
        Ok(Self { lens, radius: radius as f32, focus: focus as f32 })
    }

    /// The centre of the lens.
    pub fn position(&self) -> Vec3 {
        self.lens.position
    }

    /// Uniform by area.
    #[inline]
    pub fn sample_aperture(&self, stream: &mut Stream) -> Vec2 {
        warp::to_disk(stream.square()) * self.radius
    }

    /// The ray through a film position and a point of the lens.
    #[inline]
    pub fn ray(&self, film: Vec2, aperture: Vec2) -> SensorRay {
        let lens = &self.lens;
        let local = Lens::through(lens.plane(film) - aperture / self.focus);
        let position = lens.at(aperture);
        let ray = lens.clip.ray(position, lens.frame.to_world(local), local.z);
        SensorRay { position, ray, pdf: lens.pdf(local.z) }
    }

    /// How `point` is seen through a point of the lens; none where it lies outside the clip distances.
    #[inline]
    pub fn project(&self, point: Vec3, aperture: Vec2) -> Option<Projection> {
        let local = self.lens.to_local(point) - aperture.extend(0.0);
        let distance_squared = local.length_squared();
        let seen = || self.see(local / distance_squared.sqrt(), aperture, distance_squared);
        self.lens.clip.holds(local.z).then(seen)
    }

    /// How the point at infinity in unit `direction` is seen; none behind the camera.
    #[inline]
    pub fn project_direction(&self, direction: Vec3, aperture: Vec2) -> Option<Projection> {
        let local = self.lens.frame.to_local(direction);
        (local.z > 0.0).then(|| self.see(local, aperture, 1.0))
    }

    #[inline]
    fn see(&self, local: Vec3, aperture: Vec2, distance_squared: f32) -> Projection {
        let lens = &self.lens;
        Projection {
            film: lens.film(local.truncate() / local.z + aperture / self.focus),
            ray: lens.clip.ray(lens.at(aperture), lens.frame.to_world(local), local.z),
            distance_squared,
            pdf: lens.pdf(local.z),
        }
    }
}
