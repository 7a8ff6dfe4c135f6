//! Which media the camera and the emitters of a scene lie in, and which are emitters themselves.

use super::{
    Surface,
    accel::Geometry,
    boundary::{self, Found},
    lights::Light,
};
use crate::{
    description::{Library, Location},
    emitter::{Emitter, Glow},
    math::{SpectrumExt, Vec3, offset, warp},
    medium::{Blueprint, Emission, Medium, MediumIndex},
    sampling::{Stream, stream::Purpose},
};

/// Points of an emitting shape that are asked whether they lie in one medium.
const POINTS_ASKED: u32 = 256;
/// Points of a medium that shines that are asked whether they lie in it.
const POINTS_OF_LIGHT: u32 = 4096;

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

    /// The media that shine, as emitters; `outside` is where no boundary is met.
    pub fn shining<'a>(
        &'a self,
        media: &'a [Medium],
        outside: MediumIndex,
    ) -> impl Iterator<Item = Light> + use<'a> {
        (0..).zip(media).filter_map(move |(index, medium)| {
            let (emission, medium) = (medium.emission.clone()?, MediumIndex(index));
            let filled = self.filled(&emission, medium, outside);
            let emitter = Emitter::of_medium(Glow { emission, filled });
            Some(Light { emitter, position: Vec3::ZERO, shape: None, medium, straddles: false })
        })
    }

    /// The part of the power of `emission` that is emitted in `medium`, above 0.
    fn filled(&self, emission: &Emission, medium: MediumIndex, outside: MediumIndex) -> f64 {
        let mut stream = Stream::new(2, u64::from(medium.0), 0, Purpose::Pilot);
        let mut sum = [0.0, 0.0];
        for _ in 0..POINTS_OF_LIGHT {
            let point = emission.sample(&mut stream);
            let direction = warp::to_sphere(stream.square());
            let density = emission.density(point);
            // Rounding may have put it just outside.
            let share = if density > 0.0 { f64::from(emission.at(point).luminance() / density) } else { 0.0 };
            let found = boundary::ask(self.geometry, self.surfaces, point, direction).unwrap_or(outside);
            sum[0] += share;
            sum[1] += if found == medium { share } else { 0.0 };
        }
        (sum[1] / sum[0]).max(1.0 / f64::from(POINTS_OF_LIGHT))
    }

    /// Of the medium around everything, light has to end somewhere.
    pub fn warn_of_endless_light(&self, outside: &Blueprint) {
        if let Some(location) = outside.endless_emission() {
            let text = "this medium lies around the whole scene and emits without end; it is taken to emit only in the box \
                        around all shapes and the camera. Put it into a shape to say where it ends";
            self.library.warn(location, text);
        }
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
