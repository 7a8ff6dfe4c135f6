//! When walks end: by Russian roulette at every vertex, with a probability to go on that is a function of the vertex alone,
//! so that it can be part of all densities (LW96 eq. 8 and 9).
//!
//! # Where camera subpaths run alone
//! The roulette of a vertex is drawn at the end of the flight that leaves it, after the emitter that this flight may have
//! hit is counted: a walk that ends has seen the sky once more, for the price of one flight. Strategies s = 0 and s = 1 make
//! a path by the same walk up to the vertex next to the emitter. Both have passed the roulettes of all vertices before it,
//! and neither that of this vertex: so no roulette is part of the ratio of their densities, and it multiplies the throughput
//! and the density of what follows only ([`super::vertex::Subpath::survive`]). Light subpaths could not tell the last vertex
//! of such a walk from others.
//!
//! # How long walks are
//! To go on with the albedo as probability keeps throughputs even, and is right in closed rooms, where there is always more
//! of the walk to pay for. Under a sky most walks soon leave the scene: to end them by roulette saves little time, and
//! brings most of the noise that is left. There, where camera subpaths run alone, walks put roulette off. Such a walk owes
//! the product of all albedos so far over that of its probabilities to go on, and goes on with the eighth root of what it
//! owes: soon it owes the seventh power of the albedo and no less, so that in white clouds it is no longer than with the
//! albedo. [`Lengths`] of a few walks say where that is worth it, alike for all images of a scene.

use super::{
    Contribution, Estimator,
    cache::Partners,
    camera_path,
    event::Leg,
    observer::{Meeting, Observer},
    profile::Profile,
};
use crate::{
    math::{Channels, Vec2},
    sampling::{Stream, stream::Purpose},
    settings::options::Survival,
};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Walks that are measured; of so many segments at most, each and on average.
const WALKS: u64 = 512;
const LONGEST: u32 = 256;
const LONG: f64 = 32.0;
/// So many times the segments are worth it. Measured by `pt`, variance x instructions gain 1.0 to 6 (glass, metal, fog or
/// smoke over ground, under a sky or a lamp) where they are 1.3 times as many or fewer, and 0.8 to 1.2 at 1.4 to 1.5
/// (`drifting_mist`, `countryside`, `reflector`). Rooms are at 1.7 to 2.8.
const STRETCH: f64 = 4.0 / 3.0;

/// When walks end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Roulette {
    /// At a vertex, by its albedo.
    AtOnce(Survival),
    /// Of camera subpaths that run alone: at the end of the flight from it, by all albedos so far.
    Late,
}

/// What is still to be drawn for a walk.
#[derive(Clone, Copy, Debug)]
pub struct Pending {
    /// The probability to go on at the end of the flight.
    pub survival: f32,
    /// The product of all albedos over that of all probabilities to go on, this one among them.
    owed: f32,
}

impl Pending {
    /// Nothing.
    pub const NONE: Self = Self { survival: 1.0, owed: 1.0 };

    /// How often walks that end by the albedo come so far, over how often this one does.
    #[inline]
    pub fn by_albedo(self) -> f32 {
        self.survival * self.owed
    }
}

impl Roulette {
    /// The probability to go on at once from a vertex of `albedo`, and what is pending behind it, where `before` was.
    #[inline]
    pub fn at(self, albedo: f32, before: Pending) -> (f32, Pending) {
        match self {
            Self::AtOnce(survival) => (survival.of(albedo), Pending::NONE),
            Self::Late if albedo > 0.0 => {
                let owed = before.owed * albedo;
                let survival = owed.sqrt().sqrt().sqrt();
                (1.0, Pending { survival, owed: owed / survival })
            }
            // No weight of 0 / 0.
            Self::Late => (0.0, before),
        }
    }

    /// That of `estimator`, whose camera subpaths run alone.
    pub fn alone<P: Profile>(estimator: &mut Estimator<'_, P>) -> Self {
        let asked = estimator.roulette;
        // In fog without end walks had better end, see `walk::thinned`.
        let may_be_late = !estimator.scene.is_endless();
        let is_late = may_be_late
            && (asked == Self::AtOnce(Survival::FourthRoot) || Lengths::of(estimator).are_worth_it());
        if is_late { Self::Late } else { asked }
    }
}

/// Segments of walks whose roulette is late.
#[derive(Clone, Copy, Debug, Default)]
struct Lengths {
    late: f64,
    /// Those of them that they would have had by the albedo.
    usual: f64,
}

