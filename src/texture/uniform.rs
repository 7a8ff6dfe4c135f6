//! One colour everywhere.

use super::TextureModel;
use crate::description::Params;
use crate::error::Result;
use crate::math::{Spectrum, Vec2};

/// A constant colour, linear sRGB.
#[derive(Clone, Copy, Debug)]
pub struct Uniform(pub Spectrum);

impl Uniform {
    pub(super) fn build(params: &Params<'_>) -> Result<Self> {
        params.color("value", 1.0).map(Self)
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        vec![Self(Spectrum::new(0.2, 0.5, 0.0))]
    }
}

impl TextureModel for Uniform {
    #[inline]
    fn eval(&self, _: Vec2) -> Spectrum {
        self.0
    }

    fn max(&self) -> Spectrum {
        self.0
    }

    fn mean(&self) -> Spectrum {
        self.0
    }
}
