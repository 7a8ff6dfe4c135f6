//! Path guiding: where light comes from at a place, and where it is seen from, learnt from paths that reach the image
//! (after P03T sec. 5.2 and Mueller et al. 2017, Practical Path Guiding). Both kinds of walks are guided, hence two
//! distributions at every place. Walks follow the guide at some of their vertices, and only where it was found to lower
//! the variance: no density becomes 0 that was not.
//!
//! With p the density of the BSDF or the phase function, a walk leaves a vertex in direction w with the density
//! ```text
//! a p(w) + (1 - a) G(w)
//! ```
//! (a is the BSDF sampling fraction of Mueller et al.). The walk from the other end leaves the same vertex towards the
//! one before, in direction w', with the density a p'(w') + (1 - a) G'(w'). G' does not depend on w: it is looked up
//! once, on arrival, and kept. A part of G aims at portals, each of them a few spheres around one centre; a little does
//! so even where no walk was seen to pass through. The rest is a table of directions from a cell of places.

mod directions;
pub mod distribution;
pub mod hierarchy;
pub mod links;
mod places;
mod radiance;
pub mod solution;

use crate::{
    bsdf::Transport,
    math::Vec3,
    sampling::{
        Basis, Cells, Stream,
        cells::Keyed,
        crossings::{self, Search},
        portal::{Passage, Portal},
        quadtree::limit,
    },
    scene::lights::{Lights, Starts},
};
use directions::{Directions, ENOUGH, Tabulator};
use links::Links;
use places::Places;
pub use radiance::{Look, Radiance, Seen};
use rayon::prelude::*;
use solution::Ending;
use std::sync::Arc;

/// What was learnt of the paths that reach the image.
#[derive(Clone, Debug, Default)]
pub struct Learnt {
    /// Where light subpaths start.
    pub starts: Option<Arc<Starts>>,
    /// Where walks go on to.
    pub guide: Option<Arc<Guide>>,
    /// What camera subpaths end in.
    pub ending: Option<Arc<Ending>>,
}

impl Learnt {
    /// The same for a scene with `lights`, at another time.
    pub fn fitting(self, lights: &Lights) -> Self {
        let starts = self.starts.and_then(|starts| starts.fitting(lights)).map(Arc::new);
        Self { starts, ..self }
    }

    /// Memory that all of it takes (bytes).
    pub fn bytes(&self) -> usize {
        let starts = self.starts.as_deref().map_or(0, Starts::bytes);
        let guide = self.guide.as_deref().map_or(0, Guide::bytes);
        starts + guide + self.ending.as_deref().map_or(0, Ending::bytes)
    }
}

/// Half the number of directions, as [`quadtree::effective`](crate::sampling::quadtree::effective) counts them, at
/// which a cell is divided.
const PER_CELL: f64 = 256.0;
/// Levels of cells below the root: there are 4,096 of surfaces, and as many of media.
const LEVELS: u32 = 12;
/// For portals. Several lessons come from one path.
const SEARCH: Search = Search { crossed: 32, judges: 1024, fewest: 5 };
/// Largest part of the weight of all directions that one may have: it may be an outlier.
const MOST: f64 = 1.0 / 1024.0;

/// A direction in which a walk should leave a vertex.
#[derive(Clone, Copy, Debug)]
pub struct Lesson {
    /// World position.
    pub position: Vec3,
    /// Unit geometric normal; none in a medium.
    pub normal: Option<Vec3>,
    /// Which walk.
    pub transport: Transport,
    /// Unit.
    pub direction: Vec3,
    /// How much it counts, at least 0, finite.
    pub weight: f32,
    /// Density of the direction by the BSDF or the phase function (1/sr).
    pub unguided: f32,
    /// To which of two independent parts of all lessons it belongs.
    pub fold: usize,
}

impl Lesson {
    /// What it teaches of portals.
    fn passage(&self) -> Passage {
        let Self { position, direction, weight, unguided, fold, .. } = *self;
        Passage { position, direction, is_parallel: false, weight, unaimed: unguided, fold }
    }
}

/// The distributions that walks follow.
#[derive(Clone, Debug, Default)]
pub struct Guide {
    places: Places,
    portals: Vec<Portal>,
    surfaces: Cells<6, u32>,
    media: Cells<3, u32>,
    /// Cells of surfaces come first.
    cells: Vec<Cell>,
    of_surfaces: usize,
    /// The part of the second moment that the guide before it left; 1 if there was none.
    pub second_moment: f64,
}

