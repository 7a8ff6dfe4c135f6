//! Mie scattering approximated by a lobe over a constant (P03T 2.3.4): any lobe, that of haze and those of murk.

use super::{Deflection, PhaseModel, deflect};
use crate::description::{Params, Table, table};
use crate::error::Result;
use crate::math::{Vec3, warp};
use crate::sampling::Stream;
use std::f32::consts::TAU;

/// k (1 + m cos^n(theta/2)) / (4 pi), k making it 1: (n + 2) / (n + 2 + 2 m).
///
/// P03T prints it without the 1 / (4 pi), and each atmosphere in two forms. For haze they are one function:
/// (1 + 9 cos^16(theta/2)) / 2. For murk they are two functions of n = 64: Nishita et al.'s has m = 50 (k is then
/// 33/83), Blasi et al.'s (eq. 2.16) m = 33 (k is 1/2).
#[derive(Clone, Copy, Debug)]
pub struct Mie {
    /// k, what the constant scatters, in (0, 1]; the lobe scatters the rest.
    constant: f32,
    /// k m.
    peak: f32,
    /// n / 2: the lobe is ((1 + cos) / 2) to its power.
    exponent: f32,
}

/// Higher and narrower lobes have no more than a few directions in f32.
const LARGEST: f64 = 1e9;

impl Mie {
    /// `m` >= 0 is the height of the lobe over the constant, `n` >= 0 how narrow it is.
    pub fn new(m: f64, n: f64) -> Self {
        let constant = (n + 2.0) / (n + 2.0 + 2.0 * m);
        Self { constant: constant as f32, peak: (m * constant) as f32, exponent: (0.5 * n) as f32 }
    }

    pub(super) const TABLE: Table = table! {
        "Mie scattering as a lobe over a constant: 1 + m cos^n(theta/2), normalised (Bhate and Tokuta 1992, p. 230; P03T 2.3.4).";
        number("m", "", within(0.0, LARGEST), Required, "Height of the lobe over the constant: 9 in haze, 50 in murk."),
        number("n", "", within(0.0, LARGEST), Required, "How narrow the lobe is: 16 in haze, 64 in murk."),
    };

    pub(super) const HAZY_TABLE: Table = table! {
    "Mie scattering by haze, few particles in the air: (1 + 9 cos^16(theta/2)) / (8 pi) (Nishita et al. 1987, p. 304; P03T 2.3.4)."; };

    pub(super) const MURKY_TABLE: Table = table! {
        "Mie scattering by murk, many particles in the air: 33 (1 + 50 cos^64(theta/2)) / (332 pi) (Nishita et al. 1987, p. 304) or (1 + 33 cos^64(theta/2)) / (8 pi) (Blasi et al. 1993, p. C205; P03T eq. 2.16).";
        choice("form", &["nishita", "blasi"], "nishita", "Whose approximation."),
    };

    pub(super) fn build(params: &Params<'_>) -> Result<Self> {
        Ok(Self::new(params.float("m")?, params.float("n")?))
    }

    pub(super) fn hazy(_: &Params<'_>) -> Result<Self> {
        Ok(Self::new(9.0, 16.0))
    }

    pub(super) fn murky(params: &Params<'_>) -> Result<Self> {
        let m = params.choice("form", &[("nishita", 50.0), ("blasi", 33.0)])?;
        Ok(Self::new(m, 64.0))
    }

    /// cos^n(theta/2), from 1 - cos on the side where that has more digits.
    #[inline]
    fn lobe(&self, turn: Deflection) -> f32 {
        let d = 0.5 * turn.from_peak(1.0);
        if d < 0.5 {
            (self.exponent * (-d).ln_1p()).exp()
        } else {
            (0.5 * turn.from_peak(-1.0)).powf(self.exponent)
        }
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        let pairs = [(9.0, 16.0), (50.0, 64.0), (33.0, 64.0), (0.0, 3.0), (2.0, 0.0), (0.7, 1.0), (1e4, 1e5)];
        pairs.map(|(m, n)| Self::new(m, n)).to_vec()
    }
}

impl PhaseModel for Mie {
    #[inline]
    fn pdf_sr(&self, turn: Deflection) -> f32 {
        warp::SPHERE_PDF * (self.constant + self.peak * self.lobe(turn))
    }

    #[inline]
    fn sample(&self, direction: Vec3, stream: &mut Stream) -> Vec3 {
        if stream.uniform() < self.constant {
            return warp::to_sphere(stream.square());
        }
        // (1 + cos) / 2 is u^(1 / (n/2 + 1)).
        let u = stream.square();
        let one_minus_cos = -2.0 * (u.x.ln() / (self.exponent + 1.0)).exp_m1();
        deflect(direction, warp::near_pole(one_minus_cos, TAU * u.y))
    }

    fn mean_cosine(&self) -> f32 {
        // The lobe scatters peak / (n/2 + 1), with the mean cosine n/2 / (n/2 + 2).
        let Self { peak, exponent, .. } = *self;
        peak / (exponent + 1.0) * (exponent / (exponent + 2.0))
    }
}
