//! Sensors: camera subpaths start there, light subpaths connect there. Camera space: +z forwards, +y
//! up, +x to the image's left, as in Mitsuba. Film positions are in pixels, (0, 0) the top left corner of the
//! image.
//!
//! A camera subpath starts by a film position and a point of the aperture, both sampled with densities that do not
//! depend on the path; a connection with the sensor samples the aperture in the same way and finds the film
//! position. What remains of either is one density: of directions per film area of a pixel, or, for parallel
//! rays, of positions.

mod batch;
mod irradiance;
mod lens;
mod meter;
mod orthographic;
mod perspective;
#[cfg(test)]
mod tests;
mod thinlens;

pub use batch::{BATCH, BATCH_TABLE};
use irradiance::Irradiance;
use lens::LENS;
pub(crate) use lens::{FIELD_OF_VIEW, half_width};
use meter::Meter;
pub use orthographic::Orthographic;
pub use perspective::Perspective;
pub use thinlens::ThinLens;

use crate::{
    description::{Library, Location, Object, Params, Plugin, Registry, Table, parameter::Parameter, rows},
    error::Result,
    math::{DVec3, Vec2, Vec3},
    sampling::Stream,
    shape::{self, Ray, Shape},
};
use std::{collections::HashMap, f32::consts::PI};

/// Any sensor.
#[derive(Clone, Debug)]
pub enum Sensor {
    /// A pinhole.
    Perspective(Perspective),
    /// A lens of some radius, with depth of field.
    ThinLens(ThinLens),
    /// Parallel rays.
    Orthographic(Orthographic),
    /// Parallel rays of which one number is measured.
    Meter(Meter),
    /// A shape, on which all light counts.
    Irradiance(Box<Irradiance>),
}

/// The image that a sensor makes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crop {
    /// Width and height of the whole film (pixels).
    pub film: [u32; 2],
    /// The top left corner of the part of it that is the image (pixels).
    pub offset: [u32; 2],
}

/// The first ray of a camera subpath.
#[derive(Clone, Copy, Debug)]
pub struct SensorRay {
    /// The point of the sensor.
    pub position: Vec3,
    /// From the near to the far clip distance.
    pub ray: Ray,
    /// Density of the direction per film area of a pixel (pixels/sr); of parallel rays that of their positions
    /// (pixels/m^2).
    pub pdf: f32,
}

/// A point as a sensor sees it.
#[derive(Clone, Copy, Debug)]
pub struct Projection {
    /// Where on the film (pixels); may lie outside the image.
    pub film: Vec2,
    /// The ray that sees it, from the near clip distance on; it ends at the far one, not at the point.
    pub ray: Ray,
    /// 1 over this turns a density per solid angle at the sensor into one per area across the ray at the point
    /// (m^2); 1 for points at infinity and for parallel rays.
    pub distance_squared: f32,
    /// As in [`SensorRay::pdf`].
    pub pdf: f32,
}

/// What a sensor is built in.
#[derive(Clone, Copy)]
pub struct Site<'a> {
    /// The point of the file's coordinates that becomes the origin (m).
    pub recentre: DVec3,
    /// The image that it is to make.
    pub crop: Crop,
    /// All shapes of the scene,
    pub shapes: &'a [Shape],
    /// and the number of each by where it is described, unless it is in a group.
    pub places: &'a HashMap<Location, usize>,
}

/// Reads the parameters of one kind of sensor (film, sampler and medium remain for the scene to read, which calls
/// `finish`).
pub type BuildSensor = fn(&Params<'_>, &Site<'_>) -> Result<Sensor>;

