//! The flight: a segment sampled from one end (LW96 eq. 4-7).

use super::{depth_of, passed, past};
use crate::{
    math::{Lanes, Section, Spectrum, Vec3},
    medium::{Heterogeneous, Matter, Medium, MediumIndex, tracker::collision_ratio},
    sampling::Stream,
    scene::Scene,
    shape::{Ray, SurfacePoint},
    transport::profile::Profile,
};

/// How a flight ended.
#[derive(Clone, Copy, Debug)]
pub enum Landing {
    /// On a surface that scatters.
    Surface(SurfacePoint),
    /// At a collision in the medium, and what that is made of there.
    Medium(Vec3, Matter),
    /// At infinity.
    Escape,
}

/// A sampled segment.
#[derive(Clone, Copy, Debug)]
pub struct Flight<L> {
    /// Where it ended.
    pub landing: Landing,
    /// The medium at its end.
    pub medium: MediumIndex,
    /// Optical depth per lane, the logarithms of null-passing probabilities included: the flight density that weights
    /// know is exp(-depth), times sigma_t at a collision.
    pub depth: L,
    /// Contribution over the density by which the flight was really sampled, per lane. Profiles without varying media
    /// have it from `depth`.
    pub ratio: L,
    /// Null transmittances over their passing probabilities; 1 where none was tinted.
    pub tint: Spectrum,
}

/// A part of a flight that lies in one medium.
#[derive(Clone, Copy, Debug)]
pub struct Flown<L> {
    /// The medium.
    pub medium: MediumIndex,
    /// The part, as long as it was really flown; infinite where it was never left.
    pub section: Section,
    /// As of [`Flight`], before it.
    pub depth: L,
    /// As of [`Flight`], before it.
    pub ratio: L,
    /// As of [`Flight`], before it.
    pub tint: Spectrum,
    /// True where it is not left to chance whether a flight comes as far as this: `ratio` is transmittance.
    pub certain: bool,
}

impl<L: Lanes> Flown<L> {
    /// The flight that would have ended `t` metres into this part, at a point made of `matter`.
    pub fn until(
        &self,
        scene: &Scene,
        t: f32,
        matter: Matter,
        hero: usize,
        stream: &mut Stream,
    ) -> Flight<L> {
        let section = Section { length: t, ..self.section };
        let medium = &scene.media[self.medium.0 as usize];
        let (depth, ratio) = match &medium.varying {
            Some(varying) => {
                let depth = varying.depth::<L>(&section);
                let ratio = match self.certain {
                    false => varying.ratio::<L>(&section, depth, hero, stream),
                    true => varying.transmittance::<L>(&section, depth, stream),
                };
                (depth, ratio)
            }
            None => {
                let depth = depth_of(L::from_spectrum(medium.sigma_t), t);
                let ratio =
                    if self.certain { depth.exp_neg() } else { depth.flight_ratio(L::splat(1.0), hero) };
                (depth, ratio)
            }
        };
        Flight {
            landing: Landing::Medium(section.at(t), matter),
            medium: self.medium,
            depth: self.depth + depth,
            ratio: self.ratio * ratio,
            tint: self.tint,
        }
    }
}

/// Samples a segment along `ray`, starting in `medium`: an exponential optical depth by the `hero` channel, until a
/// surface, a collision, or infinity. Where emitters are `hidden`, the ray passes them; only profiles with nulls can.
/// In profiles where media shine, `along` is shown every part of it.
#[inline(always)]
pub fn fly<P: Profile>(
    scene: &Scene,
    ray: Ray,
    medium: MediumIndex,
    hidden: bool,
    hero: usize,
    stream: &mut Stream,
    along: &mut impl FnMut(&Flown<P::Lanes>, &mut Stream),
) -> Flight<P::Lanes> {
    let remaining = if P::MEDIA { stream.exponential() } else { 0.0 };
    if P::NULLS {
        fly_through::<P>(scene, ray, medium, hidden, hero, remaining, stream, along)
    } else {
        let Leg { landing, depth, ratio, .. } =
            fly_leg::<P>(scene, ray, 0.0, medium, hero, remaining, stream);
        Flight { landing, medium, depth, ratio, tint: Spectrum::ONE }
    }
}

/// A flight as far as the next surface.
struct Leg<L> {
    landing: Landing,
    depth: L,
    ratio: L,
    /// What it used up of the optical depth to go.
    spent: f32,
    /// How far it went [m].
    length: f32,
}

/// A flight to the next surface, in one medium that, where it is homogeneous, began `skipped` metres before the ray.
#[inline(always)]
fn fly_leg<P: Profile>(
    scene: &Scene,
    ray: Ray,
    skipped: f32,
    medium: MediumIndex,
    hero: usize,
    remaining: f32,
    stream: &mut Stream,
) -> Leg<P::Lanes> {
    let medium = &scene.media[medium.0 as usize];
    if P::HETEROGENEOUS
        && let Some(varying) = &medium.varying
    {
        return fly_varying::<P>(scene, ray, varying, hero, remaining, stream);
    }
    fly_straight::<P>(scene, ray, skipped, medium, hero, remaining)
}

