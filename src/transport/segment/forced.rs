//! The forced flight (P03T sec. A.2.2): a segment that ends in two ways at once, at a collision within the media that
//! the ray crosses and on what lies behind them, each with its share of radiance.

use super::{
    depth_of,
    flight::{Flight, Flown, Landing, Toll, toll},
    passed, past,
};
use crate::{
    math::{Lanes, Section, Spectrum},
    medium::{MediumIndex, tracker::collision_ratio},
    sampling::Stream,
    scene::Scene,
    shape::Ray,
    transport::profile::Profile,
};

/// One way in which a forced flight ends.
#[derive(Clone, Copy, Debug)]
pub struct End<L> {
    /// As weights know it: like one that was left to chance.
    pub flight: Flight<L>,
    /// Contribution over the density by which it was really sampled.
    pub share: Spectrum,
}

/// A forced flight.
pub struct Forced<L> {
    /// In the media, where there is something to collide with, and on what lies behind.
    pub ends: [Option<End<L>>; 2],
    /// See [`sure_depth`].
    pub sure_depth: L,
}

/// What lies behind while the ray is followed.
#[derive(Clone, Copy, Debug)]
struct Way<L> {
    /// As of [`Flight`].
    depth: L,
    /// Estimate of the transmittance of media.
    through: L,
    /// The same over exp(-`spent`).
    ratio: L,
    /// As of [`Flight`].
    tint: Spectrum,
    /// The optical depth by which collisions are drawn.
    spent: f32,
}

/// A part of the ray that lies in one medium with extinction.
struct Part<L> {
    medium: MediumIndex,
    section: Section,
    /// How far before the section the medium began [m], see [`past`].
    skipped: f32,
    before: Way<L>,
    /// What it adds to the depth by which collisions are drawn.
    depth: f32,
}

/// A ratio of transmittances is looked at no deeper than this: exponential depths are less, whatever lies beyond.
const DEEPEST: f32 = 80.0;

impl<L: Lanes> Way<L> {
    fn new() -> Self {
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        Self { depth: zero, through: one, ratio: one, tint: Spectrum::ONE, spent: 0.0 }
    }

    /// Goes along `section` of `medium`, which began `skipped` metres before it does.
    fn add(
        &mut self,
        scene: &Scene,
        medium: MediumIndex,
        section: &Section,
        skipped: f32,
        hero: usize,
        stream: &mut Stream,
    ) {
        let medium = &scene.media[medium.0 as usize];
        let (depth, through, spent, ratio) = match &medium.varying {
            Some(varying) => {
                let depth = varying.depth::<L>(section);
                let through = varying.transmittance::<L>(section, depth, stream);
                let spent = varying.forced_depth::<L>(section, depth, hero);
                (depth, through, spent, through.scaled(spent.min(DEEPEST).exp()))
            }
            None => {
                let depth = depth_of(L::from_spectrum(medium.sigma_t), section.length + skipped);
                let ratio = depth.flight_ratio(L::splat(1.0), hero);
                (depth, depth.exp_neg(), depth.hero(hero), ratio)
            }
        };
        self.depth = self.depth + depth;
        self.through = self.through * through;
        self.ratio = self.ratio * ratio;
        self.spent += spent;
    }
}

/// Follows `ray` from `medium` to the first surface that stops it, and forces a collision of the `hero` channel on the
/// way. `hidden` and `along` as in [`super::fly`].
pub fn force<P: Profile>(
    scene: &Scene,
    ray: Ray,
    medium: MediumIndex,
    hidden: bool,
    hero: usize,
    stream: &mut Stream,
    along: &mut impl FnMut(&Flown<P::Lanes>, &mut Stream),
) -> Forced<P::Lanes> {
    let Followed { parts, behind, depth, sure_depth } =
        follow::<P>(scene, ray, medium, hidden, hero, stream, along);
    let collision = collide::<P>(scene, &parts, depth, hero, stream);
    Forced { ends: [collision, (behind.share.max_element() > 0.0).then_some(behind)], sure_depth }
}

/// Optical depth per lane of the media that `ray` crosses from `medium` on, before the first surface that holds
/// anything back: what a forced flight always follows. Never random: the same for all strategies.
pub fn sure_depth<P: Profile>(
    scene: &Scene,
    mut ray: Ray,
    mut medium: MediumIndex,
    hidden: bool,
) -> P::Lanes {
    let mut depth = P::Lanes::splat(0.0);
    let mut skipped = 0.0;
    loop {
        let hit = scene.geometry.closest(&ray);
        let length = hit.map_or(ray.t_max, |hit| hit.t);
        let section = Section { origin: ray.origin, direction: ray.direction, length };
        let crossed = &scene.media[medium.0 as usize];
        depth = depth
            + match &crossed.varying {
                Some(varying) => varying.depth::<P::Lanes>(&section),
                None => depth_of(P::Lanes::from_spectrum(crossed.sigma_t), length + skipped),
            };
        let Some(hit) = hit.filter(|_| P::NULLS) else { return depth };
        let point = scene.geometry.surface(&ray, &hit);
        if passed(scene, &point, ray.direction, hidden).max_element() < 1.0 {
            return depth;
        }
        (ray, skipped) = past(&ray, &point);
        medium = scene.medium_beyond(&point, &ray, medium);
    }
}

