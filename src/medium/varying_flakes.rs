//! Flakes that differ from one point to another, in a medium of any kind. Along a ray the area that they show is that of
//! their mean, times a share between known bounds. Flights are those through the densest flakes that there may be: a
//! collision counts with the probability that flakes there show so much, and the flight goes on where it does not (delta
//! tracking). Transmittance is that of the sparsest, times estimates of what lies between (ratio tracking, Novak et al.
//! 2014): no estimate exceeds 1. Weights use a depth by the shares in a few places.
//!
//! All of these are media of flakes that are the same everywhere, whose trackers are free of bias.

use super::{
    Attenuation, DistanceSample, MediaProfile, Medium, MediumInterval, MediumProperties, Unforced,
    heterogeneous::DEEPEST,
};
use crate::{
    math::{Bounds, Channels, RaySegment, Spectrum, Vec3},
    phase::{Phase, Sggx},
    sampling::Stream,
};

/// A medium, and what it is like with other flakes, the same everywhere.
#[derive(Clone, Debug)]
pub(super) struct VaryingFlakes {
    flakes: Sggx,
    /// The mean of all flakes.
    mean: Medium,
    /// As sparse as they may be, in every direction; none where that is nothing.
    sparsest: Option<Medium>,
    /// As dense.
    densest: Medium,
    /// As dense as the densest are beyond the sparsest.
    between: Medium,
    /// Shares of the mean's area that the sparsest and the densest show.
    shares: [f32; 2],
    is_grey: bool,
}

/// Equal parts of a ray, in the middle of which shares are looked up for depths that need not be exact.
const PIECES: usize = 16;

/// The least share of the mean by which collisions are forced in such a part, however few flakes there are in its middle.
const LEAST: f32 = 0.05;

/// A flight that has met so many places without flakes is taken for past all of them.
const MOST_NULLS: u32 = 1 << 18;

/// No depth of the weights is greater: densities of paths must not underflow where there are fewer flakes than it seems.
const DEEPEST_SEEN: f32 = 30.0;

impl VaryingFlakes {
    /// What `flakes` make of `medium`, whatever its own are.
    pub(super) fn new(medium: &Medium, flakes: &Sggx) -> Self {
        let shares @ [least, most] = flakes.shares();
        let of = |by| Medium { phase: Phase::Sggx(flakes.mean(by)), ..medium.clone() };
        Self {
            flakes: flakes.clone(),
            mean: of(1.0),
            sparsest: (least > 0.0).then(|| of(least)),
            densest: of(most),
            between: of(most - least),
            shares,
            is_grey: !medium.is_chromatic(),
        }
    }

    /// The medium of the mean.
    pub(super) fn mean(&self) -> &Medium {
        &self.mean
    }

    /// The area shown at `t` (m) of a ray over the mean's.
    fn share(&self, segment: &RaySegment, t: f32) -> f32 {
        let RaySegment { direction, .. } = *segment;
        self.flakes.area_at(segment.at(t), direction) / self.flakes.area(direction)
    }

    /// Unbiased estimates of what transmittance is over that of the sparsest, per channel; 0 where nothing of it `arrives`.
    fn beyond_sparsest<M: MediaProfile>(
        &self,
        interval: &MediumInterval,
        arrives: M::Channels,
        stream: &mut Stream,
    ) -> M::Channels {
        let mut found = [0.0; 3];
        for channel in 0..M::Channels::COUNT {
            found[channel] = match arrives.hero(channel) {
                0.0 => 0.0,
                _ if channel > 0 && self.is_grey => found[0],
                _ => self.beyond_sparsest_of::<M>(interval, channel, 1.0, stream),
            };
        }
        M::Channels::from_fn(|channel| found[channel])
    }

    /// The same of one channel, to the power of `sign`, which is 1 or -1.
    fn beyond_sparsest_of<M: MediaProfile>(
        &self,
        interval: &MediumInterval,
        channel: usize,
        sign: f32,
        stream: &mut Stream,
    ) -> f32 {
        let (whole, [least, most]) = (interval.whole(), self.shares);
        let (mut at, mut estimate) = (0.0, 1.0);
        for _ in 0..MOST_NULLS {
            let Some(t) = next::<M>(&self.between, &whole, at, channel, stream) else { break };
            estimate *= 1.0
                - sign * ((self.share(&whole.segment, t as f32) - least) / (most - least)).clamp(0.0, 1.0);
            if estimate == 0.0 {
                break;
            }
            at = t;
        }
        estimate
    }

    /// See [`Medium::properties_at`].
    #[cold]
    #[inline(never)]
    pub(super) fn properties_at<M: MediaProfile>(&self, position: Vec3) -> MediumProperties {
        self.mean.properties_at::<M>(0, position)
    }

