//! Emission from the side of a shape that its normal points to.

use super::{COMMON, PROFILE, Profile, SurfaceEmission, SurfaceModel};
use crate::{
    description::{Params, Table, table},
    error::Result,
    math::{DVec3, Frame, Spectrum, Uv, Vec3, warp},
    sampling::Stream,
    shape::SurfacePoint,
    texture::{self, Texture},
};
use std::f32::consts::PI;

/// Emits `radiance`, which may vary over the surface and, by a profile, with the angle to the normal.
#[derive(Clone, Debug)]
pub struct Area {
    /// Radiance along the normal (W/(m^2 sr)).
    radiance: Texture,
    /// Beyond Mitsuba: radiance relative to that, by angle.
    profile: Option<Profile>,
}

impl Area {
    pub(super) const TABLE: Table = table! {
        "Diffuse emission from the front of a shape.";
        light_texture("radiance", "W/(m^2 sr)", Is(1.0), "Radiance.");
        PROFILE, COMMON
    };

    pub(super) fn build(params: &Params<'_>) -> Result<Self> {
        let profile = Profile::build(params)?;
        Ok(Self { radiance: texture::parameter(params, "radiance")?, profile })
    }

    /// A direction in the frame of the normal, cosine-weighted.
    #[inline]
    pub(super) fn sample_local(&self, stream: &mut Stream) -> Vec3 {
        match &self.profile {
            None => warp::to_cosine_hemisphere(stream.square()),
            Some(profile) => profile.sample_from_surface(stream),
        }
    }
}

impl SurfaceModel for Area {
    #[inline]
    fn radiance(&self, uv: Uv, cosine: f32) -> Spectrum {
        match &self.profile {
            _ if cosine <= 0.0 => Spectrum::ZERO,
            None => self.radiance.eval(uv),
            Some(profile) => self.radiance.eval(uv) * profile.value(cosine),
        }
    }

    #[inline]
    fn pdf_sr(&self, cosine: f32) -> f32 {
        match &self.profile {
            None => warp::cosine_hemisphere_pdf(cosine),
            Some(profile) => profile.pdf_sr_from_surface(cosine),
        }
    }

    #[inline]
    fn sample(&self, point: &SurfacePoint, pdf_area: f32, stream: &mut Stream) -> SurfaceEmission {
        let front = point.front();
        let direction = Frame::around(front).to_world(self.sample_local(stream)).normalize();
        let cosine = front.dot(direction);
        let pdf_sr = self.pdf_sr(cosine);
        let throughput = self.radiance(point.uv, cosine) * (cosine / (pdf_area * pdf_sr));
        SurfaceEmission { direction, cosine, pdf_sr, throughput }
    }

    fn exitance(&self) -> DVec3 {
        let leaving = self.profile.as_ref().map_or(PI, Profile::projected_integral);
        self.radiance.mean().as_dvec3() * f64::from(leaving)
    }
}
