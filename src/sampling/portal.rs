//! Portals: what light must pass through to reach the image, like the openings between rooms, or a ball of glass. A
//! table of directions would have to learn them anew in every cell of places; a portal is known from everywhere.
//! Walks aim at them by direction, and parallel light by the place where it sets out.

use super::Stream;
use crate::math::{Frame, Vec2, Vec3, warp};
use std::f32::consts::PI;

/// Number of concentric spheres that directions aim at, each wider by the square root of 2. An opening may be of any
/// shape: one sphere of about its size leaves out its corners, and the few paths that find those would weigh as much as
/// without a guide.
const SPHERES: usize = 4;
/// Least part of the directions that aims at each of them.
const LEAST: f32 = 0.05;
/// How often shares are fitted.
const FITS: usize = 16;
/// Least part that aims at each portal: where few rays were seen to pass through it, these few would else weigh as much as
/// without it.
const LEAST_AIMED: f32 = 0.05;
/// Largest part of walks that aims at portals.
const MOST_AIMED: f32 = 0.5;
/// Above this squared sine, at the surface and within, a sphere counts as all around.
const WITHIN: f32 = 0.999;
/// Below this squared sine, too: f32 cannot tell directions to it from others.
const RESOLVED: f32 = 1e-8;

/// A ray of a path that reaches the image.
#[derive(Clone, Copy, Debug)]
pub struct Passage {
    /// Where it begins; of parallel light any point of it.
    pub position: Vec3,
    /// Unit.
    pub direction: Vec3,
    /// Parallel light is sampled by its place (1/m^2), other by its direction (1/sr).
    pub is_parallel: bool,
    /// How much it counts, at least 0, finite.
    pub weight: f32,
    /// Its density without portals (1/sr or 1/m^2).
    pub unaimed: f32,
    /// To which of two independent parts of all it belongs.
    pub fold: usize,
}

impl Passage {
    /// Squared distance at which it passes `centre` (m^2); none if that is behind it.
    #[inline]
    pub(super) fn miss(&self, centre: Vec3) -> Option<f32> {
        match self.is_parallel {
            true => Some(miss_of_line(centre, self.position, self.direction)),
            false => miss_of_ray(centre, self.position, self.direction),
        }
    }

    /// True if it comes from outside `sphere` and passes through.
    pub fn crosses(&self, sphere: &Sphere) -> bool {
        let is_hit = self.miss(sphere.centre).is_some_and(|miss| miss <= sphere.radius_squared);
        is_hit && self.begins_outside(sphere)
    }

    pub(super) fn begins_outside(&self, sphere: &Sphere) -> bool {
        self.is_parallel || sphere.cone(self.position).is_some()
    }

    /// Its density among those that aim at `sphere` (1/sr or 1/m^2).
    pub(super) fn density(&self, sphere: &Sphere) -> f32 {
        match self.is_parallel {
            true => sphere.pdf_at(miss_of_line(sphere.centre, self.position, self.direction)),
            false => sphere.pdf(self.position, self.direction),
        }
    }
}

/// Portals, and the share of the rays that aims at each.
#[derive(Clone, Debug, Default)]
pub struct Aimed(Vec<(f32, Portal)>);

impl Aimed {
    /// Shares in proportion to the `passages` through each of `portals`, in balance with the others.
    pub fn of(portals: &[Portal], passages: impl Iterator<Item = Passage>) -> Self {
        let mut aimed: Vec<(f32, Portal)> = portals.iter().map(|portal| (0.0, *portal)).collect();
        let mut total = 0.0;
        for passage in passages {
            total += passage.weight;
            if let Some((sum, _)) = aimed.iter_mut().find(|(_, portal)| passage.crosses(&portal.outermost()))
            {
                *sum += passage.weight;
            }
        }
        let share = |sum: f32| if total > 0.0 { sum / total } else { 0.0 };
        aimed.iter_mut().for_each(|(sum, _)| *sum = share(*sum));
        Self(aimed).bounded(MOST_AIMED)
    }

