//! `constvolume`: one value everywhere. As the extinction of a medium it fills the unit cube of `to_world`, as in
//! Mitsuba.

use super::{Place, VolumeModel};
use crate::{
    description::{Params, Table, table},
    error::Result,
    math::{Channels, DVec3, RaySegment, Spectrum, SpectrumExt, Vec3, boxes},
};

/// One value.
#[derive(Clone, Debug)]
pub struct Constant {
    value: Spectrum,
    cube: [Vec3; 2],
}

impl Constant {
    pub(super) const TABLE: Table = table! {
        "A constant. As `sigma_t` it fills only the unit cube of `to_world`, as in Mitsuba.";
        colour("value", "", f64::INFINITY, Is(1.0), "The value."),
        transform("to_world", "Places the unit cube."),
    };

    /// Reads `value` and `to_world`.
    pub fn build(params: &Params<'_>, place: &Place) -> Result<Self> {
        let to_world = place.to_world(params)?;
        let [low, high] = boxes::image(&to_world, [DVec3::ZERO, DVec3::ONE]).map(|corner| corner.as_vec3());
        Ok(Self::new(params.color("value")?, [low, high]))
    }

    /// `value`, and the box that it fills as an extinction.
    pub fn new(value: Spectrum, cube: [Vec3; 2]) -> Self {
        Self { value, cube }
    }

    /// The world box around the unit cube.
    pub fn cube(&self) -> [Vec3; 2] {
        self.cube
    }

    /// 1 - the value.
    pub fn complement(&self) -> Self {
        Self::new(Spectrum::ONE - self.value, self.cube)
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        let cube = [Vec3::ZERO, Vec3::ONE];
        vec![Self::new(Spectrum::splat(0.3), cube), Self::new(Spectrum::new(0.0, 1.0, 1e3), cube)]
    }
}

impl VolumeModel for Constant {
    #[inline]
    fn eval<L: Channels>(&self, _: Vec3) -> L {
        L::from_spectrum(self.value)
    }

    fn range(&self, _: Vec3, _: Vec3) -> [Spectrum; 2] {
        [self.value; 2]
    }

    fn domain(&self) -> Option<[Vec3; 2]> {
        None
    }

    fn is_grey(&self) -> bool {
        self.value.is_grey()
    }

    fn has_integral(&self) -> bool {
        true
    }

    fn integral<L: Channels>(&self, segment: &RaySegment) -> L {
        L::from_spectrum(self.value).scaled(segment.length)
    }

    fn moved(&self, by: DVec3) -> Self {
        Self::new(self.value, self.cube.map(|corner| (corner.as_dvec3() + by).as_vec3()))
    }
}
