//! Which media the camera and the emitters of a scene lie in, with a warning for everything that is a guess.

use super::{
    boundary::Boundary,
    locate::{Certainty, Contradiction, Known, Located, Locator, Survey},
    overlap::Overlaps,
};
use crate::{
    description::{Library, Location, Position},
    emitter::{Emitter, InfiniteModel, Kind},
    math::{DVec3, Vec2, Vec3},
    medium::{MediumDescription, MediumIndex},
    sampling::{Stream, stream::Purpose},
    scene::{accel::Geometry, contact::Contact, lights::Disk, surface::Surface},
    sensor::Sensor,
    shape::SurfacePoint,
};
use std::collections::{BTreeMap, BTreeSet};

/// Points of an emitting shape that are located.
const POINTS: u32 = 64;
/// Rays of a camera whose starts are located...
const RAYS: usize = 256;
/// ... unless nothing is seen from so many.
const LOOKS: usize = 8;
/// Starts that show that a medium is there: fewer may have seen it past an edge.
const FEWEST: usize = RAYS / 50;

/// What messages call things by.
pub(crate) struct Names<'a> {
    /// Takes the warnings.
    pub library: &'a Library,
    /// Id (or plugin name) of each medium after vacuum.
    pub media: &'a [String],
    /// The ids of those that have one.
    pub ids: &'a [Option<String>],
    /// The same of each shape.
    pub shapes: &'a [String],
    /// Where each shape is in the file.
    pub locations: &'a [Location],
    /// Origin of all positions in the file's coordinates (m).
    pub recentre: DVec3,
}