/// In a homogeneous medium: one ray, no longer than the sampled distance.
#[inline(always)]
fn fly_straight<P: Profile>(
    scene: &Scene,
    mut ray: Ray,
    skipped: f32,
    medium: &Medium,
    hero: usize,
    remaining: f32,
) -> Leg<P::Lanes> {
    let sigma_t = P::Lanes::from_spectrum(medium.sigma_t);
    let limit = ray.t_max;
    let flown = if P::MEDIA { remaining / sigma_t.hero(hero) } else { f32::INFINITY };
    // A collision in what was skipped happens where the ray starts: nearer to the surface it might be behind it.
    let collision = if flown < skipped { 0.0 } else { flown - skipped };
    ray.t_max = collision.min(limit);
    let (landing, distance) = match scene.geometry.closest(&ray) {
        Some(hit) => (Landing::Surface(scene.geometry.surface(&ray, &hit)), hit.t + skipped),
        None if collision < limit => {
            (Landing::Medium(ray.origin + ray.direction * collision, medium.matter()), flown)
        }
        // Infinite for all but primary rays, which the far clip ends.
        None => (Landing::Escape, limit + skipped),
    };
    let one = P::Lanes::splat(1.0);
    let depth = if P::MEDIA { depth_of(sigma_t, distance) } else { P::Lanes::splat(0.0) };
    let ratio = match landing {
        _ if !P::HETEROGENEOUS => one,
        Landing::Medium(..) => depth.flight_ratio(sigma_t, hero),
        _ => depth.flight_ratio(one, hero),
    };
    Leg { landing, depth, ratio, spent: depth.hero(hero), length: distance }
}

/// In a varying medium: the ray first, for its tracker need not look beyond the surface.
fn fly_varying<P: Profile>(
    scene: &Scene,
    ray: Ray,
    varying: &Heterogeneous,
    hero: usize,
    remaining: f32,
    stream: &mut Stream,
) -> Leg<P::Lanes> {
    let hit = scene.geometry.closest(&ray);
    let length = hit.map_or(ray.t_max, |hit| hit.t);
    let section = Section { origin: ray.origin, direction: ray.direction, length };
    let leg = varying.fly::<P::Lanes>(&section, hero, remaining, stream);
    let (landing, ratio) = match (leg.collision, hit) {
        (Some(t), _) => {
            let position = section.at(t);
            let matter = varying.at::<P::Lanes>(position);
            (Landing::Medium(position, matter), leg.ratio * collision_ratio(matter.sigma_t, hero))
        }
        (None, Some(hit)) => (Landing::Surface(scene.geometry.surface(&ray, &hit)), leg.ratio),
        (None, None) => (Landing::Escape, leg.ratio),
    };
    let length = leg.collision.unwrap_or(length);
    Leg { landing, depth: leg.depth, ratio, spent: leg.spent, length }
}

/// A flight that may pass surfaces: each crossing switches the medium, and takes its toll where the surface
/// lets only a part through.
#[expect(clippy::too_many_arguments, reason = "what a flight is made of")]
fn fly_through<P: Profile>(
    scene: &Scene,
    mut ray: Ray,
    mut medium: MediumIndex,
    hidden: bool,
    hero: usize,
    mut remaining: f32,
    stream: &mut Stream,
    along: &mut impl FnMut(&Flown<P::Lanes>, &mut Stream),
) -> Flight<P::Lanes> {
    let mut depth = P::Lanes::splat(0.0);
    let mut ratio = P::Lanes::splat(1.0);
    let mut tint = Spectrum::ONE;
    let mut skipped = 0.0;
    loop {
        let leg = fly_leg::<P>(scene, ray, skipped, medium, hero, remaining, stream);
        if P::EMISSIVE {
            let section = Section { origin: ray.origin, direction: ray.direction, length: leg.length };
            along(&Flown { medium, section, depth, ratio, tint, certain: false }, stream);
        }
        depth = depth + leg.depth;
        ratio = ratio * leg.ratio;
        let Landing::Surface(point) = leg.landing else {
            return Flight { landing: leg.landing, medium, depth, ratio, tint };
        };
        match toll(scene, &point, ray.direction, hidden, stream) {
            Toll::Stopped(probability) => {
                tint /= probability;
                return Flight { landing: leg.landing, medium, depth, ratio, tint };
            }
            Toll::Passed(through, probability) => {
                tint *= through / probability;
                depth = depth + P::Lanes::splat(-probability.ln());
            }
        }
        remaining = (remaining - leg.spent).max(0.0);
        (ray, skipped) = past(&ray, &point);
        medium = scene.medium_beyond(&point, &ray, medium);
    }
}

/// What became of a flight at a surface.
pub enum Toll {
    /// It ends there, which had this probability from either side: it takes the place of sigma_t at a collision, cancels
    /// in every ratio of densities, and divides the throughput.
    Stopped(f32),
    /// It went on, tinted by the first, which had the probability of the second.
    Passed(Spectrum, f32),
}

/// A flight that meets a surface passes or stops.
#[inline]
pub fn toll(scene: &Scene, point: &SurfacePoint, direction: Vec3, hidden: bool, stream: &mut Stream) -> Toll {
    let through = passed(scene, point, direction, hidden);
    let passing = through.max_element();
    if passing <= 0.0 || (passing < 1.0 && stream.uniform() >= passing) {
        return Toll::Stopped(1.0 - passing.max(0.0));
    }
    Toll::Passed(through, passing)
}
