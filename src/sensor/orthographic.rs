//! Parallel projection: Mitsuba's `orthographic`.

use super::{ALL, CLIP, Clip, Crop, Projection, SensorRay};
use crate::{
    description::{Params, Table, table},
    error::Result,
    math::{DMat3, DMat4, DVec3, Mat3, Vec2, Vec3, vec2},
    shape::Ray,
};

/// A film that sees along one direction only. Before `to_world` it covers [-1, 1] across, its height by the
/// film's aspect; scales change its size.
#[derive(Clone, Debug)]
pub struct Orthographic {
    /// The film position (0, 0), on the near clip plane.
    corner: Vec3,
    /// From one pixel to the next across, and down.
    steps: [Vec3; 2],
    /// Unit direction of sight.
    direction: Vec3,
    /// From a point relative to `corner` to film position and distance along `direction`.
    to_film: Mat3,
    /// Distance from the near to the far clip plane along `direction` (m).
    reach: f32,
    /// Pixels per area across the rays (pixels/m^2).
    pdf: f32,
    /// The middle of the film.
    position: Vec3,
}

impl Orthographic {
    pub(super) const TABLE: Table = table! {
        "Parallel rays along +z: before `to_world` the film covers [-1, 1] across.";
        transform("to_world", "Position, direction and, by scales, size."),
        ignored("focus_distance", "parallel rays have no focus");
        CLIP, ALL
    };

    /// Reads Mitsuba's parameters (except film, sampler and medium). As there, the near clip distance is in the
    /// units of `to_world`, that between near and far in those of the world.
    pub(super) fn build(params: &Params<'_>, recentre: DVec3, crop: Crop) -> Result<Self> {
        let to_world = DMat4::from_translation(-recentre) * params.transform("to_world")?;
        let clip = Clip::build(params)?;
        let [width, height] = crop.film.map(f64::from);
        let film = |x: f64, y: f64| {
            let local = DVec3::new(1.0 - 2.0 * x / width, (height - 2.0 * y) / width, f64::from(clip.near));
            to_world.transform_point3(local)
        };
        let [left, top] = crop.offset.map(f64::from);
        let corner = film(left, top);
        let (across, down) = (film(left + 1.0, top) - corner, film(left, top + 1.0) - corner);
        let direction = to_world.transform_vector3(DVec3::Z).normalize();
        let area = across.cross(down).dot(direction).abs();
        Ok(Self {
            corner: corner.as_vec3(),
            steps: [across.as_vec3(), down.as_vec3()],
            direction: direction.as_vec3(),
            to_film: DMat3::from_cols(across, down, direction).inverse().as_mat3(),
            reach: clip.far - clip.near,
            pdf: (1.0 / area) as f32,
            position: film(0.5 * width, 0.5 * height).as_vec3(),
        })
    }

    /// Without clip distances: rays in unit `direction` from `corner` on, one pixel from the next by `steps`.
    pub(super) fn endless(corner: DVec3, steps: [DVec3; 2], direction: DVec3) -> Self {
        let [across, down] = steps;
        Self {
            corner: corner.as_vec3(),
            steps: [across.as_vec3(), down.as_vec3()],
            direction: direction.as_vec3(),
            to_film: DMat3::from_cols(across, down, direction).inverse().as_mat3(),
            reach: f32::INFINITY,
            pdf: (1.0 / across.cross(down).dot(direction).abs()) as f32,
            position: (corner + 0.5 * (across + down)).as_vec3(),
        }
    }

    /// The middle of the film.
    pub fn position(&self) -> Vec3 {
        self.position
    }

    /// The ray through a film position.
    #[inline]
    pub fn ray(&self, film: Vec2) -> SensorRay {
        let position = self.corner + self.steps[0] * film.x + self.steps[1] * film.y;
        let ray = Ray { origin: position, direction: self.direction, t_max: self.reach };
        SensorRay { position, ray, pdf: self.pdf }
    }

    /// How `point` is seen; none where it lies outside the clip planes.
    #[inline]
    pub fn project(&self, point: Vec3) -> Option<Projection> {
        let seen = self.to_film * (point - self.corner);
        if seen.z <= 0.0 || seen.z >= self.reach {
            return None;
        }
        let origin = point - self.direction * seen.z;
        let ray = Ray { origin, direction: self.direction, t_max: self.reach };
        Some(Projection { film: vec2(seen.x, seen.y), ray, distance_squared: 1.0, pdf: self.pdf })
    }
}
