//! The same radiance from all directions at infinity.

use super::{COMMON, InfiniteModel};
use crate::{
    description::{Params, Table, table},
    error::Result,
    math::{DVec3, Spectrum, Vec3, warp},
    sampling::Stream,
};
use std::f32::consts::PI;

/// A constant environment.
#[derive(Clone, Debug)]
pub struct Constant {
    /// Radiance (W/(m^2 sr)).
    radiance: Spectrum,
}

impl Constant {
    pub(super) const TABLE: Table = table! {
        "A sky of constant radiance.";
        light("radiance", "W/(m^2 sr)", Is(1.0), "Radiance.");
        COMMON
    };

    pub(super) fn build(params: &Params<'_>) -> Result<Self> {
        Ok(Self { radiance: params.color("radiance")? })
    }
}

impl InfiniteModel for Constant {
    #[inline]
    fn radiance(&self, _: Vec3) -> Spectrum {
        self.radiance
    }

    #[inline]
    fn sample(&self, stream: &mut Stream) -> Vec3 {
        warp::to_sphere(stream.square())
    }

    #[inline]
    fn pdf_sr(&self, _: Vec3) -> f32 {
        warp::SPHERE_PDF
    }

    fn fluence(&self) -> DVec3 {
        self.radiance.as_dvec3() * f64::from(4.0 * PI)
    }

    fn even_radiance(&self) -> Option<Spectrum> {
        Some(self.radiance)
    }
}
