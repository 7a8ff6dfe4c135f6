//! Sakas' Gaussian phase function: a normal distribution of the angle (P03T 2.3.5).

use super::{Deflection, PhaseModel, deflect};
use crate::description::{Params, Table, table};
use crate::error::Result;
use crate::math::{Vec3, warp};
use crate::sampling::Stream;
use std::f64::consts::PI;

/// exp(-gamma theta^2), normalised to 1 over the sphere by quadrature.
#[derive(Clone, Copy, Debug)]
pub struct Gaussian {
    /// (1/rad^2).
    gamma: f32,
    /// The value straight on (1/sr).
    peak: f32,
    mean_cosine: f32,
}

/// Narrower lobes have no more than a few directions in f32.
const LARGEST: f64 = 1e9;

impl Gaussian {
    /// `gamma` >= 0 (1/rad^2) narrows the lobe: 1 / (2 gamma) is the variance of the angle along any plane.
    pub fn new(gamma: f64) -> Self {
        let [total, moment] = [0, 1].map(|power| integral(gamma, power));
        let peak = 1.0 / (2.0 * PI * total);
        Self { gamma: gamma as f32, peak: peak as f32, mean_cosine: (moment / total) as f32 }
    }

    pub(super) const TABLE: Table = table! {
        "Sakas' Gaussian of the angle: exp(-gamma theta^2), normalised (P03T 2.3.5).";
        number("gamma", "1/rad^2", within(0.0, LARGEST), Required, "How narrow the lobe is: 1 / (2 gamma) is the variance of the angle."),
    };

    pub(super) fn build(params: &Params<'_>) -> Result<Self> {
        Ok(Self::new(params.float("gamma")?))
    }

    /// The square of an angle whose density goes as theta exp(-gamma theta^2) up to pi.
    #[inline]
    fn planar(&self, u: f32) -> f32 {
        const PI_SQUARE: f32 = (PI * PI) as f32;
        let within = -(-self.gamma * PI_SQUARE).exp_m1();
        // Below this the exponential is constant to the last bit.
        if within < 1e-12 { u * PI_SQUARE } else { -(-u * within).ln_1p() / self.gamma }
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        [0.0, 1e-20, 1e-6, 0.2, 0.6, 5.0, 1e4].map(Self::new).to_vec()
    }
}

/// Integral of exp(-gamma theta^2) cos^power sin over theta, by Simpson's rule up to where nothing is left.
fn integral(gamma: f64, power: i32) -> f64 {
    let end = PI.min(7.0 / gamma.sqrt());
    let steps = 2048;
    let at = |i: i32| {
        let theta = end * f64::from(i) / f64::from(steps);
        (-gamma * theta * theta).exp() * theta.cos().powi(power) * theta.sin()
    };
    let weight = |i: i32| if i % 2 == 1 { 4.0 } else { 2.0 };
    let inner: f64 = (1..steps).map(|i| weight(i) * at(i)).sum();
    (at(0) + inner + at(steps)) * end / (3.0 * f64::from(steps))
}

impl PhaseModel for Gaussian {
    #[inline]
    fn pdf_sr(&self, turn: Deflection) -> f32 {
        let angle = turn.angle();
        self.peak * (-self.gamma * angle * angle).exp()
    }

    /// Angles of the plane are kept with probability sin(theta) / theta: four of ten at least.
    #[inline]
    fn sample(&self, direction: Vec3, stream: &mut Stream) -> Vec3 {
        loop {
            let u = stream.square();
            let angle = self.planar(u.x).sqrt();
            if angle * stream.uniform() <= angle.sin() {
                let half = (0.5 * angle).sin();
                let azimuth = std::f32::consts::TAU * u.y;
                return deflect(direction, warp::near_pole((2.0 * half * half).min(2.0), azimuth));
            }
        }
    }

    fn mean_cosine(&self) -> f32 {
        self.mean_cosine
    }
}
