//! Segments between path vertices: the flight that samples one, and the passage along a given one. They own
//! distances, optical depths and boundary crossings; media enter transport here and nowhere else.

use super::profile::Profile;
use crate::{
    math::{Lanes, Spectrum, Vec3, measure, offset},
    medium::MediumIndex,
    sampling::Stream,
    scene::Scene,
    shape::{Ray, SurfacePoint},
};

/// How a flight ended.
#[derive(Clone, Copy, Debug)]
pub enum Landing {
    /// On a surface that scatters.
    Surface(SurfacePoint),
    /// At a collision in the medium.
    Medium(Vec3),
    /// At infinity.
    Escape,
}

/// A sampled segment (LW96 eq. 4-7).
#[derive(Clone, Copy, Debug)]
pub struct Flight<L> {
    /// Where it ended.
    pub landing: Landing,
    /// The medium at its end.
    pub medium: MediumIndex,
    /// Optical depth per lane, the logarithms of null-passing probabilities included: the flight density is
    /// exp(-depth), times sigma_t at a collision.
    pub depth: L,
    /// Null transmittances over their passing probabilities; 1 where none was tinted.
    pub tint: Spectrum,
}

/// A given segment that nothing blocks.
#[derive(Clone, Copy, Debug)]
pub struct Passage<L> {
    /// exp(-depth) per lane: the surface flight density (LW96 eq. 7), as in [`Flight::depth`].
    pub density: L,
    /// The fraction of radiance that arrives.
    pub transmittance: Spectrum,
}

/// Samples a segment from `origin` along unit `direction`, starting in `medium`, no longer than `t_max`: an
/// exponential optical depth by the `hero` channel, until a surface, a collision, or infinity. Where emitters are
/// `hidden`, the ray passes them; only profiles with nulls can.
#[inline(always)]
pub fn fly<P: Profile>(
    scene: &Scene,
    ray: Ray,
    medium: MediumIndex,
    hidden: bool,
    hero: usize,
    stream: &mut Stream,
) -> Flight<P::Lanes> {
    let remaining = if P::MEDIA { stream.exponential() } else { 0.0 };
    if P::NULLS {
        fly_through::<P>(scene, ray, medium, hidden, hero, remaining, stream)
    } else {
        fly_straight::<P>(scene, ray, medium, hero, remaining)
    }
}

/// A flight where every surface scatters: one ray, no longer than the sampled distance.
#[inline(always)]
fn fly_straight<P: Profile>(
    scene: &Scene,
    mut ray: Ray,
    medium: MediumIndex,
    hero: usize,
    remaining: f32,
) -> Flight<P::Lanes> {
    let sigma_t = P::Lanes::from_spectrum(scene.media[medium.0 as usize].sigma_t);
    let limit = ray.t_max;
    let collision = if P::MEDIA { remaining / sigma_t.hero(hero) } else { f32::INFINITY };
    ray.t_max = collision.min(limit);
    let (landing, distance) = match scene.geometry.closest(&ray) {
        Some(hit) => (Landing::Surface(scene.geometry.surface(&ray, &hit)), hit.t),
        None if collision < limit => (Landing::Medium(ray.origin + ray.direction * collision), collision),
        None => (Landing::Escape, f32::INFINITY),
    };
    let depth = if P::MEDIA { depth_of(sigma_t, distance) } else { P::Lanes::splat(0.0) };
    Flight { landing, medium, depth, tint: Spectrum::ONE }
}

/// Optical depth of a distance that may be infinite: nothing times infinity is nothing.
#[inline]
fn depth_of<L: Lanes>(sigma_t: L, distance: f32) -> L {
    if distance < f32::INFINITY {
        return sigma_t.scaled(distance);
    }
    let sigma_t = sigma_t.to_spectrum();
    let lane = |s: f32| if s > 0.0 { f32::INFINITY } else { 0.0 };
    L::from_spectrum(Spectrum::new(lane(sigma_t.x), lane(sigma_t.y), lane(sigma_t.z)))
}

