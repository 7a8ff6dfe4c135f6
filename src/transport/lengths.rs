//! Where late roulette pays, judged by the lengths of a few walks: the same for all images of a scene.

use super::{
    cache::Partners,
    camera_path,
    estimator::Estimator,
    event::Leg,
    observer::{Contribution, Meeting, Observer},
    profile::Profile,
    roulette::Roulette,
};
use crate::{
    math::{Channels, Vec2},
    sampling::{Stream, stream::Purpose},
    settings::options::Survival,
};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Number of walks measured; most segments of each; and most on average if late roulette is to pay.
const WALKS: u64 = 512;
const LONGEST: u32 = 256;
const LONG: f64 = 32.0;
/// Late roulette pays if walks have at most this many times the segments. Measured by `pt`, gains in variance x
/// instructions: 1.0 to 6 where segments are at most 1.3 times as many (glass, metal, fog or smoke over ground, under a
/// sky or a lamp); 0.8 to 1.2 at 1.4 to 1.5 (`drifting_mist`, `countryside`, `reflector`). Rooms are at 1.7 to 2.8.
const STRETCH: f64 = 4.0 / 3.0;

impl Roulette {
    /// The roulette of `estimator`, whose camera subpaths run alone.
    pub fn alone<P: Profile>(estimator: &mut Estimator<'_, P>) -> Self {
        let asked = estimator.roulette;
        // In endless fog walks are long enough.
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
    /// Segments that they would have had with roulette by the albedo.
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

impl Observer for Lengths {
    fn contribute(&mut self, _: u32, _: u32, _: Meeting<'_>, _: Option<&Contribution>) {}
    fn depart(&mut self, leg: &Leg) {
        self.late += 1.0;
        self.usual += f64::from(leg.by_albedo);
    }
}

/// True if late roulette pays: with it walks have `late` segments, by the albedo `usual` ones.
pub fn is_worth_it(late: f64, usual: f64) -> bool {
    late < LONG && late <= STRETCH * usual
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        guide::Learnt,
        scene::build::Setup,
        settings::options::{Options, Strategies},
        transport::{profiles::Vacuum, tests::scenes::*},
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
}
