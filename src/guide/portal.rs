//! Portals: what light must pass through to reach the image, like the openings between rooms, or a ball of glass. A
//! table of directions would have to learn them anew in every cell of places; a portal is known from everywhere.

use super::Lesson;
use crate::{
    math::{Frame, Vec2, Vec3, warp},
    sampling::Stream,
};

/// Number of concentric spheres that directions aim at, each wider by the square root of 2. An opening may be of any
/// shape: one sphere of about its size leaves out its corners, and the few paths that find those would weigh as much as
/// without a guide.
const SPHERES: usize = 4;
/// Least part of the directions that aims at each of them.
const LEAST: f32 = 0.05;
/// How often shares are fitted.
const FITS: usize = 16;
/// Above this squared sine, at the surface and within, a sphere counts as all around.
const WITHIN: f32 = 0.999;

/// Concentric spheres that walks aim at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Portal {
    /// The other spheres are around it.
    pub smallest: Sphere,
    /// The part of the directions that aims at each sphere, 1 together.
    shares: [f32; SPHERES],
}

impl Portal {
    /// The portal of spheres from `smallest` on. Their shares maximise the likelihood of the `lessons` that come from
    /// outside and pass through, each with its weight (above 0).
    pub fn fitted<'a>(smallest: Sphere, lessons: impl Iterator<Item = (f32, &'a Lesson)>) -> Self {
        let even = Self { smallest, shares: [1.0 / SPHERES as f32; SPHERES] };
        let outermost = even.outermost();
        let through = lessons.filter(|(_, lesson)| outermost.is_crossed(lesson));
        let known = through.map(|(weight, lesson)| (weight, even.parts(lesson.position, lesson.direction)));
        let known: Vec<_> = known.collect();
        let fitted = (0..FITS).fold(even, |portal, _| portal.refitted(&known));
        let rest = 1.0 - SPHERES as f32 * LEAST;
        Self { smallest, shares: fitted.shares.map(|share| LEAST + rest * share) }
    }

    /// One step of expectation maximisation.
    fn refitted(&self, known: &[(f32, [f32; SPHERES])]) -> Self {
        let mut sums = [f32::MIN_POSITIVE; SPHERES];
        for (weight, pdfs) in known {
            let parts: [f32; SPHERES] = std::array::from_fn(|index| self.shares[index] * pdfs[index]);
            let all: f32 = parts.iter().sum();
            sums.iter_mut().zip(parts).for_each(|(sum, part)| *sum += weight * part / all);
        }
        let all: f32 = sums.iter().sum();
        Self { shares: sums.map(|sum| sum / all), ..*self }
    }

    /// The greatest of its spheres.
    pub fn outermost(&self) -> Sphere {
        let [.., outermost] = self.spheres();
        outermost
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
        if !spheres[SPHERES - 1].is_aimed(position, direction) {
            return [0.0; SPHERES];
        }
        spheres.map(|sphere| sphere.pdf(position, direction))
    }

    /// Density of unit `direction` among those that aim at it from `position` (1/sr).
    #[inline]
    pub fn pdf(&self, position: Vec3, direction: Vec3) -> f32 {
        let parts = self.parts(position, direction);
        parts.iter().zip(&self.shares).map(|(pdf, share)| share * pdf).sum()
    }

    /// A unit direction from `position` that aims at it.
    #[inline]
    pub fn sample(&self, position: Vec3, stream: &mut Stream) -> Vec3 {
        let mut u = stream.uniform();
        let [inner @ .., outermost] = self.spheres();
        let of = inner.into_iter().zip(self.shares).find(|(_, share)| {
            u -= share;
            u < 0.0
        });
        of.map_or(outermost, |(sphere, _)| sphere).sample(position, stream.square())
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
    /// 1 - cos of the half angle in which `position` sees it; none from within.
    #[inline]
    fn cone(&self, position: Vec3) -> Option<f32> {
        let squared = position.distance_squared(self.centre);
        (self.radius_squared < WITHIN * squared).then(|| warp::one_minus_cos(self.radius_squared / squared))
    }

    /// Squared distance at which the ray in unit `direction` passes `centre` (m^2); none if that is behind it.
    #[inline]
    pub fn passes(centre: Vec3, position: Vec3, direction: Vec3) -> Option<f32> {
        let to = centre - position;
        let along = to.dot(direction);
        (along > 0.0).then(|| (to - along * direction).length_squared())
    }

    /// True if unit `direction` from `position` may be one that aims at it.
    #[inline]
    fn is_aimed(&self, position: Vec3, direction: Vec3) -> bool {
        let is_outside = self.radius_squared < WITHIN * position.distance_squared(self.centre);
        !is_outside || self.is_hit(position, direction)
    }

    /// True if the lesson comes from outside and goes through.
    pub fn is_crossed(&self, lesson: &Lesson) -> bool {
        self.cone(lesson.position).is_some() && self.is_hit(lesson.position, lesson.direction)
    }

    #[inline]
    fn is_hit(&self, position: Vec3, direction: Vec3) -> bool {
        Self::passes(self.centre, position, direction).is_some_and(|miss| miss <= self.radius_squared)
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
    use crate::{bsdf::Transport, math::vec3, sampling::stream::Purpose, testing};
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

    /// Where all lessons go through one of the spheres, evenly, most directions aim at that one, and some at all others.
    #[test]
    fn directions_aim_at_what_lessons_go_through() {
        let smallest = Sphere { centre: vec3(0.3, -0.2, 0.5), radius_squared: 0.01 };
        let even = Portal::fitted(smallest, [].into_iter());
        assert!(even.shares.iter().all(|share| (share - 0.25).abs() < 1e-6), "{:?}", even.shares);
        let mut stream = Stream::new(32, 0, 0, Purpose::Study);
        for (index, sphere) in even.spheres().into_iter().enumerate() {
            let lesson = |_| {
                let position = smallest.centre + 2.0 * warp::to_sphere(stream.square());
                let direction = sphere.sample(position, stream.square());
                let (normal, transport, weight) = (None, Transport::Radiance, stream.uniform());
                Lesson { position, normal, transport, direction, weight, unguided: warp::SPHERE_PDF, fold: 0 }
            };
            let lessons: Vec<Lesson> = (0..500).map(lesson).collect();
            let Portal { shares, .. } =
                Portal::fitted(smallest, lessons.iter().map(|lesson| (lesson.weight, lesson)));
            assert!((shares.iter().sum::<f32>() - 1.0).abs() < 1e-5, "{shares:?}");
            assert!(shares.iter().all(|share| *share >= LEAST), "{shares:?}");
            assert!(shares[index] > 0.6, "{index}: {shares:?}");
        }
    }
}