/// A flight that may pass surfaces: each crossing switches the medium, and takes its toll where the surface
/// lets only a part through.
fn fly_through<P: Profile>(
    scene: &Scene,
    mut ray: Ray,
    mut medium: MediumIndex,
    hidden: bool,
    hero: usize,
    mut remaining: f32,
    stream: &mut Stream,
) -> Flight<P::Lanes> {
    let mut depth = P::Lanes::splat(0.0);
    let mut tint = Spectrum::ONE;
    loop {
        let leg = fly_straight::<P>(scene, ray, medium, hero, remaining);
        depth = depth + leg.depth;
        let Landing::Surface(point) = leg.landing else {
            return Flight { landing: leg.landing, medium, depth, tint };
        };
        let through = passed(scene, &point, ray.direction, hidden);
        let passing = through.max_element();
        if passing <= 0.0 || (passing < 1.0 && stream.uniform() >= passing) {
            // Stopping where a part passes has probability 1 - passing, from either side: it takes the place
            // of sigma_t at a collision, cancels in every ratio of densities, and divides the throughput.
            tint /= 1.0 - passing.max(0.0);
            return Flight { landing: leg.landing, medium, depth, tint };
        }
        tint *= through / passing;
        depth = depth + P::Lanes::splat(-passing.ln());
        remaining = (remaining - leg.depth.hero(hero)).max(0.0);
        ray = past(&ray, &point);
        medium = scene.medium_beyond(&point, &ray, medium);
    }
}

/// The part of light that passes a surface point undeflected.
#[inline]
fn passed(scene: &Scene, point: &SurfacePoint, direction: Vec3, hidden: bool) -> Spectrum {
    if hidden && scene.surface(point.shape).emitter.is_some() {
        return Spectrum::ONE;
    }
    scene.null_transmission(point, direction)
}

/// The rest of a ray beyond a surface point that it crosses.
#[inline]
fn past(ray: &Ray, point: &SurfacePoint) -> Ray {
    let origin = offset::leave_surface(point.position, point.error, point.normal, ray.direction);
    let t_max = ray.t_max - (origin - ray.origin).dot(ray.direction);
    Ray { origin, direction: ray.direction, t_max }
}

/// What remains of radiance along `ray` (its `t_max` is the segment's length, infinite for an emitter at
/// infinity), starting in `medium`; none where a surface blocks it. The ray stops `cut` short of the segment's
/// end to be clear of the surface there: the medium reaches on to the end. `hidden` as in [`fly`].
#[inline]
pub fn pass<P: Profile>(
    scene: &Scene,
    ray: Ray,
    cut: f32,
    medium: MediumIndex,
    hidden: bool,
) -> Option<Passage<P::Lanes>> {
    if P::NULLS {
        return pass_through::<P>(scene, ray, cut, medium, hidden);
    }
    if scene.geometry.occluded(&ray) {
        return None;
    }
    if !P::MEDIA {
        return Some(Passage { density: P::Lanes::splat(1.0), transmittance: Spectrum::ONE });
    }
    let sigma_t = P::Lanes::from_spectrum(scene.media[medium.0 as usize].sigma_t);
    let density = depth_of(sigma_t, ray.t_max + cut).exp_neg();
    Some(Passage { density, transmittance: density.to_spectrum() })
}

fn pass_through<P: Profile>(
    scene: &Scene,
    mut ray: Ray,
    cut: f32,
    mut medium: MediumIndex,
    hidden: bool,
) -> Option<Passage<P::Lanes>> {
    let end = ray.origin + ray.direction * ray.t_max;
    let mut depth = P::Lanes::splat(0.0);
    let (mut passing, mut tint) = (1.0, Spectrum::ONE);
    loop {
        let sigma_t = P::Lanes::from_spectrum(scene.media[medium.0 as usize].sigma_t);
        let Some(hit) = scene.geometry.closest(&ray) else {
            let transmitted = (depth + depth_of(sigma_t, ray.t_max + cut)).exp_neg();
            let transmittance = transmitted.to_spectrum() * tint;
            return Some(Passage { density: transmitted.scaled(passing), transmittance });
        };
        let point = scene.geometry.surface(&ray, &hit);
        let through = passed(scene, &point, ray.direction, hidden);
        if through.max_element() <= 0.0 {
            return None;
        }
        passing *= through.max_element();
        tint *= through;
        depth = depth + sigma_t.scaled(hit.t);
        ray = past(&ray, &point);
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
