//! Colours that vary over a surface: one file a model; this page is the contract and the registry.

mod bitmap;
mod checkerboard;
pub mod image;
#[cfg(test)]
mod tests;
mod uniform;

pub use bitmap::Bitmap;
pub use checkerboard::Checkerboard;
pub use image::Image;
pub use uniform::Uniform;

use crate::description::{
    Build, Library, Object, Params, Registry, Value,
    colour::{self, Role},
};
use crate::error::Result;
use crate::math::{DMat4, Spectrum, Uv, Vec2, vec2};

/// What every texture can do.
pub trait TextureModel {
    /// The colour at texture position `uv`.
    fn eval(&self, uv: Uv) -> Spectrum;
    /// A bound that no channel of `eval` exceeds.
    fn max(&self) -> Spectrum;
    /// The average over the unit square.
    fn mean(&self) -> Spectrum;
    /// Columns and rows of what it is made of; one of each where it is no grid.
    fn resolution(&self) -> [usize; 2] {
        [1, 1]
    }
}

/// Makes the enum, its dispatch, the registry and the list of test examples from one row a model, and the
/// names of more plugins that represent one colour.
macro_rules! textures {
    ($($name:literal => $model:ident,)* colors: $($color:literal,)*) => {
        /// Any texture. Cheap to clone: images are shared.
        #[derive(Clone, Debug)]
        #[expect(missing_docs, reason = "each variant is the model of its name, documented there")]
        pub enum Texture {
            $($model($model),)*
        }

        impl Texture {
            /// The colour at texture position `uv`.
            #[inline(always)]
            pub fn eval(&self, uv: impl Into<Uv>) -> Spectrum {
                let uv = uv.into();
                match self { $(Self::$model(model) => model.eval(uv),)* }
            }
            /// A bound that no channel of `eval` exceeds.
            pub fn max(&self) -> Spectrum {
                match self { $(Self::$model(model) => model.max(),)* }
            }
            /// The average over the unit square before `to_uv` (of an image, over its pixels).
            pub fn mean(&self) -> Spectrum {
                match self { $(Self::$model(model) => model.mean(),)* }
            }
            /// Columns and rows of what it is made of; one of each where it is no grid.
            pub fn resolution(&self) -> [usize; 2] {
                match self { $(Self::$model(model) => model.resolution(),)* }
            }
        }

        /// Every texture there is, by plugin name.
        pub const ROWS: Registry<Build<Texture>> = Registry::new("a texture", &[
            $(($name, |params: &Params<'_>| $model::build(params).map(Texture::$model)),)*
            $(($color, build_color),)*
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
    colors: "rawconstant", "srgb", "d65", "regular", "irregular", "blackbody",
}

impl Texture {
    /// One colour everywhere.
    pub fn constant(color: Spectrum) -> Self {
        Self::Uniform(Uniform(color))
    }
}

/// Builds the texture that `object` describes.
pub fn build(object: &Object, library: &Library) -> Result<Texture> {
    ROWS.build(object, library)
}

/// The parameter `name` as a texture: a colour, or a nested or referenced texture; a grey `default` where
/// not given. Bounds are the caller's to check, by [`Texture::max`].
pub fn parameter(params: &Params<'_>, name: &'static str, default: f32) -> Result<Texture> {
    of_role(params, name, default, Role::Matter)
}

/// The same for radiance and other light. As in Mitsuba, the role ends at the texture: what a texture holds
/// inside is matter.
pub fn emission(params: &Params<'_>, name: &'static str, default: f32) -> Result<Texture> {
    of_role(params, name, default, Role::Light)
}

/// The same for indices of refraction; their spectra may exceed 1.
pub fn index(params: &Params<'_>, name: &'static str, default: f32) -> Result<Texture> {
    of_role(params, name, default, Role::Index)
}

fn of_role(params: &Params<'_>, name: &'static str, default: f32, role: Role) -> Result<Texture> {
    let property = params.object.properties.iter().find(|property| property.name == name);
    if let Some(Value::Object(_) | Value::Reference(_)) = property.map(|property| &property.value)
        && let Some(child) = params.child(name)?
        && !colour::is_plugin(child.object)
    {
        return build(child.object, params.library);
    }
    let color = match role {
        Role::Light => params.emission(name, default),
        Role::Index => params.index(name, default),
        Role::Matter => params.color(name, default),
    };
    color.map(Texture::constant)
}

/// A plugin that represents one colour; or `d65` around a texture, which is that texture.
fn build_color(params: &Params<'_>) -> Result<Texture> {
    if colour::is_plugin(params.object) {
        return Uniform::build(params).map(Texture::Uniform);
    }
    params.accept_unused(&["scale"], "Mitsuba does not scale a texture in d65 either");
    match params.children(|_| true)?.as_slice() {
        [child] if !params.has("color") => build(child.object, params.library),
        _ => Err(params.complain("", "either one texture or a \"color\" in d65", "more")),
    }
}

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

    fn build(params: &Params<'_>) -> Result<Self> {
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
