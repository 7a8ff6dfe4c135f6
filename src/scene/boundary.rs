//! The media on the two sides of shapes, and what the sides that a ray hits say about the medium it runs
//! through.

use super::{Surface, accel::Geometry};
use crate::{
    math::{Vec3, offset, vec2, warp},
    medium::MediumIndex,
    shape::{Ray, SurfacePoint},
};

/// The media on the two sides of a shape; none where nothing is known about a side.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Boundary {
    /// Behind the surface, where the normal points away from.
    pub interior: Option<MediumIndex>,
    /// In front of the surface.
    pub exterior: Option<MediumIndex>,
}

impl Boundary {
    /// What a file states. Light that gets through a surface must be in some medium behind it: if one side is stated,
    /// the other is vacuum, as in Mitsuba. Nothing gets through an opaque one, and a side that is not stated says
    /// nothing.
    pub fn stated(interior: Option<MediumIndex>, exterior: Option<MediumIndex>, transmits: bool) -> Self {
        if !transmits || (interior.is_none() && exterior.is_none()) {
            return Self { interior, exterior };
        }
        let side = |stated: Option<MediumIndex>| Some(stated.unwrap_or(MediumIndex::VACUUM));
        Self { interior: side(interior), exterior: side(exterior) }
    }

    /// True if a medium is known on some side.
    pub fn is_known(&self) -> bool {
        self.interior.is_some() || self.exterior.is_some()
    }

    /// Only one of the sides is known.
    pub fn is_half_known(&self) -> bool {
        self.interior.is_some() != self.exterior.is_some()
    }

    /// The medium on the side whose directions have this `cosine` to the normal.
    #[inline]
    pub fn side(&self, cosine: f32) -> Option<MediumIndex> {
        if cosine > 0.0 { self.exterior } else { self.interior }
    }
}

/// A side of a boundary that a ray has hit.
#[derive(Clone, Copy, Debug)]
pub struct Side {
    /// The medium of the ray.
    pub medium: MediumIndex,
    /// The shape.
    pub shape: u32,
    /// Where.
    pub position: Vec3,
    /// It was hit from its inside.
    inside: bool,
    /// Its faces may coincide with another's (see [`touching`]).
    touching: bool,
}

impl Side {
    /// Where two shapes share a face, a ray hits one of the two, and which one is chance: from within one
    /// shape, a hit on the other's face says that the ray is outside of the other, which is true but does not
    /// answer the question.
    pub fn is_doubtful(&self) -> bool {
        self.touching && !self.inside
    }

    /// What was hit from `origin`, without doubt: rays in other directions are searched for a side that is
    /// hit from its inside. No ray that starts outside hits a side from its inside.
    pub fn undoubted(self, geometry: &Geometry, surfaces: &[Surface], origin: Vec3) -> Self {
        if !self.is_doubtful() {
            return self;
        }
        let look = |direction: Vec3| {
            let ray = Ray { origin, direction, t_max: f32::INFINITY };
            if let Met::Side(side) = first(geometry, surfaces, ray, true) { Some(side) } else { None }
        };
        let mut others = (0..DIRECTIONS).step_by(4).map(direction).filter_map(look);
        others.find(|side| side.inside).unwrap_or(self)
    }
}

/// What a ray hits that has to do with media. Surfaces that light passes and that separate no media do not count.
#[derive(Clone, Copy, Debug)]
pub enum Met {
    /// A side of which the medium is known.
    Side(Side),
    /// An opaque surface of which this side's medium is not known.
    Wall {
        /// The point.
        point: SurfacePoint,
        /// The other side's medium is known: as in Mitsuba this one's is then vacuum, unless there is evidence.
        half_known: bool,
    },
    /// Nothing up to the end of the ray.
    Nothing,
}

/// Most surfaces that a ray is followed through: it cannot hit more than there are, except a sphere twice;
/// the bound ends even a faulty loop.
pub const MOST_SURFACES: u32 = 10_000;

/// The first thing that `ray` hits. Where `through_walls`, opaque surfaces are passed if they say nothing.
pub fn first(geometry: &Geometry, surfaces: &[Surface], mut ray: Ray, through_walls: bool) -> Met {
    for _ in 0..MOST_SURFACES {
        let Some(hit) = geometry.closest(&ray) else { return Met::Nothing };
        let point = geometry.surface(&ray, &hit);
        let Surface { boundary, touching, transmits, .. } = surfaces[point.shape as usize];
        let inside = point.normal.dot(ray.direction) >= 0.0;
        let (shape, position) = (point.shape, point.position);
        match if inside { boundary.interior } else { boundary.exterior } {
            Some(medium) => return Met::Side(Side { medium, shape, position, inside, touching }),
            None if transmits || through_walls => {}
            None => return Met::Wall { point, half_known: boundary.is_half_known() },
        }
        let origin = offset::leave_surface(point.position, point.error, point.normal, ray.direction);
        ray.t_max -= (origin - ray.origin).dot(ray.direction);
        ray.origin = origin;
    }
    Met::Nothing
}

/// For every shape, whether its boundary may share faces with that of another: their boxes overlap, and
/// neither lies within the other.
pub fn touching(geometry: &Geometry, surfaces: &[Surface]) -> Vec<bool> {
    let bounding: Vec<usize> = (0..surfaces.len()).filter(|i| surfaces[*i].boundary.is_known()).collect();
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

/// Another shape that has a face at `point` too.
pub fn sharing(geometry: &Geometry, point: &SurfacePoint) -> Option<u32> {
    let reach = 4.0 * offset::gamma(32) * point.position.abs().max_element() + point.error.max_element();
    let [above, below] = [reach, -reach].map(|by| point.position + point.normal * by);
    let mut ray = Ray { origin: above, direction: -point.normal, t_max: above.distance(below) };
    for _ in 0..4 {
        let hit = geometry.closest(&ray)?;
        let shape = geometry.shape_of(&hit);
        if shape != point.shape {
            return Some(shape);
        }
        let met = geometry.surface(&ray, &hit);
        let origin = offset::leave_surface(met.position, met.error, met.normal, ray.direction);
        ray = Ray { origin, t_max: (below - origin).dot(ray.direction), ..ray };
    }
    None
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

/// Directions of [`direction`], spread evenly over the sphere.
pub const DIRECTIONS: u32 = 32;

/// Direction `index` of a golden-angle spiral.
pub fn direction(index: u32) -> Vec3 {
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

    #[test]
    fn an_unstated_side_is_vacuum_only_where_light_gets_through() {
        let fog = Some(MediumIndex(1));
        assert_eq!(Boundary::stated(fog, None, true).exterior, Some(MediumIndex::VACUUM));
        assert_eq!(Boundary::stated(None, fog, true).interior, Some(MediumIndex::VACUUM));
        assert_eq!(Boundary::stated(fog, None, false), Boundary { interior: fog, exterior: None });
        assert_eq!(Boundary::stated(None, None, true), Boundary::default());
    }
}
