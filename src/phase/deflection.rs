//! The angle of a scattering, with all its digits at both ends.

use crate::math::{Vec3, vec3};

/// The turn from one direction of flight to another.
///
/// The cosine alone cannot distinguish narrow angles: near 1 the steps of an f32 are 6e-8, as wide as the
/// whole peak of a sharp phase function. Half the squared distance between two unit vectors is 1 - cos
/// without a cancellation. Nothing is computed before it is needed.
#[derive(Clone, Copy, Debug)]
pub struct Deflection {
    before: Vec3,
    after: Vec3,
}

impl Deflection {
    /// From unit `before` to unit `after`, both directions of flight.
    #[inline]
    pub fn between(before: Vec3, after: Vec3) -> Self {
        Self { before, after }
    }

    /// The direction of flight before.
    #[inline]
    pub fn before(&self) -> Vec3 {
        self.before
    }

    /// The normal, of any length, of a mirror that turns so; straight on, of one that is grazed.
    #[inline]
    pub fn normal(&self) -> Vec3 {
        let normal = self.after - self.before;
        if normal == Vec3::ZERO { self.before.any_orthogonal_vector() } else { normal }
    }

    /// Its cosine, in [-1, 1]: 1 straight on, -1 straight back.
    #[inline]
    pub fn cosine(&self) -> f32 {
        self.before.dot(self.after).clamp(-1.0, 1.0)
    }

    /// 1 - cos in [0, 2] as seen from a peak: straight on for `sign` 1, straight back for -1.
    #[inline]
    pub fn from_peak(&self, sign: f32) -> f32 {
        (0.5 * (self.after - sign * self.before).length_squared()).min(2.0)
    }

    /// The angle (rad), in [0, pi] (Kahan: twice the arc tangent of |a - b| / |a + b|).
    #[inline]
    pub fn angle(&self) -> f32 {
        2.0 * (self.after - self.before).length().atan2((self.after + self.before).length())
    }

    /// The turn with the given 1 - cos in [0, 2] as seen from straight on (`sign` 1) or straight back (-1).
    pub fn of(one_minus_cos: f64, sign: f32) -> Self {
        let sine = (one_minus_cos * (2.0 - one_minus_cos)).max(0.0).sqrt();
        let along = (1.0 - one_minus_cos) as f32 * sign;
        Self { before: Vec3::Z, after: vec3(sine as f32, 0.0, along) }
    }
}