impl Names<'_> {
    fn medium(&self, medium: MediumIndex) -> String {
        match medium.0.checked_sub(1) {
            Some(index) => format!("\"{}\"", self.media[index as usize]),
            None => "vacuum".to_owned(),
        }
    }

    fn shape(&self, shape: Option<u32>) -> String {
        shape.map_or("the camera or an emitter".to_owned(), |shape| {
            format!("\"{}\"", self.shapes[shape as usize])
        })
    }

    /// What to write into a camera or emitter so that it lies in `medium`.
    fn line(&self, medium: MediumIndex, location: &Location) -> String {
        let Some(index) = medium.0.checked_sub(1) else {
            return "a homogeneous medium with \"sigma_t\" 0".to_owned();
        };
        match (&self.ids[index as usize], &location.position) {
            (None, _) => "a reference to that medium (which needs an \"id\")".to_owned(),
            (Some(id), Position::Text { .. }) => format!("<ref id=\"{id}\"/>"),
            (Some(id), Position::Path(_)) => format!("\"medium\": {{\"type\": \"ref\", \"id\": \"{id}\"}}"),
        }
    }

    /// Says what `located` is if not certain; `what` is at `location`.
    fn warn(&self, located: Located, what: &str, location: &Location) {
        let (medium, line) = (self.medium(located.medium), self.line(located.medium, location));
        let text = match located.certainty {
            Certainty::Seen | Certainty::Unstated => return,
            Certainty::Contradicted([a, b]) => format!(
                "rays from {what} meet boundaries of different media, those of {} and {} among them; \
                 it is taken to lie in {medium}, which most rays meet. Close the shapes that bound media, or add \
                 {line} to it",
                self.shape(a),
                self.shape(b)
            ),
            Certainty::ThroughWalls => format!(
                "nothing between {what} and the opaque shapes around it says which medium it lies in; it is taken to \
                 lie in {medium}, which is seen behind them. Add {line} to it"
            ),
            Certainty::Assumed => format!(
                "nothing says which medium {what} lies in; it is taken to lie in {medium}, as the camera does. Add \
                 {line} to it"
            ),
        };
        self.library.warn(location, &text);
    }

    /// Shapes whose openings were closed.
    pub(crate) fn warn_of_lids(&self, open: &[u32]) {
        for &shape in open {
            let text = format!(
                "{} bounds a medium and is open: its openings are taken to be closed by flat lids",
                self.shape(Some(shape))
            );
            self.library.warn(&self.locations[shape as usize], &text);
        }
    }

    /// Shapes that are open, or overlap, in a way that nothing can put in order.
    pub(crate) fn warn_of_contradictions(&self, survey: &Survey) {
        let found = survey.proven();
        let Some((Contradiction { from, medium, at }, _)) = found.first() else { return };
        let place = at.position.as_dvec3() + self.recentre;
        let others = match found.len() {
            1 => String::new(),
            n => format!(" (and {} more such pairs)", n - 1),
        };
        let text = format!(
            "the image cannot be correct: an unobstructed ray from {} in {} reaches the side of \"{}\" in {}, near \
             {place:.3}{others}. Light that gets around open shapes is left out. Close the shapes that bound media, and \
             state the exterior of those that lie within a medium",
            self.shape(*from),
            self.medium(*medium),
            self.shapes[at.shape as usize],
            self.medium(at.medium)
        );
        self.library.warn(&self.locations[at.shape as usize], &text);
    }

    /// Warns of faces in one place whose order only the file decides: each pair of shapes once.
    pub(crate) fn warn_of_ties(&self, contacts: &[Contact]) {
        let by = contacts.iter().map(|contact| contact.by).fold(0.0, f64::max);
        let ties = contacts.iter().filter(|contact| contact.is_tie);
        let pairs: BTreeSet<[u32; 2]> =
            ties.map(|Contact { shapes: [a, b], .. }| [*a.min(b), *a.max(b)]).collect();
        for [first, second] in pairs {
            let [one, other] = [first, second].map(|shape| self.shape(Some(shape)));
            let text = format!(
                "faces of {one} and {other} lie in one place; the camera is taken to see {one} first, which comes first in \
                 the file. Move one of them by more than {by:.0e} m"
            );
            self.library.warn(&self.locations[second as usize], &text);
        }
    }

    /// No light gets to a camera at `location`.
    pub(crate) fn warn_of_camera_shut_in(&self, shape: u32, location: &Location) {
        let text = format!(
            "the camera is inside the closed opaque shape {}, and no emitter is: the image will be black. Move the \
             camera or an emitter, or give the shape a bsdf that light passes",
            self.shape(Some(shape))
        );
        self.library.warn(location, &text);
    }

    /// No camera sees `medium` in `shape`.
    pub(crate) fn warn_of_medium_shut_in(&self, medium: MediumIndex, shape: u32) {
        let text = format!(
            "the medium {} inside this closed shape is never seen: no light gets through its opaque surface. Give it \
             a \"null\" or \"dielectric\" bsdf, or remove the medium",
            self.medium(medium)
        );
        self.library.warn(&self.locations[shape as usize], &text);
    }

    /// The medium of a camera that states none is not what Mitsuba takes.
    fn warn_of_camera_in(&self, medium: MediumIndex, location: &Location) {
        let (name, line) = (self.medium(medium), self.line(medium, location));
        let text = format!(
            "the camera states no medium. By the shapes around it, it lies in {name}; Mitsuba would take vacuum. Add \
             {line} to the sensor to make both agree"
        );
        self.library.warn(location, &text);
    }

    /// The rays of a camera that states no medium start in several `media`, some of them regions of `overlaps`.
    pub(crate) fn warn_of_camera_across(
        &self,
        media: &[MediumIndex],
        overlaps: &Overlaps,
        location: &Location,
    ) {
        let name = |medium: &MediumIndex| match overlaps.members_of(*medium) {
            None => self.medium(*medium),
            Some([]) => self.medium(MediumIndex::VACUUM),
            Some(members) => {
                let names: Vec<String> = members.iter().map(|one| self.medium(*one)).collect();
                names.join(" + ")
            }
        };
        let names: Vec<String> = media.iter().map(name).collect();
        let text = format!(
            "this camera states no medium, and its rays start in several ({}): each in the one around its start. Mitsuba \
             would start all of them in vacuum",
            names.join(", ")
        );
        self.library.warn(location, &text);
    }

    /// Of the medium around everything, light has to end somewhere, and none comes in from infinity.
    pub(crate) fn warn_of_endless(
        &self,
        outside: MediumIndex,
        media: &[MediumDescription],
        sky: Option<&Location>,
    ) {
        let description = &media[outside.0 as usize];
        if let Some(location) = description.endless_emission() {
            let text = "this medium surrounds the whole scene and emits everywhere; emission is limited to the box around all shapes and the camera. Bound the medium by a shape to limit its emission yourself";
            self.library.warn(location, text);
        }
        if let Some(location) = sky
            && description.extinguishes_without_end()
        {
            let text = format!(
                "no light of this emitter arrives: {} lies around the whole scene without end. If it should fill a \
                 part of the scene only, close that by shapes, openings by a \"null\" surface with this medium as \
                 its interior",
                self.medium(outside)
            );
            self.library.warn(location, &text);
        }
    }
}