    /// Shares of `portals`, and of the spheres of each, that maximise the likelihood of `passages`, where other rays have
    /// the density `unaimed` of each. The sum of the shares is at most `most`.
    pub fn fitted(portals: &[Portal], passages: impl Iterator<Item = Passage>, most: f32) -> Self {
        let known = |passage: Passage| (passage, portals.iter().map(|portal| portal.of(&passage)).collect());
        let known: Vec<(Passage, Vec<[f32; SPHERES]>)> = passages.map(known).collect();
        let share = 1.0 / (portals.len() + 1) as f32;
        let even = Self(portals.iter().map(|portal| (share, Portal::even(portal.smallest))).collect());
        let Self(mut fitted) = even.refitted(&known);
        fitted.iter_mut().for_each(|(_, portal)| *portal = portal.ample());
        Self(fitted).bounded(most)
    }

    /// Shares in proportion to the number behind each portal; none where that is 0.
    pub fn shared(portals: impl Iterator<Item = (Portal, f32)>) -> Self {
        let kept = portals.filter(|(_, part)| *part > 0.0).map(|(portal, part)| (part, portal));
        let mut aimed = Self(kept.collect());
        let all = aimed.share();
        aimed.0.iter_mut().for_each(|(share, _)| *share /= all);
        aimed.bounded(MOST_AIMED)
    }

    /// All rays aim at one portal.
    pub fn all_at(portal: Portal) -> Self {
        Self(vec![(1.0, portal)])
    }

    /// The shares by expectation maximisation, for passages with such densities by portal and sphere.
    fn refitted(self, known: &[(Passage, Vec<[f32; SPHERES]>)]) -> Self {
        (0..FITS).fold(self, |aimed, _| aimed.refitted_once(known))
    }

    fn refitted_once(&self, known: &[(Passage, Vec<[f32; SPHERES]>)]) -> Self {
        let (mut sums, mut total) = (vec![[0.0; SPHERES]; self.0.len()], 0.0);
        let others = (1.0 - self.share()).max(0.0);
        for (passage, parts) in known {
            let by_portals = self.0.iter().zip(parts).map(|((share, portal), of)| share * portal.mixed(of));
            let all = others * passage.unaimed + by_portals.sum::<f32>();
            total += f64::from(passage.weight);
            for (((share, portal), parts), sums) in self.0.iter().zip(parts).zip(&mut sums) {
                let each = if all > 0.0 { passage.weight * share / all } else { 0.0 };
                for ((sum, part), of_sphere) in sums.iter_mut().zip(parts).zip(&portal.shares) {
                    *sum += f64::from(each * of_sphere * part);
                }
            }
        }
        let refitted = |((_, portal), sums): (&(f32, Portal), [f64; SPHERES])| {
            let all: f64 = sums.iter().sum();
            match all > 0.0 {
                true => {
                    ((all / total) as f32, Portal { shares: sums.map(|sum| (sum / all) as f32), ..*portal })
                }
                false => (0.0, *portal),
            }
        };
        Self(self.0.iter().zip(sums).map(refitted).collect())
    }

    /// The same with at least a small share of each portal. Their sum is at most `most`.
    fn bounded(mut self, most: f32) -> Self {
        self.0.iter_mut().for_each(|(share, _)| *share = share.max(LEAST_AIMED));
        let all = self.share();
        self.0.iter_mut().for_each(|(share, _)| *share *= (most / all).min(1.0));
        self
    }

    /// The part of the rays that aims at portals.
    #[inline]
    pub fn share(&self) -> f32 {
        self.0.iter().map(|(share, _)| share).sum()
    }

    /// Each with its share.
    pub fn portals(&self) -> &[(f32, Portal)] {
        &self.0
    }

    /// The sum of the shares times `pdf`.
    #[inline]
    pub fn pdf(&self, pdf: impl Fn(&Portal) -> f32) -> f32 {
        self.0.iter().map(|(share, portal)| share * pdf(portal)).sum()
    }

    /// The portal to aim at, by a number `u` in [0, 1); none, and what is left of `u`, for the other rays.
    #[inline]
    pub fn choose(&self, u: &mut f32) -> Option<&Portal> {
        for (share, portal) in &self.0 {
            if *u < *share {
                return Some(portal);
            }
            *u -= share;
        }
        None
    }

    /// Memory that they take (bytes).
    pub fn bytes(&self) -> usize {
        size_of_val(&self.0[..])
    }
}

