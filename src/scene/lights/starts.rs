//! Learnt starts of light subpaths: which emitter, from where at infinity, in which direction. Paths of any strategy
//! show which light subpaths reach the image. What they teach is mixed with the emitters' own distributions, so that no
//! density becomes 0. (In the manner of Vorba et al. 2014, On-line Learning of Parametric Mixture Models for Light
//! Transport Simulation, who guide emission too; the distributions are those of Mueller et al. 2017.)
//!
//! With P the probability of an emitter, p(x) the density of its point and p(w | x) that of the direction, the mixture is
//! ```text
//! a P p(x) p(w | x) + (1 - a) P' p'(x) p'(w | x)
//! ```
//! Points on shapes and in media stay as they are, p' = p, so that nothing has to be inverted; p'(w | x) is looked up
//! by position. From infinity, and for a beam, x is a direction, learnt as one. There, w becomes a point on the disk
//! that faces x, looked up by direction.
//!
//! A part of p'(w | x) aims at portals. Light of a sky comes through a hole from all directions, and for each of them the
//! hole lies elsewhere on the disk: a table needs thousands of starts to know it, a portal a few.

mod aimed;

use super::{Disk, EmitterPoint, Lights, aim::Openings};
use crate::{
    math::{Vec2, Vec3, warp},
    sampling::{
        Cells, Discrete, Quadtree, Stream,
        cells::Keyed,
        crossings::{self, Search},
        portal::{Aimed, Passage, Portal},
        quadtree::{Deposit, effective, limit},
    },
};

/// a: the part of the starts that are not learnt.
pub(super) const UNLEARNT: f32 = 0.25;
/// Fewest starts, as [`effective`] counts them, in a cell of positions.
pub(super) const PER_CELL: f64 = 256.0;
/// Levels of cells below the root.
pub(super) const LEVELS: u32 = 7;
/// Fewer starts than this, as [`effective`] counts them, make no table. The emitters' own probabilities count as so many.
const ENOUGH: f64 = 16.0;
/// For portals, of each emitter. Most starts are of different walks, so that few of them hardly cross by chance.
const SEARCH: Search = Search { crossed: 32, judges: 256, fewest: 2 };
/// Largest share of one start in the weight of all: it may be an outlier. Of few starts each may have a larger one.
const MOST: f64 = 1.0 / 256.0;
/// The same over that of an average start.
const MOST_OF_FEW: f64 = 4.0;

/// Where and which way light leaves.
#[derive(Clone, Copy, Debug)]
pub struct Start {
    /// The emitter.
    pub light: u32,
    /// The point that emits; from infinity any point of the ray.
    pub position: Vec3,
    /// Unit direction of the light.
    pub direction: Vec3,
}

impl Start {
    /// From `point` of the emitter `light` along the segment from there to `other`, in unit `direction`.
    pub fn towards(light: u32, point: &EmitterPoint, other: Vec3, direction: Vec3) -> Self {
        Self { light, position: point.position().unwrap_or(other), direction }
    }
}

/// Densities of a start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Densities {
    /// Of the point, see [`super::EmissionSample::pdf`].
    pub point: f32,
    /// Of the direction, see [`super::EmissionSample::pdf_direction`].
    pub direction: f32,
}

impl Densities {
    /// Of point and direction.
    #[inline]
    pub fn both(&self) -> f32 {
        self.point * self.direction
    }
}

/// Which starts reach the image.
#[derive(Clone, Debug)]
pub struct Starts {
    emitters: Discrete,
    /// Of each emitter.
    learnt: Vec<Learnt>,
    /// Of the environment, for next-event estimation.
    pub(super) openings: Openings,
}

/// Those of one emitter. What is not known is as the emitter has it.
#[derive(Clone, Debug, Default)]
pub(super) struct Learnt {
    /// (1 - a) P'/P.
    over_unlearnt: f32,
    /// Of directions to where light comes from, of emitters that surround the scene.
    towards: Option<Quadtree>,
    /// The shares that aim at portals.
    aimed: Aimed,
    /// Tables for the rest, of all starts: portals leave out what passes beside them.
    cells: Cells<3, Option<Quadtree>>,
}