/// Finds the media of camera and emitters.
pub(crate) struct Placement<'a> {
    /// Finds media.
    pub locator: Locator<'a>,
    /// For warnings.
    pub names: &'a Names<'a>,
    /// Where nothing else is known.
    pub ambient: MediumIndex,
}

/// The medium of a camera that states none. Its ray through the middle of the image starts at `start`. A guess also
/// serves as evidence for others.
pub(crate) fn place_camera(
    geometry: &Geometry,
    surfaces: &[Surface],
    known: &mut Known,
    start: Vec3,
    names: &Names<'_>,
    location: &Location,
) -> MediumIndex {
    let locator = Locator { geometry, surfaces, known };
    let mut stream = Stream::new(3, 0, 0, Purpose::Pilot);
    let located = locator
        .locate(start, &mut stream)
        .unwrap_or(Located { medium: MediumIndex::VACUUM, certainty: Certainty::Unstated });
    names.warn(located, "the camera", location);
    if located.certainty == Certainty::Seen && located.medium != MediumIndex::VACUUM {
        names.warn_of_camera_in(located.medium, location);
    }
    if located.certainty != Certainty::Seen {
        known.add(start, located.medium);
    }
    located.medium
}

/// The media that rays of `sensor`, whose film is so large (pixels), start in, if several are seen; else none.
pub(crate) fn media_before(
    locator: &Locator<'_>,
    overlaps: Option<&Overlaps>,
    sensor: &Sensor,
    size: Vec2,
) -> Vec<MediumIndex> {
    if locator.known.is_uniform() && overlaps.is_none() {
        return Vec::new();
    }
    let mut stream = Stream::new(8, 0, 0, Purpose::Pilot);
    let mut seen: BTreeMap<MediumIndex, usize> = BTreeMap::new();
    for looks in 0..RAYS {
        if looks == LOOKS && seen.is_empty() {
            break;
        }
        let film = size * stream.square();
        let start = sensor.ray(film, sensor.sample_aperture(&mut stream)).ray.origin;
        let located = locator.locate(start, &mut stream);
        if let Some(Located { medium, certainty: Certainty::Seen }) = located {
            let there = overlaps.map_or(medium, |overlaps| overlaps.at(medium, start, Vec3::X));
            *seen.entry(there).or_default() += 1;
        }
    }
    seen.retain(|_, count| *count >= FEWEST);
    if seen.len() > 1 { seen.into_keys().collect() } else { Vec::new() }
}

