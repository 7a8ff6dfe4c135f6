//! `wind`: a nested volume that drifts with `velocity` (m/s), from its place at the time 0 to its place at the scene's
//! `time` (s) (BMA02 5). Other terms of a sum stay. A velocity that changes in time counts by its mean since 0, which
//! carries as far.

use super::{Place, Volume, VolumeModel, nested};
use crate::{
    description::{Params, Table, table},
    error::{Error, Result},
    math::{Channels, DVec3, RaySegment, Spectrum, Vec3},
};
use std::sync::Arc;

/// A volume that has drifted: it is made where it is now, so that wind costs nothing.
#[derive(Clone, Debug)]
pub struct Wind {
    now: Arc<Volume>,
    /// As it was built.
    built: Arc<Volume>,
    /// When that was (s).
    built_at: f64,
    /// (m/s)
    velocity: DVec3,
}

impl Wind {
    pub(super) const TABLE: Table = table! {
        "A nested volume that drifts; at `time` 0 it is in its place.";
        vector("velocity", "m/s", Required, "Velocity; keyframes are integrated from time 0."),
        nested("volume", Required, "The volume."),
    };

    pub(super) fn build(params: &Params<'_>, place: &Place) -> Result<Self> {
        let velocity = params.vector("velocity")?;
        let moved = Place { recentre: place.recentre - velocity * place.time, ..*place };
        let [inner] = <[Volume; 1]>::try_from(nested(params, &moved)?).map_err(|several| {
            Error::new(
                params.location(),
                "one nested volume",
                several.len().to_string(),
                "put them into a sum, or each into its own wind",
            )
        })?;
        Ok(Self::new(inner, velocity, place.time))
    }

    /// `volume` is placed as at the time `built_at`.
    fn new(volume: Volume, velocity: DVec3, built_at: f64) -> Self {
        let built = Arc::new(volume);
        Self { now: Arc::clone(&built), built, built_at, velocity }
    }

    /// What drifts.
    #[inline]
    pub(super) fn nested(&self) -> &Volume {
        &self.now
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        let waves = super::Cosine::examples().into_iter().take(2);
        let wind = |wave| Self::new(Volume::Cosine(wave), DVec3::new(1.0, -0.5, 0.25), 1.0);
        let still: Vec<_> = waves.map(wind).collect();
        let drifted: Vec<_> = still.iter().filter_map(|wind| wind.at_time(2.5)).collect();
        [still, drifted].concat()
    }
}

impl VolumeModel for Wind {
    #[inline]
    fn eval<L: Channels>(&self, position: Vec3) -> L {
        self.now.eval(position)
    }

    fn range(&self, low: Vec3, high: Vec3) -> [Spectrum; 2] {
        self.now.range(low, high)
    }

    fn domain(&self) -> Option<[Vec3; 2]> {
        self.now.domain()
    }

    #[inline]
    fn contains(&self, position: Vec3) -> bool {
        self.now.contains(position)
    }

    fn is_grey(&self) -> bool {
        self.now.is_grey()
    }

    fn has_integral(&self) -> bool {
        self.now.has_integral()
    }

    #[inline]
    fn integral<L: Channels>(&self, segment: &RaySegment) -> L {
        self.now.integral(segment)
    }

    fn moved(&self, by: DVec3) -> Self {
        let [now, built] = [&self.now, &self.built].map(|volume| Arc::new(volume.moved(by)));
        Self { now, built, ..*self }
    }

    fn at_time(&self, time: f64) -> Option<Self> {
        let inner = self.built.at_time(time);
        if inner.is_none() && self.velocity == DVec3::ZERO {
            return None;
        }
        let drift = self.velocity * (time - self.built_at);
        let now = Arc::new(inner.as_ref().unwrap_or(&self.built).moved(drift));
        Some(Self { now, built: Arc::clone(&self.built), ..*self })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::vec3;

    /// The clouds of `examples` at their own time.
    fn clouds() -> Vec<Wind> {
        Wind::examples().into_iter().take(2).collect()
    }

    #[test]
    fn a_cloud_is_where_the_wind_took_it() {
        for still in clouds() {
            let later = still.at_time(5.0).unwrap();
            let back = later.at_time(1.0).unwrap();
            for position in [vec3(0.3, 0.1, -0.2), vec3(-0.5, 0.25, 0.125), Vec3::ZERO] {
                let moved = position + vec3(4.0, -2.0, 1.0);
                let (before, after): (Spectrum, Spectrum) = (still.eval(position), later.eval(moved));
                assert!((before - after).abs().max_element() < 1e-5, "{before} {after}");
                assert_eq!(back.eval::<Spectrum>(position), before);
            }
            let boxes = (still.domain(), later.domain());
            if let (Some([low, _]), Some([moved, _])) = boxes {
                assert!((moved - low - vec3(4.0, -2.0, 1.0)).abs().max_element() < 1e-5);
            }
        }
    }

    #[test]
    fn what_drifts_drifts_within_sums_and_products_and_what_does_not_stays() {
        let cloud = Volume::Wind(clouds().remove(0));
        let ground = Volume::Cosine(super::super::Cosine::examples().remove(0));
        let (at, by) = (vec3(0.3, 0.1, -0.2), vec3(4.0, -2.0, 1.0));
        let sum = Volume::Sum(super::super::Sum::new(vec![cloud.clone(), ground.clone()]));
        let later = sum.at_time(5.0).unwrap();
        let expected = cloud.eval::<Spectrum>(at - by) + ground.eval::<Spectrum>(at);
        assert!((later.eval::<Spectrum>(at) - expected).abs().max_element() < 1e-5);
        let product = Volume::Product(super::super::Product::new(vec![cloud.clone(), ground.clone()]));
        let later = product.at_time(5.0).unwrap();
        let expected = cloud.eval::<Spectrum>(at - by) * ground.eval::<Spectrum>(at);
        assert!((later.eval::<Spectrum>(at) - expected).abs().max_element() < 1e-5);
        assert!(Volume::Product(super::super::Product::new(vec![ground.clone()])).at_time(5.0).is_none());
        assert!(ground.at_time(5.0).is_none());
    }

    #[test]
    fn a_wind_of_no_speed_moves_nothing_but_what_moves_in_it() {
        let calm = |inner| Wind::new(inner, DVec3::ZERO, 0.0);
        let ground = Volume::Cosine(super::super::Cosine::examples().remove(0));
        assert!(calm(ground).at_time(2.0).is_none());
        let inner = clouds().remove(0);
        let later = calm(Volume::Wind(inner.clone())).at_time(2.0).unwrap();
        let at = vec3(0.1, 0.2, 0.3);
        assert_eq!(later.eval::<Spectrum>(at), inner.at_time(2.0).unwrap().eval::<Spectrum>(at));
    }
}