/// Squared distance of `centre` from the line through `position` (m^2).
#[inline]
fn miss_of_line(centre: Vec3, position: Vec3, direction: Vec3) -> f32 {
    let to = centre - position;
    (to - to.dot(direction) * direction).length_squared()
}

/// The same of the ray from `position`; none if `centre` is behind it.
#[inline]
fn miss_of_ray(centre: Vec3, position: Vec3, direction: Vec3) -> Option<f32> {
    let to = centre - position;
    let along = to.dot(direction);
    (along > 0.0).then(|| (to - along * direction).length_squared())
}

/// Concentric spheres that walks aim at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Portal {
    /// The other spheres are around it.
    pub smallest: Sphere,
    /// The part of the directions that aims at each sphere, 1 together.
    shares: [f32; SPHERES],
}

impl Portal {
    /// The portal of spheres from `smallest` on. Their shares maximise the likelihood of the `passages` that come from
    /// outside and pass through.
    pub fn fitted<'a>(smallest: Sphere, passages: impl Iterator<Item = &'a Passage>) -> Self {
        let even = Self::even(smallest);
        let outermost = even.outermost();
        let through = passages.filter(|passage| passage.crosses(&outermost));
        // No others are among them.
        let known = |passage: &Passage| (Passage { unaimed: 0.0, ..*passage }, vec![even.of(passage)]);
        let known: Vec<_> = through.map(known).collect();
        Aimed(vec![(1.0, even)]).refitted(&known).0[0].1.ample()
    }

    /// Most of what aims at it aims at `smallest`.
    pub fn around(smallest: Sphere) -> Self {
        Self { smallest, shares: [1.0, 0.0, 0.0, 0.0] }.ample()
    }

    fn even(smallest: Sphere) -> Self {
        Self { smallest, shares: [1.0 / SPHERES as f32; SPHERES] }
    }

    /// The same with at least a small share of each sphere.
    fn ample(&self) -> Self {
        let rest = 1.0 - SPHERES as f32 * LEAST;
        Self { shares: self.shares.map(|share| LEAST + rest * share), ..*self }
    }

    /// The greatest of its spheres.
    pub fn outermost(&self) -> Sphere {
        self.smallest.outermost()
    }

    /// Density of `passage` among those that aim at each of its spheres (1/sr or 1/m^2).
    fn of(&self, passage: &Passage) -> [f32; SPHERES] {
        self.spheres().map(|sphere| passage.density(&sphere))
    }

    #[inline]
    fn spheres(&self) -> [Sphere; SPHERES] {
        let Sphere { centre, radius_squared } = self.smallest;
        std::array::from_fn(|index| Sphere { centre, radius_squared: radius_squared * (1 << index) as f32 })
    }

    /// Density of unit `direction` from `position` among those that aim at each of its spheres (1/sr).
    #[inline]
    fn parts(&self, position: Vec3, direction: Vec3) -> [f32; SPHERES] {
        let spheres = self.spheres();
        // Where the smallest counts as all around, it has all directions.
        if self.smallest.cone(position).is_some() && !spheres[SPHERES - 1].is_aimed(position, direction) {
            return [0.0; SPHERES];
        }
        spheres.map(|sphere| sphere.pdf(position, direction))
    }

    /// Density of unit `direction` among those that aim at it from `position` (1/sr).
    #[inline]
    pub fn pdf(&self, position: Vec3, direction: Vec3) -> f32 {
        self.mixed(&self.parts(position, direction))
    }

    /// The density of the mixture whose spheres have the densities `parts`.
    #[inline]
    fn mixed(&self, parts: &[f32; SPHERES]) -> f32 {
        parts.iter().zip(&self.shares).map(|(pdf, share)| share * pdf).sum()
    }

    /// Density of the line through `position` in unit `direction` among the parallel ones that aim at it (1/m^2).
    #[inline]
    pub fn pdf_across(&self, position: Vec3, direction: Vec3) -> f32 {
        let miss = miss_of_line(self.smallest.centre, position, direction);
        self.mixed(&self.spheres().map(|sphere| sphere.pdf_at(miss)))
    }

    /// A unit direction from `position` that aims at it.
    #[inline]
    pub fn sample(&self, position: Vec3, stream: &mut Stream) -> Vec3 {
        self.choose(stream).sample(position, stream.square())
    }

    /// A point that a line in unit `direction` passes through if it aims at it.
    #[inline]
    pub fn sample_across(&self, direction: Vec3, stream: &mut Stream) -> Vec3 {
        let Sphere { centre, radius_squared } = self.choose(stream);
        let across = radius_squared.sqrt() * warp::to_disk(stream.square());
        centre + Frame::around(direction).to_world(across.extend(0.0))
    }

    #[inline]
    fn choose(&self, stream: &mut Stream) -> Sphere {
        let mut u = stream.uniform();
        let [inner @ .., outermost] = self.spheres();
        let of = inner.into_iter().zip(self.shares).find(|(_, share)| {
            u -= share;
            u < 0.0
        });
        of.map_or(outermost, |(sphere, _)| sphere)
    }
}

