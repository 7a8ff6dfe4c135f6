//! A point that emits in all directions.

use super::{COMMON, PROFILE, PointModel, Profile};
use crate::{
    description::{Params, Table, table},
    error::Result,
    math::{DVec3, Frame, Spectrum, Vec3, warp},
    sampling::Stream,
};
use std::f32::consts::PI;

/// A point light: the same in all directions, or by a profile around an axis.
#[derive(Clone, Debug)]
pub struct Point {
    position: DVec3,
    /// Intensity on the axis (W/sr).
    intensity: Spectrum,
    /// Beyond Mitsuba: intensity relative to that by angle, and the axis, local +z.
    profile: Option<(Profile, Frame)>,
}

impl Point {
    pub(super) const TABLE: Table = table! {
        "A point light that emits in all directions.";
        vector("position", "m", Said("the origin of `to_world`"), "Position."),
        transform("to_world", "In place of `position`; its +z is the axis of `profile`."),
        light("intensity", "W/sr", Is(1.0), "Intensity.");
        PROFILE, COMMON
    };

    pub(super) fn build(params: &Params<'_>) -> Result<Self> {
        let to_world = params.transform("to_world")?;
        let position = match params.optional_vector("position")? {
            Some(_) if params.has("to_world") => {
                return Err(params.complain("position", "position or to_world, not both", "both"));
            }
            Some(position) => position,
            None => to_world.transform_point3(DVec3::ZERO),
        };
        let axis = Frame::around(to_world.transform_vector3(DVec3::Z).normalize().as_vec3());
        let profile = Profile::build(params)?.map(|profile| (profile, axis));
        Ok(Self { position, intensity: params.color("intensity")?, profile })
    }
}

impl PointModel for Point {
    fn position(&self) -> DVec3 {
        self.position
    }

    #[inline]
    fn intensity(&self, direction: Vec3) -> Spectrum {
        match &self.profile {
            None => self.intensity,
            Some((profile, axis)) => self.intensity * profile.value(axis.normal.dot(direction)),
        }
    }

    /// A direction: uniform, or by the profile.
    #[inline]
    fn sample(&self, stream: &mut Stream) -> Vec3 {
        match &self.profile {
            None => warp::to_sphere(stream.square()),
            Some((profile, axis)) => axis.to_world(profile.sample_around(stream)).normalize(),
        }
    }

    #[inline]
    fn pdf_sr(&self, direction: Vec3) -> f32 {
        match &self.profile {
            None => warp::SPHERE_PDF,
            Some((profile, axis)) => profile.pdf_sr_around(axis.normal.dot(direction)),
        }
    }

    fn power(&self) -> DVec3 {
        let around = self.profile.as_ref().map_or(4.0 * PI, |(profile, _)| profile.integral());
        self.intensity.as_dvec3() * f64::from(around)
    }
}
