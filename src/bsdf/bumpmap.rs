//! Normals from a height: Mitsuba's `bumpmap`.

use super::perturbed::{Normals, PERTURBED, Perturbed};
use crate::description::{Params, Table, table};
use crate::error::{Error, Result};
use crate::math::{Uv, Vec3, vec3};
use crate::texture::{self, Texture};

/// A surface with the normals of one that an image displaces. Nested bump maps differ from Mitsuba 3.9.1, which mixes
/// their frames.
pub type BumpMap = Perturbed<Heights>;

/// The image: heights (m) over the surface, of which only the changes count.
#[derive(Clone, Debug)]
pub struct Heights {
    texture: Texture,
    scale: f32,
}

impl BumpMap {
    pub(super) const TABLE: Table = table! {
        "A surface that looks as if an image raised it.";
        nested("texture", Required, "The height: an image's luminance. Give the image `raw` = true."),
        number("scale", "", ANY, Is(1.0), "Scales the height.");
        PERTURBED
    };

    pub(super) fn build(params: &Params<'_>) -> Result<Self> {
        let children = params.children("texture", |child| texture::ROWS.has(child.object))?;
        let [child] = children.as_slice() else {
            let remedy = "nest one texture in the bumpmap";
            let found = children.len().to_string();
            return Err(Error::new(params.location(), "one nested texture", found, remedy));
        };
        let texture = texture::build(child.object, params.library, f32::INFINITY)?;
        if !matches!(texture, Texture::Bitmap(_) | Texture::Uniform(_)) {
            let found = format!("\"{}\", whose slope is not known", child.object.plugin);
            return Err(Error::new(child.location, "a bitmap", found, "make an image of the texture"));
        }
        Self::build_around(params, Heights { texture, scale: params.float("scale")? as f32 })
    }

    /// Without a surface there is nothing to see: scenes test it.
    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        Vec::new()
    }
}

impl Normals for Heights {
    fn normal(&self, uv: Uv) -> Vec3 {
        let Uv::Known(detail) = uv else { return Vec3::Z };
        let slope = self.texture.gradient(uv) * self.scale;
        let [du, dv] = detail.partials;
        let normal = vec3(du.x, du.y, slope.x).cross(vec3(dv.x, dv.y, slope.y));
        if normal.dot(detail.normal) < 0.0 { -normal } else { normal }
    }
}
