//! Henyey & Greenstein's phase function (P03 eq. 2), precise from g = 0 to within rounding of g = +-1.

use super::{Deflection, PhaseModel, deflect};
use crate::description::{Params, Table, table};
use crate::error::Result;
use crate::math::{Vec3, warp};
use crate::sampling::Stream;
use std::f32::consts::TAU;

/// (1 - g^2) / (4 pi (1 + g^2 - 2 g cos)^(3/2)).
///
/// Kept as |g| and 1 - |g|, and written in d = 1 - cos as seen from the peak: 1 + g^2 - 2 g cos is
/// (1 - |g|)^2 + 2 |g| d, which has no cancellation however sharp the peak is.
#[derive(Clone, Copy, Debug)]
pub struct HenyeyGreenstein {
    /// |g|.
    size: f32,
    /// 1 - |g|, rounded once.
    complement: f32,
    /// The sign of g: 1 with the peak forward, -1 with the peak backward.
    sign: f32,
}

/// Sharper peaks turn no direction of f32, and the third power of their 1 - |g| is 0 in f32.
const SHARPEST: f64 = 1.0 - 1e-12;

impl HenyeyGreenstein {
    /// `g` is the mean cosine, in (-1, 1).
    pub fn new(g: f64) -> Self {
        let size = g.abs().min(SHARPEST);
        Self { size: size as f32, complement: (1.0 - size) as f32, sign: 1f32.copysign(g as f32) }
    }

    pub(super) const TABLE: Table = table! {
        "The Henyey-Greenstein function, one lobe: (1 - g^2) / (4 pi (1 + g^2 - 2 g cos)^1.5) (P03 eq. 2).";
        number("g", "", between(-1.0, 1.0), Is(0.8), "The mean cosine: above 0 forward, below 0 backward."),
    };

    pub(super) fn build(params: &Params<'_>) -> Result<Self> {
        Ok(Self::new(params.float("g")?))
    }

    /// 1 - cos as seen from the peak, for a uniform `u`: the inverse of the cumulative distribution, as
    /// a quotient of sums of positive terms.
    #[inline]
    fn invert(&self, u: f32) -> f32 {
        let Self { size: g, complement, .. } = *self;
        let ratio = complement / (complement + 2.0 * g * (1.0 - u));
        (2.0 * u * (1.0 + g * (1.0 - u)) * ratio * ratio).min(2.0)
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        [0.0, 1e-9, 5e-5, -5e-5, 0.3, -0.6, 0.8, 0.9, -0.99].map(Self::new).to_vec()
    }
}

impl PhaseModel for HenyeyGreenstein {
    #[inline]
    fn pdf_sr(&self, turn: Deflection) -> f32 {
        let Self { size: g, complement, sign } = *self;
        let squared = complement * complement + 2.0 * g * turn.from_peak(sign);
        warp::SPHERE_PDF * complement * (1.0 + g) / (squared * squared.sqrt())
    }

    #[inline]
    fn sample(&self, direction: Vec3, stream: &mut Stream) -> Vec3 {
        let u = stream.square();
        deflect(self.sign * direction, warp::near_pole(self.invert(u.x), TAU * u.y))
    }

    fn mean_cosine(&self) -> f32 {
        self.sign * self.size
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The cumulative distribution in d = 1 - cos, in f64.
    fn cumulative(g: f64, d: f64) -> f64 {
        let near = 1.0 - g;
        let s = (near * near + 2.0 * g * d).sqrt();
        // (1 - g^2) / (2 g) (1 / (1 - g) - 1 / s), the difference taken out.
        (1.0 + g) * d / (s * (s + near))
    }

    #[test]
    fn sampling_inverts_the_distribution_up_to_the_sharpest_peaks() {
        for g in [0.0, 1e-6, 1e-3, 0.5, 0.9, 0.99, 0.999, 0.999_99, 0.999_999_9] {
            let model = HenyeyGreenstein::new(g);
            for i in 0..=64 {
                let u = i as f32 / 64.0;
                let found = cumulative(g, f64::from(model.invert(u)));
                assert!((found - f64::from(u)).abs() < 1e-5, "g {g}, u {u}: {found}");
            }
        }
    }

    /// Where the third power of 1 - |g| leaves f32.
    #[test]
    fn no_g_makes_a_lobe_of_no_width() {
        for g in [1.0 - f64::EPSILON, -1.0 + f64::EPSILON / 2.0] {
            let model = HenyeyGreenstein::new(g);
            let pdf = |d| model.pdf_sr(Deflection::of(d, 1f32.copysign(g as f32)));
            assert!(pdf(0.0).is_finite() && pdf(0.0) > 1e20 && pdf(1.0) >= 0.0, "{model:?}");
            assert!([0.0, 0.5, 1.0].iter().all(|u| (0.0..=2.0).contains(&model.invert(*u))), "{model:?}");
        }
    }

    #[test]
    fn the_density_keeps_its_digits_at_the_peak() {
        for g in [0.9f64, 0.999, 0.999_999_9] {
            let exact = (1.0 + g) / (4.0 * std::f64::consts::PI * (1.0 - g) * (1.0 - g));
            for (g, sign) in [(g, 1.0), (-g, -1.0)] {
                let found = f64::from(HenyeyGreenstein::new(g).pdf_sr(Deflection::of(0.0, sign)));
                assert!((found / exact - 1.0).abs() < 1e-6, "g {g}: {found} for {exact}");
            }
        }
    }
}
