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

use super::{EmitterPoint, Lights};
use crate::{
    math::{Vec2, Vec3, warp},
    sampling::{
        Cells, Discrete, Quadtree, Stream,
        cells::Keyed,
        quadtree::{Deposit, effective, limit},
    },
};
/// a: the part of the starts that are not learnt.
const UNLEARNT: f32 = 0.25;
/// Fewest starts, as [`effective`] counts them, in a cell of positions.
const PER_CELL: f64 = 256.0;
/// Levels of cells below the root.
const LEVELS: u32 = 7;
/// Fewer starts than this tell nothing.
const ENOUGH: f64 = 16.0;
/// Largest share of one start in the weight of all: it may be an outlier.
const MOST: f64 = 1.0 / 256.0;

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
    learnt: Vec<Option<Learnt>>,
}

/// Those of one emitter.
#[derive(Clone, Debug)]
pub(super) struct Learnt {
    /// (1 - a) P'/P.
    over_unlearnt: f32,
    /// Of directions to where light comes from: emitters that surround the scene only.
    towards: Option<Quadtree>,
    cells: Cells<3, Option<Quadtree>>,
}

impl Starts {
    /// Learns from `starts`, each with a weight, finite and at least 0; none where they tell nothing.
    pub fn learn(lights: &Lights, mut starts: Vec<(Start, f32)>) -> Option<Self> {
        // Emitters without power are never chosen: they have no density that could be mixed with another.
        starts.retain(|(start, _)| lights.starts.probability(start.light as usize) > 0.0);
        if limit(&mut starts, MOST, |(_, weight)| weight) < ENOUGH {
            return None;
        }
        let mut of_emitters = vec![Vec::new(); lights.all.len()];
        for (start, weight) in starts {
            of_emitters[start.light as usize].push((start, weight));
        }
        let total = |starts: &Vec<(Start, f32)>| starts.iter().map(|(_, weight)| f64::from(*weight)).sum();
        let emitters = Discrete::new(of_emitters.iter().map(total));
        let learn = |(index, starts): (usize, Vec<(Start, f32)>)| {
            (!starts.is_empty()).then(|| {
                let ratio = emitters.probability(index) / lights.starts.probability(index);
                Learnt::of(lights, index, (1.0 - UNLEARNT) * ratio, &starts)
            })
        };
        let learnt = of_emitters.into_iter().enumerate().map(learn).collect();
        Some(Self { emitters, learnt })
    }

    /// The same for `lights` of another time; none if the emitters differ.
    pub fn fitting(&self, lights: &Lights) -> Option<Self> {
        let mut fitting = self.clone();
        if fitting.learnt.len() != lights.all.len() {
            return None;
        }
        for (index, learnt) in fitting.learnt.iter_mut().enumerate() {
            let Some(learnt) = learnt else { continue };
            let probability = lights.starts.probability(index);
            if probability <= 0.0 {
                return None;
            }
            learnt.over_unlearnt = (1.0 - UNLEARNT) * self.emitters.probability(index) / probability;
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
        (index, lights.starts.probability_precisely(index), self.learnt[index].as_ref())
    }

    /// Densities of `start`, given its densities `unlearnt` by the emitters alone.
    #[inline]
    pub fn densities(&self, lights: &Lights, start: &Start, unlearnt: Densities) -> Densities {
        let Some(learnt) = &self.learnt[start.light as usize] else {
            return Densities { point: UNLEARNT * unlearnt.point, ..unlearnt };
        };
        let (is_parallel, even) = lights.measure(start);
        let ratio = learnt.over_unlearnt;
        let key = if is_parallel { -start.direction } else { start.position };
        let by_table = match learnt.cells.at(key.to_array()).and_then(Option::as_ref) {
            Some(table) => table.density(lights.to_square(start)) * even,
            None => unlearnt.direction,
        };
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
        let direction = (by_emitter * unlearnt.direction + by_learnt * by_table) / point;
        Densities { point, direction }
    }

    /// Memory that they take (bytes).
    pub fn bytes(&self) -> usize {
        let learnt: usize = self.learnt.iter().flatten().map(Learnt::bytes).sum();
        self.emitters.bytes() + size_of_val(&self.learnt[..]) + learnt
    }

    /// Density of `point` of the emitter `light`, given its density `unlearnt` by the emitter alone.
    pub fn pdf_point(&self, lights: &Lights, light: u32, point: &EmitterPoint, unlearnt: f32) -> f32 {
        // At infinity the point is a direction; elsewhere it is as dense whichever way light leaves it.
        let direction = if let EmitterPoint::Direction(towards) = point { -*towards } else { Vec3::Z };
        let start = Start::towards(light, point, lights.centre, direction);
        self.densities(lights, &start, Densities { point: unlearnt, direction: 1.0 }).point
    }
}

impl Learnt {
    fn bytes(&self) -> usize {
        let trees = self.cells.leaves().flatten().chain(&self.towards);
        self.cells.bytes() + trees.map(Quadtree::bytes).sum::<usize>()
    }

    fn of(lights: &Lights, index: usize, over_unlearnt: f32, starts: &[(Start, f32)]) -> Self {
        let emitter = &lights.all[index].emitter;
        let is_parallel = emitter.is_parallel();
        let of_sphere = |(start, weight): &(Start, f32)| Deposit {
            at: warp::from_sphere(-start.direction),
            weight: *weight,
        };
        let towards = emitter.environment().map(|_| Quadtree::learn(starts.iter().map(of_sphere).collect()));
        let known = |(start, weight): &(Start, f32)| Known {
            key: if is_parallel { -start.direction } else { start.position },
            deposit: Deposit { at: lights.to_square(start), weight: *weight },
        };
        // The one direction of a Dirac emitter is no density.
        let cells = if emitter.is_connectible() {
            Cells::learn(starts.iter().map(known).collect(), PER_CELL, LEVELS, |known: Vec<Known>| {
                let enough = effective(known.iter().map(Known::weight)) >= ENOUGH;
                enough.then(|| Quadtree::learn(known.into_iter().map(|known| known.deposit).collect()))
            })
        } else {
            Cells::default()
        };
        Self { over_unlearnt, towards, cells }
    }

    /// A direction to where light comes from; none where there is only one.
    #[inline]
    pub(super) fn sample_towards(&self, stream: &mut Stream) -> Option<Vec3> {
        self.towards.as_ref().map(|towards| warp::to_sphere(towards.sample(stream.square())))
    }

    /// For a start that is not at infinity, at `position`; none where nothing is known of such.
    #[inline]
    pub(super) fn sample_direction(&self, position: Vec3, stream: &mut Stream) -> Option<Vec3> {
        Some(warp::to_sphere(self.cells.at(position.to_array())?.as_ref()?.sample(stream.square())))
    }

    /// A point on the unit disk that faces `towards`; none where nothing is known of that direction.
    #[inline]
    pub(super) fn sample_disk(&self, towards: Vec3, stream: &mut Stream) -> Option<Vec2> {
        Some(warp::to_disk(self.cells.at(towards.to_array())?.as_ref()?.sample(stream.square())))
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
