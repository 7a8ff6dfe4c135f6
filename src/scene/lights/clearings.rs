//! Which medium fills the space around an emissive medium, where that is certain.
//!
//! Points of light are sampled in the box around the medium, and not all of them lie in it. Locating each by rays costs
//! as much as its walk. But connected space without surfaces holds one medium. So each connected set of lattice cells
//! that no surface enters is located once.

use crate::{
    math::{Bounds, Vec3, measure},
    scene::accel::Geometry,
    shape::{CurvedModel, Primitive, Ray, ShapeModel},
    volume::Coarse,
};

/// Cells along the longest side of a box.
const CELLS: f32 = 64.0;
/// Connected parts that are located: the largest.
const MOST: usize = 64;
/// Surfaces are widened by this (cells): more than the rounding of positions.
const SLACK: f32 = 1e-3;

/// Whether cells of the box around a medium lie in it; none where surfaces are, or it is not certain.
#[derive(Clone, Debug)]
pub struct Clearings(Coarse<Option<bool>>);

impl Clearings {
    /// In the box from `low` to `high`, among the shapes of `geometry`: `holds` says of a point whether it lies in the
    /// medium, if that is certain.
    pub fn of(
        [low, high]: [Vec3; 2],
        geometry: &Geometry,
        mut holds: impl FnMut(Vec3) -> Option<bool>,
    ) -> Self {
        let lattice = Coarse::lattice(low, high, CELLS);
        let mut parts = parts(&lattice, geometry);
        parts.sort_by_key(|part| std::cmp::Reverse(part.len()));
        let mut cells = vec![None; lattice.cells().len()];
        for part in parts.iter().take(MOST) {
            let found = holds(lattice.position(part[0], Vec3::splat(0.5)));
            part.iter().for_each(|cell| cells[*cell as usize] = found);
        }
        Self(lattice.fill(|cell| cells[cell as usize]))
    }

    /// Whether `position` lies in the medium, if certain: by its cell, or by one beside it that is in sight.
    #[inline]
    pub fn holds(&self, position: Vec3, geometry: &Geometry) -> Option<bool> {
        let cell = self.0.cell_at(position)?;
        self.0.cell(cell).or_else(|| self.beside(position, geometry))
    }

    #[inline(never)]
    fn beside(&self, position: Vec3, geometry: &Geometry) -> Option<bool> {
        let edge = self.0.position(0, Vec3::ONE) - self.0.position(0, Vec3::ZERO);
        self.0.cells_around(position - edge, position + edge).find_map(|cell| {
            let known = (*self.0.cell(cell))?;
            let (direction, t_max, _) = measure::between(position, self.0.position(cell, Vec3::splat(0.5)))?;
            (!geometry.occluded(&Ray { origin: position, direction, t_max })).then_some(known)
        })
    }
}

/// The cells that no surface enters, by the connected parts that they make.
fn parts(lattice: &Coarse<()>, geometry: &Geometry) -> Vec<Vec<u32>> {
    let mut taken = entered(lattice, geometry);
    let mut parts = Vec::new();
    for first in 0..taken.len() as u32 {
        if std::mem::replace(&mut taken[first as usize], true) {
            continue;
        }
        let mut part = vec![first];
        let mut next = 0;
        while let Some(cell) = part.get(next) {
            let free = |cell: &u32| !std::mem::replace(&mut taken[*cell as usize], true);
            part.extend(lattice.neighbours(*cell).filter(free).collect::<Vec<_>>());
            next += 1;
        }
        parts.push(part);
    }
    parts
}

/// For every cell, whether a surface may enter it.
fn entered(lattice: &Coarse<()>, geometry: &Geometry) -> Vec<bool> {
    let mut entered = vec![false; lattice.cells().len()];
    let edge = lattice.position(0, Vec3::ONE) - lattice.position(0, Vec3::ZERO);
    let slack = edge.max_element() * SLACK;
    let around = |Bounds { low, high }| lattice.cells_around(low - slack, high + slack);
    for shape in geometry.shapes() {
        if around(shape.bounds()).next().is_none() {
            continue;
        }
        for primitive in (0..shape.primitive_count()).map(|index| shape.primitive(index)) {
            for cell in around(primitive.bounds()) {
                let centre = lattice.position(cell, Vec3::splat(0.5));
                entered[cell as usize] |= may_meet(&primitive, centre, 0.5 * edge + slack);
            }
        }
    }
    entered
}

/// True unless `primitive` surely misses the box around `centre` that reaches `half` along the axes. Its own box meets
/// it.
fn may_meet(primitive: &Primitive, centre: Vec3, half: Vec3) -> bool {
    match primitive {
        Primitive::Flat(flat) => (centre - flat.corner).dot(flat.normal).abs() <= half.dot(flat.normal.abs()),
        Primitive::Ball { center, radius } => (centre.distance(*center) - radius).abs() <= half.length(),
        Primitive::Curved(curved) => curved.distance(centre.as_dvec3()) <= f64::from(half.length()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        description::{Library, Value},
        math::DMat4,
        sampling::{Stream, stream::Purpose},
        shape,
        testing::object,
    };

    /// A ball in a tube in a large box: the medium is what lies between ball and tube.
    #[test]
    fn what_is_known_is_right_and_most_is_known() {
        let vector = |x, y, z| Value::Vector([x, y, z]);
        let shapes = [
            object("sphere", &[("radius", Value::Float(0.4)), ("center", vector(0.1, 0.0, 0.0))]),
            object(
                "cylinder",
                &[
                    ("radius", Value::Float(0.8)),
                    ("p0", vector(0.0, 0.0, -3.0)),
                    ("p1", vector(0.0, 0.0, 3.0)),
                ],
            ),
        ];
        let build = |object| {
            let library = Library::default();
            let (params, build) = shape::ROWS.read(object, &library).unwrap();
            build(&params, DMat4::IDENTITY).unwrap()
        };
        let geometry = Geometry::build(shapes.iter().map(build).collect());
        let between = |p: Vec3| p.truncate().length() < 0.8 && p.distance(Vec3::X * 0.1) > 0.4;
        let mut located = 0;
        let clearings = Clearings::of([Vec3::splat(-1.0), Vec3::ONE], &geometry, |p| {
            located += 1;
            Some(between(p))
        });
        // Within the ball, between, and outside of the tube.
        assert_eq!(located, 3);
        let mut stream = Stream::new(8, 0, 0, Purpose::Study);
        let mut unknown = 0;
        for _ in 0..20_000 {
            let p = 2.0 * Vec3::new(stream.uniform(), stream.uniform(), stream.uniform()) - 1.0;
            match clearings.holds(p, &geometry) {
                Some(found) => assert_eq!(found, between(p), "{p}"),
                None => unknown += 1,
            }
        }
        assert!(unknown < 20, "{unknown}");
        assert_eq!(clearings.holds(Vec3::splat(1.5), &geometry), None);
    }
}
