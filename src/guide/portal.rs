//! Portals: what light has to go through to reach the image, like the openings between rooms, or a ball of glass. A table of
//! directions would have to learn of it in every cell of places anew; a portal is known from everywhere.

use super::Lesson;
use crate::math::{Frame, Vec2, Vec3, warp};

/// Where sine squared is more, at the surface and within, it is around on all sides.
const WITHIN: f32 = 0.999;

/// A sphere that walks aim at, evenly by solid angle; from within they go anywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Portal {
    /// World position.
    pub centre: Vec3,
    /// Above 0 [m].
    pub radius: f32,
}

impl Portal {
    /// 1 - cos of the half angle in which `position` sees it; none from within.
    #[inline]
    fn cone(&self, position: Vec3) -> Option<f32> {
        let sine_squared = self.radius * self.radius / position.distance_squared(self.centre);
        (sine_squared < WITHIN).then(|| warp::one_minus_cos(sine_squared))
    }

    /// Squared distance at which the ray in unit `direction` passes the centre [m^2]; none if that is behind it.
    #[inline]
    pub fn passes(centre: Vec3, position: Vec3, direction: Vec3) -> Option<f32> {
        let to = centre - position;
        let along = to.dot(direction);
        (along > 0.0).then(|| (to - along * direction).length_squared())
    }

    /// True if the lesson comes from outside and goes through.
    pub fn is_crossed(&self, lesson: &Lesson) -> bool {
        self.cone(lesson.position).is_some() && self.is_hit(lesson.position, lesson.direction)
    }

    #[inline]
    fn is_hit(&self, position: Vec3, direction: Vec3) -> bool {
        Self::passes(self.centre, position, direction).is_some_and(|miss| miss <= self.radius * self.radius)
    }

    /// Density of unit `direction` among those that aim at it from `position` [1/sr].
    #[inline]
    pub fn pdf(&self, position: Vec3, direction: Vec3) -> f32 {
        match self.cone(position) {
            None => warp::SPHERE_PDF,
            Some(one_minus_cos) if self.is_hit(position, direction) => warp::cone_pdf(one_minus_cos),
            Some(_) => 0.0,
        }
    }

    /// A unit direction from `position` that aims at it.
    #[inline]
    pub fn sample(&self, position: Vec3, u: Vec2) -> Vec3 {
        let Some(one_minus_cos) = self.cone(position) else { return warp::to_sphere(u) };
        let axis = (self.centre - position).normalize();
        Frame::around(axis).to_world(warp::to_cone(u, one_minus_cos)).normalize()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        math::vec3,
        sampling::{Stream, stream::Purpose},
        testing,
    };
    use std::f64::consts::TAU;

    /// Seen from afar, from close by, from its surface and from within: all directions aim at it, evenly, and the density is 1 over
    /// their solid angle, within it alone.
    #[test]
    fn directions_are_even_and_as_dense_as_they_are_said_to_be() {
        let portal = Portal { centre: vec3(0.3, -0.2, 0.5), radius: 0.25 };
        let mut stream = Stream::new(31, 0, 0, Purpose::Study);
        for distance in [1000.0, 3.0, 0.3, 0.251, 0.25, 0.1, 0.0] {
            let axis = vec3(-0.6, 0.48, 0.64);
            let position = portal.centre - distance * axis;
            let axis = (portal.centre - position).as_dvec3().normalize_or(axis.as_dvec3());
            let sine = f64::from(portal.radius) / position.as_dvec3().distance(portal.centre.as_dvec3());
            // 1 - cos, in which even directions are even, where they are not around it.
            let most = if sine < 0.9999 { sine * sine / (1.0 + (1.0 - sine * sine).sqrt()) } else { 2.0 };
            let mut counts = [0; 16];
            for _ in 0..16_000 {
                let direction = portal.sample(position, stream.square());
                let across = (direction.as_dvec3() - axis).length_squared() / 2.0 / most;
                assert!(across < 1.0 + 1e-4, "{distance}: {direction}");
                counts[(across * 16.0).min(15.0) as usize] += 1;
                if across < 0.999 {
                    let pdf = f64::from(portal.pdf(position, direction)) * TAU * most;
                    assert!((pdf - 1.0).abs() < 1e-3, "{distance}: {pdf}");
                }
                let direction = warp::to_sphere(stream.square());
                let across = (direction.as_dvec3() - axis).length_squared() / 2.0 / most;
                assert!(across < 1.001 || portal.pdf(position, direction) == 0.0, "{distance}: {direction}");
            }
            let p = testing::chi_square(&counts, &[1000.0; 16]);
            assert!(p > testing::significance(7), "{distance}: {p}, {counts:?}");
        }
    }
}
