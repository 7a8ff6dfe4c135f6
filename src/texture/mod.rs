//! Colours that vary over a surface: one file a model; this page is the contract and the registry.

mod bitmap;
mod checkerboard;
pub mod image;
mod in_volume;
mod mesh_attribute;
#[cfg(test)]
mod tests;
mod uniform;

pub use bitmap::Bitmap;
pub use checkerboard::Checkerboard;
pub use image::Image;
pub use in_volume::InVolume;
pub use mesh_attribute::MeshAttribute;
pub use uniform::Uniform;

use crate::description::{
    Library, Object, Params, Plugin, Registry, Value, colour,
    parameter::{self, Parameter},
};
use crate::error::Result;
use crate::math::{DMat4, Spectrum, Uv, Vec2, vec2};

/// What every texture can do.
pub trait TextureModel {
    /// The colour at texture position `uv`.
    fn eval(&self, uv: Uv) -> Spectrum;
    /// The same as a number, as Mitsuba takes it: an image's luminance, the mean of the channels of all others.
    fn number(&self, uv: Uv) -> f32 {
        self.eval(uv).element_sum() / 3.0
    }
    /// A bound that no channel of `eval` exceeds.
    fn max(&self) -> Spectrum;
    /// The average over the unit square.
    fn mean(&self) -> Spectrum;
    /// How it changes with u and v, as a number: the luminance of an image. 0 where it says nothing of that.
    fn gradient(&self, _uv: Uv) -> Vec2 {
        Vec2::ZERO
    }
    /// Columns and rows of what it is made of; one of each where it is no grid.
    fn resolution(&self) -> [usize; 2] {
        [1, 1]
    }
}

/// Makes the enum, its dispatch, the registry and the list of test examples from one row a model, and the
/// names of more plugins that represent one colour.
macro_rules! textures {
    ($($name:literal => $model:ident,)* colors: $($color:literal => $table:ident,)*) => {
        /// Any texture. Cheap to clone: images are shared.
        #[derive(Clone, Debug)]
        #[expect(missing_docs, reason = "each variant is the model of its name, documented there")]
        pub enum Texture {
            $($model($model),)*
        }

        impl Texture {
            /// The colour at texture position `uv`.
            #[inline(always)]
            pub fn eval<'a>(&self, uv: impl Into<Uv<'a>>) -> Spectrum {
                let uv = uv.into();
                match self { $(Self::$model(model) => model.eval(uv),)* }
            }
            /// The same as a number, as Mitsuba takes it: an image's luminance, the mean of the channels of all others.
            #[inline]
            pub fn number(&self, uv: Uv) -> f32 {
                match self { $(Self::$model(model) => model.number(uv),)* }
            }
            /// A bound that no channel of `eval` exceeds.
            pub fn max(&self) -> Spectrum {
                match self { $(Self::$model(model) => model.max(),)* }
            }
            /// The average over the unit square before `to_uv` (of an image, over its pixels).
            pub fn mean(&self) -> Spectrum {
                match self { $(Self::$model(model) => model.mean(),)* }
            }
            /// How it changes with u and v, as a number: the luminance of an image. 0 where it says nothing of that.
            pub fn gradient(&self, uv: Uv) -> Vec2 {
                match self { $(Self::$model(model) => model.gradient(uv),)* }
            }
            /// Columns and rows of what it is made of; one of each where it is no grid.
            pub fn resolution(&self) -> [usize; 2] {
                match self { $(Self::$model(model) => model.resolution(),)* }
            }
        }

        /// Every texture there is, by plugin name.
        pub const ROWS: Registry<Plugin<BuildTexture>> = Registry::new("a texture", &[
            $(($name, Plugin {
                table: $model::TABLE,
                build: |params: &Params<'_>, most: f32| $model::build(params, most).map(Texture::$model),
            }),)*
            $(($color, Plugin { table: colour::$table, build: build_color }),)*
        ]);

        /// Instances of every model, for the tests that hold for all.
        #[cfg(test)]
        fn examples() -> Vec<Texture> {
            let mut all = Vec::new();
            $(all.extend($model::examples().into_iter().map(Texture::$model));)*
            all
        }
    };
}

