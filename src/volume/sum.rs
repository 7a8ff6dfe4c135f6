//! `sum`: the values of nested volumes, added (BMA02 eq. 7). What takes away is a function with negative values.

use super::{NESTED, Place, Volume, VolumeModel, all_at_time, nested};
use crate::{
    description::{Params, Table, table},
    error::Result,
    math::{Channels, DVec3, RaySegment, Spectrum, Vec3},
};
use std::sync::Arc;

/// A sum. Each term has a place and a factor of its own.
#[derive(Clone, Debug)]
pub struct Sum(Arc<[Volume]>);

impl Sum {
    pub(super) const TABLE: Table = table! { "The sum of nested volumes."; ; NESTED };

    pub(super) fn build(params: &Params<'_>, place: &Place) -> Result<Self> {
        nested(params, place).map(Self::of)
    }

    /// Terms that add nothing cost nothing.
    fn of(mut terms: Vec<Volume>) -> Self {
        match terms.iter().any(|term| !term.is_zero()) {
            true => terms.retain(|term| !term.is_zero()),
            false => terms.truncate(1),
        }
        Self(terms.into())
    }

    #[cfg(test)]
    pub(super) fn new(terms: Vec<Volume>) -> Self {
        Self(terms.into())
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        let (all, fogs) = (super::Equipotential::examples(), super::Exponential::examples());
        let potentials = all.into_iter().map(Volume::Equipotential).take(6).collect();
        let noise = super::Noise::examples().remove(0);
        let fog = |i: usize| Volume::Exponential(fogs[i].clone());
        vec![
            Self::new(potentials),
            Self::new(vec![fog(0), Volume::Noise(noise), fog(1)]),
            Self::new(vec![fog(1)]),
        ]
    }
}

impl VolumeModel for Sum {
    #[inline]
    fn eval<L: Channels>(&self, position: Vec3) -> L {
        self.0.iter().fold(L::splat(0.0), |sum, term| sum + term.inside(position))
    }

    fn range(&self, low: Vec3, high: Vec3) -> [Spectrum; 2] {
        let ranges = || self.0.iter().map(|term| term.range_inside(low, high));
        let [least, most] = ranges().fold([Spectrum::ZERO; 2], |[a, b], [c, d]| [a + c, b + d]);
        // What f32 loses where the terms are greater than their sum.
        let magnitude: Spectrum = ranges().map(|[a, b]| a.abs().max(b.abs())).sum();
        let slack = magnitude * (f32::EPSILON * self.0.len() as f32);
        [least - slack, most + slack]
    }

    fn is_zero(&self) -> bool {
        self.0.iter().all(VolumeModel::is_zero)
    }

    fn domain(&self) -> Option<[Vec3; 2]> {
        let [first, rest @ ..] = &self.0[..] else { return None };
        rest.iter().try_fold(first.domain()?, |[low, high], term| {
            let [a, b] = term.domain()?;
            Some([low.min(a), high.max(b)])
        })
    }

    fn is_grey(&self) -> bool {
        self.0.iter().all(VolumeModel::is_grey)
    }

    fn has_integral(&self) -> bool {
        self.0.iter().all(VolumeModel::has_integral)
    }

    #[inline]
    fn integral<L: Channels>(&self, segment: &RaySegment) -> L {
        self.0.iter().fold(L::splat(0.0), |sum, term| sum + term.integral(segment))
    }

    fn moved(&self, by: DVec3) -> Self {
        Self(self.0.iter().map(|term| term.moved(by)).collect())
    }

    fn at_time(&self, time: f64) -> Option<Self> {
        all_at_time(&self.0, time).map(Self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        description::{Library, Value},
        testing::object,
    };

    #[test]
    fn terms_of_nothing_are_left_out() {
        let place = Place::new(DVec3::ZERO, 0.0);
        let fog = |value: f64| {
            let wave =
                object("exponential", &[("height", Value::Float(1.0)), ("value", Value::Float(value))]);
            super::super::build(&wave, &Library::default(), &place).unwrap()
        };
        assert_eq!(Sum::of(vec![fog(0.0), fog(0.5), fog(0.0)]).0.len(), 1);
        let nothing = Sum::of(vec![fog(0.0), fog(0.0)]);
        assert!(nothing.is_zero() && nothing.eval::<Spectrum>(Vec3::ONE) == Spectrum::ZERO);
    }
}
