//! Flakes that differ from one point to another, in a medium of any kind. Along a ray the area that they show is that of
//! their mean, times a share between known bounds. Flights are those through flakes that show the greatest area: a
//! collision counts with the probability that flakes there show it, and the flight goes on where it does not (delta
//! tracking). Transmittance is that of the mean, corrected by the shares at random points (residual ratio tracking, Novak
//! et al. 2014). Weights use the mean alone.
//!
//! All three are media of flakes that are the same everywhere, whose trackers are free of bias.

use super::{Attenuation, DistanceSample, MediaProfile, Medium, MediumInterval, MediumProperties, Unforced};
use crate::{
    math::{Channels, RaySegment, Spectrum, Vec3},
    phase::{Phase, Sggx},
    sampling::Stream,
};

/// A medium with its flakes replaced by others, the same everywhere.
#[derive(Clone, Debug)]
pub(super) struct VaryingFlakes {
    flakes: Sggx,
    /// The mean of all flakes.
    mean: Medium,
    /// As dense as they may be, in every direction.
    densest: Medium,
    /// As dense as they may differ from the mean.
    deviation: Medium,
    /// The greatest share of the mean's area, and how far a share may lie from 1.
    most: f32,
    spread: f32,
}

impl VaryingFlakes {
    /// What `flakes` make of `medium`, whatever its own are.
    pub(super) fn new(medium: &Medium, flakes: &Sggx) -> Self {
        let [least, most] = flakes.shares();
        let spread = (most - 1.0).max(1.0 - least);
        let of = |by| Medium { phase: Phase::Sggx(flakes.mean(by)), ..medium.clone() };
        Self { flakes: flakes.clone(), mean: of(1.0), densest: of(most), deviation: of(spread), most, spread }
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

    /// Unbiased estimates of what transmittance is over the mean's, per channel; 0 where nothing of it `arrives`.
    fn corrections<M: MediaProfile>(
        &self,
        interval: &MediumInterval,
        arrives: M::Channels,
        stream: &mut Stream,
    ) -> M::Channels {
        let mut corrections = [0.0; 3];
        for (channel, correction) in corrections.iter_mut().enumerate().take(M::Channels::COUNT) {
            if arrives.hero(channel) != 0.0 {
                *correction = self.correction::<M>(interval, channel, 1.0, stream);
            }
        }
        M::Channels::from_fn(|channel| corrections[channel])
    }

    /// The same of one channel, to the power of `sign`, which is 1 or -1.
    fn correction<M: MediaProfile>(
        &self,
        interval: &MediumInterval,
        channel: usize,
        sign: f32,
        stream: &mut Stream,
    ) -> f32 {
        let whole = interval.whole();
        let (mut at, mut correction) = (0.0, 1.0);
        while let Some(t) = next::<M>(&self.deviation, &whole, at, channel, stream) {
            correction *= 1.0 - sign * (self.share(&whole.segment, t as f32) - 1.0) / self.spread;
            at = t;
        }
        correction
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
        self.mean.optical_depth::<M>(interval)
    }

    /// See [`Medium::attenuation`].
    #[cold]
    #[inline(never)]
    pub(super) fn attenuation<M: MediaProfile>(
        &self,
        interval: &MediumInterval,
        stream: &mut Stream,
    ) -> Option<Attenuation<M::Channels>> {
        let Attenuation { depth, transmittance } = self.mean.attenuation::<M>(interval, stream)?;
        let transmittance = transmittance * self.corrections::<M>(interval, transmittance, stream);
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
        if M::Channels::COUNT == 1 {
            return M::Channels::splat(1.0);
        }
        let depth = self.mean.optical_depth::<M>(interval);
        let ratio = self.mean.transmittance_ratio::<M>(interval, depth, hero, stream);
        let ratio = ratio * self.corrections::<M>(interval, ratio, stream);
        let over_hero = self.correction::<M>(interval, hero, -1.0, stream);
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
        let whole = interval.whole();
        let mut at = 0.0;
        let collision = loop {
            let Some(t) = next::<M>(&self.densest, &whole, at, hero, stream) else { break None };
            let collision = (t as f32 - interval.skipped).max(0.0);
            // Where light will scatter, to the last bit: a rounding error farther there may be no flakes.
            if stream.uniform() * self.most < self.share(&interval.segment, collision) {
                break Some(collision);
            }
            at = t;
        };
        let passed = collision.map_or(*interval, |t| interval.up_to(t));
        let depth = self.mean.optical_depth::<M>(&passed);
        let ratio = self.transmittance_ratio::<M>(&passed, hero, stream);
        DistanceSample { collision, component: 0, depth, ratio, spent: 0.0 }
    }

    /// See [`Medium::unforced`].
    #[cold]
    #[inline(never)]
    pub(super) fn unforced<M: MediaProfile>(
        &self,
        interval: &MediumInterval,
        depth: M::Channels,
        hero: usize,
        stream: &mut Stream,
    ) -> Unforced<M::Channels> {
        let Unforced { transmittance, depth, ratio } = self.mean.unforced::<M>(interval, depth, hero, stream);
        let corrections = self.corrections::<M>(interval, transmittance, stream);
        Unforced { transmittance: transmittance * corrections, depth, ratio: ratio * corrections }
    }

    /// See [`Medium::forced_depth`].
    #[cold]
    #[inline(never)]
    pub(super) fn forced_depth<M: MediaProfile>(&self, interval: &MediumInterval, hero: usize) -> f32 {
        self.mean.forced_depth::<M>(interval, hero)
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
        let sample = self.mean.force_collision::<M>(interval, hero, remaining, stream)?;
        let t = sample.collision?;
        let share = self.share(&interval.segment, t);
        if share <= 0.0 {
            return None;
        }
        let corrections = self.corrections::<M>(&interval.up_to(t), sample.ratio, stream);
        Some(DistanceSample { ratio: (sample.ratio * corrections).scaled(share), ..sample })
    }

    /// See [`Medium::quick_depth`].
    pub(super) fn quick_depth(&self, segment: &RaySegment) -> Spectrum {
        let mean = self.mean.quick_depth(segment);
        if segment.length == f32::INFINITY {
            return mean;
        }
        let step = segment.length / GLANCES as f32;
        let shares = (0..GLANCES).map(|i| self.share(segment, (i as f32 + 0.5) * step));
        mean * (shares.sum::<f32>() / GLANCES as f32)
    }
}

/// Points at which [`VaryingFlakes::quick_depth`] looks.
const GLANCES: u32 = 16;

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
