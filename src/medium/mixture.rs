//! Several media in one place: their coefficients add. Each medium samples a flight of its own, and the first collision
//! counts; the vertex has the sigma_t, albedo and phase function of its medium. Its density is that of the flight,
//! exp(-depth of all), times the sigma_t of this medium. Summed over the media, this is the density in a medium of
//! summed coefficients.

use super::{Attenuation, DistanceSample, MediaProfile, Medium, MediumInterval, MediumProperties, Unforced};
use crate::{
    math::{Channels, RaySegment, Spectrum, Vec3},
    sampling::Stream,
};
use std::sync::Arc;

/// Media that overlap.
#[derive(Clone, Debug)]
pub(super) struct Mixture(pub Arc<[Medium]>);

impl Mixture {
    /// Bounds: sigma_t of all together, and the largest albedo.
    pub(super) fn bound(&self) -> (Spectrum, Spectrum) {
        let sum = |all: Spectrum, medium: &Medium| all + medium.bound().sigma_t;
        let largest = |most: Spectrum, medium: &Medium| most.max(medium.bound().albedo);
        (self.0.iter().fold(Spectrum::ZERO, sum), self.0.iter().fold(Spectrum::ZERO, largest))
    }

    /// Properties at `position` of the medium that collides.
    #[cold]
    #[inline(never)]
    pub(super) fn properties_at<M: MediaProfile>(
        &self,
        component: usize,
        position: Vec3,
    ) -> MediumProperties {
        self.0[component].properties_at::<M>(0, position)
    }

    /// See [`Medium::optical_depth`].
    #[cold]
    #[inline(never)]
    pub(super) fn optical_depth<M: MediaProfile>(&self, interval: &MediumInterval) -> M::Channels {
        let add = |sum: M::Channels, medium: &Medium| sum + medium.optical_depth::<M>(interval);
        self.0.iter().fold(M::Channels::splat(0.0), add)
    }

    /// See [`Medium::attenuation`].
    #[cold]
    #[inline(never)]
    pub(super) fn attenuation<M: MediaProfile>(
        &self,
        interval: &MediumInterval,
        stream: &mut Stream,
    ) -> Option<Attenuation<M::Channels>> {
        self.attenuation_beside::<M>(self.0.len(), interval, stream)
    }

    /// The same of all but one.
    fn attenuation_beside<M: MediaProfile>(
        &self,
        component: usize,
        interval: &MediumInterval,
        stream: &mut Stream,
    ) -> Option<Attenuation<M::Channels>> {
        let nothing = Attenuation { depth: M::Channels::splat(0.0), transmittance: M::Channels::splat(1.0) };
        self.others(component).try_fold(nothing, |all, medium| {
            let Attenuation { depth, transmittance } = medium.attenuation::<M>(interval, stream)?;
            Some(Attenuation { depth: all.depth + depth, transmittance: all.transmittance * transmittance })
        })
    }

    /// All but one.
    fn others(&self, component: usize) -> impl Iterator<Item = &Medium> {
        self.0.iter().enumerate().filter(move |(index, _)| *index != component).map(|(_, medium)| medium)
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
        self.ratio_beside::<M>(self.0.len(), interval, hero, stream).1
    }

    /// Depth and ratio of all but one.
    fn ratio_beside<M: MediaProfile>(
        &self,
        component: usize,
        interval: &MediumInterval,
        hero: usize,
        stream: &mut Stream,
    ) -> (M::Channels, M::Channels) {
        let nothing = (M::Channels::splat(0.0), M::Channels::splat(1.0));
        self.others(component).fold(nothing, |(depths, ratios), medium| {
            let depth = medium.optical_depth::<M>(interval);
            let ratio = medium.transmittance_ratio::<M>(interval, depth, hero, stream);
            (depths + depth, ratios * ratio)
        })
    }

    /// See [`Medium::sample_distance`]. Flights have no memory: every medium draws its own, and the optical depth that
    /// the flight came with is left for the media behind.
    #[cold]
    #[inline(never)]
    pub(super) fn sample_distance<M: MediaProfile>(
        &self,
        interval: &MediumInterval,
        hero: usize,
        stream: &mut Stream,
    ) -> DistanceSample<M::Channels> {
        let mut passed = DistanceSample::exact(None, M::Channels::splat(0.0), hero);
        let (mut reached, mut first) = (*interval, None);
        for (component, medium) in self.0.iter().enumerate() {
            let sample = medium.sample_distance::<M>(&reached, hero, stream.exponential(), stream);
            if let Some(t) = sample.collision {
                reached.segment.length = t;
                first = Some(DistanceSample { component, ..sample });
            }
            passed.depth = passed.depth + sample.depth;
            passed.ratio = passed.ratio * sample.ratio;
        }
        let Some(sample) = first else { return passed };
        // The other media were passed up to there, however far their own flights would have gone.
        let (depth, ratio) = self.ratio_beside::<M>(sample.component, &reached, hero, stream);
        DistanceSample { depth: sample.depth + depth, ratio: sample.ratio * ratio, spent: 0.0, ..sample }
    }

    /// See [`Medium::forced_depth`].
    #[cold]
    #[inline(never)]
    pub(super) fn forced_depth<M: MediaProfile>(&self, interval: &MediumInterval, hero: usize) -> f32 {
        self.0.iter().map(|medium| medium.forced_depth::<M>(interval, hero)).sum()
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
        let one = M::Channels::splat(1.0);
        let nothing = Unforced { transmittance: one, depth: 0.0, ratio: one };
        self.0.iter().fold(nothing, |all, medium| {
            let depth = medium.optical_depth::<M>(interval);
            let own = medium.unforced::<M>(interval, depth, hero, stream);
            Unforced {
                transmittance: all.transmittance * own.transmittance,
                depth: all.depth + own.depth,
                ratio: all.ratio * own.ratio,
            }
        })
    }

    /// See [`Medium::force_collision`]. A medium is chosen by its share of the depth, and collides where it has used up
    /// the same part of its own depth as `remaining` is of all: the density of both is exp(-`remaining`) sigma_t.
    #[cold]
    #[inline(never)]
    pub(super) fn force_collision<M: MediaProfile>(
        &self,
        interval: &MediumInterval,
        hero: usize,
        remaining: f32,
        stream: &mut Stream,
    ) -> Option<DistanceSample<M::Channels>> {
        let depth = self.forced_depth::<M>(interval, hero);
        let mut left = stream.uniform() * depth;
        let (component, medium, own) = (0..).zip(self.0.iter()).find_map(|(index, medium)| {
            let own = medium.forced_depth::<M>(interval, hero);
            left -= own;
            (left < 0.0).then_some((index, medium, own))
        })?;
        let own_remaining = (remaining / depth * own).min(own);
        let sample = medium.force_collision::<M>(interval, hero, own_remaining, stream)?;
        let mut reached = *interval;
        reached.segment.length = sample.collision?;
        let beside = self.attenuation_beside::<M>(component, &reached, stream)?;
        let ratio = (sample.ratio * beside.transmittance).scaled((remaining - own_remaining).exp());
        Some(DistanceSample { component, depth: sample.depth + beside.depth, ratio, ..sample })
    }

    /// See [`Medium::quick_depth`].
    pub(super) fn quick_depth(&self, segment: &RaySegment) -> Spectrum {
        self.0.iter().map(|medium| medium.quick_depth(segment)).sum()
    }
}