impl Starts {
    /// Learns from `starts`, each with a weight, finite and at least 0; none where they tell nothing. Next-event estimation
    /// learns from the light `arriving`, weighted likewise: starts that are said to begin where it arrives.
    pub fn learn(
        lights: &Lights,
        mut starts: Vec<(Start, f32)>,
        arriving: Vec<(Start, f32)>,
    ) -> Option<Self> {
        // Emitters without power are never chosen: they have no density that could be mixed with another.
        let has_power = |start: &Start| lights.starts.probability(start.light as usize) > 0.0;
        starts.retain(|(start, weight)| *weight > 0.0 && has_power(start));
        if starts.len() < 2 * SEARCH.fewest as usize {
            return None;
        }
        let known = limited(&mut starts);
        let mut of_emitters = vec![Vec::new(); lights.all.len()];
        for (start, weight) in starts {
            of_emitters[start.light as usize].push((start, weight));
        }
        let total = |starts: &Vec<(Start, f32)>| starts.iter().map(|(_, weight)| f64::from(*weight)).sum();
        let totals: Vec<f64> = of_emitters.iter().map(total).collect();
        let each = known / totals.iter().sum::<f64>();
        let own = |index| ENOUGH * f64::from(lights.starts.probability(index));
        let emitters = Discrete::new(totals.iter().enumerate().map(|(index, sum)| each * sum + own(index)));
        let learn = |(index, starts): (usize, &Vec<(Start, f32)>)| {
            let over_unlearnt = over_unlearnt(&emitters, lights, index);
            Learnt::of(lights, index, over_unlearnt, starts)
        };
        let learnt: Vec<Learnt> = of_emitters.iter().enumerate().map(learn).collect();
        let starts = Self { emitters, learnt, openings: Openings::default() };
        let openings = lights.environment.map(|sky| {
            let portals: Vec<Portal> = starts.portals(sky as usize).copied().collect();
            Openings::learn(lights, sky, &portals, arriving)
        });
        Some(Self { openings: openings.unwrap_or_default(), ..starts })
    }

    /// The same for `lights` of another time; none if the emitters differ.
    pub fn fitting(&self, lights: &Lights) -> Option<Self> {
        let mut fitting = self.clone();
        if fitting.learnt.len() != lights.all.len() {
            return None;
        }
        for (index, learnt) in fitting.learnt.iter_mut().enumerate() {
            if lights.starts.probability(index) <= 0.0 && self.emitters.probability(index) > 0.0 {
                return None;
            }
            learnt.over_unlearnt = over_unlearnt(&self.emitters, lights, index);
        }
        Some(fitting)
    }

    /// The probability that a light subpath starts at an emitter.
    pub fn probability(&self, lights: &Lights, light: usize) -> f32 {
        UNLEARNT * lights.start_probability(light) + (1.0 - UNLEARNT) * self.emitters.probability(light)
    }

    /// An emitter, its probability without what was learnt, and its learnt distributions if the start is to be drawn
    /// from them.
    #[inline]
    pub(super) fn choose(&self, lights: &Lights, stream: &mut Stream) -> (usize, f64, Option<&Learnt>) {
        let (u, unlearnt) = (stream.uniform_precisely(), f64::from(UNLEARNT));
        if u < unlearnt {
            let (index, probability) = lights.starts.sample_precisely(u / unlearnt);
            return (index, probability, None);
        }
        let (index, _) = self.emitters.sample_precisely((u - unlearnt) / (1.0 - unlearnt));
        (index, lights.starts.probability_precisely(index), Some(&self.learnt[index]))
    }

