//! Directions that walks should take from the places of a cell: how many of them aim at each portal, a table of all others, and
//! how many are left to the BSDF or the phase function.

use super::{Lesson, Portal};
use crate::{
    math::{Vec3, warp},
    sampling::{
        Basis, Quadtree, Stream,
        quadtree::{Deposit, effective},
    },
};

/// What a, the BSDF sampling fraction, may be. It multiplies what a path weighs by 1 / a at a vertex, at most.
const BSDF_FRACTIONS: [f32; 6] = [0.5, 0.65, 0.8, 0.9, 0.95, 1.0];
/// Directions, as [`effective`] counts them, that tell nothing if there are fewer.
pub const ENOUGH: f64 = 32.0;
/// Portals that fewer of the directions go through are not aimed at.
const LEAST_AIMED: f32 = 0.02;
/// The most that aim at portals.
const MOST_AIMED: f32 = 0.95;

/// Second moments of what is learnt.
#[derive(Clone, Copy, Debug, Default)]
pub struct Moments {
    pub unguided: f64,
    pub guided: f64,
}

impl Moments {
    pub fn add(&mut self, other: Self) {
        self.unguided += other.unguided;
        self.guided += other.guided;
    }
}

/// a p + (1 - a) G.
#[derive(Clone, Debug)]
pub struct Directions {
    /// a.
    pub unguided: f32,
    /// G.
    pub mixture: Mixture,
}

impl Directions {
    /// None where directions are better left to the BSDF or the phase function.
    pub fn learn(lessons: &[&Lesson], portals: &[Portal], basis: Basis) -> (Option<Self>, Moments) {
        if effective(lessons.iter().map(|lesson| lesson.weight)) < ENOUGH {
            return (None, Moments::default());
        }
        let (unguided, moments) = part_unguided(lessons, portals, basis);
        let guided = || Self { unguided, mixture: Mixture::learn(lessons.iter().copied(), portals, basis) };
        ((unguided < 1.0).then(guided), moments)
    }

    /// (1 - a) G [1/sr].
    #[inline]
    pub fn pdf(&self, position: Vec3, direction: Vec3) -> f32 {
        (1.0 - self.unguided) * self.mixture.pdf(position, direction)
    }
}

/// a, and the second moments at it that matter: as each half of the `lessons` finds what the other half guides.
///
/// That which makes the lessons likeliest (Mueller 2019, Path Guiding in Production): the likelihood of a path is a product
/// over its vertices, so that one at which the guide finds a keyhole makes up for many at which it is of no use. The second
/// moment, which is not, tells only what a guide is worth at one vertex, by the best a for it.
fn part_unguided(lessons: &[&Lesson], portals: &[Portal], basis: Basis) -> (f32, Moments) {
    let half = |fold| lessons.iter().copied().filter(move |lesson| lesson.fold == fold);
    let guides = [1, 0].map(|other| Mixture::learn(half(other), portals, basis));
    let known = lessons.iter().filter(|lesson| lesson.unguided > 0.0);
    let ratios: Vec<_> = known
        .map(|lesson| {
            let guided = guides[lesson.fold].pdf(lesson.position, lesson.direction);
            (f64::from(lesson.weight), f64::from(guided / lesson.unguided))
        })
        .collect();
    let sum = |a: f32, of: fn(f64, f64) -> f64| -> f64 {
        let a = f64::from(a);
        ratios.iter().map(|(weight, ratio)| of(*weight, a + (1.0 - a) * ratio)).sum()
    };
    let likelihood = |a| sum(a, |weight, ratio| weight * ratio.ln());
    let moment = |a| sum(a, |weight, ratio| weight * weight / ratio);
    let best = BSDF_FRACTIONS.map(|a| (a, likelihood(a))).into_iter().max_by(|a, b| a.1.total_cmp(&b.1));
    let guided = BSDF_FRACTIONS.map(moment).into_iter().fold(f64::INFINITY, f64::min);
    (best.map_or(1.0, |best| best.0), Moments { unguided: moment(1.0), guided })
}

/// Some directions that aim at portals, and others.
#[derive(Clone, Debug)]
pub struct Mixture {
    /// How many aim at each.
    aimed: Vec<(f32, Portal)>,
    /// How many the others are.
    rest: f32,
    table: Quadtree,
}

