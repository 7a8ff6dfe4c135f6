//! Spheres much larger than the wavelength whose surface reflects diffusely (P03T eq. 2.17).

use super::{Deflection, PhaseModel, deflect};
use crate::description::{Params, Table, table};
use crate::error::Result;
use crate::math::{Vec3, warp};
use crate::sampling::Stream;
use std::f32::consts::PI;

/// 2 (sin theta - theta cos theta) / (3 pi^2): nothing straight on, most straight back, like the full moon.
///
/// P03T prints it twice. The first form has theta as the angle of deflection, and is this one; the second has
/// it from the direction back and a minus sign too many.
#[derive(Clone, Copy, Debug)]
pub struct DiffuseSphere;

impl DiffuseSphere {
    pub(super) const TABLE: Table = table! {
    "Spheres much larger than the wavelength that reflect diffusely: 2 (sin(theta) - theta cos) / (3 pi^2) (P03T eq. 2.17)."; };

    pub(super) fn build(_: &Params<'_>) -> Result<Self> {
        Ok(Self)
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        vec![Self]
    }
}

/// sin x - x cos x, by its series where the two cancel.
#[inline]
fn crescent(x: f32) -> f32 {
    if x > 0.4 {
        return x.sin() - x * x.cos();
    }
    let square = x * x;
    x * square / 3.0 * (1.0 - square / 10.0 * (1.0 - square / 28.0 * (1.0 - square / 54.0)))
}

impl PhaseModel for DiffuseSphere {
    #[inline]
    fn pdf_sr(&self, turn: Deflection) -> f32 {
        const SCALE: f32 = 2.0 / (3.0 * PI * PI);
        SCALE * crescent(turn.angle())
    }

    /// What happens: a ray hits the sphere somewhere, the normal there being distributed by cosine around the
    /// direction back, and leaves by cosine around that normal.
    #[inline]
    fn sample(&self, direction: Vec3, stream: &mut Stream) -> Vec3 {
        let normal = deflect(-direction, warp::to_cosine_hemisphere(stream.square()));
        deflect(normal, warp::to_cosine_hemisphere(stream.square()))
    }

    fn mean_cosine(&self) -> f32 {
        -4.0 / 9.0
    }
}