    /// Densities of `start`, given its densities `unlearnt` by the emitters alone.
    #[inline]
    pub fn densities(&self, lights: &Lights, start: &Start, unlearnt: Densities) -> Densities {
        let learnt = &self.learnt[start.light as usize];
        let (is_parallel, even) = lights.measure(start);
        let ratio = learnt.over_unlearnt;
        let key = if is_parallel { -start.direction } else { start.position };
        let by_table = match learnt.cells.at(key.to_array()).and_then(Option::as_ref) {
            Some(table) => table.density(lights.to_square(start)) * even,
            None => unlearnt.direction,
        };
        let by_aim = learnt.aimed.pdf(|portal| match is_parallel {
            true => portal.pdf_across(start.position, start.direction),
            false => portal.pdf(start.position, start.direction),
        });
        let by_either = by_aim + (1.0 - learnt.aimed.share()) * by_table;
        let by_learnt = match &learnt.towards {
            // P' p'(x) over P.
            Some(towards) => {
                let density = towards.density(warp::from_sphere(key)) * warp::SPHERE_PDF;
                ratio * lights.starts.probability(start.light as usize) * density
            }
            None => ratio * unlearnt.point,
        };
        let by_emitter = UNLEARNT * unlearnt.point;
        let point = by_emitter + by_learnt;
        let both = by_emitter * unlearnt.direction + by_learnt * by_either;
        // An emitter that no light subpath starts at may still be hit.
        let direction = if point > 0.0 { both / point } else { unlearnt.direction };
        Densities { point, direction }
    }

    /// The portals that a part of the light of an emitter aims at.
    pub fn portals(&self, light: usize) -> impl Iterator<Item = &Portal> {
        self.learnt[light].aimed.portals().iter().map(|(_, portal)| portal)
    }

    /// Memory that they take (bytes).
    pub fn bytes(&self) -> usize {
        let learnt: usize = self.learnt.iter().map(Learnt::bytes).sum();
        self.emitters.bytes() + size_of_val(&self.learnt[..]) + learnt + self.openings.bytes()
    }

    /// Density of `point` of the emitter `light`, given its density `unlearnt` by the emitter alone.
    pub fn pdf_point(&self, lights: &Lights, light: u32, point: &EmitterPoint, unlearnt: f32) -> f32 {
        // At infinity the point is a direction; elsewhere it is as dense whichever way light leaves it.
        let direction = if let EmitterPoint::Direction(towards) = point { -*towards } else { Vec3::Z };
        let start = Start::towards(light, point, lights.centre, direction);
        self.densities(lights, &start, Densities { point: unlearnt, direction: 1.0 }).point
    }
}

/// Limits the weights of `starts`; how many they are then, as [`effective`] counts them.
pub(super) fn limited(starts: &mut [(Start, f32)]) -> f64 {
    let most = MOST.max(MOST_OF_FEW / starts.len() as f64);
    limit(starts, most, |(_, weight)| weight)
}

/// (1 - a) P'/P of the emitter `index`; 0 without power.
fn over_unlearnt(emitters: &Discrete, lights: &Lights, index: usize) -> f32 {
    let ratio = emitters.probability(index) / lights.starts.probability(index);
    if ratio.is_finite() { (1.0 - UNLEARNT) * ratio } else { 0.0 }
}

impl Learnt {
    fn bytes(&self) -> usize {
        let trees = self.cells.leaves().flatten().chain(&self.towards);
        self.cells.bytes() + self.aimed.bytes() + trees.map(Quadtree::bytes).sum::<usize>()
    }

    fn of(lights: &Lights, index: usize, over_unlearnt: f32, starts: &[(Start, f32)]) -> Self {
        let emitter = &lights.all[index].emitter;
        let is_parallel = emitter.is_parallel();
        let of_sphere = |(start, weight): &(Start, f32)| Deposit {
            at: warp::from_sphere(-start.direction),
            weight: *weight,
        };
        let is_known = effective(starts.iter().map(|(_, weight)| *weight)) >= ENOUGH;
        let surrounds = emitter.environment().is_some();
        let towards =
            (surrounds && is_known).then(|| Quadtree::learn(starts.iter().map(of_sphere).collect()));
        let known = |(start, weight): &(Start, f32)| Known {
            key: if is_parallel { -start.direction } else { start.position },
            deposit: Deposit { at: lights.to_square(start), weight: *weight },
        };
        // The one direction of a Dirac emitter is no density.
        if !emitter.is_connectible() {
            return Self { over_unlearnt, towards, aimed: Aimed::default(), cells: Cells::default() };
        }
        let cells =
            Cells::learn(starts.iter().map(known).collect(), PER_CELL, LEVELS, |known: Vec<Known>| {
                let enough = effective(known.iter().map(Known::weight)) >= ENOUGH;
                enough.then(|| Quadtree::learn(known.into_iter().map(|known| known.deposit).collect()))
            });
        // Where all light leaves one point, or one way, a table is as good.
        let aimed = if is_known && !emitter.is_hittable() { Aimed::default() } else { lights.aimed(starts) };
        Self { over_unlearnt, towards, aimed, cells }
    }

