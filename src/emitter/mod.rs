//! Emitters: how much light leaves in which direction, and how directions are sampled. Where emission starts
//! on a shape, and which emitter is chosen, the scene decides.

mod constant;
mod directional;
mod point;
mod spot;

mod area;

pub use area::Area;
pub use constant::Constant;
pub use directional::Directional;
pub use point::Point;
pub use spot::Spot;

use crate::{
    description::{Library, Object, Params, Row, find_row},
    error::Result,
    math::{DVec3, Spectrum, SpectrumExt},
    medium,
};
use std::f32::consts::PI;

/// Any emitter.
#[derive(Clone, Debug)]
pub enum Emitter {
    /// A shape whose surface emits.
    Area(Area),
    /// A point that emits alike in all directions.
    Point(Point),
    /// A point that emits within a cone.
    Spot(Spot),
    /// Parallel light from infinity.
    Directional(Directional),
    /// The same radiance from everywhere at infinity.
    Constant(Constant),
}

/// Every kind of emitter.
pub const ROWS: &[Row<Emitter>] = &[
    Row { name: "area", build: |p| Area::build(p).map(Emitter::Area) },
    Row { name: "point", build: |p| Point::build(p).map(Emitter::Point) },
    Row { name: "spot", build: |p| Spot::build(p).map(Emitter::Spot) },
    Row { name: "directional", build: |p| Directional::build(p).map(Emitter::Directional) },
    Row { name: "constant", build: |p| Constant::build(p).map(Emitter::Constant) },
];

/// Builds the emitter that `object` describes; positions still stand in the file's coordinates. A medium among
/// its children (the one it stands in) is the scene's to read.
pub fn build(object: &Object, library: &Library) -> Result<Emitter> {
    let params = Params::new(object, library);
    let row = find_row(object, "emitter", ROWS)?;
    let emitter = (row.build)(&params)?;
    params.children(|child| medium::is_medium(child.object))?;
    params.finish()?;
    Ok(emitter)
}

/// True if `object` is an emitter.
pub fn is_emitter(object: &Object) -> bool {
    ROWS.iter().any(|row| row.name == object.plugin)
}

impl Emitter {
    /// True for emitters at infinity: their "position" is a direction and is measured in steradians.
    pub fn is_infinite(&self) -> bool {
        matches!(self, Self::Directional(_) | Self::Constant(_))
    }

    /// True if a walk can meet it by chance: it is neither a point nor a single direction.
    pub fn is_hittable(&self) -> bool {
        matches!(self, Self::Area(_) | Self::Constant(_))
    }

    /// The plugin name.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Area(_) => "area",
            Self::Point(_) => "point",
            Self::Spot(_) => "spot",
            Self::Directional(_) => "directional",
            Self::Constant(_) => "constant",
        }
    }

    /// Emitted power [W], luminance-weighted; `area` [m^2] of the emitting shape, `radius` [m] of the scene.
    pub fn power(&self, area: f32, radius: f32) -> f32 {
        let disk = PI * radius * radius;
        let power: Spectrum = match self {
            Self::Area(e) => e.radiance * (PI * area),
            Self::Point(e) => e.intensity * (4.0 * PI),
            Self::Spot(e) => e.power(),
            Self::Directional(e) => e.irradiance * disk,
            Self::Constant(e) => e.radiance * (4.0 * PI * disk),
        };
        power.luminance()
    }

    /// The user's factor on the probability of choosing this emitter.
    pub fn sampling_weight(&self) -> f32 {
        match self {
            Self::Area(e) => e.sampling_weight,
            Self::Point(e) => e.sampling_weight,
            Self::Spot(e) => e.sampling_weight,
            Self::Directional(e) => e.sampling_weight,
            Self::Constant(e) => e.sampling_weight,
        }
    }
}

/// Mitsuba's `sampling_weight`: a factor > 0 on the probability of choosing an emitter.
fn sampling_weight(params: &Params<'_>) -> Result<f32> {
    let weight = params.float("sampling_weight", 1.0)? as f32;
    if weight > 0.0 {
        return Ok(weight);
    }
    Err(params.complain("sampling_weight", "a number > 0", weight.to_string()))
}

/// The place and axis of an emitter that stands at a point, from `to_world` or `position`.
fn point_position(params: &Params<'_>) -> Result<DVec3> {
    match params.optional_vector("position")? {
        Some(_) if params.has("to_world") => {
            Err(params.complain("position", "position or to_world, not both", "both"))
        }
        Some(position) => Ok(position),
        None => Ok(params.transform("to_world")?.transform_point3(DVec3::ZERO)),
    }
}
