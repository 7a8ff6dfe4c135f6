//! `constvolume`: one value in the unit cube of `to_world`, as in Mitsuba.

use super::{Place, VolumeModel};
use crate::{
    description::Params,
    error::Result,
    math::{Lanes, Section, Spectrum, SpectrumExt, Vec3},
};

/// One value everywhere.
#[derive(Clone, Debug)]
pub struct Constant(pub Spectrum);

impl Constant {
    /// Reads `value`.
    pub fn build(params: &Params<'_>, _: &Place) -> Result<Self> {
        params.color("value", 1.0).map(Self)
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        vec![Self(Spectrum::splat(0.3)), Self(Spectrum::new(0.0, 1.0, 1e3))]
    }
}

impl VolumeModel for Constant {
    #[inline]
    fn eval<L: Lanes>(&self, _: Vec3) -> L {
        L::from_spectrum(self.0)
    }

    fn range(&self, _: Vec3, _: Vec3) -> [Spectrum; 2] {
        [self.0; 2]
    }

    fn domain(&self) -> Option<[Vec3; 2]> {
        None
    }

    fn is_grey(&self) -> bool {
        self.0.is_grey()
    }

    fn has_integral(&self) -> bool {
        true
    }

    fn integral<L: Lanes>(&self, section: &Section) -> L {
        L::from_spectrum(self.0).scaled(section.length)
    }
}