/// All sensors: Mitsuba's plugin name and the builder.
pub const ROWS: Registry<Plugin<BuildSensor>> = Registry::new(
    "a sensor",
    &[
        (
            "perspective",
            plugin(Perspective::TABLE, |p, site| {
                Perspective::build(p, site.recentre, site.crop).map(Sensor::Perspective)
            }),
        ),
        (
            "thinlens",
            plugin(ThinLens::TABLE, |p, site| {
                ThinLens::build(p, site.recentre, site.crop).map(Sensor::ThinLens)
            }),
        ),
        (
            "orthographic",
            plugin(Orthographic::TABLE, |p, site| {
                Orthographic::build(p, site.recentre, site.crop).map(Sensor::Orthographic)
            }),
        ),
        (
            "radiancemeter",
            plugin(meter::RADIANCEMETER, |p, site| meter::radiancemeter(p, site).map(Sensor::Meter)),
        ),
        ("distant", plugin(meter::DISTANT, |p, site| meter::distant(p, site).map(Sensor::Meter))),
        (
            ON_SHAPE,
            plugin(Irradiance::TABLE, |p, site| {
                Irradiance::build(p, site).map(|sensor| Sensor::Irradiance(Box::new(sensor)))
            }),
        ),
    ],
);

const fn plugin(table: Table, build: BuildSensor) -> Plugin<BuildSensor> {
    Plugin { table, build }
}

/// What cameras have.
const CLIP: &[Parameter] = rows! {
    number("near_clip", "m", within(0.0, MAX), Is(1e-2), "Nothing nearer than this along the axis is seen, fog included."),
    number("far_clip", "m", above(0.0, MAX), Is(1e4), "Nothing farther than this along the axis is seen; above `near_clip`."),
};

/// What all sensors have.
const ALL: &[Parameter] = rows! {
    nested("film", Optional, "The image; default: an `hdrfilm`."),
    nested("sampler", Optional, "The number of samples per pixel."),
    nested("medium", Optional, "The medium around the camera; default: found from the boundaries."),
    number(SHUTTER[0], "s", ANY, Is(0.0), "When the shutter opens, after the scene's `time`."),
    number(SHUTTER[1], "s", ANY, Said("0, or `shutter_open` if that is later"), "When it closes. What moves in between is blurred."),
};

/// The two ends of the time for which the shutter is open.
pub const SHUTTER: [&str; 2] = ["shutter_open", "shutter_close"];

/// The sensor's position in the file's coordinates; of one on a shape, that of the shape; of a distant one, its target.
pub fn viewpoint(object: &Object, library: &Library) -> Result<DVec3> {
    let (params, _) = ROWS.read(object, library)?;
    let given = match object.plugin.as_str() {
        "radiancemeter" => params.optional_vector("origin")?,
        "distant" => meter::target(&params)?,
        ON_SHAPE => {
            let shape = params.child("shape")?.map(|child| place_of(child.object, library));
            Some(shape.transpose()?.flatten().unwrap_or(DVec3::ZERO))
        }
        _ => None,
    };
    let place = || Ok(params.transform("to_world")?.transform_point3(DVec3::ZERO));
    given.map_or_else(place, Ok)
}

/// Where `shape` stands in the file's coordinates; none of what is composed.
fn place_of(shape: &Object, library: &Library) -> Result<Option<DVec3>> {
    if !shape::ROWS.has(shape) {
        return Ok(None);
    }
    let (params, _) = shape::ROWS.read(shape, library)?;
    Ok(Some(params.transform("to_world")?.transform_point3(DVec3::ZERO)))
}

/// The plugin of the sensor that goes inside a shape.
pub const ON_SHAPE: &str = "irradiancemeter";

/// True of a plugin whose film has one pixel.
pub fn is_meter(plugin: &str) -> bool {
    [ON_SHAPE, "radiancemeter", "distant"].contains(&plugin)
}

impl Sensor {
    /// A point of the aperture for one walk or connection, uniform by area, in the lens's own axes (m).
    #[inline(always)]
    pub fn sample_aperture(&self, stream: &mut Stream) -> Vec2 {
        match self {
            Self::ThinLens(lens) => lens.sample_aperture(stream),
            Self::Perspective(_) | Self::Orthographic(_) | Self::Meter(_) => Vec2::ZERO,
            Self::Irradiance(_) => Irradiance::sample_aperture(stream),
        }
    }

    /// The ray through a film position and a point of the aperture.
    #[inline(always)]
    pub fn ray(&self, film: Vec2, aperture: Vec2) -> SensorRay {
        match self {
            Self::Perspective(sensor) => sensor.ray(film),
            Self::ThinLens(sensor) => sensor.ray(film, aperture),
            Self::Orthographic(sensor) => sensor.ray(film),
            Self::Meter(sensor) => sensor.ray(film),
            Self::Irradiance(sensor) => sensor.ray(film, aperture),
        }
    }

