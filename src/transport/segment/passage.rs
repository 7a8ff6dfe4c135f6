//! The passage: what remains along a segment that is given.

use super::{depth_of, passed, past};
use crate::{
    math::{Lanes, Section, Spectrum, measure},
    medium::MediumIndex,
    sampling::Stream,
    scene::Scene,
    shape::Ray,
    transport::profile::Profile,
};

/// A given segment that nothing blocks.
#[derive(Clone, Copy, Debug)]
pub struct Passage<L> {
    /// exp(-depth) per lane as weights know it: the surface flight density (LW96 eq. 7), see
    /// [`super::Flight::depth`].
    pub density: L,
    /// The fraction of radiance that arrives; where a medium's tracker is random, an unbiased estimate of it.
    pub transmittance: Spectrum,
    /// The medium at its end.
    pub medium: MediumIndex,
}

/// What remains of radiance along `ray` (its `t_max` is the segment's length, infinite for an emitter at
/// infinity), starting in `medium`; none where a surface blocks it. The ray stops `cut` short of the segment's
/// end to be clear of the surface there: the medium reaches on to the end. `hidden` as in [`super::fly`].
#[inline]
pub fn pass<P: Profile>(
    scene: &Scene,
    ray: Ray,
    cut: f32,
    medium: MediumIndex,
    hidden: bool,
    stream: &mut Stream,
) -> Option<Passage<P::Lanes>> {
    if P::NULLS {
        return pass_through::<P>(scene, ray, cut, medium, hidden, stream);
    }
    if scene.geometry.occluded(&ray) {
        return None;
    }
    let mut way = Way::<P>::new();
    way.add(scene, medium, &ray, ray.t_max + cut, 0.0, stream);
    Some(way.passage(medium))
}

fn pass_through<P: Profile>(
    scene: &Scene,
    mut ray: Ray,
    cut: f32,
    mut medium: MediumIndex,
    hidden: bool,
    stream: &mut Stream,
) -> Option<Passage<P::Lanes>> {
    let end = ray.origin + ray.direction * ray.t_max;
    let mut way = Way::<P>::new();
    let mut skipped = 0.0;
    loop {
        let Some(hit) = scene.geometry.closest(&ray) else {
            way.add(scene, medium, &ray, ray.t_max + cut, skipped, stream);
            return Some(way.passage(medium));
        };
        let point = scene.geometry.surface(&ray, &hit);
        let through = passed(scene, &point, ray.direction, hidden);
        if through.max_element() <= 0.0 {
            return None;
        }
        way.passing *= through.max_element();
        way.tint *= through;
        way.add(scene, medium, &ray, hit.t, skipped, stream);
        (ray, skipped) = past(&ray, &point);
        medium = scene.medium_beyond(&point, &ray, medium);
        if ray.t_max < f32::INFINITY {
            // Crossings are rounded: aimed anew, the segment ends where it should, not in the surface beyond.
            let (aim, t_max, _) = measure::between(ray.origin, end).unwrap_or((ray.direction, 0.0, 0.0));
            // An end so near to the boundary that the step across passed it has been reached.
            let overshot = aim.dot(ray.direction) <= 0.0;
            ray = if overshot { Ray { t_max: 0.0, ..ray } } else { Ray { direction: aim, t_max, ..ray } };
        }
    }
}

/// What lies behind while a segment is followed.
struct Way<P: Profile> {
    depth: P::Lanes,
    /// Product of the transmittances of all legs, some of them estimates; where nothing varies, left at 1.
    estimate: P::Lanes,
    /// Product of the probabilities of passing half-transparent surfaces.
    passing: f32,
    /// Product of what they let through.
    tint: Spectrum,
}

impl<P: Profile> Way<P> {
    #[inline]
    fn new() -> Self {
        let (zero, one) = (P::Lanes::splat(0.0), P::Lanes::splat(1.0));
        Self { depth: zero, estimate: one, passing: 1.0, tint: Spectrum::ONE }
    }

    /// Goes `length` along `ray` through `medium`, which began `skipped` metres before; see [`past`].
    #[inline(always)]
    fn add(
        &mut self,
        scene: &Scene,
        medium: MediumIndex,
        ray: &Ray,
        length: f32,
        skipped: f32,
        stream: &mut Stream,
    ) {
        if !P::MEDIA {
            return;
        }
        let medium = &scene.media[medium.0 as usize];
        if P::HETEROGENEOUS
            && let Some(varying) = &medium.varying
        {
            let section = Section { origin: ray.origin, direction: ray.direction, length };
            let depth = varying.depth::<P::Lanes>(&section);
            self.depth = self.depth + depth;
            self.estimate = self.estimate * varying.transmittance::<P::Lanes>(&section, depth, stream);
            return;
        }
        let depth = depth_of(P::Lanes::from_spectrum(medium.sigma_t), length + skipped);
        self.depth = self.depth + depth;
        if P::HETEROGENEOUS {
            self.estimate = self.estimate * depth.exp_neg();
        }
    }

    #[inline(always)]
    fn passage(&self, medium: MediumIndex) -> Passage<P::Lanes> {
        let density = if P::MEDIA { self.depth.exp_neg() } else { P::Lanes::splat(1.0) };
        let transmittance = if P::HETEROGENEOUS { self.estimate } else { density };
        Passage {
            density: density.scaled(self.passing),
            transmittance: transmittance.to_spectrum() * self.tint,
            medium,
        }
    }
}