    /// See [`Medium::optical_depth`].
    #[cold]
    #[inline(never)]
    pub(super) fn optical_depth<M: MediaProfile>(&self, interval: &MediumInterval) -> M::Channels {
        let nothing = M::Channels::splat(0.0);
        let Some((_, span)) = self.span(&interval.segment) else { return nothing };
        if span.length == f32::INFINITY {
            return self.mean.optical_depth::<M>(interval).at_most(DEEPEST_SEEN);
        }
        let step = span.length / PIECES as f32;
        let depth = |i| {
            let part = part(&span, i, step);
            self.mean.optical_depth::<M>(&MediumInterval::of(part)).scaled(self.share(&part, 0.5 * step))
        };
        (0..PIECES).map(depth).fold(nothing, |sum, depth| sum + depth).at_most(DEEPEST_SEEN)
    }

    /// The part of a ray, and where it starts (m), beyond which nothing of the medium can be; none where nothing is.
    fn span(&self, segment: &RaySegment) -> Option<(f32, RaySegment)> {
        let Some(Bounds { low, high }) = self.mean.extent() else { return Some((0.0, *segment)) };
        let [first, last] = segment.within(low, high)?;
        Some((first, RaySegment { origin: segment.at(first), length: last - first, ..*segment }))
    }

    /// See [`Medium::attenuation`].
    #[cold]
    #[inline(never)]
    pub(super) fn attenuation<M: MediaProfile>(
        &self,
        interval: &MediumInterval,
        stream: &mut Stream,
    ) -> Option<Attenuation<M::Channels>> {
        let sparsest = match &self.sparsest {
            Some(medium) => medium.attenuation::<M>(interval, stream)?.transmittance,
            None => M::Channels::splat(1.0),
        };
        let transmittance = sparsest * self.beyond_sparsest::<M>(interval, sparsest, stream);
        let depth = self.optical_depth::<M>(interval);
        (transmittance.sum() > 0.0).then_some(Attenuation { depth, transmittance })
    }

    /// See [`Medium::transmittance_ratio`].
    #[cold]
    #[inline(never)]
    pub(super) fn transmittance_ratio<M: MediaProfile>(
        &self,
        interval: &MediumInterval,
        hero: usize,
        stream: &mut Stream,
    ) -> M::Channels {
        let one = M::Channels::splat(1.0);
        if M::Channels::COUNT == 1 || self.is_grey {
            return one;
        }
        let sparsest = self.sparsest.as_ref().map_or(one, |medium| {
            let depth = medium.optical_depth::<M>(interval);
            medium.transmittance_ratio::<M>(interval, depth, hero, stream)
        });
        let ratio = sparsest * self.beyond_sparsest::<M>(interval, sparsest, stream);
        let over_hero = self.beyond_sparsest_of::<M>(interval, hero, -1.0, stream);
        M::Channels::from_fn(|channel| if channel == hero { 1.0 } else { ratio.hero(channel) * over_hero })
    }

    /// See [`Medium::sample_distance`]. Flights have no memory: the optical depth that one comes with is left for the
    /// media behind.
    #[cold]
    #[inline(never)]
    pub(super) fn sample_distance<M: MediaProfile>(
        &self,
        interval: &MediumInterval,
        hero: usize,
        stream: &mut Stream,
    ) -> DistanceSample<M::Channels> {
        let (whole, [_, most]) = (interval.whole(), self.shares);
        let (mut at, mut collision) = (0.0, None);
        for _ in 0..MOST_NULLS {
            let Some(t) = next::<M>(&self.densest, &whole, at, hero, stream) else { break };
            let there = (t as f32 - interval.skipped).max(0.0);
            // Where light will scatter, to the last bit: a rounding error farther there may be no flakes.
            if stream.uniform() * most < self.share(&interval.segment, there) {
                collision = Some(there);
                break;
            }
            at = t;
        }
        let passed = collision.map_or(*interval, |t| interval.up_to(t));
        let depth = self.optical_depth::<M>(&passed);
        let ratio = self.transmittance_ratio::<M>(&passed, hero, stream);
        DistanceSample { collision, component: 0, depth, ratio, spent: 0.0 }
    }

    /// See [`Medium::unforced`].
    #[cold]
    #[inline(never)]
    pub(super) fn unforced<M: MediaProfile>(
        &self,
        interval: &MediumInterval,
        hero: usize,
        stream: &mut Stream,
    ) -> Unforced<M::Channels> {
        let found = self.attenuation::<M>(interval, stream);
        let transmittance = found.map_or(M::Channels::splat(0.0), |found| found.transmittance);
        let depth = self.forced_depth::<M>(interval, hero);
        Unforced { transmittance, depth, ratio: transmittance.scaled(depth.min(DEEPEST).exp()) }
    }

