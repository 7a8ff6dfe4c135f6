//! How next-event estimation aims at emitters.
//!
//! Where a sky shines through an opening, most directions to it are blocked. Learnt starts know the opening as a portal.
//! Light subpaths aim at it, and so does a part of the directions that next-event estimation takes to the sky.
//! (Bitterli, Novak and Jarosz 2015, Portal-Masked Environment Map Sampling, have the opening given as a rectangle.
//! They sample the map behind it, which a portal does not.)

use super::{
    Lights, Start, Starts,
    starts::{LEVELS, PER_CELL, UNLEARNT, limited},
};
use crate::{
    emitter::{InfiniteEmitter, InfiniteModel, Kind, Seen},
    math::Vec3,
    sampling::{
        Cells, Stream, Thinning,
        cells::Keyed,
        portal::{Aimed, Passage, Portal},
    },
    settings::options::Sky,
};

/// Largest part of the directions to a sky that aims at portals.
const MOST: f32 = 1.0 - UNLEARNT;
/// About so many arrivals of light teach. They fill half of the cells that the levels allow; more would only take time.
const MOST_KNOWN: f32 = 16_384.0;

/// How next-event estimation aims at emitters.
#[derive(Clone, Copy, Debug, Default)]
pub struct Aim<'a> {
    /// Whether it takes the environment at all, where there are other emitters.
    pub sky: Sky,
    /// The starts whose portals it takes the environment through.
    pub starts: Option<&'a Starts>,
}

/// The portals of a sky, and which part of next-event estimation aims at each, by where light arrives: rooms are lit
/// through windows, and what is outside is not.
#[derive(Clone, Debug, Default)]
pub(super) struct Openings(Cells<3, Aimed>);

impl Openings {
    /// With the `portals` of the environment `sky`, from light that begins where it arrives.
    pub(super) fn learn(
        lights: &Lights,
        sky: u32,
        portals: &[Portal],
        mut arriving: Vec<(Start, f32)>,
    ) -> Self {
        let Some(emitter) = lights.all[sky as usize].emitter.environment().filter(|_| !portals.is_empty())
        else {
            return Self::default();
        };
        arriving.retain(|(start, _)| start.light == sky);
        limited(&mut arriving);
        let step = arriving.iter().map(|(_, weight)| weight).sum::<f32>() / MOST_KNOWN;
        let mut thinning = Thinning::by(step);
        let known = arriving.iter().filter_map(|(start, weight)| {
            let passage = passage(emitter, start, thinning.keeps(*weight)?);
            let is_through = portals.iter().any(|portal| passage.crosses(&portal.smallest));
            Some(Arriving { passage, is_through })
        });
        Self(Cells::learn(known.collect(), PER_CELL, LEVELS, |all| {
            Aimed::fitted(portals, all.into_iter().map(|one: Arriving| one.passage), MOST)
        }))
    }

    /// Memory that they take (bytes).
    pub(super) fn bytes(&self) -> usize {
        self.0.bytes() + self.0.leaves().map(Aimed::bytes).sum::<usize>()
    }

    /// As seen from `reference`; none without portals.
    #[inline]
    fn at(&self, reference: Vec3) -> Option<&Aimed> {
        self.0.at(reference.to_array())
    }
}

/// The ray from where light of the `sky` arrives, back to it.
fn passage(sky: &InfiniteEmitter, start: &Start, weight: f32) -> Passage {
    let (position, direction) = (start.position, -start.direction);
    let unaimed = sky.seen(direction).aimed_sr;
    Passage { position, direction, is_parallel: false, weight, unaimed, fold: 0 }
}

/// A sky's light where it arrives. Cells end where it ceases to come through portals.
struct Arriving {
    passage: Passage,
    is_through: bool,
}

impl Keyed<3> for Arriving {
    fn key(&self) -> [f32; 3] {
        self.passage.position.to_array()
    }
    fn weight(&self) -> f32 {
        self.passage.weight
    }
    fn value(&self) -> Option<f32> {
        Some(if self.is_through { 1.0 } else { 0.0 })
    }
}

impl Lights {
    /// The density of next-event estimation from `reference` at `start` without portals, over that with those of `learnt`.
    pub fn unaimed(&self, learnt: Option<&Starts>, start: &Start, reference: Vec3) -> f32 {
        let (index, aim) = (start.light as usize, Aim { starts: learnt, ..Aim::default() });
        let Kind::Infinite(sky) = &self.all[index].emitter.kind else { return 1.0 };
        let Some(aimed) = self.openings(index, reference, aim) else { return 1.0 };
        let (towards, seen) = (-start.direction, sky.seen(-start.direction));
        let ratio = seen.aimed_sr / with_portals(aimed, seen, reference, towards).aimed_sr;
        if ratio.is_finite() { ratio } else { 1.0 }
    }

