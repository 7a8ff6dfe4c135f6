//! Mie scattering by haze and by murk, approximated by a lobe over a constant (P03T 2.3.4).

use super::{Deflection, PhaseModel, deflect};
use crate::description::{Params, Table, table};
use crate::error::Result;
use crate::math::{Vec3, warp};
use crate::sampling::Stream;
use std::f32::consts::TAU;

/// (1 - share) / (4 pi) + share (n + 1) / (4 pi) ((1 + cos) / 2)^n.
///
/// P03T prints it without the 1 / (4 pi), and each atmosphere in two forms. For haze they are one function:
/// (1 + 9 cos^16(theta/2)) / 2 has n = 8 and share 1/2. For murk they are two functions of n = 32: Nishita et
/// al.'s 33/83 (1 + 50 cos^64(theta/2)) has share 50/83, Blasi et al.'s (eq. 2.16) 1/2.
#[derive(Clone, Copy, Debug)]
pub struct Mie {
    /// What the lobe scatters, in [0, 1].
    share: f32,
    exponent: i32,
}

impl Mie {
    const HAZY: Self = Self { share: 0.5, exponent: 8 };
    const MURKY_OF_NISHITA: Self = Self { share: 50.0 / 83.0, exponent: 32 };
    const MURKY_OF_BLASI: Self = Self { share: 0.5, exponent: 32 };

    pub(super) const HAZY_TABLE: Table = table! {
    "Mie scattering by haze: few particles in the air."; };

    pub(super) const MURKY_TABLE: Table = table! {
        "Mie scattering by murk: many particles in the air.";
        choice("form", &["nishita", "blasi"], "nishita", "Whose approximation."),
    };

    pub(super) fn hazy(_: &Params<'_>) -> Result<Self> {
        Ok(Self::HAZY)
    }

    pub(super) fn murky(params: &Params<'_>) -> Result<Self> {
        let forms = [("nishita", Self::MURKY_OF_NISHITA), ("blasi", Self::MURKY_OF_BLASI)];
        params.choice("form", &forms)
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        vec![Self::HAZY, Self::MURKY_OF_NISHITA, Self::MURKY_OF_BLASI]
    }
}

impl PhaseModel for Mie {
    #[inline]
    fn pdf_sr(&self, turn: Deflection) -> f32 {
        let half_angle_cosine_square = 0.5 * turn.from_peak(-1.0);
        let lobe = (self.exponent + 1) as f32 * half_angle_cosine_square.powi(self.exponent);
        warp::SPHERE_PDF * (1.0 - self.share + self.share * lobe)
    }

    #[inline]
    fn sample(&self, direction: Vec3, stream: &mut Stream) -> Vec3 {
        if stream.uniform() >= self.share {
            return warp::to_sphere(stream.square());
        }
        // (1 + cos) / 2 is u^(1/(n+1)).
        let u = stream.square();
        let one_minus_cos = -2.0 * (u.x.ln() / (self.exponent + 1) as f32).exp_m1();
        deflect(direction, warp::near_pole(one_minus_cos, TAU * u.y))
    }

    fn mean_cosine(&self) -> f32 {
        self.share * self.exponent as f32 / (self.exponent + 2) as f32
    }
}
