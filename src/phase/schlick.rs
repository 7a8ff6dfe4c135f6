//! Schlick's phase function: like Henyey & Greenstein's, without the fractional power (P03 eq. 4).

use super::{Deflection, PhaseModel, deflect};
use crate::description::{Params, Table, table};
use crate::error::Result;
use crate::math::{Vec3, warp};
use crate::sampling::Stream;
use std::f32::consts::TAU;

/// (1 - k^2) / (4 pi (1 - k cos)^2). P03 eq. 4 prints the denominator with a plus, its cosine being that to
/// the direction back; here cos > 0 is forward and so is the peak of k > 0.
///
/// Kept as |k| and 1 - |k|, as in Henyey & Greenstein's: 1 - k cos is (1 - |k|) + |k| d with d = 1 - cos as
/// seen from the peak.
#[derive(Clone, Copy, Debug)]
pub struct Schlick {
    size: f32,
    complement: f32,
    sign: f32,
}

impl Schlick {
    /// `k` in (-1, 1): negative backward, 0 isotropic, positive forward.
    pub fn new(k: f64) -> Self {
        let size = k.abs();
        Self { size: size as f32, complement: (1.0 - size) as f32, sign: 1f32.copysign(k as f32) }
    }

    pub(super) const TABLE: Table = table! {
        "Schlick's rational approximation of Henyey-Greenstein: (1 - k^2) / (4 pi (1 - k cos)^2) (P03 eq. 4).";
        number("k", "", between(-1.0, 1.0), Is(0.0), "Asymmetry: above 0 forward, below 0 backward."),
    };

    pub(super) fn build(params: &Params<'_>) -> Result<Self> {
        Ok(Self::new(params.float("k")?))
    }

    /// 1 - cos as seen from the peak, for a uniform `u`.
    #[inline]
    fn invert(&self, u: f32) -> f32 {
        let Self { size: k, complement, .. } = *self;
        (2.0 * u * complement / (complement + 2.0 * k * (1.0 - u))).min(2.0)
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        [0.0, 1e-9, 5e-5, 0.025, 0.5, -0.8, 0.99, -0.999].map(Self::new).to_vec()
    }
}

impl PhaseModel for Schlick {
    #[inline]
    fn pdf_sr(&self, turn: Deflection) -> f32 {
        let Self { size: k, complement, sign } = *self;
        let base = complement + k * turn.from_peak(sign);
        warp::SPHERE_PDF * complement * (1.0 + k) / (base * base)
    }

    #[inline]
    fn sample(&self, direction: Vec3, stream: &mut Stream) -> Vec3 {
        let u = stream.square();
        deflect(self.sign * direction, warp::near_pole(self.invert(u.x), TAU * u.y))
    }

    /// 1/k - (1 - k^2) artanh(k) / k^2, by its series where the two terms cancel.
    fn mean_cosine(&self) -> f32 {
        let k = f64::from(self.size);
        let mean = if k < 0.03 {
            k * (2.0 / 3.0 + k * k * (2.0 / 15.0 + k * k * (2.0 / 35.0)))
        } else {
            let complement = f64::from(self.complement);
            let artanh = 0.5 * ((1.0 + k) / complement).ln();
            (1.0 - complement * (1.0 + k) * artanh / k) / k
        };
        self.sign * mean as f32
    }
}
