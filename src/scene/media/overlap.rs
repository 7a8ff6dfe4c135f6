//! Media whose boundaries overlap: which of them lie at a point.
//!
//! A closed boundary replaces its exterior by its interior. Where several hold a point, each does so. Overlapping media
//! are all there, and their coefficients add; a medium of two boundaries is there once. A bubble takes away the medium
//! that it states as its exterior, whichever boundary put it there, unless that boundary lies within the bubble. That
//! depends on the point alone, so camera and light subpaths cannot differ. They would if each crossing switched from
//! one medium to another.
//!
//! Only scenes whose boundaries overlap have this. Walks then carry the index of a region, which follows the indices of
//! media. A region has a base, the medium without these boundaries (walks find it as in other scenes), and the
//! boundaries that hold the current part of the ray.

use super::{boundary::Boundary, locate::Survey, solid::Solid};
use crate::{
    math::{Bounds, RaySegment, Vec3, vec3, warp},
    medium::{Medium, MediumIndex},
    sampling::{Stream, stream::Purpose},
    scene::{accel::Geometry, surface::Surface},
    shape::{Shape, ShapeModel as _},
};
use std::collections::{BTreeSet, HashMap, VecDeque};

/// Points at which each pair of boundaries is examined, and how many tests of all of these may take.
const POINTS: u64 = 64;
const MOST_TESTS: u64 = 200_000_000;

/// Larger shapes are examined only if rays show that they overlap others.
const MOST_PRIMITIVES: usize = 100_000;

/// Beyond this number, regions are not enumerated but looked for.
const FORESEEN: usize = 4096;

/// Points at which they are looked for.
const LOOKS: u32 = 50_000;

/// The boundaries of a scene that overlap, and what lies where.
#[derive(Clone, Debug, Default)]
pub struct Overlaps {
    boundaries: Vec<ClosedBoundary>,
    /// How many media there are besides.
    media: usize,
    regions: Vec<Region>,
    /// Maps a medium or region, and the number of one more boundary, to the region with that one too. Boundaries are
    /// added in ascending order.
    next: HashMap<(MediumIndex, usize), MediumIndex>,
    /// Numbers of boundaries, the first of which lies within the second.
    nested: BTreeSet<(usize, usize)>,
}

/// A closed shape that bounds a medium.
#[derive(Clone, Debug)]
struct ClosedBoundary {
    shape: u32,
    solid: Solid,
    /// What it adds.
    inside: MediumIndex,
    /// What it takes away.
    outside: MediumIndex,
}

/// What lies where some of the boundaries are.
#[derive(Clone, Debug)]
struct Region {
    base: MediumIndex,
    /// The numbers of the boundaries, in ascending order.
    held: Vec<usize>,
    /// What is there, vacuum left out.
    members: Vec<MediumIndex>,
}

impl Overlaps {
    /// Finds the closed boundaries that overlap, by points that they hold or by what rays of a `survey` met, and all
    /// that lie in or across these.
    pub fn find(geometry: &Geometry, surfaces: &[Surface], survey: &Survey) -> Self {
        let closed = |shape: &u32| {
            let Surface { boundary, transmits, .. } = surfaces[*shape as usize];
            transmits && boundary.is_known() && geometry.shapes()[*shape as usize].is_closed()
        };
        let mut chosen: BTreeSet<u32> = survey.shapes().into_iter().filter(closed).collect();
        let near = Near::of(geometry, (0..surfaces.len() as u32).filter(closed).collect());
        let new = |shape: u32| ClosedBoundary::new(&geometry.shapes()[shape as usize], &[], surfaces, shape);
        let small = |shape: &u32| geometry.shapes()[*shape as usize].primitive_count() <= MOST_PRIMITIVES;
        let examined: Vec<_> = near.shapes().into_iter().filter(small).map(new).collect();
        chosen.extend(near.contradictory(&examined));
        near.spread(&mut chosen);
        Self { boundaries: chosen.into_iter().map(new).collect(), ..Self::default() }
    }

    /// Another boundary: `shape`, which is number `index` and closed by `lids`.
    pub fn add(&mut self, shape: &Shape, lids: &[Shape], surfaces: &[Surface], index: u32) {
        self.boundaries.push(ClosedBoundary::new(shape, lids, surfaces, index));
    }

    /// True where nothing overlaps.
    pub fn is_empty(&self) -> bool {
        self.boundaries.is_empty()
    }

