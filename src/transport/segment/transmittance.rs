//! Transmittance of a segment with given ends.

use super::Segment;
use crate::{
    math::{Channels, RaySegment, Spectrum},
    medium::{Attenuation, Medium, MediumIndex, MediumInterval},
    sampling::Stream,
    scene::Scene,
    shape::Ray,
    transport::profile::Profile,
};

/// A given segment that nothing blocks.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SegmentTransmittance<L> {
    /// exp(-depth) per channel as the weights use it: the density of a flight that ends on a surface (LW96
    /// eq. 7), see [`super::free_flight::FlightPart`].
    pub pdf: L,
    /// The fraction of radiance that arrives; where a medium's tracker is random, an unbiased estimate of it.
    pub transmittance: Spectrum,
    /// The medium at its end.
    pub medium: MediumIndex,
}

/// Transmittance along `ray` (its `t_max` is the segment's length, infinite for an emitter at infinity), starting in
/// `medium`; none where a surface blocks it or an estimate is 0. The ray stops `cut` short of the segment's end, to be
/// clear of the surface there, but the medium reaches to the end. Emitters do not block if `hidden`.
///
/// LW96 eq. 10: T and the visibility in g(x, y).
#[inline]
pub(crate) fn transmittance<P: Profile>(
    scene: &Scene,
    ray: Ray,
    cut: f32,
    medium: MediumIndex,
    hidden: bool,
    stream: &mut Stream,
) -> Option<SegmentTransmittance<P::Channels>> {
    if P::NULLS {
        return across_boundaries::<P>(Segment::along(scene, ray, medium, hidden), cut, stream);
    }
    if scene.geometry.occluded(&ray) {
        return None;
    }
    let mut product = Product::<P>::new();
    let Ray { origin, direction, t_max } = ray;
    let interval = MediumInterval::of(RaySegment { origin, direction, length: t_max + cut });
    product.add(&scene.media[medium.0 as usize], &interval, stream)?;
    Some(product.ending_in(medium))
}

fn across_boundaries<P: Profile>(
    mut segment: Segment<'_>,
    cut: f32,
    stream: &mut Stream,
) -> Option<SegmentTransmittance<P::Channels>> {
    let Ray { origin, direction, t_max } = *segment.ray();
    let end = (t_max < f32::INFINITY).then(|| origin + direction * t_max);
    let mut product = Product::<P>::new();
    loop {
        let (mut interval, hit) = segment.next::<P>(f32::INFINITY);
        let Some(hit) = hit else {
            interval.segment.length += cut;
            product.add(segment.medium(), &interval, stream)?;
            return Some(product.ending_in(segment.medium));
        };
        let point = segment.surface(&hit);
        let through = segment.transmission(&point);
        if through.max_element() <= 0.0 {
            return None;
        }
        product.passing *= through.max_element();
        product.tint *= through;
        product.add(segment.medium(), &interval, stream)?;
        segment.cross(&point);
        if let Some(end) = end {
            segment.aim(end);
        }
    }
}

/// What the segment has crossed so far.
struct Product<P: Profile> {
    depth: P::Channels,
    /// Product of the transmittances of all intervals, some of them estimates; where nothing varies, left at 1.
    estimate: P::Channels,
    /// Product of the probabilities of passing half-transparent surfaces.
    passing: f32,
    /// Product of the fractions that they let through.
    tint: Spectrum,
}

impl<P: Profile> Product<P> {
    #[inline]
    fn new() -> Self {
        let (zero, one) = (P::Channels::splat(0.0), P::Channels::splat(1.0));
        Self { depth: zero, estimate: one, passing: 1.0, tint: Spectrum::ONE }
    }

    /// Goes on through `interval` of `medium`; none where nothing gets through.
    #[inline(always)]
    fn add(&mut self, medium: &Medium, interval: &MediumInterval, stream: &mut Stream) -> Option<()> {
        if P::HETEROGENEOUS {
            let Attenuation { depth, transmittance } = medium.attenuation::<P>(interval, stream)?;
            self.depth = self.depth + depth;
            self.estimate = self.estimate * transmittance;
        } else if P::MEDIA {
            self.depth = self.depth + medium.optical_depth::<P>(interval);
        }
        Some(())
    }

    #[inline(always)]
    fn ending_in(&self, medium: MediumIndex) -> SegmentTransmittance<P::Channels> {
        let pdf = if P::MEDIA { self.depth.exp_neg() } else { P::Channels::splat(1.0) };
        let transmittance = if P::HETEROGENEOUS { self.estimate } else { pdf };
        SegmentTransmittance {
            pdf: pdf.scaled(self.passing),
            transmittance: transmittance.to_spectrum() * self.tint,
            medium,
        }
    }
}
