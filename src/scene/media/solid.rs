//! What a closed shape holds: the one inside test.

use crate::{
    math::{Bounds, Vec3},
    sampling::{Stream, stream::Purpose},
    scene::accel::Geometry,
    shape::{Ray, Shape, SurfacePoint},
};

/// A closed shape by itself.
#[derive(Clone, Debug)]
pub(crate) struct Solid {
    geometry: Geometry,
    /// Its normals point away from what it holds.
    outward: bool,
}

impl Solid {
    /// `shape`, closed by `lids` if it is open.
    pub(crate) fn new(shape: &Shape, lids: &[Shape]) -> Self {
        let geometry = Geometry::build(std::iter::once(shape).chain(lids).cloned().collect());
        let outward = is_outward(&geometry);
        Self { geometry, outward }
    }

    /// True if the normals point away from what it holds.
    pub(crate) fn is_outward(&self) -> bool {
        self.outward
    }

    /// The box around it.
    pub(crate) fn bounds(&self) -> Bounds {
        self.geometry.bounds()
    }

    /// A point on it, its lids left out, uniform by area.
    pub(crate) fn sample_area(&self, stream: &mut Stream) -> SurfacePoint {
        self.geometry.sample_area(0, stream)
    }

    /// True if `position`, which is not on it, lies within. `direction` is where to look for its surface: any does.
    pub(crate) fn holds(&self, position: Vec3, direction: Vec3) -> bool {
        if !self.bounds().contains(Bounds::of(position)) {
            return false;
        }
        let ray = Ray { origin: position, direction, t_max: f32::INFINITY };
        self.geometry.closest(&ray).is_some_and(|hit| {
            let normal = self.geometry.surface(&ray, &hit).normal;
            (normal.dot(direction) > 0.0) == self.outward
        })
    }
}

/// True if the normals of a closed shape point away from what it holds: a ray along one meets as many surfaces on its way
/// out as back in.
fn is_outward(shape: &Geometry) -> bool {
    let mut stream = Stream::new(6, 0, 0, Purpose::Pilot);
    let start = shape.sample_area(0, &mut stream);
    shape.march(start.leaving(start.normal)).count().is_multiple_of(2)
}