    /// See [`Medium::forced_depth`].
    #[cold]
    #[inline(never)]
    pub(super) fn forced_depth<M: MediaProfile>(&self, interval: &MediumInterval, hero: usize) -> f32 {
        self.forcing::<M>(interval, hero).map_or(0.0, |Forcing { depths, .. }| depths.iter().sum())
    }

    /// How collisions are forced in an interval; none where nothing of the medium can be.
    fn forcing<M: MediaProfile>(&self, interval: &MediumInterval, hero: usize) -> Option<Forcing> {
        let (first, mut span) = self.span(&interval.whole().segment)?;
        if span.length == f32::INFINITY {
            // As far as anything of the sparsest is left.
            let sigma_t = M::Channels::from_spectrum(self.mean.bound().sigma_t).hero(hero);
            let least = if self.shares[0] > 0.0 { self.shares[0] } else { 1.0 };
            span.length = DEEPEST / (sigma_t * self.flakes.area(span.direction) * least);
        }
        let step = span.length / PIECES as f32;
        let depths = std::array::from_fn(|i| {
            let part = part(&span, i, step);
            let mean = self.mean.forced_depth::<M>(&MediumInterval::of(part), hero);
            (mean * self.share(&part, 0.5 * step).max(LEAST)).min(1.0)
        });
        Some(Forcing { first, step, depths })
    }

    /// See [`Medium::force_collision`].
    #[cold]
    #[inline(never)]
    pub(super) fn force_collision<M: MediaProfile>(
        &self,
        interval: &MediumInterval,
        hero: usize,
        remaining: f32,
        stream: &mut Stream,
    ) -> Option<DistanceSample<M::Channels>> {
        let (whole, forcing) = (interval.whole(), self.forcing::<M>(interval, hero)?);
        let (t, density) = forcing.at(remaining);
        let collision = (t - interval.skipped).max(0.0);
        let (position, direction) = (interval.segment.at(collision), interval.segment.direction);
        let sigma_t = M::Channels::from_spectrum(self.properties_at::<M>(position).sigma_t).hero(hero);
        let extinction = sigma_t * self.flakes.area_at(position, direction);
        let weight = remaining.min(DEEPEST).exp() * extinction / density;
        if !(weight > 0.0 && weight < f32::INFINITY) {
            return None;
        }
        let Attenuation { depth, transmittance } = self.attenuation::<M>(&whole.up_to(t), stream)?;
        let (collision, ratio) = (Some(collision), transmittance.scaled(weight));
        Some(DistanceSample { collision, component: 0, depth, ratio, spent: 0.0 })
    }

    /// See [`Medium::quick_depth`].
    pub(super) fn quick_depth(&self, segment: &RaySegment) -> Spectrum {
        let mean = self.mean.quick_depth(segment);
        if segment.length == f32::INFINITY {
            return mean;
        }
        let step = segment.length / PIECES as f32;
        let shares = (0..PIECES).map(|i| self.share(segment, (i as f32 + 0.5) * step));
        mean * (shares.sum::<f32>() / PIECES as f32)
    }
}

/// Equal parts of a ray that are as deep as it seems by what lies in their middle, but no deeper than 1: where there are
/// fewer flakes than there seem to be, collisions behind them must not become rare.
struct Forcing {
    /// Where the first begins (m).
    first: f32,
    /// Length of one (m).
    step: f32,
    depths: [f32; PIECES],
}

impl Forcing {
    /// Where the depth is `remaining` (m from the boundary), and how fast it grows there (1/m).
    fn at(&self, remaining: f32) -> (f32, f32) {
        let (mut index, mut left) = (0, remaining);
        while index + 1 < PIECES && left >= self.depths[index] {
            left -= self.depths[index];
            index += 1;
        }
        let within = (left / self.depths[index]).min(1.0);
        (self.first + (index as f32 + within) * self.step, self.depths[index] / self.step)
    }
}

/// Part `i` of those of `step` metres along a ray.
fn part(segment: &RaySegment, i: usize, step: f32) -> RaySegment {
    RaySegment { origin: segment.at(i as f32 * step), length: step, ..*segment }
}

/// The next collision of the `hero` channel in `medium` beyond `from` (m); none in what is left of `interval`.
fn next<M: MediaProfile>(
    medium: &Medium,
    interval: &MediumInterval,
    from: f64,
    hero: usize,
    stream: &mut Stream,
) -> Option<f64> {
    let RaySegment { direction, length, .. } = interval.segment;
    let left = (f64::from(length) - from).max(0.0) as f32;
    let rest = RaySegment { origin: interval.segment.at(from as f32), direction, length: left };
    let flight = medium.sample_distance::<M>(&MediumInterval::of(rest), hero, stream.exponential(), stream);
    flight.collision.map(|t| (from + f64::from(t)).min(length.into()))
}
