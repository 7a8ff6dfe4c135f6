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

/// What the first boundary along a ray says of the medium before it.
struct Claim {
    medium: MediumIndex,
    /// The boundary is seen from its inside.
    inside: bool,
    /// Its faces may be another's too (see [`touching`]).
    touching: bool,
}

/// The medium in front of the first boundary along a ray. Surfaces that do not separate media do not matter.
///
/// Where two shapes share a face, a ray meets one of the two, and which one is chance: seen from within one shape, the
/// other's face says that one is outside of it, which is true and not the question. Other directions are asked then,
/// for a boundary that is seen from its inside: no ray meets one that starts outside.
pub fn ask(geometry: &Geometry, surfaces: &[Surface], origin: Vec3, direction: Vec3) -> Option<MediumIndex> {
    let first = claim(geometry, surfaces, origin, direction)?;
    if first.inside || !first.touching {
        return Some(first.medium);
    }
    let others = (0..DIRECTIONS).step_by(4).map(self::direction);
    let inside = others
        .filter_map(|other| claim(geometry, surfaces, origin, other))
        .find(|claim| claim.inside)
        .map(|claim| claim.medium);
    inside.or(Some(first.medium))
}

fn claim(geometry: &Geometry, surfaces: &[Surface], origin: Vec3, direction: Vec3) -> Option<Claim> {
    let mut ray = Ray { origin, direction, t_max: f32::INFINITY };
    // A ray cannot meet more surfaces than there are, but a sphere twice; the bound ends even a faulty one.
    for _ in 0..10_000 {
        let hit = geometry.closest(&ray)?;
        let point = geometry.surface(&ray, &hit);
        let Surface { boundary, touching, .. } = surfaces[point.shape as usize];
        if let Some(boundary) = boundary {
            let inside = point.normal.dot(direction) >= 0.0;
            let medium = if inside { boundary.interior } else { boundary.exterior };
            return Some(Claim { medium, inside, touching });
        }
        ray.origin = offset::leave_surface(point.position, point.error, point.normal, direction);
    }
    None
}

/// For every shape, whether its boundary may share faces with that of another: their boxes meet, and neither
/// lies within the other.
pub fn touching(geometry: &Geometry, surfaces: &[Surface]) -> Vec<bool> {
    let bounding: Vec<usize> = (0..surfaces.len()).filter(|i| surfaces[*i].boundary.is_some()).collect();
    let boxes: Vec<(Vec3, Vec3)> = bounding.iter().map(|i| geometry.shapes()[*i].bounds()).collect();
    let mut touching = vec![false; surfaces.len()];
    for (i, a) in boxes.iter().enumerate() {
        for (j, b) in boxes.iter().enumerate().skip(i + 1) {
            if meet(*a, *b) {
                (touching[bounding[i]], touching[bounding[j]]) = (true, true);
            }
        }
    }
    touching
}

/// True if the surfaces of two boxes, given by least and greatest corner, have points in common up to rounding.
fn meet(a: (Vec3, Vec3), b: (Vec3, Vec3)) -> bool {
    let reach = a.0.abs().max(a.1.abs()).max(b.0.abs()).max(b.1.abs());
    let slack = offset::gamma(32) * reach.max_element();
    let apart = a.0.cmpgt(b.1 + slack).any() || b.0.cmpgt(a.1 + slack).any();
    let within =
        |a: (Vec3, Vec3), b: (Vec3, Vec3)| a.0.cmpgt(b.0 + slack).all() && a.1.cmplt(b.1 - slack).all();
    !(apart || within(a, b) || within(b, a))
}

/// Direction `index` of a golden-angle spiral.
fn direction(index: u32) -> Vec3 {
    let turn = (index as f32 * 0.618_034).fract();
    warp::to_sphere(vec2((index as f32 + 0.5) / DIRECTIONS as f32, turn))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_meet_where_their_surfaces_do() {
        let cube = |low: f32, high: f32| (Vec3::splat(low), Vec3::splat(high));
        let right_of = |x: f32| (Vec3::new(x, -1.0, -1.0), Vec3::new(x + 1.0, 1.0, 1.0));
        let unit = cube(-1.0, 1.0);
        for (name, other, expected) in [
            ("itself", unit, true),
            ("a neighbour", right_of(1.0), true),
            ("a neighbour up to rounding", right_of(1.0f32.next_up()), true),
            ("one across a gap", right_of(1.001), false),
            ("one that overlaps", right_of(0.5), true),
            ("one inside", cube(-0.9, 0.9), false),
            ("one inside against a face", (Vec3::splat(-0.9), Vec3::new(1.0, 0.9, 0.9)), true),
            ("one around", cube(-2.0, 2.0), false),
        ] {
            assert_eq!((meet(unit, other), meet(other, unit)), (expected, expected), "{name}");
        }
    }
}