    /// A direction to where light comes from; none where there is only one.
    #[inline]
    pub(super) fn sample_towards(&self, stream: &mut Stream) -> Option<Vec3> {
        self.towards.as_ref().map(|towards| warp::to_sphere(towards.sample(stream.square())))
    }

    /// For a start that is not at infinity, at `position`; none where nothing is known of such.
    #[inline]
    pub(super) fn sample_direction(&self, position: Vec3, stream: &mut Stream) -> Option<Vec3> {
        if let Some(portal) = self.aim(stream) {
            return Some(portal.sample(position, stream));
        }
        Some(warp::to_sphere(self.cells.at(position.to_array())?.as_ref()?.sample(stream.square())))
    }

    /// A point of `disk`, in units of its radius, whose light aims at a portal; perhaps beyond its edge. None where
    /// light aims at none.
    #[inline]
    pub(super) fn aim_on(&self, disk: &Disk, stream: &mut Stream) -> Option<Vec2> {
        let portal = self.aim(stream)?;
        Some(disk.unit(portal.sample_across(disk.direction(), stream)))
    }

    /// A point on the unit disk that faces `towards`, of light that aims at no portal; none where nothing is known of
    /// that direction.
    #[inline]
    pub(super) fn sample_disk(&self, towards: Vec3, stream: &mut Stream) -> Option<Vec2> {
        Some(warp::to_disk(self.cells.at(towards.to_array())?.as_ref()?.sample(stream.square())))
    }

    #[inline]
    fn aim(&self, stream: &mut Stream) -> Option<&Portal> {
        if self.aimed.portals().is_empty() { None } else { self.aimed.choose(&mut stream.uniform()) }
    }
}

impl Lights {
    /// True for parallel light, and the density of a direction, or of a point of the disk, if all are as likely.
    #[inline]
    fn measure(&self, start: &Start) -> (bool, f32) {
        match self.disk(start.light as usize, start.direction) {
            Some(disk) => (true, disk.pdf_area()),
            None => (false, warp::SPHERE_PDF),
        }
    }

    /// The portals that `starts` of one emitter go through. The first and the second half of them are independent.
    /// Without portals, directions and places on a disk count as equally likely.
    fn aimed(&self, starts: &[(Start, f32)]) -> Aimed {
        let passage = |(index, (start, weight)): (usize, &(Start, f32))| {
            let (is_parallel, unaimed) = self.measure(start);
            let Start { position, direction, .. } = *start;
            let fold = usize::from(2 * index >= starts.len());
            Passage { position, direction, is_parallel, weight: *weight, unaimed, fold }
        };
        let passages = || starts.iter().enumerate().map(passage);
        let portals = crossings::find(passages(), 2.0 * self.radius, SEARCH);
        Aimed::of(&portals, passages())
    }

    /// Where on the unit square `start` has its direction, or its point of the disk.
    #[inline]
    fn to_square(&self, start: &Start) -> Vec2 {
        match self.disk(start.light as usize, start.direction) {
            Some(disk) => warp::from_disk(disk.unit(start.position)),
            None => warp::from_sphere(start.direction),
        }
    }
}

/// A start by what it is looked up, a position or a direction.
struct Known {
    key: Vec3,
    deposit: Deposit,
}

impl Keyed<3> for Known {
    fn key(&self) -> [f32; 3] {
        self.key.to_array()
    }
    fn weight(&self) -> f32 {
        self.deposit.weight
    }
}