/// What directions aim at, evenly by solid angle; from within they go anywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// World position.
    pub centre: Vec3,
    /// Above 0 (m^2).
    pub radius_squared: f32,
}

impl Sphere {
    /// The greatest sphere of a portal from this one on.
    pub(super) fn outermost(&self) -> Self {
        Self { radius_squared: self.radius_squared * (1 << (SPHERES - 1)) as f32, ..*self }
    }

    /// 1 - cos of the half angle in which `position` sees it; none from within and from too far away.
    #[inline]
    fn cone(&self, position: Vec3) -> Option<f32> {
        let sine_squared = self.radius_squared / position.distance_squared(self.centre);
        (RESOLVED..WITHIN).contains(&sine_squared).then(|| warp::one_minus_cos(sine_squared))
    }

    /// True if unit `direction` from `position` may be one that aims at it.
    #[inline]
    fn is_aimed(&self, position: Vec3, direction: Vec3) -> bool {
        self.cone(position).is_none() || self.is_hit(position, direction)
    }

    #[inline]
    fn is_hit(&self, position: Vec3, direction: Vec3) -> bool {
        miss_of_ray(self.centre, position, direction).is_some_and(|miss| miss <= self.radius_squared)
    }

    /// Density of unit `direction` among those that aim at it from `position` (1/sr).
    #[inline]
    pub fn pdf(&self, position: Vec3, direction: Vec3) -> f32 {
        match self.cone(position) {
            None => warp::SPHERE_PDF,
            Some(one_minus_cos) if self.is_hit(position, direction) => warp::cone_pdf(one_minus_cos),
            Some(_) => 0.0,
        }
    }

    /// Density of a line at the squared distance `miss` from its centre (m^2) among the parallel ones through it (1/m^2).
    #[inline]
    fn pdf_at(&self, miss: f32) -> f32 {
        if miss <= self.radius_squared { 1.0 / (PI * self.radius_squared) } else { 0.0 }
    }