    /// A direction from `reference` to the emitter `index` at infinity, and what is seen there.
    #[inline]
    pub(super) fn aim_at_infinity(
        &self,
        index: usize,
        sky: &InfiniteEmitter,
        reference: Vec3,
        aim: Aim<'_>,
        stream: &mut Stream,
    ) -> (Vec3, Seen) {
        let Some(aimed) = self.openings(index, reference, aim) else { return sky.aim(stream) };
        let (towards, seen) = match aimed.choose(&mut stream.uniform()) {
            Some(portal) => {
                let towards = portal.sample(reference, stream);
                (towards, sky.seen(towards))
            }
            None => sky.aim(stream),
        };
        (towards, with_portals(aimed, seen, reference, towards))
    }

    /// What is seen of the emitter `index` at infinity from `reference` in unit direction `towards`.
    #[inline]
    pub(super) fn seen_towards(
        &self,
        index: usize,
        sky: &InfiniteEmitter,
        reference: Vec3,
        towards: Vec3,
        aim: Aim<'_>,
    ) -> Seen {
        let seen = sky.seen(towards);
        let openings = self.openings(index, reference, aim);
        openings.map_or(seen, |aimed| with_portals(aimed, seen, reference, towards))
    }

    /// The portals that next-event estimation from `reference` takes the emitter `index` through; none where it takes
    /// all of it alike.
    #[inline]
    fn openings<'a>(&self, index: usize, reference: Vec3, aim: Aim<'a>) -> Option<&'a Aimed> {
        let is_taken = self.environment == Some(index as u32) && self.connects_to_sky(aim.sky);
        let starts = aim.starts.filter(|_| is_taken)?;
        starts.openings.at(reference)
    }
}

/// What is `seen`, with the density of aiming at portals, too. Where nothing is emitted, nothing is found.
#[inline]
fn with_portals(aimed: &Aimed, seen: Seen, reference: Vec3, towards: Vec3) -> Seen {
    if seen.aimed_sr <= 0.0 {
        return seen;
    }
    let by_portals = aimed.pdf(|portal| portal.pdf(reference, towards));
    Seen { aimed_sr: (1.0 - aimed.share()) * seen.aimed_sr + by_portals, ..seen }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        description::Library,
        emitter,
        math::{vec3, warp},
        medium::MediumIndex,
        sampling::{portal::Sphere, stream::Purpose},
        scene::lights::Light,
        testing::object,
    };

    /// The ground beneath a sky, and a room below it that is lit by a hole in its ceiling.
    #[test]
    fn rooms_look_at_their_windows_and_the_ground_at_all_of_the_sky() {
        let hole = Sphere { centre: vec3(0.5, 0.0, 0.5), radius_squared: 0.01 };
        let emitter = emitter::build(&object("constant", &[]), &Library::default()).unwrap();
        let light = Light {
            emitter,
            position: Vec3::ZERO,
            shape: None,
            medium: MediumIndex::VACUUM,
            straddles: false,
            clearings: None,
        };
        let lights = Lights { all: vec![light], ..Lights::default() };
        let mut stream = Stream::new(23, 0, 0, Purpose::Study);
        let mut start = |index: u32| {
            let (at, height, to) = (stream.square(), stream.uniform(), warp::to_sphere(stream.square()));
            let inside = index.is_multiple_of(4);
            let position = vec3(at.x, if inside { -1.0 - height } else { 0.0 }, at.y);
            let aim = hole.centre + 0.1 * to - position;
            let towards = if inside { aim.normalize() } else { vec3(to.x, to.y.abs(), to.z) };
            (Start { light: 0, position, direction: -towards }, 1.0)
        };
        let starts: Vec<(Start, f32)> = (0..8000).map(&mut start).collect();
        let portal = Portal::fitted(hole, [].iter());
        let openings = Openings::learn(&lights, 0, &[portal], starts.clone());
        for (place, expected) in [(vec3(0.2, -1.7, 0.3), 0.7..0.8), (vec3(0.8, 0.0, 0.9), 0.0..0.1)] {
            let share = openings.at(place).unwrap().share();
            assert!(expected.contains(&share), "{place}: {share}");
        }
        assert!(Openings::learn(&lights, 0, &[], starts).at(Vec3::ZERO).is_none());
    }
}
