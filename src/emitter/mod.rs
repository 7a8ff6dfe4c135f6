//! Emitters: one file a model; this page is the contract and the registry. Models say how much light leaves in which
//! direction, and sample directions. The scene decides where emission starts on a shape, and which emitter is chosen.

mod area;
mod collimated;
mod constant;
mod directional;
mod directionalarea;
mod envmap;
mod point;
mod profile;
mod projector;
mod spot;
mod sunsky;
#[cfg(test)]
mod tests;
mod volume;

use area::Area;
use collimated::Collimated;
use constant::Constant;
use directional::Directional;
use directionalarea::DirectionalArea;
use envmap::EnvMap;
use point::Point;
use profile::{PROFILE, Profile};
use projector::Projector;
use spot::Spot;
use sunsky::SunSky;
pub use volume::VolumeEmitter;

use crate::{
    description::{Build, Library, Object, Params, Plugin, Registry, models, parameter::Parameter, rows},
    error::Result,
    math::{DVec3, Spectrum, Uv, Vec3, spectrum::LUMINANCE},
    medium,
    sampling::Stream,
    shape::SurfacePoint,
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
    /// What images of groups show it in; none for the group of the rest.
    pub group: Option<String>,
}

/// The ways to emit, by where light starts: each has a measure of its own for the density of that.
#[derive(Clone, Debug)]
pub enum Kind {
    /// A shape (1/m^2).
    Surface(SurfaceEmitter),
    /// A point.
    Point(PointEmitter),
    /// Infinity (1/sr).
    Infinite(InfiniteEmitter),
    /// A disk that parallel rays leave: a point of it is as the single direction of an emitter at infinity.
    Beam(BeamEmitter),
    /// An emissive medium (1/m^3). Its description is the medium's own.
    Medium(VolumeEmitter),
}

/// What every emitter on a shape can do.
pub trait SurfaceModel {
    /// Radiance that leaves texture position `uv` at `cosine` to the normal of the side that emits (W/(m^2 sr)): none
    /// behind. Of a Dirac emitter 0.
    fn radiance(&self, uv: Uv, cosine: f32) -> Spectrum;

    /// Density of [`Self::sample`] (1/sr). Of a Dirac emitter 0.
    fn pdf_sr(&self, cosine: f32) -> f32;

    /// A direction for light to leave `point` in, which was sampled with density `pdf_area` (1/m^2).
    fn sample(&self, point: &SurfacePoint, pdf_area: f32, stream: &mut Stream) -> SurfaceEmission;

    /// Emitted power per area (W/m^2); for textured shapes an estimate from the mean of the texture.
    fn exitance(&self) -> DVec3;

    /// True if each point emits in a single direction: no camera subpath hits that by chance, and no point can be
    /// connected to it.
    fn is_dirac(&self) -> bool {
        false
    }
}

/// Light that leaves a point of a shape.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceEmission {
    /// Where it goes, a unit vector.
    pub direction: Vec3,
    /// |cos| to the normal; 1 of a Dirac emitter.
    pub cosine: f32,
    /// Density of the direction (1/sr); 1 of a Dirac emitter.
    pub pdf_sr: f32,
    /// Radiance x cosine over the densities of direction and point.
    pub throughput: Spectrum,
}

/// What every emitter at a point can do.
pub trait PointModel {
    /// Its position in the file's coordinates.
    fn position(&self) -> DVec3;

    /// Intensity towards unit `direction` (W/sr).
    fn intensity(&self, direction: Vec3) -> Spectrum;

    /// A direction for light to leave in; 0 where there is none.
    fn sample(&self, stream: &mut Stream) -> Vec3;

    /// Density of [`Self::sample`] (1/sr).
    fn pdf_sr(&self, direction: Vec3) -> f32;

    /// Emitted power (W).
    fn power(&self) -> DVec3;
}

/// What an emitter at infinity is in one direction.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    /// See [`InfiniteModel::radiance`].
    pub radiance: Spectrum,
    /// See [`InfiniteModel::pdf_sr`].
    pub pdf_sr: f32,
    /// Density of [`InfiniteModel::aim`] (1/sr); 1 of the only direction there is.
    pub aimed_sr: f32,
}

/// What every emitter at infinity can do.
pub trait InfiniteModel {
    /// Radiance from the unit direction `towards` it (W/(m^2 sr)); from a single direction irradiance (W/m^2).
    fn radiance(&self, towards: Vec3) -> Spectrum;