    #[inline]
    fn sample(&self, position: Vec3, u: Vec2) -> Vec3 {
        let Some(one_minus_cos) = self.cone(position) else { return warp::to_sphere(u) };
        let axis = (self.centre - position).normalize();
        Frame::around(axis).to_world(warp::to_cone(u, one_minus_cos)).normalize()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{math::vec3, sampling::stream::Purpose, testing};
    use std::f64::consts::TAU;

    /// Seen from afar, from close by, from its surface and from within: all directions aim at it, evenly, and the density is 1 over
    /// their solid angle, within it alone.
    #[test]
    fn directions_are_even_and_as_dense_as_they_are_said_to_be() {
        let sphere = Sphere { centre: vec3(0.3, -0.2, 0.5), radius_squared: 0.0625 };
        let mut stream = Stream::new(31, 0, 0, Purpose::Study);
        for distance in [1000.0, 3.0, 0.3, 0.251, 0.25, 0.1, 0.0] {
            let axis = vec3(-0.6, 0.48, 0.64);
            let position = sphere.centre - distance * axis;
            let axis = (sphere.centre - position).as_dvec3().normalize_or(axis.as_dvec3());
            let sine = 0.25 / position.as_dvec3().distance(sphere.centre.as_dvec3());
            // 1 - cos, in which even directions are even, where they are not around it.
            let most = if sine < 0.9999 { sine * sine / (1.0 + (1.0 - sine * sine).sqrt()) } else { 2.0 };
            let mut counts = [0; 16];
            for _ in 0..16_000 {
                let direction = sphere.sample(position, stream.square());
                let across = (direction.as_dvec3() - axis).length_squared() / 2.0 / most;
                assert!(across < 1.0 + 1e-4, "{distance}: {direction}");
                counts[(across * 16.0).min(15.0) as usize] += 1;
                if across < 0.999 {
                    let pdf = f64::from(sphere.pdf(position, direction)) * TAU * most;
                    assert!((pdf - 1.0).abs() < 1e-3, "{distance}: {pdf}");
                }
                let direction = warp::to_sphere(stream.square());
                let across = (direction.as_dvec3() - axis).length_squared() / 2.0 / most;
                assert!(across < 1.001 || sphere.pdf(position, direction) == 0.0, "{distance}: {direction}");
            }
            let p = testing::chi_square(&counts, &[1000.0; 16]);
            assert!(p > testing::significance(7), "{distance}: {p}, {counts:?}");
        }
    }

    /// Of rays from near and from far, some aim at one of a portal's spheres, some at another portal, and the
    /// others anywhere. So many are found.
    #[test]
    fn shares_are_found_from_near_and_far() {
        let sphere = |x| Sphere { centre: vec3(x, -0.2, 0.5), radius_squared: 0.01 };
        let portals = [sphere(0.3), sphere(-3.0)].map(Portal::even);
        let targets =
            [(0.5, Some(portals[0].spheres()[2])), (0.2, Some(portals[1].spheres()[0])), (0.3, None)];
        for most in [0.5, 0.9] {
            let unknown = Aimed::fitted(&portals, [].into_iter(), most).share();
            assert!((unknown - 0.1).abs() < 1e-6, "{unknown}");
        }
        let mut stream = Stream::new(33, 0, 0, Purpose::Study);
        for distance in [0.3, 1.0, 20.0] {
            let mut passage = |target: Option<Sphere>| {
                let position = portals[0].smallest.centre + distance * warp::to_sphere(stream.square());
                let u = stream.square();
                let direction =
                    target.map_or_else(|| warp::to_sphere(u), |sphere| sphere.sample(position, u));
                let unaimed = warp::SPHERE_PDF;
                Passage { position, direction, is_parallel: false, weight: 1.0, unaimed, fold: 0 }
            };
            let some = |(share, target): &(f64, Option<Sphere>)| vec![*target; (share * 10_000.0) as usize];
            let passages: Vec<Passage> = targets.iter().flat_map(some).map(&mut passage).collect();
            let found = Aimed::fitted(&portals, passages.into_iter(), 0.9);
            let shares: Vec<f32> = found.0.iter().map(|(share, _)| *share).collect();
            assert!(
                (shares[0] - 0.5).abs() < 0.05 && (shares[1] - 0.2).abs() < 0.05,
                "{distance}: {shares:?}"
            );
            assert!(found.0[0].1.shares[2] > 0.6 && found.0[1].1.shares[0] > 0.6, "{distance}: {found:?}");
        }
    }

    /// Where all passages go through one of the spheres, evenly, most directions aim at that one, and some at all others.
    #[test]
    fn directions_aim_at_what_passages_go_through() {
        let smallest = Sphere { centre: vec3(0.3, -0.2, 0.5), radius_squared: 0.01 };
        let even = Portal::fitted(smallest, [].into_iter());
        assert!(even.shares.iter().all(|share| (share - 0.25).abs() < 1e-6), "{:?}", even.shares);
        let mut stream = Stream::new(32, 0, 0, Purpose::Study);
        for (index, sphere) in even.spheres().into_iter().enumerate() {
            let passage = |_| {
                let position = smallest.centre + 2.0 * warp::to_sphere(stream.square());
                let direction = sphere.sample(position, stream.square());
                let (weight, unaimed) = (stream.uniform(), warp::SPHERE_PDF);
                Passage { position, direction, is_parallel: false, weight, unaimed, fold: 0 }
            };
            let passages: Vec<Passage> = (0..500).map(passage).collect();
            let Portal { shares, .. } = Portal::fitted(smallest, passages.iter());
            assert!((shares.iter().sum::<f32>() - 1.0).abs() < 1e-5, "{shares:?}");
            assert!(shares.iter().all(|share| *share >= LEAST), "{shares:?}");
            assert!(shares[index] > 0.6, "{index}: {shares:?}");
        }
    }
}