    /// Takes these boundaries from `surfaces`, which then describe the media without them. Walls lose media that are
    /// only a part of what lies there.
    pub fn take_from(&self, surfaces: &mut [Surface]) {
        for boundary in &self.boundaries {
            surfaces[boundary.shape as usize].boundary = Boundary::default();
        }
        let added = self.added(None);
        let unless_added = |side: Option<MediumIndex>| side.filter(|medium| !added.contains(medium));
        for surface in surfaces.iter_mut().filter(|surface| !surface.transmits) {
            surface.boundary.interior = unless_added(surface.boundary.interior);
            surface.boundary.exterior = unless_added(surface.boundary.exterior);
        }
    }

    /// Finds the regions on top of each of `bases`, for this many `media`: all that boxes of boundaries allow, smaller
    /// sets of boundaries first; if very many, those that hold points.
    pub fn find_regions(&mut self, media: usize, bases: &BTreeSet<u32>) {
        self.media = media;
        self.find_nested();
        let starts = bases.iter().map(|base| (MediumIndex(*base), 0, Bounds::ENDLESS));
        let mut waiting: VecDeque<_> = starts.collect();
        while let Some((from, first, within)) = waiting.pop_front() {
            for index in first..self.boundaries.len() {
                if self.regions.len() >= FORESEEN {
                    return self.look_for_regions(bases);
                }
                if let Some(within) = within.common(self.boundaries[index].solid.bounds()) {
                    waiting.push_back((self.with(from, index), index + 1, within));
                }
            }
        }
    }

    /// Adds the regions of points that are spread over the boxes of all boundaries.
    fn look_for_regions(&mut self, bases: &BTreeSet<u32>) {
        let mut stream = Stream::new(8, 0, 0, Purpose::Pilot);
        for _ in 0..LOOKS {
            let bounds = self.boundaries[stream.below(self.boundaries.len())].solid.bounds();
            let (position, direction) = (within(bounds, &mut stream), warp::to_sphere(stream.square()));
            let holding: Vec<usize> = self.holding(position, direction).collect();
            for base in bases {
                holding.iter().fold(MediumIndex(*base), |region, index| self.with(region, *index));
            }
        }
    }

    /// The region within boundary number `index` too.
    fn with(&mut self, from: MediumIndex, index: usize) -> MediumIndex {
        if let Some(known) = self.next.get(&(from, index)) {
            return *known;
        }
        let new = MediumIndex((self.media + self.regions.len()) as u32);
        let (base, mut held) =
            (self.base(from), self.region(from).map_or(vec![], |region| region.held.clone()));
        held.push(index);
        let members = self.members(base, &held);
        self.regions.push(Region { base, held, members });
        self.next.insert((from, index), new);
        new
    }

    /// What is there within the boundaries that are `held` over `base`, vacuum left out.
    fn members(&self, base: MediumIndex, held: &[usize]) -> Vec<MediumIndex> {
        let added = held.iter().map(|index| (self.boundaries[*index].inside, Some(*index)));
        let there = [(base, None)].into_iter().chain(added).filter(|(medium, by)| {
            *medium != MediumIndex::VACUUM && !held.iter().any(|taker| self.takes(*taker, *medium, *by))
        });
        there.map(|(medium, _)| medium).collect::<BTreeSet<_>>().into_iter().collect()
    }

    /// True if boundary `taker` takes away a `medium` that boundary `by`, or none, put there.
    fn takes(&self, taker: usize, medium: MediumIndex, by: Option<usize>) -> bool {
        let is_spared = by.is_some_and(|by| by == taker || self.nested.contains(&(by, taker)));
        self.boundaries[taker].outside == medium && !is_spared
    }

    /// Finds which boundaries lie within which.
    fn find_nested(&mut self) {
        let numbers = 0..self.boundaries.len();
        let pairs = numbers.clone().flat_map(|inner| numbers.clone().map(move |outer| (inner, outer)));
        let is_nested = |(inner, outer): &(usize, usize)| {
            inner != outer && self.boundaries[*outer].contains(&self.boundaries[*inner])
        };
        self.nested = pairs.filter(is_nested).collect();
    }

    /// The boundaries that hold `position`, in order.
    fn holding(&self, position: Vec3, direction: Vec3) -> impl Iterator<Item = usize> {
        let holds = move |(_, boundary): &(usize, &ClosedBoundary)| boundary.solid.holds(position, direction);
        self.boundaries.iter().enumerate().filter(holds).map(|(index, _)| index)
    }

