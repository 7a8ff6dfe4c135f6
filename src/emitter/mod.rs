//! Emitters: how much light leaves in which direction, and how directions are sampled. The scene decides
//! where emission starts on a shape, and which emitter is chosen.

mod area;
mod constant;
mod directional;
mod directionalarea;
mod envmap;
mod point;
mod profile;
mod projector;
mod spot;
#[cfg(test)]
mod tests;
mod volume;

pub use area::Area;
pub use constant::Constant;
pub use directional::Directional;
pub use directionalarea::DirectionalArea;
pub use envmap::EnvMap;
pub use point::Point;
pub use profile::Profile;
pub use projector::Projector;
pub use spot::Spot;
pub use volume::VolumeEmitter;

use crate::{
    description::{Build, Library, Object, Params, Registry},
    error::Result,
    math::{DVec3, Spectrum, Vec3, spectrum::LUMINANCE},
    medium,
    sampling::Stream,
};
use std::f32::consts::PI;

/// An emitter.
#[derive(Clone, Debug)]
pub struct Emitter {
    /// The plugin name.
    pub name: &'static str,
    /// How it emits.
    pub kind: Kind,
    /// The factor from the user on the probability of choosing this emitter.
    pub sampling_weight: f32,
}

/// The ways to emit.
#[derive(Clone, Debug)]
pub enum Kind {
    /// A shape whose surface emits.
    Area(Area),
    /// A shape that emits along its normal only.
    DirectionalArea(DirectionalArea),
    /// A point.
    Point(PointKind),
    /// Parallel light from infinity.
    Directional(Directional),
    /// Light from all around at infinity.
    Environment(Environment),
    /// An emissive medium. Its description is the medium's own.
    Medium(VolumeEmitter),
}

/// Emitters at a point.
#[derive(Clone, Debug)]
pub enum PointKind {
    /// All around.
    Point(Point),
    /// Within a cone.
    Spot(Spot),
    /// An image.
    Projector(Projector),
}

/// Emitters that surround the scene.
#[derive(Clone, Debug)]
pub enum Environment {
    /// The same radiance from everywhere.
    Constant(Constant),
    /// An image of the surroundings.
    EnvMap(EnvMap),
}

/// Every kind of emitter.
pub const ROWS: Registry<Build<Kind>> = Registry::new(
    "an emitter",
    &[
        ("area", |p| Area::build(p).map(Kind::Area)),
        ("directionalarea", |p| DirectionalArea::build(p).map(Kind::DirectionalArea)),
        ("point", |p| Point::build(p).map(PointKind::Point).map(Kind::Point)),
        ("spot", |p| Spot::build(p).map(PointKind::Spot).map(Kind::Point)),
        ("projector", |p| Projector::build(p).map(PointKind::Projector).map(Kind::Point)),
        ("directional", |p| Directional::build(p).map(Kind::Directional)),
        ("constant", |p| Constant::build(p).map(Environment::Constant).map(Kind::Environment)),
        ("envmap", |p| EnvMap::build(p).map(Environment::EnvMap).map(Kind::Environment)),
    ],
);

/// Builds the emitter that `object` describes; positions are still in the file's coordinates. A medium among
/// its children (the one it is in) is read by the scene.
pub fn build(object: &Object, library: &Library) -> Result<Emitter> {
    let params = Params::new(object, library);
    let (name, build) = ROWS.row(object)?;
    let kind = build(&params)?;
    let sampling_weight = sampling_weight(&params)?;
    params.children(|child| medium::ROWS.has(child.object))?;
    params.finish()?;
    Ok(Emitter { name, kind, sampling_weight })
}

impl Emitter {
    /// An emissive medium.
    pub fn of_medium(volume: VolumeEmitter) -> Self {
        Self { name: "medium", kind: Kind::Medium(volume), sampling_weight: 1.0 }
    }

    /// True for emitters that lie on a shape.
    pub fn needs_shape(&self) -> bool {
        matches!(self.kind, Kind::Area(_) | Kind::DirectionalArea(_))
    }

    /// True for emitters at infinity: their "position" is a direction and is measured in steradians.
    pub fn is_infinite(&self) -> bool {
        matches!(self.kind, Kind::Directional(_) | Kind::Environment(_))
    }

    /// True if a walk can hit it by chance: it is neither a point nor a single direction.
    pub fn is_hittable(&self) -> bool {
        matches!(self.kind, Kind::Area(_) | Kind::Environment(_) | Kind::Medium(_))
    }

