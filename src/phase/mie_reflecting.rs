//! Mie scattering by spheres far smaller than the wavelength that reflect all light, as metal does (P03T 2.3.4).

use super::{Deflection, PhaseModel, deflect};
use crate::description::{Params, Table, table};
use crate::error::Result;
use crate::math::{Vec3, cubic, warp};
use crate::sampling::Stream;
use std::f32::consts::TAU;

/// 3 ((1 - cos / 2)^2 + (cos - 1/2)^2) / (20 pi): most goes back. P03T has it of Languenou et al. 1994; the amplitudes
/// under the squares are van de Hulst's, of totally reflecting spheres (Light Scattering by Small Particles, 10.61).
#[derive(Clone, Copy, Debug)]
pub struct MieReflecting;

impl MieReflecting {
    pub(super) const TABLE: Table = table! {
    "Mie scattering by small spheres that reflect all light, most of it back: 3 ((1 - cos/2)^2 + (cos - 1/2)^2) / (20 pi) (Languenou et al. 1994, p. 13; P03T 2.3.4)."; };

    pub(super) fn build(_: &Params<'_>) -> Result<Self> {
        Ok(Self)
    }

    /// The cosine for a uniform `u`: the root of 5 c^3 - 12 c^2 + 15 c + 32 = 40 u, by c = y + 4/5.
    #[inline]
    fn invert(u: f32) -> f32 {
        let y = cubic::root(0.6, 4.0 * f64::from(u) - 3.888);
        (y + 0.8).clamp(-1.0, 1.0) as f32
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        vec![Self]
    }
}

impl PhaseModel for MieReflecting {
    #[inline]
    fn pdf_sr(&self, turn: Deflection) -> f32 {
        let cosine = turn.cosine();
        let (across, along) = (1.0 - 0.5 * cosine, cosine - 0.5);
        0.6 * warp::SPHERE_PDF * (across * across + along * along)
    }

    #[inline]
    fn sample(&self, direction: Vec3, stream: &mut Stream) -> Vec3 {
        let u = stream.square();
        deflect(direction, warp::spherical(Self::invert(u.x), TAU * u.y))
    }

    fn mean_cosine(&self) -> f32 {
        -0.4
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sampling_inverts_the_distribution_from_end_to_end() {
        for i in 0..=64 {
            let u = i as f32 / 64.0;
            let c = f64::from(MieReflecting::invert(u));
            let cumulative = (((5.0 * c - 12.0) * c + 15.0) * c + 32.0) / 40.0;
            assert!((cumulative - f64::from(u)).abs() < 1e-7, "{u}: {c}, {cumulative}");
        }
        assert_eq!([0.0, 1.0].map(MieReflecting::invert), [-1.0, 1.0]);
    }
}
