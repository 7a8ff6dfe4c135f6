//! A point that emits within a cone: constant inside the beam, falling linearly in the angle to its edge.

use super::{COMMON, PointModel};
use crate::{
    description::{Params, Table, table},
    error::Result,
    math::{DMat3, DMat4, DVec3, Frame, Mat3, Spectrum, Vec3, similarity, vec2, warp},
    sampling::Stream,
    texture::{self, Texture},
};
use std::f32::consts::TAU;

/// A spotlight.
#[derive(Clone, Debug)]
pub struct Spot {
    position: DVec3,
    /// Intensity on the axis (W/sr).
    intensity: Spectrum,
    axis: Frame,
    /// Half angle of the full cone (rad).
    cutoff: f32,
    /// Half angle within which the intensity is constant (rad).
    beam: f32,
    /// A factor that varies over the cone.
    slide: Option<Slide>,
}

/// A texture before the light: its unit square just holds the cone.
#[derive(Clone, Debug)]
struct Slide {
    texture: Texture,
    to_local: Mat3,
    /// Tangent of the cutoff angle.
    reach: f32,
}

impl Spot {
    pub(super) const TABLE: Table = table! {
        "A point light that emits within a cone around +z.";
        transform("to_world", "Position and direction; scales must be uniform."),
        light("intensity", "W/sr", Is(1.0), "Intensity on the axis."),
        number("cutoff_angle", "degrees", above(0.0, 180.0), Is(20.0), "Half angle of the cone."),
        number("beam_width", "degrees", within(0.0, 180.0), Said("three quarters of `cutoff_angle`"),
            "Half angle of full intensity; at most `cutoff_angle`."),
        texture("texture", f64::INFINITY, Optional, "Scales the intensity over the cone, which just fits into the texture's unit square.");
        COMMON
    };

    pub(super) fn build(params: &Params<'_>) -> Result<Self> {
        let to_world = params.transform("to_world")?;
        if similarity::scale_of(to_world).is_none() {
            let expected = "a transform that neither shears nor stretches";
            return Err(params.complain("to_world", expected, "one that does"));
        }
        let axis = to_world.transform_vector3(DVec3::Z).normalize().as_vec3();
        let cutoff = params.float("cutoff_angle")?;
        let beam = params.optional_float("beam_width")?.unwrap_or(cutoff * 0.75);
        if beam > cutoff {
            let expected = format!("an angle of at most cutoff_angle ({cutoff})");
            return Err(params.complain("beam_width", expected, beam.to_string()));
        }
        Ok(Self {
            position: to_world.transform_point3(DVec3::ZERO),
            intensity: params.color("intensity")?,
            axis: Frame::around(axis),
            cutoff: cutoff.to_radians() as f32,
            beam: beam.to_radians() as f32,
            slide: Slide::build(params, to_world, cutoff)?,
        })
    }

    fn falloff(&self, angle: f32) -> f32 {
        if angle <= self.beam {
            1.0
        } else if angle < self.cutoff {
            (self.cutoff - angle) / (self.cutoff - self.beam)
        } else {
            0.0
        }
    }

    /// 1 - cos of the half angle, without cancellation for narrow cones.
    fn one_minus_cos(&self) -> f32 {
        2.0 * (0.5 * self.cutoff).sin().powi(2)
    }
}

impl PointModel for Spot {
    fn position(&self) -> DVec3 {
        self.position
    }

    #[inline]
    fn intensity(&self, direction: Vec3) -> Spectrum {
        let falloff = self.falloff(angle(direction, self.axis.normal));
        match &self.slide {
            Some(slide) if falloff > 0.0 => self.intensity * slide.eval(direction) * falloff,
            _ => self.intensity * falloff,
        }
    }

    /// A direction, uniform in the cone.
    #[inline]
    fn sample(&self, stream: &mut Stream) -> Vec3 {
        self.axis.to_world(warp::to_cone(stream.square(), self.one_minus_cos()))
    }

    #[inline]
    fn pdf_sr(&self, direction: Vec3) -> f32 {
        if angle(direction, self.axis.normal) < self.cutoff {
            warp::cone_pdf(self.one_minus_cos())
        } else {
            0.0
        }
    }

    /// 2 pi times the integral of falloff(a) sin(a), in closed form; of a texture its mean counts.
    fn power(&self) -> DVec3 {
        let (beam, cutoff) = (f64::from(self.beam), f64::from(self.cutoff));
        let inner = 2.0 * (0.5 * beam).sin().powi(2);
        let ramp = if cutoff - beam < 1e-6 {
            0.0
        } else {
            beam.cos() - (cutoff.sin() - beam.sin()) / (cutoff - beam)
        };
        let mean = self.slide.as_ref().map_or(Spectrum::ONE, |slide| slide.texture.mean());
        self.intensity.as_dvec3() * mean.as_dvec3() * (f64::from(TAU) * (inner + ramp))
    }
}

impl Slide {
    fn build(params: &Params<'_>, to_world: DMat4, cutoff: f64) -> Result<Option<Self>> {
        if !params.has("texture") {
            return Ok(None);
        }
        let texture = texture::parameter(params, "texture")?;
        if cutoff >= 90.0 {
            let expected = "an angle below 90 where a texture fills the cone";
            return Err(params.complain("cutoff_angle", expected, cutoff.to_string()));
        }
        let to_local = DMat3::from_mat4(to_world).inverse().as_mat3();
        Ok(Some(Self { texture, to_local, reach: cutoff.to_radians().tan() as f32 }))
    }

    #[inline]
    fn eval(&self, direction: Vec3) -> Spectrum {
        let local = self.to_local * direction;
        let scale = 0.5 / (local.z * self.reach);
        self.texture.eval(vec2(0.5 + local.x * scale, 0.5 + local.y * scale))
    }
}

/// Angle between unit vectors, precise for small ones too (Kahan 2006).
fn angle(a: Vec3, b: Vec3) -> f32 {
    2.0 * (a - b).length().atan2((a + b).length())
}
