//! A disk of parallel light: a laser, a searchlight, a collimator. Beyond Mitsuba.

use super::{BeamModel, COMMON};
use crate::{
    description::{Params, Table, table},
    error::Result,
    math::{DMat4, DVec3, Spectrum, Vec3, similarity},
};
use std::f64::consts::PI;

/// World radii from one to the other (m): within these, f32 holds the disk's area and 1 over it.
const RADII: [f64; 2] = [1e-15, 1e15];

/// A collimated beam. The disk itself is no surface: it is not seen, blocks nothing and bounds no medium.
#[derive(Clone, Debug)]
pub struct Collimated {
    centre: DVec3,
    /// Unit direction in which the light travels.
    direction: Vec3,
    /// Of the disk (m).
    radius: f32,
    /// Irradiance across the beam (W/m^2).
    irradiance: Spectrum,
}

impl Collimated {
    pub(super) const TABLE: Table = table! {
        "A disk of parallel light along +z, such as a laser or searchlight. The disk itself is invisible.";
        transform("to_world", "Places the disk, which lies in the xy plane around the origin; it must stay round."),
        number("radius", "m", above(0.0, RADII[1]), Is(1.0), "Radius of the disk, times the scale of `to_world`."),
        light("irradiance", "W/m^2", Is(1.0), "Irradiance on a surface that faces the light."),
        light("power", "W", Optional, "In place of `irradiance`: power of the whole beam.");
        COMMON
    };

    pub(super) fn build(params: &Params<'_>) -> Result<Self> {
        let to_world = params.transform("to_world")?;
        let Some(scale) = scale_across(to_world) else {
            let expected = "a transform that keeps a disk in the xy plane round";
            return Err(params.complain("to_world", expected, "one that does not"));
        };
        let radius = params.float("radius")? * scale;
        if !(RADII[0]..=RADII[1]).contains(&radius) {
            return Err(params.complain(
                "radius",
                "a radius from 1e-15 to 1e15 m in the world",
                radius.to_string(),
            ));
        }
        Ok(Self {
            centre: to_world.transform_point3(DVec3::ZERO),
            direction: to_world.transform_vector3(DVec3::Z).normalize().as_vec3(),
            radius: radius as f32,
            irradiance: irradiance(params, radius)?,
        })
    }
}

impl BeamModel for Collimated {
    fn centre(&self) -> DVec3 {
        self.centre
    }

    #[inline]
    fn direction(&self) -> Vec3 {
        self.direction
    }

    #[inline]
    fn radius(&self) -> f32 {
        self.radius
    }

    #[inline]
    fn irradiance(&self) -> Spectrum {
        self.irradiance
    }

    fn power(&self) -> DVec3 {
        self.irradiance.as_dvec3() * area(f64::from(self.radius))
    }
}

/// Stated as such, or as the `power` of the whole beam (W).
fn irradiance(params: &Params<'_>, radius: f64) -> Result<Spectrum> {
    let Some(power) = params.optional_color("power")? else {
        return params.color("irradiance");
    };
    if params.has("irradiance") {
        return Err(params.complain("power", "power or irradiance, not both", "both"));
    }
    let irradiance = (power.as_dvec3() / area(radius)).as_vec3();
    if irradiance.is_finite() {
        return Ok(irradiance);
    }
    let expected = "a power whose irradiance, over the area of the disk, is at most 3e38 W/m^2";
    Err(params.complain("power", expected, power.max_element().to_string()))
}

/// Of a disk (m^2).
fn area(radius: f64) -> f64 {
    PI * radius * radius
}

/// By what factor `transform` makes a disk in the xy plane larger; none where it does not stay round, or +z does not stay
/// perpendicular to it. How it scales along z makes no difference.
fn scale_across(transform: DMat4) -> Option<f64> {
    let along = transform.z_axis * (transform.x_axis.length() / transform.z_axis.length());
    similarity::scale_of(DMat4 { z_axis: along, ..transform })
}
