//! Fresnel's equations for dielectrics and conductors, and refraction.

use super::{Spectrum, Vec3, vec3};

/// An interface between two dielectrics as seen from one side.
#[derive(Clone, Copy, Debug)]
pub struct Interface {
    /// Index of the far side over that of the near side.
    pub ratio: f32,
    /// ratio^2 - 1, from the difference of the indices: an interface of nearly equal ones keeps its digits.
    excess: f32,
}

/// An interface as seen from both sides.
#[derive(Clone, Copy, Debug)]
pub struct Interfaces {
    /// From the side that the normal points to.
    pub outside: Interface,
    /// From the other side.
    pub inside: Interface,
}

impl Interfaces {
    /// Between indices of refraction `inside` and `outside`, both > 0.
    pub fn new(inside: f64, outside: f64) -> Self {
        let seen = |near: f64, far: f64| Interface {
            ratio: (far / near) as f32,
            excess: ((far - near) * (far + near) / (near * near)) as f32,
        };
        Self { outside: seen(outside, inside), inside: seen(inside, outside) }
    }

    /// As seen from a direction at signed `cosine` to the normal.
    #[inline]
    pub fn seen_from(&self, cosine: f32) -> Interface {
        if cosine > 0.0 { self.outside } else { self.inside }
    }
}

impl Interface {
    /// Fresnel's reflectance of unpolarised light at `cosine` in [0, 1] to the normal of the near side; 1 in
    /// total reflection.
    #[inline]
    pub fn reflectance(&self, cosine: f32) -> f32 {
        let (s, p) = self.polarised(cosine);
        (0.5 * (s + p)).min(1.0)
    }

    /// The same of light that swings across and along the plane of incidence.
    ///
    /// With q = ratio cos_t the amplitudes (c - q)/(c + q) and (ratio^2 c - q)/(ratio^2 c + q) are multiplied
    /// above and below by their denominators; what cancels above then is `excess`.
    #[inline]
    pub fn polarised(&self, cosine: f32) -> (f32, f32) {
        let Self { ratio, excess } = *self;
        if excess == 0.0 {
            return (0.0, 0.0);
        }
        let square = cosine * cosine;
        let q_square = square + excess;
        if q_square <= 0.0 {
            return (1.0, 1.0);
        }
        let q = q_square.sqrt();
        let (across, along) = (cosine + q, ratio * ratio * cosine + q);
        let s = excess / (across * across);
        let p = excess * ((2.0 + excess) * square - 1.0) / (along * along);
        (s * s, p * p)
    }

    /// The reflectance averaged over the near hemisphere by cosine.
    pub fn diffuse_reflectance(&self) -> f64 {
        self.moment(0)
    }

    /// Integral of the reflectance times x^`power` over x = cos^2 from 0 to 1.
    ///
    /// In total reflection the integrand is 1. Beyond, it is smooth in cos or, seen from the denser side, in
    /// q; the third power of the step crowds points where an interface of nearly equal indices reflects.
    pub fn moment(&self, power: i32) -> f64 {
        let excess = f64::from(self.excess);
        let total = (-excess).max(0.0);
        let (steps, end) = (8192, (1.0 - total).sqrt());
        let at = |i: i32| {
            let t = (f64::from(i) + 0.5) / f64::from(steps);
            let v = end * t * t * t;
            let x = v * v + total;
            f64::from(self.reflectance(x.sqrt() as f32)) * x.powi(power) * 2.0 * v * 3.0 * end * t * t
        };
        let beyond = (0..steps).map(at).sum::<f64>() / f64::from(steps);
        beyond + total.powi(power + 1) / f64::from(power + 1)
    }

    /// Cosine of the refracted direction to the normal of the far side; none in total reflection.
    #[inline]
    pub fn refracted_cosine(&self, cosine: f32) -> Option<f32> {
        let q_square = cosine * cosine + self.excess;
        (q_square > 0.0).then(|| (q_square.sqrt() / self.ratio).min(1.0))
    }

    /// The direction on the far side, away from the surface, into which `w` (on the near side, away from it)
    /// is refracted about the shading normal; none in total reflection.
    #[inline]
    pub fn refract(&self, w: Vec3) -> Option<Vec3> {
        let cosine = self.refracted_cosine(w.z)?;
        let bent = vec3(-w.x / self.ratio, -w.y / self.ratio, -cosine.copysign(w.z));
        Some(bent.normalize())
    }

    /// The same as seen from the far side.
    #[inline]
    pub fn reversed(&self) -> Self {
        let Self { ratio, excess } = *self;
        Self { ratio: 1.0 / ratio, excess: -excess / (ratio * ratio) }
    }

    /// True if the far side has the larger index: there is no total reflection, and Fresnel's reflectance
    /// is well conditioned in the near cosine.
    #[inline]
    pub fn is_into_denser(&self) -> bool {
        self.excess > 0.0
    }
}

