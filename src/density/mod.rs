//! Volumes: numbers and colours that vary in space, of which extinction, albedo and emission are made. One file a
//! model; this page is the contract and the registry.

mod constant;
pub mod files;
mod samples;
#[cfg(test)]
mod tests;

pub use constant::Constant;
pub use samples::Samples;

use crate::{
    description::{Library, Object, Params, Value, suggest},
    error::{Error, Result},
    math::{DAffine3, DVec3, Lanes, Section, Spectrum, Vec3},
};

/// Where and when volumes are built.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// What becomes the origin of all positions, in the file's coordinates [m].
    pub recentre: DVec3,
    /// The scene's time [s].
    pub time: f64,
}

impl Place {
    /// The map from a volume's own coordinates, placed by `to_world`, to recentred ones.
    pub fn to_world(&self, params: &Params<'_>) -> Result<DAffine3> {
        let to_file = DAffine3::from_mat4(params.transform("to_world")?);
        Ok(DAffine3::from_translation(-self.recentre) * to_file)
    }
}

/// What every volume can do. Positions are world positions, recentred.
pub trait VolumeModel {
    /// The value at `position`, per lane; 0 outside the domain.
    fn eval<L: Lanes>(&self, position: Vec3) -> L;

    /// Bounds of every channel within the box from `low` to `high`: conservative, and as narrow as is cheap.
    fn range(&self, low: Vec3, high: Vec3) -> [Spectrum; 2];

    /// The box outside of which the value is 0 (or, of an albedo, of no matter); none where there is no such box.
    fn domain(&self) -> Option<[Vec3; 2]>;

    /// True if all channels are equal everywhere.
    fn is_grey(&self) -> bool;

    /// True if [`Self::integral`] is known in closed form.
    fn has_integral(&self) -> bool;

    /// The integral along `section`, whose length is finite unless `domain` says otherwise; meaningful only where
    /// `has_integral` is true.
    fn integral<L: Lanes>(&self, section: &Section) -> L;
}

/// Makes the enum, its dispatch, the registry and the list of test examples from one row a model.
macro_rules! volumes {
    ($($name:literal => $model:ident,)*) => {
        /// Any volume. Cheap to clone: grids are shared.
        #[derive(Clone, Debug)]
        #[expect(missing_docs, reason = "each variant is the model of its name, documented there")]
        pub enum Volume {
            $($model($model),)*
        }

        impl VolumeModel for Volume {
            #[inline]
            fn eval<L: Lanes>(&self, position: Vec3) -> L {
                match self { $(Self::$model(model) => model.eval(position),)* }
            }
            fn range(&self, low: Vec3, high: Vec3) -> [Spectrum; 2] {
                match self { $(Self::$model(model) => model.range(low, high),)* }
            }
            fn domain(&self) -> Option<[Vec3; 2]> {
                match self { $(Self::$model(model) => model.domain(),)* }
            }
            fn is_grey(&self) -> bool {
                match self { $(Self::$model(model) => model.is_grey(),)* }
            }
            fn has_integral(&self) -> bool {
                match self { $(Self::$model(model) => model.has_integral(),)* }
            }
            #[inline]
            fn integral<L: Lanes>(&self, section: &Section) -> L {
                match self { $(Self::$model(model) => model.integral(section),)* }
            }
        }

        /// Every volume there is, by plugin name.
        pub const ROWS: &[Row] = &[
            $(Row {
                name: $name,
                build: |params: &Params<'_>, place: &Place| $model::build(params, place).map(Volume::$model),
            },)*
        ];

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
}

/// How a volume is called and built.
pub struct Row {
    /// Mitsuba's plugin name, or ours where Mitsuba has none.
    pub name: &'static str,
    /// Builds it.
    pub build: fn(&Params<'_>, &Place) -> Result<Volume>,
}

/// True if `object` is a volume.
pub fn is_volume(object: &Object) -> bool {
    ROWS.iter().any(|row| row.name == object.plugin)
}

/// Builds the volume that `object` describes.
pub fn build(object: &Object, library: &Library, place: &Place) -> Result<Volume> {
    let row = ROWS.iter().find(|row| row.name == object.plugin).ok_or_else(|| {
        let names: Vec<_> = ROWS.iter().map(|row| row.name).collect();
        let found = format!("\"{}\"", object.plugin);
        Error::new(&object.location, "the type of a volume", found, suggest(&object.plugin, "known", &names))
    })?;
    let params = Params::new(object, library);
    let built = (row.build)(&params, place)?;
    params.finish()?;
    Ok(built)
}

/// The parameter `name` as a volume: a nested or referenced volume, or a number or colour for one everywhere; none
/// where not given.
pub fn parameter(params: &Params<'_>, name: &'static str, place: &Place) -> Result<Option<Volume>> {
    let property = params.object.properties.iter().find(|property| property.name == name);
    match property.map(|property| &property.value) {
        None => Ok(None),
        Some(Value::Object(_) | Value::Reference(_)) => match params.child(name)? {
            Some(child) if is_volume(child.object) => build(child.object, params.library, place).map(Some),
            _ => params.color(name, 0.0).map(|color| Some(Volume::Constant(Constant(color)))),
        },
        Some(_) => params.color(name, 0.0).map(|color| Some(Volume::Constant(Constant(color)))),
    }
}