    /// True if next-event estimation can find it: it emits towards more than a single direction at each point.
    pub fn is_connectible(&self) -> bool {
        !matches!(self.kind, Kind::DirectionalArea(_))
    }

    /// True for what surrounds the scene.
    pub fn is_environment(&self) -> bool {
        matches!(self.kind, Kind::Environment(_))
    }

    /// Emitted power [W], luminance-weighted; `area` [m^2] of the emitting shape, `radius` [m] of the scene.
    /// For textured shapes an estimate from the mean of the texture.
    pub fn power(&self, area: f32, radius: f32) -> f64 {
        let disk = f64::from(PI) * f64::from(radius).powi(2);
        let power = match &self.kind {
            Kind::Area(e) => e.exitance() * f64::from(area),
            Kind::DirectionalArea(e) => e.exitance() * f64::from(area),
            Kind::Point(e) => e.power(),
            Kind::Directional(e) => e.irradiance.as_dvec3() * disk,
            Kind::Environment(e) => e.fluence() * disk,
            Kind::Medium(e) => e.power(),
        };
        power.dot(LUMINANCE.as_dvec3())
    }

    /// Its position in the file's coordinates: emitters at a point only.
    pub fn position(&self) -> Option<DVec3> {
        match &self.kind {
            Kind::Point(PointKind::Point(e)) => Some(e.position),
            Kind::Point(PointKind::Spot(e)) => Some(e.position),
            Kind::Point(PointKind::Projector(e)) => Some(e.position),
            _ => None,
        }
    }
}

impl Emitter {
    /// The unit direction in which its light travels, where there is only one.
    pub fn direction(&self) -> Option<Vec3> {
        if let Kind::Directional(sun) = &self.kind { Some(sun.direction) } else { None }
    }
}

impl PointKind {
    /// Intensity towards unit `direction` [W/sr].
    #[inline]
    pub fn intensity(&self, direction: Vec3) -> Spectrum {
        match self {
            Self::Point(e) => e.intensity(direction),
            Self::Spot(e) => e.intensity(direction),
            Self::Projector(e) => e.intensity(direction),
        }
    }

    /// A direction for light to leave in; 0 where there is none.
    #[inline]
    pub fn sample(&self, stream: &mut Stream) -> Vec3 {
        match self {
            Self::Point(e) => e.sample(stream),
            Self::Spot(e) => e.sample(stream),
            Self::Projector(e) => e.sample(stream),
        }
    }

    /// Density of `sample` [1/sr].
    #[inline]
    pub fn pdf_sr(&self, direction: Vec3) -> f32 {
        match self {
            Self::Point(e) => e.pdf_sr(direction),
            Self::Spot(e) => e.pdf_sr(direction),
            Self::Projector(e) => e.pdf_sr(direction),
        }
    }

    /// Emitted power [W].
    pub fn power(&self) -> DVec3 {
        match self {
            Self::Point(e) => e.power(),
            Self::Spot(e) => e.power(),
            Self::Projector(e) => e.power(),
        }
    }
}

impl Environment {
    /// Radiance from the unit direction `towards` [W/(m^2 sr)].
    #[inline]
    pub fn radiance(&self, towards: Vec3) -> Spectrum {
        match self {
            Self::Constant(e) => e.radiance,
            Self::EnvMap(e) => e.radiance(towards),
        }
    }

    /// A unit direction for light to come from.
    #[inline]
    pub fn sample(&self, stream: &mut Stream) -> Vec3 {
        match self {
            Self::Constant(e) => e.sample(stream),
            Self::EnvMap(e) => e.sample(stream),
        }
    }

    /// Density of `sample` [1/sr].
    #[inline]
    pub fn pdf_sr(&self, towards: Vec3) -> f32 {
        match self {
            Self::Constant(e) => e.pdf_sr(),
            Self::EnvMap(e) => e.pdf_sr(towards),
        }
    }

    /// The integral of radiance over all directions [W/m^2].
    pub fn fluence(&self) -> DVec3 {
        match self {
            Self::Constant(e) => e.radiance.as_dvec3() * f64::from(4.0 * PI),
            Self::EnvMap(e) => e.fluence(),
        }
    }
}

/// Mitsuba's `sampling_weight`: a factor > 0 on the probability of choosing an emitter.
fn sampling_weight(params: &Params<'_>) -> Result<f32> {
    let weight = params.float("sampling_weight", 1.0)?;
    // Within these bounds, f32 holds it and its products.
    if (1e-20..=1e20).contains(&weight) {
        return Ok(weight as f32);
    }
    Err(params.complain("sampling_weight", "a number from 1e-20 to 1e20", weight.to_string()))
}
