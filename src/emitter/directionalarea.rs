//! Emission along the normals of a shape only: Mitsuba's `directionalarea`.

use crate::{
    description::Params,
    error::Result,
    math::{DVec3, Spectrum, Vec2},
    texture::{self, Texture},
};

/// Every point sends light in the one direction of its normal. No camera subpath can hit that by chance and
/// no point can be connected to it: only light subpaths carry its light.
#[derive(Clone, Debug)]
pub struct DirectionalArea {
    exitance: Texture,
}

impl DirectionalArea {
    /// Reads `radiance`: so Mitsuba calls it, though by its unit it is an exitance.
    pub fn build(params: &Params<'_>) -> Result<Self> {
        Ok(Self { exitance: texture::emission(params, "radiance", 1.0)? })
    }

    /// Power per area at texture position `uv` [W/m^2].
    #[inline]
    pub fn exitance_at(&self, uv: Vec2) -> Spectrum {
        self.exitance.eval(uv)
    }

    /// Its mean [W/m^2].
    pub fn exitance(&self) -> DVec3 {
        self.exitance.mean().as_dvec3()
    }
}
