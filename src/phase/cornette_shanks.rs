//! Cornette & Shanks' phase function: Henyey & Greenstein's times Rayleigh's, made one (P03 eq. 6), stated by g or by
//! the mean cosine u (P03T 2.3.4).

use super::{Deflection, HenyeyGreenstein, PhaseModel};
use crate::description::{Params, Table, table};
use crate::error::Result;
use crate::math::{Vec3, cubic};
use crate::sampling::Stream;

/// 3 (1 - g^2) (1 + cos^2) / (8 pi (2 + g^2) (1 + g^2 - 2 g cos)^(3/2)). Of g = 0 it is Rayleigh's.
#[derive(Clone, Copy, Debug)]
pub struct CornetteShanks {
    /// The factor besides 1 + cos^2.
    peak: HenyeyGreenstein,
    g: f32,
}

impl CornetteShanks {
    /// `g` in (-1, 1), up to rounding: negative backward, positive forward. It is not quite the mean cosine.
    pub fn new(g: f64) -> Self {
        Self { peak: HenyeyGreenstein::new(g), g: g as f32 }
    }

    /// Of the mean cosine `u`, in (-1, 1): the root of g^3 - 5/3 u g^2 + 4 g - 10/3 u, which Nishita et al. 1993 give in
    /// Cardano's form, the g(u) of P03T 2.3.4.
    pub fn of_mean_cosine(u: f64) -> Self {
        let a = (4.0 / 3.0 - 25.0 / 81.0 * u * u).sqrt();
        let g = 5.0 / 9.0 * u + cubic::root(a, 5.0 / 9.0 * u + 125.0 / 729.0 * u * u * u);
        Self::new(g)
    }

    pub(super) const TABLE: Table = table! {
        "The Cornette-Shanks function, Henyey-Greenstein's times Rayleigh's: hg 1.5 (1 + cos^2) / (2 + g^2) (P03 eq. 6).";
        number("g", "", between(-1.0, 1.0), Is(0.8), "Asymmetry: above 0 forward, below 0 backward."),
        number("u", "", between(-1.0, 1.0), Optional, "The mean cosine, in place of g: 0.7 to 0.85 in air, by its state (Nishita et al. 1993)."),
    };

    pub(super) fn build(params: &Params<'_>) -> Result<Self> {
        Ok(match params.optional_float("u")? {
            Some(u) => Self::of_mean_cosine(u),
            None => Self::new(params.float("g")?),
        })
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        let by_g = [0.0, 1e-6, 0.3, -0.6, 0.85, -0.99].map(Self::new);
        let by_u = [0.0, 0.7, -0.85].map(Self::of_mean_cosine);
        [&by_g[..], &by_u].concat()
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

#[cfg(test)]
mod tests {
    use super::*;

    /// As printed by Nishita et al. 1993.
    fn printed(u: f64) -> f64 {
        let square = u * u;
        let below = 64.0 / 27.0 - 325.0 / 243.0 * square + 1250.0 / 2187.0 * square * square;
        let x = 5.0 / 9.0 * u + 125.0 / 729.0 * u * square + below.sqrt();
        5.0 / 9.0 * u - (4.0 / 3.0 - 25.0 / 81.0 * square) / x.cbrt() + x.cbrt()
    }

    #[test]
    fn g_of_u_is_the_printed_one_and_u_the_mean_cosine() {
        for u in [-0.999_999, -0.85, -1e-7, 0.0, 0.3, 0.7, 0.75, 0.85, 0.999_999] {
            let model = CornetteShanks::of_mean_cosine(u);
            assert!((f64::from(model.g) - printed(u)).abs() < 1e-6, "{u}: {model:?} for {}", printed(u));
            assert!((f64::from(model.mean_cosine()) - u).abs() < 1e-6, "{u}: {model:?}");
        }
    }

    /// The largest numbers below 1 are still lobes.
    #[test]
    fn no_u_makes_a_lobe_of_no_width() {
        for u in [1.0 - f64::EPSILON / 2.0, 1.0 - f64::EPSILON, -1.0 + f64::EPSILON / 2.0] {
            let model = CornetteShanks::of_mean_cosine(u);
            let peak = model.pdf_sr(Deflection::of(0.0, 1f32.copysign(u as f32)));
            assert!(peak.is_finite() && peak > 1e20, "{u}: {peak}");
        }
    }
}