impl Lengths {
    fn of<P: Profile>(estimator: &mut Estimator<'_, P>) -> Self {
        let before = (estimator.roulette, estimator.max_edges);
        (estimator.roulette, estimator.max_edges) = (Roulette::Late, estimator.max_edges.min(LONGEST));
        let mut lengths = Self::default();
        for walk in 0..WALKS {
            if !lengths.are_long() {
                // What panics here does so in the image as well, which reports it.
                let _ = catch_unwind(AssertUnwindSafe(|| lengths.add(estimator, walk)));
            }
        }
        (estimator.roulette, estimator.max_edges) = before;
        lengths
    }

    /// One more walk, from anywhere on the film: its numbers are the same for all parts and seeds of an image.
    fn add<P: Profile>(&mut self, estimator: &Estimator<'_, P>, walk: u64) {
        let mut stream = Stream::new(0, walk, 0, Purpose::Pilot);
        let crop = estimator.scene.crop;
        let [size, offset] = [crop.film, crop.offset].map(|pixels| Vec2::from(pixels.map(|n| n as f32)));
        let film = size * stream.square() - offset;
        let aperture = estimator.scene.sensor.sample_aperture(&mut stream);
        // Compiled for instruments in any case.
        let observer: &mut dyn Observer = self;
        let hero = walk as usize % P::Channels::COUNT;
        camera_path::sample(estimator, Partners::NONE, film, aperture, hero, observer, &mut stream);
    }

    fn are_long(&self) -> bool {
        self.late >= LONG * WALKS as f64
    }

    fn are_worth_it(&self) -> bool {
        is_worth_it(self.late / WALKS as f64, self.usual / WALKS as f64)
    }
}

/// True if it is worth it that roulette is late, as walks of so many segments then have only so many as `usual` by the albedo.
pub fn is_worth_it(late: f64, usual: f64) -> bool {
    late < LONG && late <= STRETCH * usual
}

/// The logarithm of the probability that a walk goes on from `vertices` of this mean logarithm of the albedo, where roulette is
/// late. What it owes is seven eighths of what it owed before and of one albedo more.
pub fn late(vertices: f32, albedo: f32) -> f32 {
    const KEPT: f32 = 7.0 / 8.0;
    albedo * (vertices - KEPT / (1.0 - KEPT) * (1.0 - KEPT.powf(vertices)))
}

impl Observer for Lengths {
    fn contribute(&mut self, _: u32, _: u32, _: Meeting<'_>, _: Option<&Contribution>) {}
    fn depart(&mut self, leg: &Leg) {
        self.late += 1.0;
        self.usual += f64::from(leg.by_albedo);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        guide::Learnt,
        scene::build::Setup,
        settings::options::{Options, Strategies},
        transport::{profile::Vacuum, tests::scenes::*},
    };

    /// How walks of `strategies` end in a scene of `parts`.
    fn chosen(parts: &[&str], strategies: Strategies) -> Roulette {
        let Setup { scene, .. } = &build(parts);
        let options = Options { strategies, ..Options::default() };
        Estimator::<Vacuum>::new(scene, options, Learnt::default(), 1, 64, 64).roulette
    }

    #[test]
    fn roulette_is_late_where_walks_soon_leave_and_camera_subpaths_are_alone() {
        let at_once = Roulette::AtOnce(Survival::Albedo);
        assert_eq!(chosen(&[OUTSIDE, GROUND, BALL, SKY], Strategies::PT), Roulette::Late);
        assert_eq!(chosen(&[OUTSIDE, GROUND, BALL, SKY], Strategies::BDPT), at_once);
        assert_eq!(chosen(&[CLEAR, INSIDE, ROOM, LAMP, BALL], Strategies::PT), at_once);
    }

    /// However long a walk is, it owes no less than the seventh power of the albedo: it goes on as by the albedo.
    #[test]
    fn late_walks_end_as_often_in_the_end() {
        for albedo in [0.3f32, 0.9, 0.999] {
            let mut pending = Pending::NONE;
            for _ in 0..200 {
                pending = Roulette::Late.at(albedo, pending).1;
            }
            assert!((pending.survival / albedo - 1.0).abs() < 1e-3, "{albedo}: {pending:?}");
            assert!((pending.owed / albedo.powi(7) - 1.0).abs() < 1e-2, "{albedo}: {pending:?}");
        }
        let (mut pending, mut product) = (Pending::NONE, 1.0);
        for vertices in 1..20 {
            pending = Roulette::Late.at(0.7, pending).1;
            product *= pending.survival;
            assert!(
                (late(vertices as f32, 0.7f32.ln()) - product.ln()).abs() < 1e-4,
                "{vertices}: {product}"
            );
        }
        let (survival, Pending { owed, .. }) = Roulette::Late.at(0.0, Pending::NONE);
        assert_eq!((survival, owed), (0.0, 1.0));
    }
}
