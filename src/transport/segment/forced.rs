//! The forced flight (P03T sec. A.2.2): a segment that ends in two ways at once, at a collision within the media that
//! the ray crosses and on what lies behind them, each with its share of radiance.

use super::{FlightPart, FlightState, FreeFlight, NullCrossing, Passed, Segment};
use crate::{
    math::{Channels, Spectrum},
    medium::{Medium, MediumInterval, distance::collision_ratio},
    sampling::Stream,
    transport::{interaction::Interaction, profile::Profile},
};

/// One way in which a forced flight ends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ForcedEnd<L> {
    /// The flight as the weights see it: as if sampled without forcing.
    pub flight: FreeFlight<L>,
    /// Contribution over the true density of its sample.
    pub share: Spectrum,
}

/// A forced flight.
pub(crate) struct Forced<L> {
    /// A collision in the media, where there is one, and the end behind them.
    pub ends: [Option<ForcedEnd<L>>; 2],
    /// See [`sure_depth`].
    pub sure_depth: L,
}

/// What the ray has crossed so far.
#[derive(Clone, Copy, Debug)]
struct Unforced<L> {
    /// Its ratio is relative to exp(-`spent`).
    state: FlightState<L>,
    /// Estimate of the transmittance of media.
    through: L,
    /// The optical depth by which collisions are drawn.
    spent: f32,
}

/// A part of the ray that lies in one medium with extinction.
struct Part<'a, L> {
    segment: Segment<'a>,
    interval: MediumInterval,
    before: Unforced<L>,
    /// What it adds to the depth by which collisions are drawn.
    depth: f32,
}

impl<L: Channels> Unforced<L> {
    fn none() -> Self {
        Self { state: FlightState::none(), through: L::splat(1.0), spent: 0.0 }
    }

    /// Goes along `interval` of `medium`.
    fn add<P: Profile<Channels = L>>(
        &mut self,
        medium: &Medium,
        interval: &MediumInterval,
        hero: usize,
        stream: &mut Stream,
    ) {
        let depth = medium.optical_depth::<P>(interval);
        let unforced = medium.unforced::<P>(interval, depth, hero, stream);
        self.state.depth = self.state.depth + depth;
        self.state.ratio = self.state.ratio * unforced.ratio;
        self.through = self.through * unforced.transmittance;
        self.spent += unforced.depth;
    }
}

/// Follows `segment` to the first surface that stops it, and forces a collision of the `hero` channel on the
/// way. `along` as in [`super::sample_free_flight`].
pub(crate) fn force<P: Profile>(
    segment: Segment<'_>,
    hero: usize,
    stream: &mut Stream,
    along: &mut impl FnMut(&Passed<P::Channels>, &mut Stream),
) -> Forced<P::Channels> {
    let Followed { parts, behind, depth, sure_depth } = follow::<P>(segment, hero, stream, along);
    let collision = collide::<P>(&parts, depth, hero, stream);
    Forced { ends: [collision, (behind.share.max_element() > 0.0).then_some(behind)], sure_depth }
}

/// Optical depth per channel of the media that `segment` crosses before the first surface that holds anything back: the
/// part that every forced flight crosses. It is never random, and the same for all strategies.
pub(crate) fn sure_depth<P: Profile>(mut segment: Segment<'_>) -> P::Channels {
    let mut depth = P::Channels::splat(0.0);
    loop {
        let (interval, hit) = segment.next::<P>(f32::INFINITY);
        depth = depth + segment.medium().optical_depth::<P>(&interval);
        let Some(hit) = hit.filter(|_| P::NULLS) else { return depth };
        let point = segment.surface(&hit);
        if segment.transmission(&point).max_element() < 1.0 {
            return depth;
        }
        segment.cross(&point);
    }
}

/// A ray that was followed.
struct Followed<'a, L> {
    /// The parts of it that collisions can happen in.
    parts: Vec<Part<'a, L>>,
    /// Where it ends.
    behind: ForcedEnd<L>,
    /// The depth up to there by which collisions are drawn.
    depth: f32,
    sure_depth: L,
}

fn follow<'a, P: Profile>(
    mut segment: Segment<'a>,
    hero: usize,
    stream: &mut Stream,
    along: &mut impl FnMut(&Passed<P::Channels>, &mut Stream),
) -> Followed<'a, P::Channels> {
    let (mut parts, mut sure) = (Vec::new(), None);
    let mut unforced = Unforced::none();
    loop {
        let (interval, hit) = segment.next::<P>(f32::INFINITY);
        let (before, medium) = (unforced, segment.medium);
        if P::EMISSIVE {
            let before = FlightState { ratio: before.through, ..before.state };
            along(&Passed::Medium(FlightPart { medium, interval, before, certain: true }), stream);
        }
        unforced.add::<P>(segment.medium(), &interval, hero, stream);
        let depth = unforced.spent - before.spent;
        if depth > 0.0 {
            parts.push(Part { segment, interval, before, depth });
        }
        let point = hit.map(|hit| segment.surface(&hit));
        if let Some(point) = point.as_ref().filter(|_| P::NULLS) {
            let before = FlightState { ratio: unforced.through, ..unforced.state };
            segment.show_emitter(*point, before, true, stream, along);
            let crossing = segment.sample_crossing(point, stream);
            if !matches!(crossing, NullCrossing::Passed(_, 1.0..)) {
                sure.get_or_insert(unforced.state.depth);
            }
            if unforced.state.cross(&crossing) {
                segment.cross(point);
                continue;
            }
        }
        let Unforced { state, through, spent } = unforced;
        let flight = FreeFlight { interaction: point.map(Interaction::Surface), medium, state };
        let behind = ForcedEnd { flight, share: through.to_spectrum() * state.tint };
        return Followed { parts, behind, depth: spent, sure_depth: sure.unwrap_or(state.depth) };
    }
}

/// A collision in one of `parts`, which have the depth `whole` together. Its depth is exponential, truncated at
/// `whole`.
fn collide<P: Profile>(
    parts: &[Part<'_, P::Channels>],
    whole: f32,
    hero: usize,
    stream: &mut Stream,
) -> Option<ForcedEnd<P::Channels>> {
    let last = parts.last()?;
    let caught = -f64::from(-whole).exp_m1();
    let spent = -(-stream.uniform_precisely() * caught).ln_1p() as f32;
    let part = parts.iter().find(|part| spent - part.before.spent < part.depth).unwrap_or(last);
    let Part { segment, interval, before, .. } = part;
    let remaining = (spent - before.spent).clamp(0.0, part.depth);
    let sample = segment.medium().force_collision::<P>(interval, hero, remaining, stream)?;
    let position = interval.segment.at(sample.collision?);
    let properties = segment.medium().properties_at::<P>(sample.component, position);
    // Positions are rounded: a collision at the very edge may lie outside.
    if P::Channels::from_spectrum(properties.sigma_t).hero(hero) <= 0.0 {
        return None;
    }
    let FlightState { depth, ratio, tint } = before.state;
    let ratio = ratio * sample.ratio * collision_ratio(properties.sigma_t, hero);
    let state = FlightState { depth: depth + sample.depth, ratio, tint };
    let interaction = Some(Interaction::Medium(position, properties));
    let flight = FreeFlight { interaction, medium: segment.medium, state };
    Some(ForcedEnd { flight, share: ratio.to_spectrum() * tint * caught as f32 })
}
