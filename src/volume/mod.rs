//! Volumes: numbers and colours that vary in space, of which extinction, albedo and emission are made. One file a
//! model; this page is the contract and the registry.

mod check;
mod coarse;
mod constant;
mod cosine;
mod equipotential;
mod exponential;
pub mod files;
pub mod grid;
mod noise;
mod perlin;
mod placed;
mod polynomial;
mod product;
mod quadrature;
mod samples;
mod sum;
#[cfg(test)]
mod tests;
mod wind;

pub use check::{Negative, check_non_negative};
pub use coarse::{Coarse, Piece, Summary};
pub use constant::Constant;
pub use cosine::Cosine;
pub use equipotential::Equipotential;
pub use exponential::Exponential;
pub use grid::{Grid, Sixfold};
pub use noise::Noise;
pub use polynomial::Polynomial;
pub use product::Product;
pub use samples::{Mapped, Samples};
pub use sum::Sum;
pub use wind::Wind;

use crate::{
    description::{Library, Object, Params, Plugin, Registry, Table, Value, parameter::Parameter, rows},
    error::{Error, Result},
    math::{Channels, DAffine3, DVec3, RaySegment, Spectrum, Vec3},
};
use std::sync::Arc;

/// Where and when volumes are built.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// What becomes the origin of all positions, in the file's coordinates (m).
    pub recentre: DVec3,
    /// Where the instance of a group takes what the file places; the identity elsewhere.
    pub instance: DAffine3,
    /// The scene's time (s).
    pub time: f64,
    /// How long after that of its files (s): not 0 only while the shutter is open.
    pub after: f64,
    /// The most that a value may be, where that is less than anything: 1 for a share of light.
    pub most: f32,
}

impl Place {
    /// At `time` (s), for values of any size.
    pub const fn new(recentre: DVec3, time: f64) -> Self {
        Self { recentre, instance: DAffine3::IDENTITY, time, after: 0.0, most: f32::INFINITY }
    }

    /// The same for values up to `most`.
    pub const fn up_to(self, most: f32) -> Self {
        Self { most, ..self }
    }

    /// The map from a volume's own coordinates, placed by `to_world`, to recentred ones.
    pub fn to_world(&self, params: &Params<'_>) -> Result<DAffine3> {
        let to_file = DAffine3::from_mat4(params.transform("to_world")?);
        Ok(DAffine3::from_translation(-self.recentre) * self.instance * to_file)
    }

    /// The file's unit cube.
    fn unit_cube(&self) -> [Vec3; 2] {
        [DVec3::ZERO, DVec3::ONE].map(|corner| (corner - self.recentre).as_vec3())
    }
}

/// What every volume can do. Positions are world positions, recentred.
pub trait VolumeModel {
    /// The value at `position`, per channel. Where the volume may not reach, call `contains` first.
    fn eval<L: Channels>(&self, position: Vec3) -> L;

    /// Bounds of every channel within the box from `low` to `high`: conservative, and as narrow as is cheap.
    fn range(&self, low: Vec3, high: Vec3) -> [Spectrum; 2];

    /// The box outside of which the value is 0 (or, of an albedo, of no matter); none where there is no such box.
    fn domain(&self) -> Option<[Vec3; 2]>;

    /// True if `position` is not outside the volume.
    fn contains(&self, _position: Vec3) -> bool {
        true
    }

    /// True if it says itself that it is 0 everywhere.
    fn is_zero(&self) -> bool {
        false
    }

    /// True if all channels are equal everywhere.
    fn is_grey(&self) -> bool;

    /// True if [`Self::integral`] is known in closed form.
    fn has_integral(&self) -> bool;

    /// The integral along `segment`, whose length is finite unless `domain` says otherwise; meaningful only where
    /// `has_integral` is true.
    fn integral<L: Channels>(&self, segment: &RaySegment) -> L;

    /// The same volume, moved by `by` (m).
    fn moved(&self, by: DVec3) -> Self
    where
        Self: Sized;

    /// The volume as it is at `time` (s); none where it is the same at all times.
    fn at_time(&self, _time: f64) -> Option<Self>
    where
        Self: Sized,
    {
        None
    }
}

/// Makes the enum, its dispatch, the registry and the list of test examples from one row a model.
macro_rules! volumes {
    ($($name:expr => $model:ident,)*) => {
        /// Any volume. Cheap to clone: grids are shared.
        #[derive(Clone, Debug)]
        #[expect(missing_docs, reason = "each variant is the model of its name, documented there")]
        pub enum Volume {
            $($model($model),)*
        }

        impl VolumeModel for Volume {
            #[inline]
            fn eval<L: Channels>(&self, position: Vec3) -> L {
                match self { $(Self::$model(model) => model.eval(position),)* }
            }
            fn range(&self, low: Vec3, high: Vec3) -> [Spectrum; 2] {
                match self { $(Self::$model(model) => model.range(low, high),)* }
            }
            fn domain(&self) -> Option<[Vec3; 2]> {
                match self { $(Self::$model(model) => model.domain(),)* }
            }
            #[inline]
            fn contains(&self, position: Vec3) -> bool {
                match self { $(Self::$model(model) => model.contains(position),)* }
            }
            fn is_zero(&self) -> bool {
                match self { $(Self::$model(model) => model.is_zero(),)* }
            }
            fn is_grey(&self) -> bool {
                match self { $(Self::$model(model) => model.is_grey(),)* }
            }
            fn has_integral(&self) -> bool {
                match self { $(Self::$model(model) => model.has_integral(),)* }
            }
            #[inline]
            fn integral<L: Channels>(&self, segment: &RaySegment) -> L {
                match self { $(Self::$model(model) => model.integral(segment),)* }
            }
            fn moved(&self, by: DVec3) -> Self {
                match self { $(Self::$model(model) => Self::$model(model.moved(by)),)* }
            }
            fn at_time(&self, time: f64) -> Option<Self> {
                match self { $(Self::$model(model) => model.at_time(time).map(Self::$model),)* }
            }
        }

        /// Every volume there is, by plugin name.
        pub const ROWS: Registry<Plugin<BuildVolume>> = Registry::new("a volume", &[
            $(($name, Plugin {
                table: $model::TABLE,
                build: |params: &Params<'_>, place: &Place| $model::build(params, place).map(Volume::$model),
            }),)*
        ]);

        /// Instances of every model, for the tests that hold for all.
        #[cfg(test)]
        fn examples() -> Vec<Volume> {
            let mut all = Vec::new();
            $(all.extend($model::examples().into_iter().map(Volume::$model));)*
            all
        }
    };
}

