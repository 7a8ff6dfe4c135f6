//! `wind`: a nested volume that drifts with `velocity` [m/s], from where it stands at the time 0 to where it is at the
//! scene's `time` [s] (BMA02 5). What stands beside it, in a sum, stays.

use super::{Place, Volume, VolumeModel, nested, placed::vector};
use crate::{
    description::Params,
    error::{Error, Result},
    math::{Lanes, Section, Spectrum, Vec3},
};
use std::sync::Arc;

/// A volume that has drifted: it was built where it is now, so that wind costs nothing.
#[derive(Clone, Debug)]
pub struct Wind(Arc<Volume>);

impl Wind {
    pub(super) fn build(params: &Params<'_>, place: &Place) -> Result<Self> {
        let velocity = vector(params, "velocity")?;
        let moved = Place { recentre: place.recentre - velocity * place.time, ..*place };
        let [inner] = <[Volume; 1]>::try_from(nested(params, &moved)?).map_err(|several| {
            Error::new(
                params.location(),
                "one nested volume",
                several.len().to_string(),
                "put them into a sum, or each into a wind of its own",
            )
        })?;
        Ok(Self(Arc::new(inner)))
    }

    /// What drifts.
    #[inline]
    pub(super) fn nested(&self) -> &Volume {
        &self.0
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        super::Cosine::examples()
            .into_iter()
            .take(2)
            .map(|wave| Self(Arc::new(Volume::Cosine(wave))))
            .collect()
    }
}

impl VolumeModel for Wind {
    #[inline]
    fn eval<L: Lanes>(&self, position: Vec3) -> L {
        self.0.eval(position)
    }

    #[inline]
    fn contains(&self, position: Vec3) -> bool {
        self.0.contains(position)
    }

    fn range(&self, low: Vec3, high: Vec3) -> [Spectrum; 2] {
        self.0.range(low, high)
    }

    fn domain(&self) -> Option<[Vec3; 2]> {
        self.0.domain()
    }

    fn is_grey(&self) -> bool {
        self.0.is_grey()
    }

    fn has_integral(&self) -> bool {
        self.0.has_integral()
    }

    #[inline]
    fn integral<L: Lanes>(&self, section: &Section) -> L {
        self.0.integral(section)
    }
}
