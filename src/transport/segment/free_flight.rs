//! The free flight: a segment sampled from one end (LW96 eq. 4-7).

use super::{NullCrossing, Segment};
use crate::{
    math::{Channels, RaySegment, Spectrum},
    medium::{Medium, MediumIndex, MediumInterval, distance::collision_ratio},
    sampling::Stream,
    scene::Scene,
    shape::SurfacePoint,
    transport::{interaction::Interaction, profile::Profile},
};

/// A sampled segment.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FreeFlight<L> {
    /// Where it ended; none where it left the scene.
    pub interaction: Option<Interaction>,
    /// The medium at its end.
    pub medium: MediumIndex,
    /// What it has passed.
    pub state: FlightState<L>,
}

/// What a flight has passed, for its contribution and for the weights.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FlightState<L> {
    /// Optical depth per channel, the logarithms of null-passing probabilities included: the flight density
    /// in the weights is exp(-depth), times sigma_t at a collision.
    pub depth: L,
    /// Contribution over the true density of the flight, per channel. Profiles without varying media compute it from
    /// `depth`.
    pub ratio: L,
    /// Null transmittances over their passing probabilities; 1 where none was tinted.
    pub tint: Spectrum,
}

impl<L: Channels> FlightState<L> {
    /// For a flight that has not begun.
    #[inline]
    pub(crate) fn none() -> Self {
        Self { depth: L::splat(0.0), ratio: L::splat(1.0), tint: Spectrum::ONE }
    }

    /// Applies a surface; true if the flight goes on.
    #[inline]
    pub(crate) fn cross(&mut self, crossing: &NullCrossing) -> bool {
        match *crossing {
            NullCrossing::Stopped(probability) => self.tint /= probability,
            NullCrossing::Passed(through, probability) => {
                self.tint *= through / probability;
                self.depth = self.depth + L::splat(-probability.ln());
            }
        }
        matches!(crossing, NullCrossing::Passed(..))
    }
}

/// What a flight passes on its way, as far as walks may want to see it.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Passed<L> {
    /// A part in one medium. Only profiles with emissive media show it.
    Medium(FlightPart<L>),
    /// A point of a shape that emits, whether the flight goes on or ends there. Only profiles with nulls show it; in
    /// others the flight always ends.
    Emitter(EmitterCrossing<L>),
}

/// The arrival of a flight at a shape that emits.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EmitterCrossing<L> {
    /// The emitter.
    pub light: u32,
    /// Its point.
    pub point: SurfacePoint,
    /// The medium before it.
    pub medium: MediumIndex,
    /// What lies before it.
    pub before: FlightState<L>,
    /// As of [`FlightPart`].
    pub certain: bool,
}

/// A part of a flight that lies in one medium.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FlightPart<L> {
    /// The medium.
    pub medium: MediumIndex,
    /// The part, as long as it was really flown; infinite where it was never left.
    pub interval: MediumInterval,
    /// What lies before it.
    pub before: FlightState<L>,
    /// True where it is certain that a flight gets this far: `before.ratio` is transmittance.
    pub certain: bool,
}

impl<L: Channels> FlightPart<L> {
    /// The part in which `medium` can emit. In a homogeneous medium it includes the distance skipped behind a boundary:
    /// where mean free paths are as short, its light would be lost.
    pub(crate) fn emitting(&self, medium: &Medium) -> RaySegment {
        let MediumInterval { segment, skipped } = self.interval;
        match medium.heterogeneous() {
            Some(_) => segment,
            None => RaySegment { length: segment.length + skipped, ..segment },
        }
    }

    /// The state of a flight that would have ended `t` metres into this part.
    pub(crate) fn until<P: Profile<Channels = L>>(
        &self,
        scene: &Scene,
        t: f32,
        hero: usize,
        stream: &mut Stream,
    ) -> FlightState<L> {
        let mut interval = MediumInterval::of(self.interval.segment);
        interval.segment.length = t;
        let medium = &scene.media[self.medium.0 as usize];
        let depth = medium.optical_depth::<P>(&interval);
        let ratio = match self.certain {
            false => medium.transmittance_ratio::<P>(&interval, depth, hero, stream),
            true => {
                medium.attenuation::<P>(&interval, stream).map_or(L::splat(0.0), |found| found.transmittance)
            }
        };
        let FlightState { depth: before, ratio: ratio_before, tint } = self.before;
        FlightState { depth: before + depth, ratio: ratio_before * ratio, tint }
    }
}