volumes! {
    "constvolume" => Constant,
    "cosine" => Cosine,
    "polynomial" => Polynomial,
    "equipotential" => Equipotential,
    "exponential" => Exponential,
    "noise" => Noise,
    "sum" => Sum,
    "product" => Product,
    WIND => Wind,
    "gridvolume" => Grid,
}

/// What drifts. Its `velocity` may change in time: where it is then follows from the mean of that.
pub const WIND: &str = "wind";

/// Plugins that are parts of a volume and none themselves, each with the volume that it is a part of.
pub const PARTS: &[(&str, &str, Table)] =
    &[("wave", "cosine", cosine::WAVE), ("term", "polynomial", polynomial::TERM)];

/// What volumes have that hold others.
const NESTED: &[Parameter] = rows! { nested("volume", Required, "The volumes, one or more.") };

/// How a volume is built.
pub type BuildVolume = fn(&Params<'_>, &Place) -> Result<Volume>;

impl Volume {
    /// The grey `value` everywhere, given where the unit cube lies.
    pub fn constant(value: f32, place: &Place) -> Self {
        Self::Constant(Constant::new(Spectrum::splat(value), place.unit_cube()))
    }

    /// `value` everywhere, without an end of its own.
    pub fn endless(value: Spectrum) -> Self {
        Self::Product(Product::new(vec![Self::Constant(Constant::new(value, [Vec3::ZERO; 2]))]))
    }

    /// `self` times 1 - `albedo`: what is absorbed of an extinction.
    pub fn absorbed(self, albedo: Self) -> Self {
        Self::Product(Product::absorbed(self, albedo))
    }

    /// The value at `position`, 0 where the volume is not.
    #[inline]
    pub fn inside<L: Channels>(&self, position: Vec3) -> L {
        if self.contains(position) { self.eval(position) } else { L::splat(0.0) }
    }

    /// Bounds of [`Self::inside`] within the box from `low` to `high`.
    pub fn range_inside(&self, low: Vec3, high: Vec3) -> [Spectrum; 2] {
        let [least, most] = self.range(low, high);
        match self.domain() {
            Some([first, last]) if !(first.cmple(low).all() && last.cmpge(high).all()) => {
                [least.min(Spectrum::ZERO), most.max(Spectrum::ZERO)]
            }
            _ => [least, most],
        }
    }

    /// The grid, if it is one, whose cells an exact tracker walks; drifting or not.
    #[inline]
    pub fn grid(&self) -> Option<&Grid> {
        match self {
            Self::Grid(grid) => Some(grid),
            Self::Wind(wind) => wind.nested().grid(),
            _ => None,
        }
    }

    /// The box that the volume fills as the extinction of a medium: its domain; of one value its unit cube, as in
    /// Mitsuba.
    pub fn fills(&self) -> Option<[Vec3; 2]> {
        match self {
            Self::Constant(constant) => Some(constant.cube()),
            _ => self.domain(),
        }
    }
}

/// Builds the volume that `object` describes.
pub fn build(object: &Object, library: &Library, place: &Place) -> Result<Volume> {
    let (params, build) = ROWS.read(object, library)?;
    let built = build(&params, place)?;
    params.finish()?;
    Ok(built)
}

/// The parameter `name` as a volume: a nested or referenced volume, or a number or colour for one everywhere. Grids may
/// hold what its row allows.
pub fn parameter(params: &Params<'_>, name: &'static str, place: &Place) -> Result<Volume> {
    if let Some(Value::Object(_) | Value::Reference(_)) = params.given(name).map(|property| &property.value)
        && let Some(child) = params.child(name)?
        && ROWS.has(child.object)
    {
        return build(child.object, params.library, &place.up_to(params.most(name) as f32));
    }
    params.color(name).map(|color| Volume::Constant(Constant::new(color, place.unit_cube())))
}

/// `volumes` at `time`; none where all are the same at all times.
fn all_at_time(volumes: &[Volume], time: f64) -> Option<Arc<[Volume]>> {
    let moved: Vec<_> = volumes.iter().map(|volume| volume.at_time(time)).collect();
    let all = || moved.iter().zip(volumes).map(|(moved, volume)| moved.as_ref().unwrap_or(volume).clone());
    moved.iter().any(Option::is_some).then(|| all().collect())
}

/// All volumes nested in another, at least one; a child of another kind is an error.
fn nested(params: &Params<'_>, place: &Place) -> Result<Vec<Volume>> {
    nested_in(params)?.iter().map(|object| build(object, params.library, place)).collect()
}

/// What describes them.
fn nested_in<'a>(params: &Params<'a>) -> Result<Vec<&'a Object>> {
    let children = params.children("volume", |_| true)?;
    if children.is_empty() {
        let remedy = format!("put a volume into the {}", params.object.plugin);
        return Err(Error::new(params.location(), "one or more nested volumes", "none", remedy));
    }
    Ok(children.iter().map(|child| child.object).collect())
}