    /// What the regions are made of, in the order of their indices, which follow those of `media`.
    pub fn build(&self, media: &[Medium]) -> Vec<Medium> {
        let medium = |region: &Region| match region.members.as_slice() {
            [] => Medium::vacuum(),
            [one] => media[one.0 as usize].clone(),
            several => Medium::mixture(several.iter().map(|one| media[one.0 as usize].clone()).collect()),
        };
        self.regions.iter().map(medium).collect()
    }

    /// How many boundaries they are.
    pub fn len(&self) -> usize {
        self.boundaries.len()
    }

    /// How many media there are that are no regions.
    pub fn media(&self) -> usize {
        self.media
    }

    /// The media of each region.
    pub fn regions(&self) -> impl Iterator<Item = &[MediumIndex]> {
        self.regions.iter().map(|region| region.members.as_slice())
    }

    /// The media of a region; none of what is itself a medium.
    pub fn members_of(&self, index: MediumIndex) -> Option<&[MediumIndex]> {
        self.region(index).map(|region| region.members.as_slice())
    }

    /// The medium that the boundary `shape` adds within; none if it overlaps no other.
    pub fn inside(&self, shape: u32) -> Option<MediumIndex> {
        self.boundaries.iter().find(|boundary| boundary.shape == shape).map(|boundary| boundary.inside)
    }

    /// What would be in the region `index` without these boundaries; of a medium itself.
    pub fn base(&self, index: MediumIndex) -> MediumIndex {
        self.region(index).map_or(index, |region| region.base)
    }

    fn region(&self, index: MediumIndex) -> Option<&Region> {
        (index.0 as usize).checked_sub(self.media).and_then(|index| self.regions.get(index))
    }

    /// The region of `part` of a ray, between two surfaces, of a walk that carries `medium`.
    #[cold]
    #[inline(never)]
    pub fn along(&self, medium: MediumIndex, part: &RaySegment) -> MediumIndex {
        // Nothing closed lies around what has no end.
        if part.length == f32::INFINITY {
            return self.base(medium);
        }
        self.at(medium, part.at(0.5 * part.length), part.direction)
    }

    /// The region at `position`; rays in any direction find the same.
    pub fn at(&self, medium: MediumIndex, position: Vec3, direction: Vec3) -> MediumIndex {
        let further = |region, index| self.next.get(&(region, index)).copied().unwrap_or(region);
        self.holding(position, direction).fold(self.base(medium), further)
    }

    /// The media that boundaries put at `position`, or anywhere.
    pub fn added(&self, position: Option<Vec3>) -> Vec<MediumIndex> {
        let there = |boundary: &&ClosedBoundary| position.is_none_or(|p| boundary.solid.holds(p, Vec3::X));
        self.boundaries.iter().filter(there).map(|boundary| boundary.inside).collect()
    }
}

/// The open boundaries that contradict others by a `survey`, and that lids can close.
pub(crate) fn open(geometry: &Geometry, surfaces: &[Surface], survey: &Survey) -> Vec<u32> {
    let closable = |shape: &u32| {
        let (Surface { transmits, .. }, model) =
            (&surfaces[*shape as usize], &geometry.shapes()[*shape as usize]);
        *transmits && !model.is_closed() && !model.lids().is_empty()
    };
    survey.shapes().into_iter().filter(closable).collect()
}

/// Closed boundaries, and which of them have points of their boxes in common.
struct Near {
    pairs: Vec<Pair>,
}

/// Two closed boundaries whose boxes have points in common.
struct Pair {
    shapes: [u32; 2],
    /// The boxes of both, and what these have in common.
    boxes: [Bounds; 3],
}

impl Near {
    fn of(geometry: &Geometry, shapes: Vec<u32>) -> Self {
        let bounds: Vec<_> = shapes.iter().map(|s| geometry.shapes()[*s as usize].bounds()).collect();
        let mut pairs = Vec::new();
        for (i, a) in bounds.iter().enumerate() {
            for (j, b) in bounds.iter().enumerate().skip(i + 1) {
                if let Some(both) = a.common(*b) {
                    pairs.push(Pair { shapes: [shapes[i], shapes[j]], boxes: [*a, *b, both] });
                }
            }
        }
        Self { pairs }
    }

