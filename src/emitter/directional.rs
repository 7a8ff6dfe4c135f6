//! Parallel light from infinity.

use super::{COMMON, InfiniteModel};
use crate::{
    description::{Params, Table, table},
    error::Result,
    math::{DVec3, Spectrum, Vec3},
    sampling::Stream,
};

/// A directional light.
#[derive(Clone, Debug)]
pub struct Directional {
    /// Unit direction in which the light travels.
    direction: Vec3,
    /// Irradiance on a surface facing the light (W/m^2).
    irradiance: Spectrum,
}

impl Directional {
    pub(super) const TABLE: Table = table! {
        "Parallel light from infinity: a sun.";
        vector("direction", "", Said("along +z of `to_world`"), "Direction in which the light travels."),
        transform("to_world", "In place of `direction`: light travels along its +z."),
        light("irradiance", "W/m^2", Is(1.0), "Irradiance on a surface that faces the light.");
        COMMON
    };

    pub(super) fn build(params: &Params<'_>) -> Result<Self> {
        let direction = match params.optional_vector("direction")? {
            Some(_) if params.has("to_world") => {
                return Err(params.complain("direction", "direction or to_world, not both", "both"));
            }
            Some(d) if d == DVec3::ZERO => {
                return Err(params.complain("direction", "a non-zero vector", "0, 0, 0"));
            }
            Some(direction) => direction,
            None => params.transform("to_world")?.transform_vector3(DVec3::Z),
        };
        Ok(Self { direction: unit(direction).as_vec3(), irradiance: params.color("irradiance")? })
    }
}

impl InfiniteModel for Directional {
    #[inline]
    fn radiance(&self, _: Vec3) -> Spectrum {
        self.irradiance
    }

    #[inline]
    fn sample(&self, _: &mut Stream) -> Vec3 {
        -self.direction
    }

    #[inline]
    fn pdf_sr(&self, _: Vec3) -> f32 {
        1.0
    }

    fn fluence(&self) -> DVec3 {
        self.irradiance.as_dvec3()
    }

    #[inline]
    fn direction(&self) -> Option<Vec3> {
        Some(-self.direction)
    }
}

/// `v` at length 1, however long it is.
fn unit(v: DVec3) -> DVec3 {
    (v / v.abs().max_element()).normalize()
}