    /// A unit direction for a light subpath to come from.
    fn sample(&self, stream: &mut Stream) -> Vec3;

    /// Density of [`Self::sample`] (1/sr); 1 of the only direction there is.
    fn pdf_sr(&self, towards: Vec3) -> f32;

    /// A unit direction for next-event estimation to take, and what there is.
    fn aim(&self, stream: &mut Stream) -> (Vec3, Seen) {
        let towards = self.sample(stream);
        (towards, self.seen(towards))
    }

    /// What there is in a direction, for the cost of one of its parts where that is most of all.
    fn seen(&self, towards: Vec3) -> Seen {
        let pdf_sr = self.pdf_sr(towards);
        Seen { radiance: self.radiance(towards), pdf_sr, aimed_sr: pdf_sr }
    }

    /// The integral of radiance over all directions (W/m^2).
    fn fluence(&self) -> DVec3;

    /// The only direction towards it; none where it surrounds the scene.
    fn direction(&self) -> Option<Vec3> {
        None
    }

    /// Its radiance, if that is the same from everywhere.
    fn even_radiance(&self) -> Option<Spectrum> {
        None
    }
}

/// What every emitter of parallel rays from a disk can do.
pub trait BeamModel {
    /// Centre of the disk in the file's coordinates.
    fn centre(&self) -> DVec3;

    /// The unit direction in which the light travels, a normal of the disk.
    fn direction(&self) -> Vec3;

    /// Radius of the disk (m).
    fn radius(&self) -> f32;

    /// Irradiance on a surface that faces the light (W/m^2).
    fn irradiance(&self) -> Spectrum;

    /// Emitted power (W).
    fn power(&self) -> DVec3;
}

/// What all emitters have.
const COMMON: &[Parameter] = rows! {
    // Within these bounds, f32 holds it and its products.
    number("sampling_weight", "", within(1e-20, 1e20), Is(1.0), "Scales the probability of sampling this emitter."),
    nested("medium", Optional, "The medium around it; default: found from the boundaries."),
    text("group", "a name of 1 to 200 ASCII letters, digits and signs", Optional, "Its light group: a layer of `--groups`.").ours(),
};