/// Reflectance of unpolarised light at an interface with a conductor of index `eta` + i `k` per channel,
/// relative to the outside; `cosine` in [0, 1] (Born & Wolf 1999, sec. 14.4).
#[inline]
pub fn conductor(cosine: f32, eta: Spectrum, k: Spectrum) -> Spectrum {
    let channel = |i: usize| conductor_channel(cosine, eta[i], k[i]);
    vec3(channel(0), channel(1), channel(2))
}

#[inline]
fn conductor_channel(cosine: f32, eta: f32, k: f32) -> f32 {
    let square = cosine * cosine;
    let sine_square = (1.0 - square).max(0.0);
    // a + i b = sqrt((eta + i k)^2 - sin^2), the complex counterpart of q in `Interface::reflectance`.
    let real = eta * eta - k * k - sine_square;
    let modulus = real.hypot(2.0 * eta * k);
    let a = (0.5 * (modulus + real)).max(0.0).sqrt();
    let (sum, cross) = (modulus + square, 2.0 * a * cosine);
    let s = quotient(sum - cross, sum + cross);
    let sine_tangent = modulus * square + sine_square * sine_square;
    let cross = cross * sine_square;
    let p = s * quotient(sine_tangent - cross, sine_tangent + cross);
    (0.5 * (s + p)).clamp(0.0, 1.0)
}

/// `a / b`, and 1 for 0/0: the limit of both amplitudes' squares as the index vanishes.
#[inline]
fn quotient(a: f32, b: f32) -> f32 {
    if b > 0.0 { a / b } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Fresnel's equations as the textbook prints them, in f64.
    fn textbook(cosine: f64, ratio: f64) -> f64 {
        let sine_square = (1.0 - cosine * cosine) / (ratio * ratio);
        if sine_square >= 1.0 {
            return 1.0;
        }
        let t = (1.0 - sine_square).sqrt();
        let s = (cosine - ratio * t) / (cosine + ratio * t);
        let p = (ratio * cosine - t) / (ratio * cosine + t);
        0.5 * (s * s + p * p)
    }

    #[test]
    fn reflectance_keeps_its_digits_near_index_one() {
        for excess in [1e-6, -1e-6, 1e-4, 0.01, 0.333, -0.25, 0.5, 1.4, 9.0] {
            let interface = Interfaces::new(1.0 + excess, 1.0).outside;
            for i in 1..=100 {
                let cosine = i as f32 / 100.0;
                let exact = textbook(f64::from(cosine), 1.0 + excess);
                let found = f64::from(interface.reflectance(cosine));
                let tolerance = 1e-4 * exact + 1e-17;
                assert!((found - exact).abs() < tolerance, "{excess} at {cosine}: {found} for {exact}");
            }
        }
    }

    #[test]
    fn reflectance_is_the_same_from_both_sides() {
        let both = Interfaces::new(1.5, 1.0);
        for cosine in [1.0, 0.7, 0.3, 0.05] {
            let there = both.outside.refracted_cosine(cosine).unwrap();
            let (out, back) = (both.outside.reflectance(cosine), both.inside.reflectance(there));
            assert!((out - back).abs() < 1e-5, "{out} against {back}");
        }
        assert_eq!(both.inside.reflectance(0.5), 1.0);
        assert_eq!(both.outside.reflectance(0.0), 1.0);
        assert_eq!(Interfaces::new(1.3, 1.3).outside.reflectance(0.0), 0.0);
    }

    /// Duntley's closed form of the average over the hemisphere, for n > 1.
    #[test]
    fn the_diffuse_reflectance_is_duntley_s() {
        for n in [1.05f64, 1.33, 1.5, 2.4] {
            let (n2, n4) = (n * n, n.powi(4));
            let exact = 0.5
                + (n - 1.0) * (3.0 * n + 1.0) / (6.0 * (n + 1.0).powi(2))
                + n2 * (n2 - 1.0).powi(2) / (n2 + 1.0).powi(3) * ((n - 1.0) / (n + 1.0)).ln()
                - 2.0 * n2 * n * (n2 + 2.0 * n - 1.0) / ((n2 + 1.0) * (n4 - 1.0))
                + 8.0 * n4 * (n4 + 1.0) / ((n2 + 1.0) * (n4 - 1.0).powi(2)) * n.ln();
            let both = Interfaces::new(n, 1.0);
            let found = [both.outside.diffuse_reflectance(), both.inside.diffuse_reflectance()];
            assert!((found[0] - exact).abs() < 1e-5, "{n}: {found:?} for {exact}");
            assert!((found[1] - (1.0 - (1.0 - exact) / n2)).abs() < 1e-5, "{n}: {found:?}");
        }
    }

    #[test]
    fn a_conductor_without_absorption_is_a_dielectric() {
        let interface = Interfaces::new(1.5, 1.0).outside;
        for cosine in [1.0, 0.7, 0.3, 0.05] {
            let metal = conductor(cosine, Spectrum::splat(1.5), Spectrum::ZERO).x;
            assert!((metal - interface.reflectance(cosine)).abs() < 1e-5);
        }
        assert_eq!(conductor(1.0, Spectrum::ZERO, Spectrum::ZERO), Spectrum::ONE);
    }
}