/// A ray that was followed.
struct Followed<L> {
    /// The parts of it that collisions can happen in.
    parts: Vec<Part<L>>,
    /// Where it ends.
    behind: End<L>,
    /// The depth up to there by which collisions are drawn.
    depth: f32,
    sure_depth: L,
}

fn follow<P: Profile>(
    scene: &Scene,
    mut ray: Ray,
    mut medium: MediumIndex,
    hidden: bool,
    hero: usize,
    stream: &mut Stream,
    along: &mut impl FnMut(&Flown<P::Lanes>, &mut Stream),
) -> Followed<P::Lanes> {
    let mut parts = Vec::new();
    let mut sure = None;
    let mut way = Way::new();
    let mut skipped = 0.0;
    loop {
        let hit = scene.geometry.closest(&ray);
        let length = hit.map_or(ray.t_max, |hit| hit.t);
        let section = Section { origin: ray.origin, direction: ray.direction, length };
        let before = way;
        if P::EMISSIVE {
            let Way { depth, through, tint, .. } = before;
            along(&Flown { medium, section, depth, ratio: through, tint, certain: true }, stream);
        }
        way.add(scene, medium, &section, skipped, hero, stream);
        let depth = way.spent - before.spent;
        if depth > 0.0 {
            parts.push(Part { medium, section, skipped, before, depth });
        }
        let surface = hit.map(|hit| scene.geometry.surface(&ray, &hit));
        let landing = match surface {
            None => Landing::Escape,
            Some(point) if !P::NULLS => Landing::Surface(point),
            Some(point) => match toll(scene, &point, ray.direction, hidden, stream) {
                Toll::Stopped(probability) => {
                    sure.get_or_insert(way.depth);
                    way.tint /= probability;
                    Landing::Surface(point)
                }
                Toll::Passed(through, probability) => {
                    if probability < 1.0 {
                        sure.get_or_insert(way.depth);
                    }
                    way.tint *= through / probability;
                    way.depth = way.depth + P::Lanes::splat(-probability.ln());
                    (ray, skipped) = past(&ray, &point);
                    medium = scene.medium_beyond(&point, &ray, medium);
                    continue;
                }
            },
        };
        let Way { depth, through, ratio, tint, spent } = way;
        let share = through.to_spectrum() * tint;
        let behind = End { flight: Flight { landing, medium, depth, ratio, tint }, share };
        return Followed { parts, behind, depth: spent, sure_depth: sure.unwrap_or(depth) };
    }
}

/// A collision in one of `parts`, whose depth is `whole` in all: its depth is exponential, cut off there.
fn collide<P: Profile>(
    scene: &Scene,
    parts: &[Part<P::Lanes>],
    whole: f32,
    hero: usize,
    stream: &mut Stream,
) -> Option<End<P::Lanes>> {
    let last = parts.last()?;
    let caught = -f64::from(-whole).exp_m1();
    let spent = -(-stream.uniform_precisely() * caught).ln_1p() as f32;
    let part = parts.iter().find(|part| spent - part.before.spent < part.depth).unwrap_or(last);
    let Part { medium, section, skipped, before, .. } = part;
    let remaining = (spent - before.spent).clamp(0.0, part.depth);
    let made_of = &scene.media[medium.0 as usize];
    let (t, matter, depth, ratio) = match &made_of.varying {
        Some(varying) => {
            let leg = varying.force::<P::Lanes>(section, hero, remaining, stream)?;
            let t = leg.collision?;
            (t, varying.at::<P::Lanes>(section.at(t)), leg.depth, leg.ratio)
        }
        None => {
            let sigma_t = P::Lanes::from_spectrum(made_of.sigma_t);
            let flown = remaining / sigma_t.hero(hero);
            let depth = sigma_t.scaled(flown);
            (
                (flown - skipped).max(0.0),
                made_of.matter(),
                depth,
                depth.flight_ratio(P::Lanes::splat(1.0), hero),
            )
        }
    };
    // Positions are rounded: a collision at the very edge may come to lie outside.
    if P::Lanes::from_spectrum(matter.sigma_t).hero(hero) <= 0.0 {
        return None;
    }
    let ratio = before.ratio * ratio * collision_ratio(matter.sigma_t, hero);
    let landing = Landing::Medium(section.at(t), matter);
    let flight = Flight { landing, medium: *medium, depth: before.depth + depth, ratio, tint: before.tint };
    Some(End { flight, share: ratio.to_spectrum() * before.tint * caught as f32 })
}
