//! Two colours in squares: Mitsuba's `checkerboard`.

use super::{TO_UV, Texture, TextureModel, ToUv, fraction, parameter};
use crate::description::{Params, Table, table};
use crate::error::Result;
use crate::math::{Spectrum, Uv};
use std::sync::Arc;

/// Squares of half a unit: the first colour where both halves of u and v agree, else the second.
#[derive(Clone, Debug)]
pub struct Checkerboard {
    colors: Arc<[Texture; 2]>,
    to_uv: ToUv,
}

impl Checkerboard {
    pub(super) const TABLE: Table = table! {
        "Squares of half a unit in two colours.";
        texture("color0", f64::INFINITY, Is(0.4), "Where u and v lie in equal halves."),
        texture("color1", f64::INFINITY, Is(0.2), "Where they lie in different halves."),
        TO_UV,
    };

    pub(super) fn build(params: &Params<'_>, _: f32) -> Result<Self> {
        let colors = [parameter(params, "color0")?, parameter(params, "color1")?];
        Ok(Self { colors: Arc::new(colors), to_uv: ToUv::read(params)? })
    }

    /// Which colour is at `uv`.
    #[inline]
    fn square(&self, uv: Uv) -> usize {
        let cell = fraction(self.to_uv.apply(uv));
        usize::from((cell.x > 0.5) != (cell.y > 0.5))
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        use crate::math::{DMat4, DVec3};
        let grey = |x| Texture::constant(Spectrum::splat(x));
        let colors = Arc::new([grey(0.9), Texture::constant(Spectrum::new(0.1, 0.2, 0.3))]);
        let plain = Self { colors, to_uv: ToUv::new(DMat4::IDENTITY) };
        let scaled = ToUv::new(DMat4::from_scale(DVec3::new(3.0, 5.0, 1.0)));
        vec![Self { to_uv: scaled, ..plain.clone() }, plain]
    }
}

impl TextureModel for Checkerboard {
    fn eval(&self, uv: Uv) -> Spectrum {
        self.colors[self.square(uv)].eval(uv)
    }

    /// Mitsuba 3.9.1 takes the other colour where it takes a number.
    fn number(&self, uv: Uv) -> f32 {
        self.colors[self.square(uv)].number(uv)
    }

    fn max(&self) -> Spectrum {
        self.colors[0].max().max(self.colors[1].max())
    }

    fn mean(&self) -> Spectrum {
        0.5 * (self.colors[0].mean() + self.colors[1].mean())
    }
}
