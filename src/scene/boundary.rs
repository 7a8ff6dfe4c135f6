//! Which medium a point lies in: told by the first boundaries that rays from it meet.

use super::{Surface, accel::Geometry};
use crate::{
    math::{Vec3, offset, vec2, warp},
    medium::MediumIndex,
    shape::Ray,
};

/// Directions asked, spread evenly over the sphere.
const DIRECTIONS: u32 = 32;

/// What the rays from a point say.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Found {
    /// No boundary lies anywhere around.
    Nothing,
    /// All rays that met a boundary agree.
    Medium(MediumIndex),
    /// They disagree: the shapes do not enclose their media. The medium most of them name.
    Ambiguous(MediumIndex),
}

/// Asks rays in all directions from `point`, which must not lie on a surface.
pub fn medium_at(geometry: &Geometry, surfaces: &[Surface], point: Vec3) -> Found {
    let mut votes: Vec<(MediumIndex, u32)> = Vec::new();
    for index in 0..DIRECTIONS {
        if let Some(medium) = ask(geometry, surfaces, point, direction(index)) {
            match votes.iter_mut().find(|(voted, _)| *voted == medium) {
                Some((_, count)) => *count += 1,
                None => votes.push((medium, 1)),
            }
        }
    }
    votes.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    match votes.as_slice() {
        [] => Found::Nothing,
        [(medium, _)] => Found::Medium(*medium),
        [(medium, _), ..] => Found::Ambiguous(*medium),
    }
}

/// The medium in front of the first boundary along a ray. Surfaces that do not separate media do not matter.
pub fn ask(geometry: &Geometry, surfaces: &[Surface], origin: Vec3, direction: Vec3) -> Option<MediumIndex> {
    let mut ray = Ray { origin, direction, t_max: f32::INFINITY };
    // A ray cannot meet more surfaces than there are, but a sphere twice; the bound ends even a faulty one.
    for _ in 0..10_000 {
        let hit = geometry.closest(&ray)?;
        let point = geometry.surface(&ray, &hit);
        if let Some(boundary) = surfaces[point.shape as usize].boundary {
            let outside = point.normal.dot(direction) < 0.0;
            return Some(if outside { boundary.exterior } else { boundary.interior });
        }
        ray.origin = offset::leave_surface(point.position, point.error, point.normal, direction);
    }
    None
}

/// Direction `index` of a golden-angle spiral.
fn direction(index: u32) -> Vec3 {
    let turn = (index as f32 * 0.618_034).fract();
    warp::to_sphere(vec2((index as f32 + 0.5) / DIRECTIONS as f32, turn))
}