/// Makes an enum with its dispatch for each kind, and the registry, from one row an emitter. An emitter has
/// `fn build(&Params) -> Result<Self>` and the table of its parameters, those in [`COMMON`] included; where it has a second
/// name, these for that too.
macro_rules! emitters {
    ($($(#[$doc:meta])* $kind:ident($any:ident: $contract:ident) {
        $($name:literal => $model:ident $(| $more:literal => $build:ident $table:ident)?,)*
    } [$($methods:tt)*])*) => {
        $(models! { $(#[$doc])* $any: $contract [$($model)*] $($methods)* })*

        /// Every emitter there is, by plugin name.
        pub const ROWS: Registry<Plugin<Build<Kind>>> = Registry::new("an emitter", &[
            $($(($name, Plugin {
                table: $model::TABLE,
                build: |params: &Params<'_>| $model::build(params).map($any::from).map(Kind::$kind),
            }),
            $(($more, Plugin {
                table: $model::$table,
                build: |params: &Params<'_>| $model::$build(params).map($any::from).map(Kind::$kind),
            }),)?)*)*
        ]);
    };
}

emitters! {
    /// Any emitter on a shape.
    Surface(SurfaceEmitter: SurfaceModel) {
        "area" => Area,
        "directionalarea" => DirectionalArea,
    } [
        #[inline] fn radiance(uv: Uv, cosine: f32) -> Spectrum;
        #[inline] fn pdf_sr(cosine: f32) -> f32;
        #[inline] fn sample(point: &SurfacePoint, pdf_area: f32, stream: &mut Stream) -> SurfaceEmission;
        fn exitance() -> DVec3;
        #[inline] fn is_dirac() -> bool;
    ]

    /// Any emitter at a point.
    Point(PointEmitter: PointModel) {
        "point" => Point,
        "spot" => Spot,
        "projector" => Projector,
    } [
        fn position() -> DVec3;
        #[inline] fn intensity(direction: Vec3) -> Spectrum;
        #[inline] fn sample(stream: &mut Stream) -> Vec3;
        #[inline] fn pdf_sr(direction: Vec3) -> f32;
        fn power() -> DVec3;
    ]

    /// Any emitter at infinity.
    Infinite(InfiniteEmitter: InfiniteModel) {
        "directional" => Directional,
        "constant" => Constant,
        "envmap" => EnvMap,
        "sunsky" => SunSky | "timed_sunsky" => timed TIMED_TABLE,
    } [
        #[inline] fn radiance(towards: Vec3) -> Spectrum;
        #[inline] fn sample(stream: &mut Stream) -> Vec3;
        #[inline] fn pdf_sr(towards: Vec3) -> f32;
        #[inline] fn aim(stream: &mut Stream) -> (Vec3, Seen);
        #[inline] fn seen(towards: Vec3) -> Seen;
        fn fluence() -> DVec3;
        #[inline] fn direction() -> Option<Vec3>;
        fn even_radiance() -> Option<Spectrum>;
    ]

    /// Any emitter of parallel rays from a disk.
    Beam(BeamEmitter: BeamModel) {
        "collimated" => Collimated,
    } [
        fn centre() -> DVec3;
        #[inline] fn direction() -> Vec3;
        #[inline] fn radius() -> f32;
        #[inline] fn irradiance() -> Spectrum;
        fn power() -> DVec3;
    ]
}

/// Builds the emitter that `object` describes; positions are still in the file's coordinates. A medium among
/// its children (the one it is in) is read by the scene.
pub fn build(object: &Object, library: &Library) -> Result<Emitter> {
    let (name, _) = ROWS.row(object)?;
    let (params, build) = ROWS.read(object, library)?;
    let kind = build(&params)?;
    let (sampling_weight, group) = (params.float("sampling_weight")? as f32, medium::group(&params)?);
    params.children("medium", |child| medium::ROWS.has(child.object))?;
    params.finish()?;
    Ok(Emitter { name, kind, sampling_weight, group })
}

impl Emitter {
    /// An emissive medium.
    pub fn of_medium(volume: VolumeEmitter) -> Self {
        let group = volume.emission.group().map(str::to_owned);
        Self { name: "medium", kind: Kind::Medium(volume), sampling_weight: 1.0, group }
    }

    /// True for emitters that lie on a shape.
    pub fn needs_shape(&self) -> bool {
        matches!(self.kind, Kind::Surface(_))
    }

    /// True for emitters at infinity: their "position" is a direction and is measured in steradians.
    pub fn is_infinite(&self) -> bool {
        matches!(self.kind, Kind::Infinite(_))
    }

    /// True if its light leaves a disk in parallel; at infinity, the disk around the scene. Starts have a density per
    /// area of the disk, and there is no 1/d^2.
    pub fn is_parallel(&self) -> bool {
        matches!(self.kind, Kind::Infinite(_) | Kind::Beam(_))
    }

    /// True if a walk can hit it by chance: it is neither a point nor a single direction.
    #[inline]
    pub fn is_hittable(&self) -> bool {
        match &self.kind {
            Kind::Surface(e) => !e.is_dirac(),
            Kind::Point(_) | Kind::Beam(_) => false,
            Kind::Infinite(e) => e.direction().is_none(),
            Kind::Medium(_) => true,
        }
    }

    /// True if next-event estimation can find it. It cannot where each point emits in a single direction, unless it
    /// knows which point sends light where.
    #[inline]
    pub fn is_connectible(&self) -> bool {
        !matches!(&self.kind, Kind::Surface(e) if e.is_dirac())
    }

    /// What surrounds the scene, if it does.
    #[inline]
    pub fn environment(&self) -> Option<&InfiniteEmitter> {
        match &self.kind {
            Kind::Infinite(e) if e.direction().is_none() => Some(e),
            _ => None,
        }
    }

    /// Emitted power (W), luminance-weighted; `area` (m^2) of the emitting shape, `radius` (m) of the scene.
    pub fn power(&self, area: f32, radius: f32) -> f64 {
        let power = match &self.kind {
            Kind::Surface(e) => e.exitance() * f64::from(area),
            Kind::Point(e) => e.power(),
            Kind::Infinite(e) => e.fluence() * (f64::from(PI) * f64::from(radius).powi(2)),
            Kind::Beam(e) => e.power(),
            Kind::Medium(e) => e.power(),
        };
        power.dot(LUMINANCE.as_dvec3())
    }

    /// Its position in the file's coordinates: a point, or the centre of a disk.
    pub fn position(&self) -> Option<DVec3> {
        match &self.kind {
            Kind::Point(e) => Some(e.position()),
            Kind::Beam(e) => Some(e.centre()),
            _ => None,
        }
    }
}
