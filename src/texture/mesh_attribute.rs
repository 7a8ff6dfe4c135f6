//! Colours that a mesh brings along: Mitsuba's `mesh_attribute`.

use super::TextureModel;
use crate::description::{Params, Table, table};
use crate::error::{Error, Result};
use crate::math::{Attribute, Spectrum, Uv};
use std::sync::Arc;

/// The colours of the mesh under a name.
#[derive(Clone, Debug)]
pub struct MeshAttribute {
    name: Arc<str>,
    scale: f32,
}

impl MeshAttribute {
    pub(super) const TABLE: Table = table! {
        "The colours of a mesh: one for each vertex, or one for each triangle.";
        text("name", "the name of an attribute", Required, "`vertex_color`, `face_color`, or the name of a group in the PLY file behind `vertex_` or `face_`."),
        factor("scale", 1.0, "Scales the values: 1/255 makes bytes colours."),
    };

    /// What the mesh has, and how large it is, the scene checks.
    pub(super) fn build(params: &Params<'_>, _: f32) -> Result<Self> {
        let name = params.string("name")?;
        if !name.starts_with("vertex_") && !name.starts_with(Attribute::OF_FACES) {
            let expected = "a name that begins with vertex_ or face_";
            let place = params.given("name").map_or(params.location(), |given| &given.location);
            let remedy = format!("write \"vertex_{name}\" or \"face_{name}\"");
            return Err(Error::new(place, expected, format!("\"{name}\""), remedy));
        }
        Ok(Self { name: name.into(), scale: params.float("scale")? as f32 })
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        vec![Self { name: "vertex_color".into(), scale: 1.0 }]
    }
}

impl TextureModel for MeshAttribute {
    fn eval(&self, uv: Uv) -> Spectrum {
        let Uv::Known(detail) = uv else { return Spectrum::ONE };
        detail.attribute(&self.name) * self.scale
    }

    /// Of the mesh nothing is known here: as if it were white.
    fn max(&self) -> Spectrum {
        Spectrum::ONE
    }

    fn mean(&self) -> Spectrum {
        Spectrum::ONE
    }
}
