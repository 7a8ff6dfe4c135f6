//! Parallel projection: Mitsuba's `orthographic`.

use super::{ALL, CLIP, Clip, Crop, Projection, SensorRay};
use crate::{
    description::{Params, Table, table},
    error::Result,
    math::{DMat3, DMat4, DVec3, Mat3, Vec2, Vec3, warp},
    shape::Ray,
};
use std::f64::consts::PI;

/// Where the rays start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Extent {
    /// All over the film.
    Rectangle,
    /// All over a disc, of which one pixel is the image.
    Disc,
    /// At one point. No light subpath finds the one ray from there.
    Ray,
}

/// A film that sees along one direction only. Before `to_world` it covers [-1, 1] across, its height by the
/// film's aspect; scales change its size.
#[derive(Clone, Debug)]
pub struct Orthographic {
    /// The plugin name.
    pub(super) name: &'static str,
    extent: Extent,
    /// The film position (0, 0), on the near clip plane; of a disc its middle.
    corner: Vec3,
    /// From one pixel to the next across, and down; of a disc two half axes.
    steps: [Vec3; 2],
    /// Unit direction of sight.
    direction: Vec3,
    /// From a point relative to `corner` to such steps and distance along `direction`.
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
            name: "orthographic",
            extent: Extent::Rectangle,
            corner: corner.as_vec3(),
            steps: [across.as_vec3(), down.as_vec3()],
            direction: direction.as_vec3(),
            to_film: DMat3::from_cols(across, down, direction).inverse().as_mat3(),
            reach: clip.far - clip.near,
            pdf: (1.0 / area) as f32,
            position: film(0.5 * width, 0.5 * height).as_vec3(),
        })
    }

    /// Of one pixel, without clip distances: rays in unit `direction` from around `middle`, half `axes` far.
    pub(super) fn spanned(
        name: &'static str,
        middle: DVec3,
        axes: [DVec3; 2],
        direction: DVec3,
        extent: Extent,
    ) -> Self {
        let [x, y] = axes;
        let (corner, steps) = match extent {
            Extent::Rectangle => (middle - x - y, [2.0 * x, 2.0 * y]),
            Extent::Disc | Extent::Ray => (middle, axes),
        };
        let across = steps[0].cross(steps[1]).dot(direction).abs();
        let area = match extent {
            Extent::Rectangle => across,
            Extent::Disc => PI * across,
            Extent::Ray => 1.0,
        };
        Self {
            name,
            extent,
            corner: corner.as_vec3(),
            steps: steps.map(|step| step.as_vec3()),
            direction: direction.as_vec3(),
            to_film: DMat3::from_cols(steps[0], steps[1], direction).inverse().as_mat3(),
            reach: f32::INFINITY,
            pdf: (1.0 / area) as f32,
            position: middle.as_vec3(),
        }
    }

    /// True if light subpaths can be connected to it.
    #[inline(always)]
    pub fn is_connectible(&self) -> bool {
        self.extent != Extent::Ray
    }

    /// The middle of the film.
    pub fn position(&self) -> Vec3 {
        self.position
    }

    /// The ray through a film position.
    #[inline]
    pub fn ray(&self, film: Vec2) -> SensorRay {
        let at = if self.extent == Extent::Disc { warp::to_disk(film) } else { film };
        let position = self.corner + self.steps[0] * at.x + self.steps[1] * at.y;
        let ray = Ray { origin: position, direction: self.direction, t_max: self.reach };
        SensorRay { position, ray, pdf: self.pdf }
    }

    /// How `point` is seen; none where it lies outside the clip planes or the disc, or nothing can be connected.
    #[inline]
    pub fn project(&self, point: Vec3) -> Option<Projection> {
        let seen = self.to_film * (point - self.corner);
        let film = match self.extent {
            Extent::Rectangle => seen.truncate(),
            Extent::Disc if seen.truncate().length_squared() <= 1.0 => warp::from_disk(seen.truncate()),
            Extent::Disc | Extent::Ray => return None,
        };
        if seen.z <= 0.0 || seen.z >= self.reach {
            return None;
        }
        let origin = point - self.direction * seen.z;
        let ray = Ray { origin, direction: self.direction, t_max: self.reach };
        Some(Projection { film, ray, distance_squared: 1.0, pdf: self.pdf })
    }
}