impl Placement<'_> {
    fn assumed(&self) -> Located {
        Located { medium: self.ambient, certainty: Certainty::Assumed }
    }

    /// The medium of an emitter at a point.
    pub(crate) fn of_point(&self, position: Vec3, location: &Location) -> MediumIndex {
        let mut stream = Stream::new(4, 0, 0, Purpose::Pilot);
        let located = self.locator.locate(position, &mut stream).unwrap_or_else(|| self.assumed());
        self.names.warn(located, "an emitter", location);
        located.medium
    }

    /// The medium on the emitting side of a shape, and whether light of different points starts in different ones.
    pub(crate) fn of_shape(&self, shape: u32, location: &Location) -> (MediumIndex, bool) {
        self.of_points(self.before(shape), self.is_stated(shape), "an emitting shape", location)
    }

    /// What lies before points of a shape.
    fn before(&self, shape: u32) -> impl Iterator<Item = Located> {
        let mut stream = Stream::new(5, u64::from(shape), 0, Purpose::Pilot);
        (0..POINTS).map(move |_| {
            let point = self.locator.geometry.sample_area(shape, &mut stream);
            self.in_front_of(&point, &mut stream)
        })
    }

    /// The medium that a beam leaves `disk` in, and whether that of different points differs.
    pub(crate) fn of_disk(&self, disk: &Disk, location: &Location) -> (MediumIndex, bool) {
        let mut stream = Stream::new(7, 0, 0, Purpose::Pilot);
        let located = (0..POINTS).map(|_| {
            let point = disk.sample(&mut stream);
            self.locator.locate(point, &mut stream).unwrap_or_else(|| self.assumed())
        });
        self.of_points(located, false, "an emitter", location)
    }

    /// The medium of the first of points that were `located`, and whether that of others differs; `what` they are of is
    /// at `location`. Where it `is_stated`, the first is enough.
    fn of_points(
        &self,
        mut located: impl Iterator<Item = Located>,
        is_stated: bool,
        what: &str,
        location: &Location,
    ) -> (MediumIndex, bool) {
        let first = located.next().unwrap_or_else(|| self.assumed());
        // Where only one medium is possible, no other points have to be located.
        if self.locator.known.is_uniform() || is_stated {
            return (first.medium, false);
        }
        let weakest = located.max_by_key(|found| (found.medium != first.medium, rank(found.certainty)));
        let differs = weakest.is_some_and(|other| other.medium != first.medium);
        if !differs {
            let weaker = weakest.filter(|other| rank(other.certainty) > rank(first.certainty));
            self.names.warn(weaker.unwrap_or(first), what, location);
        }
        (first.medium, differs)
    }

    /// Both sides of `shape` are known.
    fn is_stated(&self, shape: u32) -> bool {
        let Boundary { interior, exterior } = self.locator.surfaces[shape as usize].boundary;
        interior.is_some() && exterior.is_some()
    }

    /// The medium on the emitting side of a point of a shape.
    fn in_front_of(&self, point: &SurfacePoint, stream: &mut Stream) -> Located {
        let towards = point.shading.normal;
        let side = self.locator.surfaces[point.shape as usize].boundary.side(point.normal.dot(towards));
        if let Some(medium) = side {
            return Located { medium, certainty: Certainty::Seen };
        }
        let origin = point.leaving(towards).origin;
        self.locator.locate(origin, stream).unwrap_or_else(|| self.assumed())
    }

    /// The medium that light from infinity comes through, and whether that differs by direction.
    pub(crate) fn of_infinite(&self, emitter: &Emitter) -> (MediumIndex, bool) {
        let infinity = &self.locator.known.infinity;
        let direction = if let Kind::Infinite(sky) = &emitter.kind { sky.direction() } else { None };
        let medium = direction.map_or(infinity.most(), |direction| infinity.towards(direction));
        (medium, !infinity.is_uniform())
    }
}

/// How weak evidence is.
fn rank(certainty: Certainty) -> u32 {
    match certainty {
        Certainty::Seen => 0,
        Certainty::Unstated => 1,
        Certainty::Contradicted(_) => 2,
        Certainty::ThroughWalls => 3,
        Certainty::Assumed => 4,
    }
}
