//! Normals from an image: Mitsuba's `normalmap`.

use super::perturbed::{Normals, PERTURBED, Perturbed};
use crate::description::{Params, Table, table};
use crate::error::Result;
use crate::math::{Spectrum, Uv, Vec3};
use crate::texture::{self, Texture};

/// A surface with the normals of an image.
pub type NormalMap = Perturbed<Map>;

/// The image: in its channels the components of the normal in the shading frame, from -1 as 0 to 1 as 1.
#[derive(Clone, Debug)]
pub struct Map(Texture);

impl NormalMap {
    pub(super) const TABLE: Table = table! {
        "A surface with the normals of an image.";
        texture("normalmap", f64::INFINITY, Required, "The normals: (0.5, 0.5, 1) is the surface's own. Give the image `raw` = true.");
        PERTURBED
    };

    pub(super) fn build(params: &Params<'_>) -> Result<Self> {
        Self::build_around(params, Map(texture::parameter(params, "normalmap")?))
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        use super::{Conductor, Dielectric, Diffuse, RoughDielectric, TwoSided};
        let tilted = |x: f32, y: f32| {
            let normal = Vec3::new(x, y, 1.0).normalize();
            Map(Texture::constant((normal + Vec3::ONE) * 0.5))
        };
        let matt = TwoSided::new(Diffuse::grey(0.8).into(), Diffuse::grey(0.5).into());
        vec![
            Self::example(tilted(0.3, -0.2), Diffuse::grey(0.8).into(), true, true),
            Self::example(tilted(0.8, 0.5), matt.into(), true, true),
            Self::example(tilted(0.4, 0.2), RoughDielectric::examples().swap_remove(0).into(), true, false),
            Self::example(tilted(-0.5, 0.1), Diffuse::grey(0.8).into(), false, true),
            Self::example(tilted(0.3, 0.1), Conductor::examples().swap_remove(1).into(), true, true),
            Self::example(tilted(0.2, -0.3), Dielectric::examples().swap_remove(0).into(), false, false),
        ]
    }
}

impl Normals for Map {
    #[inline]
    fn normal(&self, uv: Uv) -> Vec3 {
        self.0.eval(uv) * 2.0 - Spectrum::ONE
    }
}