/// Samples where `segment` ends: at an exponential optical depth of the `hero` channel, or before that on a surface.
/// Only profiles with nulls can pass boundaries. `along` sees what the flight passes.
///
/// LW96 eq. 4: the distance of a free flight. Its density in a medium is eq. 6; its probability to reach a surface is
/// eq. 7.
#[inline(always)]
pub(crate) fn sample_free_flight<P: Profile>(
    mut segment: Segment<'_>,
    hero: usize,
    stream: &mut Stream,
    along: &mut impl FnMut(&Passed<P::Channels>, &mut Stream),
) -> FreeFlight<P::Channels> {
    let remaining = if P::MEDIA { stream.exponential() } else { 0.0 };
    if P::NULLS {
        return fly_across_boundaries::<P>(segment, hero, remaining, stream, along);
    }
    let Leg { interaction, state, .. } = fly_to_surface::<P>(&mut segment, hero, remaining, stream);
    FreeFlight { interaction, medium: segment.medium, state }
}

/// A flight as far as the next surface.
struct Leg<L> {
    interaction: Option<Interaction>,
    state: FlightState<L>,
    /// Optical depth used up.
    spent: f32,
    /// The part of the medium that it crossed.
    interval: MediumInterval,
}

/// A flight to the next surface, in one medium.
#[inline(always)]
fn fly_to_surface<P: Profile>(
    segment: &mut Segment<'_>,
    hero: usize,
    remaining: f32,
    stream: &mut Stream,
) -> Leg<P::Channels> {
    if !P::MEDIA {
        let (interval, hit) = segment.next::<P>(f32::INFINITY);
        let interaction = hit.map(|hit| Interaction::Surface(segment.surface(&hit)));
        return Leg { interaction, state: FlightState::none(), spent: 0.0, interval };
    }
    let reach = segment.medium().reach::<P>(segment.skipped, hero, remaining);
    let (mut interval, hit) = segment.next::<P>(reach);
    let medium = segment.medium();
    let sample = medium.sample_distance::<P>(&interval, hero, remaining, stream);
    let mut state = FlightState { depth: sample.depth, ratio: sample.ratio, tint: Spectrum::ONE };
    let interaction = match (sample.collision, hit) {
        (Some(t), _) => {
            interval.segment.length = t;
            if P::EMISSIVE {
                interval.skipped = medium.skipped_before::<P>(interval.skipped, hero, sample.spent);
            }
            Some(collide::<P>(medium, sample.component, &interval, hero, &mut state))
        }
        (None, Some(hit)) => Some(Interaction::Surface(segment.surface(&hit))),
        (None, None) => None,
    };
    Leg { interaction, state, spent: sample.spent, interval }
}

/// A collision at the end of `interval`.
#[inline(always)]
fn collide<P: Profile>(
    medium: &Medium,
    component: usize,
    interval: &MediumInterval,
    hero: usize,
    state: &mut FlightState<P::Channels>,
) -> Interaction {
    let position = interval.segment.at(interval.segment.length);
    let properties = medium.properties_at::<P>(component, position);
    if P::HETEROGENEOUS {
        state.ratio = state.ratio * collision_ratio(properties.sigma_t, hero);
    }
    Interaction::Medium(position, properties)
}

/// A flight that may pass surfaces. Each crossing switches the medium and applies the surface's transmission.
fn fly_across_boundaries<P: Profile>(
    mut segment: Segment<'_>,
    hero: usize,
    mut remaining: f32,
    stream: &mut Stream,
    along: &mut impl FnMut(&Passed<P::Channels>, &mut Stream),
) -> FreeFlight<P::Channels> {
    let mut state = FlightState::none();
    loop {
        let Leg { interaction, state: leg, spent, interval } =
            fly_to_surface::<P>(&mut segment, hero, remaining, stream);
        let medium = segment.medium;
        if P::EMISSIVE {
            along(&Passed::Medium(FlightPart { medium, interval, before: state, certain: false }), stream);
        }
        state.depth = state.depth + leg.depth;
        state.ratio = state.ratio * leg.ratio;
        let Some(Interaction::Surface(point)) = interaction else {
            return FreeFlight { interaction, medium, state };
        };
        segment.show_emitter(point, state, false, stream, along);
        if !state.cross(&segment.sample_crossing(&point, stream)) {
            return FreeFlight { interaction, medium, state };
        }
        remaining = (remaining - spent).max(0.0);
        segment.cross(&point);
    }
}
