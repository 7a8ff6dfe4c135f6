//! Which media the camera and the emitters of a scene lie in.

use super::{
    Surface,
    accel::Geometry,
    boundary::{self, Found},
};
use crate::{
    description::{Library, Location},
    math::{Vec3, offset},
    medium::MediumIndex,
    sampling::{Stream, stream::Purpose},
};

/// Points of an emitting shape that are asked whether they lie in one medium.
const POINTS_ASKED: u32 = 256;

/// Finds the media of points, with a warning where the shapes contradict each other.
pub struct Finder<'a> {
    /// All shapes.
    pub geometry: &'a Geometry,
    /// What they are made of.
    pub surfaces: &'a [Surface],
    /// Takes the warnings.
    pub library: &'a Library,
}

impl Finder<'_> {
    /// The medium around `point`, `ambient` where no boundary lies anywhere.
    pub fn around(&self, point: Vec3, ambient: MediumIndex, location: &Location, what: &str) -> MediumIndex {
        match boundary::medium_at(self.geometry, self.surfaces, point) {
            Found::Nothing => ambient,
            Found::Medium(medium) => medium,
            Found::Ambiguous(medium) => {
                let text = format!(
                    "rays from {what} meet boundaries of different media; the most frequent one is taken. \
                     Close the shapes that bound media, or name the medium of the camera in its description"
                );
                self.library.warn(location, &text);
                medium
            }
        }
    }

    /// The medium on the emitting side of a shape: the shape's own exterior, else that around points on it.
    pub fn in_front_of(&self, shape: u32, ambient: MediumIndex, location: &Location) -> MediumIndex {
        if let Some(boundary) = self.surfaces[shape as usize].boundary {
            return boundary.exterior;
        }
        let mut stream = Stream::new(0, u64::from(shape), 0, Purpose::Pilot);
        let point = self.geometry.sample_area(shape, &mut stream);
        let origin = offset::leave_surface(point.position, point.error, point.normal, point.shading.normal);
        self.around(origin, ambient, location, "an emitting shape")
    }

    /// True if rays from different points of an emitting shape start in different media; `outside` is where no
    /// boundary is met.
    pub fn straddles(&self, shape: u32, outside: MediumIndex) -> bool {
        if self.surfaces[shape as usize].boundary.is_some() {
            return false;
        }
        let mut stream = Stream::new(1, u64::from(shape), 0, Purpose::Pilot);
        let mut media = (0..POINTS_ASKED).map(|_| {
            let point = self.geometry.sample_area(shape, &mut stream);
            let towards = point.shading.normal;
            let origin = offset::leave_surface(point.position, point.error, point.normal, towards);
            boundary::ask(self.geometry, self.surfaces, origin, towards).unwrap_or(outside)
        });
        let first = media.next();
        media.any(|medium| Some(medium) != first)
    }

    /// The medium far from everything: in front of the first boundary on the way in from outside.
    pub fn far_outside(&self, ambient: MediumIndex) -> MediumIndex {
        let (low, high) = self.geometry.bounds();
        let (centre, size) = (0.5 * (low + high), (high - low).length().max(f32::MIN_POSITIVE));
        let from = |towards: Vec3| {
            boundary::ask(self.geometry, self.surfaces, centre - towards * (2.0 * size), towards)
        };
        let axes = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| (axis + Vec3::splat(0.013)).normalize());
        axes.iter().flat_map(|axis| [*axis, -*axis]).find_map(from).unwrap_or(ambient)
    }
}