textures! {
    "uniform" => Uniform,
    "checkerboard" => Checkerboard,
    "bitmap" => Bitmap,
    "mesh_attribute" => MeshAttribute,
    "volume" => InVolume,
    colors: "rawconstant" => RAW, "srgb" => SRGB, "d65" => D65, "regular" => REGULAR, "irregular" => IRREGULAR,
    "blackbody" => BLACKBODY, "inverse_power" => INVERSE_POWER,
}

impl Texture {
    /// One colour everywhere.
    pub fn constant(color: Spectrum) -> Self {
        Self::Uniform(Uniform(color))
    }
}

/// How a texture is built whose channels may be up to a number.
pub type BuildTexture = fn(&Params<'_>, f32) -> Result<Texture>;

/// Builds the texture that `object` describes. Where channels are bounded by `most`, images that exceed it a little are
/// mended.
pub fn build(object: &Object, library: &Library, most: f32) -> Result<Texture> {
    let (params, build) = ROWS.read(object, library)?;
    let built = build(&params, most)?;
    params.finish()?;
    Ok(built)
}

/// The parameter `name` as a texture: a colour, or a nested or referenced texture. Bounds are the caller's to check, by
/// [`Texture::max`]. As in Mitsuba, the role that its row gives it ends at the texture: what a texture holds inside is
/// matter.
pub fn parameter(params: &Params<'_>, name: &'static str) -> Result<Texture> {
    if let Some(Value::Object(_) | Value::Reference(_)) = params.given(name).map(|property| &property.value)
        && let Some(child) = params.child(name)?
        && !colour::is_plugin(child.object)
    {
        return build(child.object, params.library, params.most(name) as f32);
    }
    params.color(name).map(Texture::constant)
}

/// A plugin that represents one colour; or `d65` around a texture, which is that texture.
fn build_color(params: &Params<'_>, most: f32) -> Result<Texture> {
    if colour::is_plugin(params.object) {
        return Uniform::build(params, most).map(Texture::Uniform);
    }
    if let Some(scale) = params.given("scale") {
        let text = "\"scale\" is accepted but not used: Mitsuba does not scale a texture in d65 either";
        params.library.warn(&scale.location, text);
        params.float("scale")?;
    }
    match params.children("texture", |_| true)?.as_slice() {
        [child] if !params.has("color") => build(child.object, params.library, most),
        _ => Err(params.complain("", "either one texture or a \"color\" in d65", "more")),
    }
}

/// The row of [`ToUv`].
const TO_UV: Parameter =
    parameter::transform("to_uv", "Applied to texture coordinates: a scale of 2 repeats the texture twice.");

/// The part of a `to_uv` transform that acts on texture positions: an affine map of the plane.
#[derive(Clone, Copy, Debug)]
struct ToUv {
    columns: [Vec2; 3],
}

impl ToUv {
    fn new(matrix: DMat4) -> Self {
        let column = |i| matrix.col(i).truncate().truncate().as_vec2();
        Self { columns: [column(0), column(1), column(3)] }
    }

    fn read(params: &Params<'_>) -> Result<Self> {
        params.transform("to_uv").map(Self::new)
    }

    #[inline]
    fn apply(&self, uv: Uv) -> Vec2 {
        let ([u, v, origin], uv) = (self.columns, uv.get());
        u * uv.x + v * uv.y + origin
    }
}

/// The position within its unit cell, in [0, 1).
#[inline]
fn fraction(uv: Vec2) -> Vec2 {
    let inside = uv - uv.floor();
    // A tiny negative number leaves exactly 1 by rounding.
    vec2(if inside.x < 1.0 { inside.x } else { 0.0 }, if inside.y < 1.0 { inside.y } else { 0.0 })
}