    /// Those that are near others.
    fn shapes(&self) -> BTreeSet<u32> {
        self.pairs.iter().flat_map(|pair| pair.shapes).collect()
    }

    /// Boundaries that overlap: those that hold some point cannot be crossed in any order so that each finds the
    /// exterior it states, or the medium before all of them is another than elsewhere.
    fn contradictory(&self, boundaries: &[ClosedBoundary]) -> BTreeSet<u32> {
        let mut found = BTreeSet::new();
        let tests = 3 * self.pairs.len() as u64 * boundaries.len() as u64;
        let points_per_pair = (MOST_TESTS / tests.max(1)).clamp(1, POINTS);
        for (index, pair) in self.pairs.iter().enumerate() {
            let mut stream = Stream::new(7, index as u64, 0, Purpose::Pilot);
            let points = (0..points_per_pair)
                .flat_map(|_| pair.boxes)
                .map(|bounds| (within(bounds, &mut stream), warp::to_sphere(stream.square())));
            let mut around = None;
            if !points.into_iter().all(|(position, direction)| {
                let held = boundaries.iter().filter(|boundary| boundary.solid.holds(position, direction));
                let mut steps: Vec<_> = held.map(|boundary| (boundary.outside, boundary.inside)).collect();
                let first = (0..steps.len()).find(|first| follow_on(&mut steps, *first));
                let start = first.map(|first| steps[first].0);
                steps.is_empty() || (start.is_some() && *around.get_or_insert(start) == start)
            }) {
                found.extend(pair.shapes);
            }
        }
        found
    }

    /// Adds to `chosen` whatever is near it.
    fn spread(&self, chosen: &mut BTreeSet<u32>) {
        loop {
            let before = chosen.len();
            for pair in &self.pairs {
                if pair.shapes.iter().any(|shape| chosen.contains(shape)) {
                    chosen.extend(pair.shapes);
                }
            }
            if chosen.len() == before {
                return;
            }
        }
    }
}

/// True if all `steps` from one medium to another can be taken in a row, beginning with number `first`.
fn follow_on(steps: &mut Vec<(MediumIndex, MediumIndex)>, first: usize) -> bool {
    let step = steps.swap_remove(first);
    let next: Vec<usize> = (0..steps.len()).filter(|next| steps[*next].0 == step.1).collect();
    let done = steps.is_empty() || next.into_iter().any(|next| follow_on(steps, next));
    steps.push(step);
    let last = steps.len() - 1;
    steps.swap(first, last);
    done
}

/// True if `medium` is at `position`, where `base` lies without the boundaries that overlap.
pub(crate) fn lies_in(
    overlaps: Option<&Overlaps>,
    base: MediumIndex,
    medium: MediumIndex,
    position: Vec3,
    direction: Vec3,
) -> bool {
    let region = overlaps.map_or(base, |overlaps| overlaps.at(base, position, direction));
    let members = overlaps.and_then(|overlaps| overlaps.members_of(region));
    members.map_or(region == medium, |members| members.contains(&medium))
}

impl ClosedBoundary {
    /// Number `index` of a scene, closed by `lids` if it is open.
    fn new(shape: &Shape, lids: &[Shape], surfaces: &[Surface], index: u32) -> Self {
        let solid = Solid::new(shape, lids);
        let boundary = surfaces[index as usize].boundary;
        let [interior, exterior] =
            [boundary.interior, boundary.exterior].map(|side| side.unwrap_or(MediumIndex::VACUUM));
        let (inside, outside) = if solid.is_outward() { (interior, exterior) } else { (exterior, interior) };
        Self { shape: index, solid, inside, outside }
    }

    /// True if another lies within, as far as points of it show.
    fn contains(&self, other: &Self) -> bool {
        let mut stream = Stream::new(7, u64::from(other.shape), 0, Purpose::Pilot);
        let mut holds = || {
            let point = other.solid.sample_area(&mut stream);
            self.solid.holds(point.position, warp::to_sphere(stream.square()))
        };
        self.solid.bounds().contains(other.solid.bounds()) && (0..POINTS).all(|_| holds())
    }
}

/// A point of a box.
fn within(bounds: Bounds, stream: &mut Stream) -> Vec3 {
    bounds.low + bounds.size() * vec3(stream.uniform(), stream.uniform(), stream.uniform())
}