/// Directions of camera subpaths and of light subpaths.
#[derive(Clone, Debug)]
struct Cell([Option<Directions>; 2]);

/// What a walk knows of the guide at a vertex.
#[derive(Clone, Copy, Debug)]
pub struct Guidance {
    /// [`NOWHERE`] if it knows nothing.
    cell: u32,
    /// (1 - a) G' of the direction to the vertex before (1/sr).
    reverse: f32,
}

const NOWHERE: u32 = u32::MAX;

impl Guidance {
    /// There is no guide here.
    pub const NONE: Self = Self { cell: NOWHERE, reverse: 0.0 };
}

/// The index of a lesson, and the key of its cell.
struct Known<const D: usize> {
    key: [f32; D],
    weight: f32,
    index: u32,
}

impl<const D: usize> Keyed<D> for Known<D> {
    fn key(&self) -> [f32; D] {
        self.key
    }
    fn weight(&self) -> f32 {
        self.weight
    }
}

impl Guide {
    /// Learns a guide from `lessons`, in a `basis`; none where it would be no better than BSDFs and phase functions.
    /// With [`Basis::Links`] there are `links`.
    pub fn learn(mut lessons: Vec<Lesson>, basis: Basis, links: Option<&Links>) -> Option<Self> {
        if limit(&mut lessons, MOST, |lesson| &mut lesson.weight) < ENOUGH {
            return None;
        }
        let places = Places::around(lessons.iter().map(|lesson| lesson.position));
        let portals = crossings::find(lessons.iter().map(Lesson::passage), places.extent(), SEARCH);
        let mut guide = Self { places, portals, second_moment: 1.0, ..Self::default() };
        let known = || lessons.iter().enumerate().map(|(index, lesson)| (index as u32, lesson));
        let of_surfaces = known().filter_map(|(index, lesson)| {
            let key = places.facing(lesson.position, lesson.normal?);
            Some(Known { key, weight: lesson.weight, index })
        });
        let of_media = known().filter(|(_, lesson)| lesson.normal.is_none()).map(|(index, lesson)| Known {
            key: places.at(lesson.position),
            weight: lesson.weight,
            index,
        });
        let (of_surfaces, of_media): (Vec<_>, Vec<_>) = (of_surfaces.collect(), of_media.collect());
        let mut leaves = Vec::new();
        guide.surfaces = Cells::learn(of_surfaces, PER_CELL, LEVELS, |known| add(&mut leaves, known));
        guide.of_surfaces = leaves.len();
        guide.media = Cells::learn(of_media, PER_CELL, LEVELS, |known| add(&mut leaves, known));
        let portals = &guide.portals[..];
        let learn = |leaf: Vec<u32>| Cell::learn(&lessons, &leaf, portals, Tabulator { basis, links });
        guide.cells = leaves.into_par_iter().map(learn).collect();
        // What guides nothing need not be looked up.
        guide.cells.iter().any(Cell::guides).then_some(guide)
    }

    /// Notes the part of the `second_moment` that the guide before left, which walks followed to learn this one.
    pub fn judged(self, second_moment: f64) -> Self {
        Self { second_moment, ..self }
    }

    /// Without the directions of the walks opposite to `transport`, which do not run.
    pub fn only(mut self, transport: Transport) -> Self {
        self.cells.iter_mut().for_each(|cell| cell.0[index(transport.reversed())] = None);
        self
    }

    /// The guidance of a walk by `transport` that arrives from unit `incoming`. The `normal` of a surface depends on
    /// the point alone: walks from both ends, perhaps on both sides, find the same cell.
    #[inline]
    pub fn guidance(
        &self,
        position: Vec3,
        normal: Option<Vec3>,
        incoming: Vec3,
        transport: Transport,
    ) -> Guidance {
        let cell = self.cell(position, normal);
        let reverse =
            self.directions(cell, transport.reversed()).map_or(0.0, |known| known.pdf(position, incoming));
        Guidance { cell, reverse }
    }

    /// The cell of a place, with a normal as for [`Self::guidance`]; an invalid one where nothing is known.
    #[inline]
    pub fn cell(&self, position: Vec3, normal: Option<Vec3>) -> u32 {
        let cell = match normal {
            None => self.media.at(self.places.at(position)),
            Some(normal) => self.surfaces.at(self.places.facing(position, normal)),
        };
        cell.copied().unwrap_or(NOWHERE)
    }

