//! Cornette & Shanks' phase function: Henyey & Greenstein's times Rayleigh's, made one (P03 eq. 6).

use super::{Deflection, HenyeyGreenstein, PhaseModel};
use crate::description::{Params, Table, table};
use crate::error::Result;
use crate::math::Vec3;
use crate::sampling::Stream;

/// 3 (1 - g^2) (1 + cos^2) / (8 pi (2 + g^2) (1 + g^2 - 2 g cos)^(3/2)). Of g = 0 it is Rayleigh's.
#[derive(Clone, Copy, Debug)]
pub struct CornetteShanks {
    /// The factor besides 1 + cos^2.
    peak: HenyeyGreenstein,
    g: f32,
}

impl CornetteShanks {
    /// `g` in (-1, 1): negative backward, positive forward. It is not quite the mean cosine.
    pub fn new(g: f64) -> Self {
        Self { peak: HenyeyGreenstein::new(g), g: g as f32 }
    }

    pub(super) const TABLE: Table = table! {
        "Cornette and Shanks' function: Henyey and Greenstein's times Rayleigh's.";
        number("g", "", between(-1.0, 1.0), Is(0.8), "Its asymmetry: above 0 forward, below 0 backward."),
    };

    pub(super) fn build(params: &Params<'_>) -> Result<Self> {
        Ok(Self::new(params.float("g")?))
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        [0.0, 1e-6, 0.3, -0.6, 0.85, -0.99].map(Self::new).to_vec()
    }
}

impl PhaseModel for CornetteShanks {
    #[inline]
    fn pdf_sr(&self, turn: Deflection) -> f32 {
        let (g, cosine) = (self.g, turn.cosine());
        self.peak.pdf_sr(turn) * (1.5 * (1.0 + cosine * cosine) / (2.0 + g * g))
    }

    /// Turns of the peak are kept with probability (1 + cos^2) / 2: two of three at least.
    #[inline]
    fn sample(&self, direction: Vec3, stream: &mut Stream) -> Vec3 {
        loop {
            let turned = self.peak.sample(direction, stream);
            let cosine = direction.dot(turned);
            if 2.0 * stream.uniform() < 1.0 + cosine * cosine {
                return turned;
            }
        }
    }

    fn mean_cosine(&self) -> f32 {
        let square = self.g * self.g;
        0.6 * self.g * (4.0 + square) / (2.0 + square)
    }
}
