//! How next-event estimation aims at emitters.
//!
//! Where a sky shines through an opening, most directions to it are blocked. Learnt starts know the opening, as a portal
//! that light subpaths aim at; next-event estimation takes a part of its directions to the sky through the same portal.
//! (Bitterli, Novak and Jarosz 2015, Portal-Masked Environment Map Sampling, have the opening given as a rectangle.
//! They sample the map behind it, which a portal does not.)

use super::{
    Lights, Start, Starts,
    starts::{LEVELS, PER_CELL, UNLEARNT},
};
use crate::{
    emitter::{InfiniteEmitter, InfiniteModel, Kind, Seen},
    math::Vec3,
    sampling::{
        Cells, Stream,
        cells::Keyed,
        portal::{Aimed, Passage, Portal},
    },
    settings::options::Sky,
};

/// Largest part of the directions to a sky that aims at portals.
const MOST: f32 = 1.0 - UNLEARNT;

/// How next-event estimation aims at emitters.
#[derive(Clone, Copy, Debug, Default)]
pub struct Aim<'a> {
    /// Whether it takes the environment at all, where there are other emitters.
    pub sky: Sky,
    /// The starts whose portals it takes the environment through.
    pub starts: Option<&'a Starts>,
}

/// The portals of a sky, and how much of its light comes through each, by where it arrives: rooms are lit through
/// windows, and what is outside is not.
#[derive(Clone, Debug, Default)]
pub(super) struct Openings(Cells<3, Aimed>);

impl Openings {
    /// With `portals`, from the `starts` of the sky's light, each of which says where it arrives.
    pub(super) fn learn(aimed: &Aimed, sky: &InfiniteEmitter, starts: &[(Start, f32)]) -> Self {
        let portals: Vec<Portal> = aimed.portals().iter().map(|(_, portal)| *portal).collect();
        if portals.is_empty() {
            return Self::default();
        }
        let arriving = |(start, weight): &(Start, f32)| {
            let passage = arriving(sky, start, *weight);
            let is_through = portals.iter().any(|portal| passage.crosses(&portal.smallest));
            Arriving { passage, is_through }
        };
        let aimed = |all: Vec<Arriving>| {
            Aimed::fitted(&portals, all.into_iter().map(|arriving| arriving.passage), MOST)
        };
        Self(Cells::learn(starts.iter().map(arriving).collect(), PER_CELL, LEVELS, aimed))
    }

    /// Memory that they take (bytes).
    pub(super) fn bytes(&self) -> usize {
        self.0.bytes() + self.0.leaves().map(Aimed::bytes).sum::<usize>()
    }

    /// As seen from `reference`; none without portals.
    #[inline]
    fn from(&self, reference: Vec3) -> Option<&Aimed> {
        self.0.at(reference.to_array())
    }
}

/// The ray from where light of the `sky` arrives, back to it.
fn arriving(sky: &InfiniteEmitter, start: &Start, weight: f32) -> Passage {
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
    /// Density of next-event estimation at `start` from where its light arrives without the portals of `learnt`, over that with them.
    pub fn unaimed(&self, learnt: Option<&Starts>, start: &Start) -> f32 {
        let Start { light, position, direction } = *start;
        let (index, aim) = (light as usize, Aim { starts: learnt, ..Aim::default() });
        let Kind::Infinite(sky) = &self.all[index].emitter.kind else { return 1.0 };
        let Some(aimed) = self.openings(index, position, aim) else { return 1.0 };
        let seen = sky.seen(-direction);
        let ratio = seen.aimed_sr / with_portals(aimed, seen, position, -direction).aimed_sr;
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
    pub(super) fn seen_from(
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
        let starts = aim.starts.filter(|_| self.environment == Some(index as u32))?;
        starts.openings.from(reference)
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
        emitter::{self, Emitter},
        math::{vec3, warp},
        sampling::{portal::Sphere, stream::Purpose},
        testing::object,
    };

    /// The ground beneath a sky, and a room below it that is lit by a hole in its ceiling.
    #[test]
    fn rooms_look_at_their_windows_and_the_ground_at_all_of_the_sky() {
        let hole = Sphere { centre: vec3(0.5, 0.0, 0.5), radius_squared: 0.01 };
        let Emitter { kind: Kind::Infinite(sky), .. } =
            emitter::build(&object("constant", &[]), &Library::default()).unwrap()
        else {
            panic!("a sky")
        };
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
        let passages = || starts.iter().map(|(start, weight)| arriving(&sky, start, *weight));
        let portal = Portal::fitted(hole, passages().collect::<Vec<_>>().iter());
        let openings = Openings::learn(&Aimed::of(&[portal], passages(), 0.5), &sky, &starts);
        for (place, expected) in [(vec3(0.2, -1.7, 0.3), 0.7..0.8), (vec3(0.8, 0.0, 0.9), 0.0..0.1)] {
            let share = openings.from(place).unwrap().share();
            assert!(expected.contains(&share), "{place}: {share}");
        }
        assert!(Openings::learn(&Aimed::default(), &sky, &starts).from(Vec3::ZERO).is_none());
    }
}
