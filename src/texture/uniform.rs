//! One colour everywhere.

use super::TextureModel;
use crate::description::{
    Params, Table,
    colour::{self, Role},
};
use crate::error::Result;
use crate::math::{Spectrum, Uv};

/// A constant colour, linear sRGB.
#[derive(Clone, Copy, Debug)]
pub struct Uniform(pub Spectrum);

impl Uniform {
    pub(super) const TABLE: Table = colour::UNIFORM;

    /// Of any plugin that represents one colour. As light, for that has the widest range; where a plugin is
    /// nested in another, [`super::parameter()`] reads it as what it is there.
    pub(super) fn build(params: &Params<'_>, _: f32) -> Result<Self> {
        colour::of_plugin(params, Role::Light).map(Self)
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        vec![Self(Spectrum::new(0.2, 0.5, 0.0))]
    }
}

impl TextureModel for Uniform {
    #[inline]
    fn eval(&self, _: Uv) -> Spectrum {
        self.0
    }

    fn max(&self) -> Spectrum {
        self.0
    }

    fn mean(&self) -> Spectrum {
        self.0
    }
}