    /// How `point` is seen through a point of the aperture; none where it lies outside the clip distances.
    #[inline(always)]
    pub fn project(&self, point: Vec3, aperture: Vec2) -> Option<Projection> {
        match self {
            Self::Perspective(sensor) => sensor.project(point),
            Self::ThinLens(sensor) => sensor.project(point, aperture),
            Self::Orthographic(sensor) => sensor.project(point),
            Self::Meter(sensor) => sensor.project(point),
            Self::Irradiance(sensor) => sensor.project(point, aperture),
        }
    }

    /// How the point at infinity in unit `direction` is seen; none where it is not, or in one single direction.
    #[inline(always)]
    pub fn project_direction(&self, direction: Vec3, aperture: Vec2) -> Option<Projection> {
        match self {
            Self::Perspective(sensor) => sensor.project_direction(direction),
            Self::ThinLens(sensor) => sensor.project_direction(direction, aperture),
            Self::Orthographic(_) | Self::Meter(_) => None,
            Self::Irradiance(sensor) => sensor.project_direction(direction, aperture),
        }
    }

    /// True where all rays are parallel: the sensor acts as a point at infinity.
    #[inline(always)]
    pub fn is_parallel(&self) -> bool {
        matches!(self, Self::Orthographic(_) | Self::Meter(_))
    }

    /// True if light subpaths can be connected to it.
    #[inline(always)]
    pub fn is_connectible(&self) -> bool {
        if let Self::Meter(sensor) = self { sensor.is_connectible() } else { true }
    }

    /// Its response to a uniform radiance of 1: of irradiance pi.
    #[inline(always)]
    pub fn response(&self) -> f32 {
        if let Self::Irradiance(_) = self { PI } else { 1.0 }
    }

    /// The number of the shape that it is on.
    pub fn shape(&self) -> Option<u32> {
        if let Self::Irradiance(sensor) = self { Some(sensor.index as u32) } else { None }
    }

    /// Takes the shape that it is on as it now is among those of the scene.
    pub fn settle(&mut self, shapes: &[Shape]) {
        if let Self::Irradiance(sensor) = self {
            sensor.settle(shapes);
        }
    }

    /// The centre of the aperture.
    pub fn position(&self) -> Vec3 {
        match self {
            Self::Perspective(sensor) => sensor.position(),
            Self::ThinLens(sensor) => sensor.position(),
            Self::Orthographic(sensor) => sensor.position(),
            Self::Meter(sensor) => sensor.position(),
            Self::Irradiance(sensor) => sensor.position(),
        }
    }

    /// The plugin name.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Perspective(_) => "perspective",
            Self::ThinLens(_) => "thinlens",
            Self::Orthographic(_) => "orthographic",
            Self::Meter(sensor) => sensor.name,
            Self::Irradiance(_) => ON_SHAPE,
        }
    }
}

/// Distances along the axis between which things are seen (m): 0 <= near < far.
#[derive(Clone, Copy, Debug)]
struct Clip {
    near: f32,
    far: f32,
}

impl Clip {
    fn build(params: &Params<'_>) -> Result<Self> {
        let near = params.float("near_clip")?;
        let far = params.float("far_clip")?;
        if far <= near {
            return Err(params.complain(
                "far_clip",
                format!("a distance above near_clip ({near})"),
                far.to_string(),
            ));
        }
        Ok(Self { near: near as f32, far: far as f32 })
    }

    /// The part between the clip distances of the ray from `position` in unit `direction`, `cosine` > 0 to the
    /// axis.
    #[inline(always)]
    fn ray(&self, position: Vec3, direction: Vec3, cosine: f32) -> Ray {
        let origin = position + direction * (self.near / cosine);
        Ray { origin, direction, t_max: (self.far - self.near) / cosine }
    }

    #[inline(always)]
    fn holds(&self, depth: f32) -> bool {
        depth > self.near && depth < self.far
    }
}
