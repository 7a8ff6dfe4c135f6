//! Sakas' phase function: a lobe forward and its mirror image backward (P03T eq. 2.18).

use super::{Deflection, PhaseModel, deflect};
use crate::description::{Params, Table, table};
use crate::error::Result;
use crate::math::{Vec3, warp};
use crate::sampling::Stream;
use std::f32::consts::TAU;

/// (1 + n) (1 + |cos|^n) / (4 pi (2 + n)). Of n = 0 it is constant, of n = 2 Rayleigh's.
#[derive(Clone, Copy, Debug)]
pub struct Sakas {
    n: f32,
}

/// Narrower lobes have no more than a few directions in f32.
const LARGEST: f64 = 1e9;

impl Sakas {
    /// `n` >= 0 narrows the lobes; it need not be whole.
    pub fn new(n: f32) -> Self {
        Self { n }
    }

    pub(super) const TABLE: Table = table! {
        "Sakas' function, a lobe forward and its mirror image backward: 1 + abs(cos)^n, normalised (P03T eq. 2.18).";
        number("n", "", within(0.0, LARGEST), Required, "How narrow the lobes are: 0 is isotropic, 2 Rayleigh's."),
    };

    pub(super) fn build(params: &Params<'_>) -> Result<Self> {
        Ok(Self::new(params.float("n")? as f32))
    }

    /// |cos|^n, from 1 - |cos| where that has more digits.
    #[inline]
    fn power(&self, turn: Deflection) -> f32 {
        let d = turn.from_peak(1.0).min(turn.from_peak(-1.0));
        if d < 0.5 { (self.n * (-d).ln_1p()).exp() } else { turn.cosine().abs().powf(self.n) }
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        [0.0, 0.5, 1.0, 2.0, 5.0, 30.0, 1e4].map(Self::new).to_vec()
    }
}

impl PhaseModel for Sakas {
    #[inline]
    fn pdf_sr(&self, turn: Deflection) -> f32 {
        warp::SPHERE_PDF * ((1.0 + self.n) / (2.0 + self.n)) * (1.0 + self.power(turn))
    }

    /// The lobes together scatter 1 / (2 + n), the constant the rest.
    #[inline]
    fn sample(&self, direction: Vec3, stream: &mut Stream) -> Vec3 {
        if stream.uniform() * (2.0 + self.n) >= 1.0 {
            return warp::to_sphere(stream.square());
        }
        let sign = if stream.uniform() < 0.5 { 1.0 } else { -1.0 };
        // |cos| is u^(1/(n+1)).
        let u = stream.square();
        let one_minus_cos = -(u.x.ln() / (self.n + 1.0)).exp_m1();
        deflect(sign * direction, warp::near_pole(one_minus_cos, TAU * u.y))
    }

    fn mean_cosine(&self) -> f32 {
        0.0
    }
}
