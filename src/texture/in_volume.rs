//! A volume where a surface passes through it: Mitsuba's `volume`.

use super::TextureModel;
use crate::description::{Params, Table, table};
use crate::error::Result;
use crate::math::{Spectrum, Uv, Vec3};
use crate::volume::{self, Place, Volume, VolumeModel};
use std::sync::Arc;

/// The volume at the surface's world position.
#[derive(Clone, Debug)]
pub struct InVolume(Arc<Volume>);

/// Where bounds are looked for of volumes that have no end (m).
const FAR: f32 = 1e6;

impl InVolume {
    pub(super) const TABLE: Table = table! {
        "A volume, looked up where the surface passes through it.";
        volume("volume", "", f64::INFINITY, Required, "The volume."),
    };

    pub(super) fn build(params: &Params<'_>, _: f32) -> Result<Self> {
        let (recentre, time) = params.library.place.get();
        volume::parameter(params, "volume", &Place::new(recentre, time)).map(|volume| Self(Arc::new(volume)))
    }

    fn range(&self) -> [Spectrum; 2] {
        let [low, high] = self.0.domain().unwrap_or([Vec3::splat(-FAR), Vec3::splat(FAR)]);
        self.0.range(low, high)
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        let even = volume::Constant::new(Spectrum::splat(0.3), [Vec3::ZERO, Vec3::ONE]);
        vec![Self(Arc::new(Volume::Constant(even)))]
    }
}

impl TextureModel for InVolume {
    fn eval(&self, uv: Uv) -> Spectrum {
        let Uv::Known(detail) = uv else { return self.mean() };
        self.0.eval(detail.position)
    }

    fn max(&self) -> Spectrum {
        self.range()[1]
    }

    fn mean(&self) -> Spectrum {
        let [low, high] = self.range();
        low.midpoint(high)
    }
}