impl Mixture {
    fn learn<'a>(
        lessons: impl Iterator<Item = &'a Lesson> + Clone,
        portals: &[Portal],
        basis: Basis,
    ) -> Self {
        let mut aimed: Vec<(f32, Portal)> = portals.iter().map(|portal| (0.0, *portal)).collect();
        let mut total = 0.0;
        for lesson in lessons.clone() {
            total += lesson.weight;
            if let Some((sum, _)) = aimed.iter_mut().find(|(_, portal)| portal.is_crossed(lesson)) {
                *sum += lesson.weight;
            }
        }
        aimed.iter_mut().for_each(|(sum, _)| *sum *= MOST_AIMED / total);
        aimed.retain(|(share, _)| *share > LEAST_AIMED);
        let others = lessons.filter(|lesson| !aimed.iter().any(|(_, portal)| portal.is_crossed(lesson)));
        let deposit =
            |lesson: &Lesson| Deposit { at: warp::from_sphere(lesson.direction), weight: lesson.weight };
        let table = Quadtree::by(basis, others.map(deposit).collect());
        Self { rest: 1.0 - aimed.iter().map(|(share, _)| share).sum::<f32>(), aimed, table }
    }

    /// Density of unit `direction` from `position` [1/sr].
    #[inline]
    pub fn pdf(&self, position: Vec3, direction: Vec3) -> f32 {
        let aimed = self.aimed.iter().map(|(share, portal)| share * portal.pdf(position, direction));
        let others = self.table.density(warp::from_sphere(direction)) * warp::SPHERE_PDF;
        self.rest * others + aimed.sum::<f32>()
    }

    /// A unit direction from `position`.
    #[inline]
    pub fn sample(&self, position: Vec3, stream: &mut Stream) -> Vec3 {
        if !self.aimed.is_empty() {
            let mut u = stream.uniform();
            for (share, portal) in &self.aimed {
                if u < *share {
                    return portal.sample(position, stream.square());
                }
                u -= share;
            }
        }
        warp::to_sphere(self.table.sample(stream.square()))
    }

    /// Memory that it takes [bytes].
    pub fn bytes(&self) -> usize {
        size_of_val(&self.aimed[..]) + self.table.bytes()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{bsdf::Transport, math::vec3, sampling::stream::Purpose, testing};
    use statrs::distribution::{ContinuousCDF, Normal};
    use std::f64::consts::PI;

    /// Half of the lessons aim at a portal, some of the others at a patch of sky. Over the density of directions, the solid angles
    /// of both and of all directions come out, wherever one looks from.
    #[test]
    fn solid_angles_are_what_samples_over_their_density_say() {
        let portal = Portal { centre: vec3(0.4, -0.7, 0.2), radius: 0.2 };
        let up = |direction: Vec3| direction.z > 0.9;
        let mut stream = Stream::new(41, 0, 0, Purpose::Study);
        let lessons: Vec<Lesson> = (0..4000)
            .map(|index| {
                let position = portal.centre + vec3(2.0, 1.0, 0.5) - warp::to_sphere(stream.square());
                let anywhere = warp::to_sphere(stream.square());
                let direction =
                    if index % 2 == 0 { portal.sample(position, stream.square()) } else { anywhere };
                let (transport, unguided) = (Transport::Radiance, warp::SPHERE_PDF);
                let weight = if up(direction) { 5.0 } else { 1.0 };
                Lesson { position, normal: None, transport, direction, weight, unguided, fold: index / 2 % 2 }
            })
            .collect();
        let mixture = Mixture::learn(lessons.iter(), &[portal], Basis::default());
        assert!(mixture.aimed.len() == 1 && mixture.aimed[0].0 > 0.3, "{:?}", mixture.aimed);
        let most = -Normal::standard().inverse_cdf(testing::significance(9) / 2.0);
        for distance in [0.1, 0.5, 3.0] {
            let position = portal.centre + distance * vec3(0.6, 0.48, 0.64);
            let within = |direction: Vec3| portal.pdf(position, direction) > 0.0;
            let sine = f64::from(portal.radius / distance).min(1.0);
            let cosine = if sine < 1.0 { (1.0 - sine * sine).sqrt() } else { -1.0 };
            let angles: [(f64, &dyn Fn(Vec3) -> bool); 3] =
                [(4.0 * PI, &|_| true), (0.2 * PI, &up), (2.0 * PI * (1.0 - cosine), &within)];
            let mut sums = [[0.0; 2]; 3];
            let n = 100_000.0;
            for _ in 0..100_000 {
                let direction = mixture.sample(position, &mut stream);
                let value = 1.0 / f64::from(mixture.pdf(position, direction));
                for ((_, holds), sums) in angles.iter().zip(&mut sums) {
                    let value = if holds(direction) { value } else { 0.0 };
                    sums[0] += value / n;
                    sums[1] += value * value / n;
                }
            }
            for ((angle, _), [mean, square]) in angles.iter().zip(sums) {
                let z = (mean - angle) / ((square - mean * mean) / n).sqrt();
                assert!(z.abs() < most, "{distance}: {mean} of {angle}, {z} standard errors");
            }
        }
    }
}