    /// How many cells there are.
    pub fn cells(&self) -> usize {
        self.cells.len()
    }

    /// How many of them, the first ones, are of surfaces.
    pub fn cells_of_surfaces(&self) -> usize {
        self.of_surfaces
    }

    /// 1 - a: the part of the directions that walks by `transport` take from the guide in `cell`.
    pub fn guided(&self, cell: u32, transport: Transport) -> f32 {
        self.directions(cell, transport).map_or(0.0, |known| 1.0 - known.unguided)
    }

    /// G: the density of unit `direction` among those from `position`, which lies in `cell` (1/sr); none where there is none.
    pub fn density(&self, cell: u32, transport: Transport, position: Vec3, direction: Vec3) -> Option<f32> {
        let known = self.directions(cell, transport)?;
        Some(known.pdf(position, direction) / (1.0 - known.unguided))
    }

    /// The portals, the most telling first.
    pub fn portals(&self) -> &[Portal] {
        &self.portals
    }

    /// Density with which walks by `transport` leave `position`, which lies in `cell`, in unit `direction`, over their
    /// density `unguided` without the guide (1/sr, 0 for mirrors).
    pub fn ratio(
        &self,
        cell: u32,
        transport: Transport,
        (position, direction): (Vec3, Vec3),
        unguided: f32,
    ) -> f32 {
        let Some(known) = self.directions(cell, transport) else { return 1.0 };
        let guided = if unguided > 0.0 { known.pdf(position, direction) / unguided } else { 0.0 };
        known.unguided + guided
    }

    /// Memory that it takes (bytes).
    pub fn bytes(&self) -> usize {
        let tables = self.cells.iter().flat_map(|cell| cell.0.iter().flatten());
        let tables: usize = tables.map(|known| known.bytes()).sum();
        size_of_val(&self.cells[..]) + tables + self.surfaces.bytes() + self.media.bytes()
    }

    #[inline]
    fn directions(&self, cell: u32, transport: Transport) -> Option<&Directions> {
        self.cells.get(cell as usize)?.0[index(transport)].as_ref()
    }

    /// Densities of `outgoing` from `position`, and of the way back, which are `unguided` without the guide (1/sr).
    #[inline]
    pub fn pdfs(
        &self,
        guidance: Guidance,
        transport: Transport,
        position: Vec3,
        outgoing: Vec3,
        unguided: [f32; 2],
    ) -> [f32; 2] {
        let [mut fwd, mut rev] = self.unguided(guidance, transport, unguided);
        if let Some(known) = self.directions(guidance.cell, transport) {
            fwd += known.pdf(position, outgoing);
        }
        rev += guidance.reverse;
        [fwd, rev]
    }

    /// The parts of densities, or probabilities, that the guide leaves.
    #[inline]
    pub fn unguided(&self, guidance: Guidance, transport: Transport, unguided: [f32; 2]) -> [f32; 2] {
        let part = |transport| self.directions(guidance.cell, transport).map_or(1.0, |known| known.unguided);
        [part(transport) * unguided[0], part(transport.reversed()) * unguided[1]]
    }

    /// A direction by the guide; none where this one is left to the BSDF or the phase function.
    #[inline]
    pub fn sample(
        &self,
        guidance: Guidance,
        transport: Transport,
        position: Vec3,
        stream: &mut Stream,
    ) -> Option<Vec3> {
        self.directions(guidance.cell, transport)?.sample(position, stream)
    }
}

/// Adds a leaf of what is `known`; its index.
fn add<const D: usize>(leaves: &mut Vec<Vec<u32>>, known: Vec<Known<D>>) -> u32 {
    leaves.push(known.into_iter().map(|known| known.index).collect());
    leaves.len() as u32 - 1
}

impl Cell {
    fn guides(&self) -> bool {
        self.0.iter().any(Option::is_some)
    }

    fn learn(lessons: &[Lesson], leaf: &[u32], portals: &[Portal], tabulator: Tabulator<'_>) -> Self {
        let of = |transport| {
            let own = leaf.iter().map(|index| &lessons[*index as usize]);
            let own: Vec<_> = own.filter(|lesson| lesson.transport == transport).collect();
            Directions::learn(&own, portals, tabulator)
        };
        Self([Transport::Radiance, Transport::Importance].map(of))
    }
}

fn index(transport: Transport) -> usize {
    match transport {
        Transport::Radiance => 0,
        Transport::Importance => 1,
    }
}
