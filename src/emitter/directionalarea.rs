//! Emission along the normals of a shape only: Mitsuba's `directionalarea`.

use super::{COMMON, SurfaceEmission, SurfaceModel};
use crate::{
    description::{Params, Table, table},
    error::Result,
    math::{DVec3, Spectrum, Uv},
    sampling::Stream,
    shape::SurfacePoint,
    texture::{self, Texture},
};

/// Every point sends light in the one direction of its normal. No camera subpath can hit that by chance and
/// no point can be connected to it: only light subpaths carry its light.
#[derive(Clone, Debug)]
pub struct DirectionalArea {
    exitance: Texture,
}

impl DirectionalArea {
    pub(super) const TABLE: Table = table! {
        "Emission along the normals of a shape only: parallel light from a flat one.";
        light_texture("radiance", "W/m^2", Is(1.0), "Power per area; called radiance by Mitsuba.");
        COMMON
    };

    pub(super) fn build(params: &Params<'_>) -> Result<Self> {
        Ok(Self { exitance: texture::parameter(params, "radiance")? })
    }
}

impl SurfaceModel for DirectionalArea {
    #[inline]
    fn radiance(&self, _: Uv, _: f32) -> Spectrum {
        Spectrum::ZERO
    }

    #[inline]
    fn pdf_sr(&self, _: f32) -> f32 {
        0.0
    }

    #[inline]
    fn sample(&self, point: &SurfacePoint, pdf_area: f32, _: &mut Stream) -> SurfaceEmission {
        let throughput = self.exitance.eval(point.uv) / pdf_area;
        SurfaceEmission { direction: point.shading.normal, cosine: 1.0, pdf_sr: 1.0, throughput }
    }

    #[inline]
    fn is_dirac(&self) -> bool {
        true
    }

    fn exitance(&self) -> DVec3 {
        self.exitance.mean().as_dvec3()
    }
}
