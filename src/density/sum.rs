//! `sum`: the values of nested volumes, added (BMA02 eq. 7). What takes away is a function with negative values.

use super::{Constant, Place, Product, Volume, VolumeModel, all_at_time, nested};
use crate::{
    description::Params,
    error::Result,
    math::{DVec3, Lanes, Section, Spectrum, Vec3},
};
use std::sync::Arc;

/// A sum. Each term has a place and a factor of its own.
#[derive(Clone, Debug)]
pub struct Sum {
    terms: Arc<[Volume]>,
    /// Terms count outside of their domains too, as albedos do.
    everywhere: bool,
}

/// One value everywhere, of which nobody asks what it fills.
fn everywhere(value: Spectrum) -> Volume {
    Volume::Constant(Constant::new(value, [Vec3::ZERO; 2]))
}

/// The value of `term`, which is nothing outside of it.
#[inline]
fn inside<L: Lanes>(term: &Volume, position: Vec3) -> L {
    if term.contains(position) { term.eval(position) } else { L::splat(0.0) }
}

/// Bounds of [`inside`].
fn range_inside(term: &Volume, low: Vec3, high: Vec3) -> [Spectrum; 2] {
    let [least, most] = term.range(low, high);
    match term.domain() {
        Some([a, b]) if !(a.cmple(low).all() && high.cmple(b).all()) => {
            [least.min(Spectrum::ZERO), most.max(Spectrum::ZERO)]
        }
        _ => [least, most],
    }
}

impl Sum {
    pub(super) fn build(params: &Params<'_>, place: &Place) -> Result<Self> {
        nested(params, place).map(Self::new)
    }

    pub(super) fn new(terms: Vec<Volume>) -> Self {
        Self { terms: terms.into(), everywhere: false }
    }

    /// 1 - `albedo`.
    pub(super) fn complement(albedo: Volume) -> Self {
        let less = Product::new(vec![everywhere(-Spectrum::ONE), albedo]);
        let terms = [everywhere(Spectrum::ONE), Volume::Product(less)];
        Self { terms: terms.into(), everywhere: true }
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
            Self::complement(everywhere(Spectrum::new(0.2, 0.5, 1.0))),
        ]
    }
}

impl VolumeModel for Sum {
    #[inline]
    fn eval<L: Lanes>(&self, position: Vec3) -> L {
        let value =
            |term: &Volume| if self.everywhere { term.eval(position) } else { inside(term, position) };
        self.terms.iter().fold(L::splat(0.0), |sum, term| sum + value(term))
    }

    fn range(&self, low: Vec3, high: Vec3) -> [Spectrum; 2] {
        let range = |term: &Volume| {
            if self.everywhere { term.range(low, high) } else { range_inside(term, low, high) }
        };
        let ranges = || self.terms.iter().map(range);
        let [least, most] = ranges().fold([Spectrum::ZERO; 2], |[a, b], [c, d]| [a + c, b + d]);
        // What f32 loses where the terms are greater than their sum.
        let magnitude: Spectrum = ranges().map(|[a, b]| a.abs().max(b.abs())).sum();
        let slack = magnitude * (f32::EPSILON * self.terms.len() as f32);
        [least - slack, most + slack]
    }

    fn domain(&self) -> Option<[Vec3; 2]> {
        let [first, rest @ ..] = &self.terms[..] else { return None };
        rest.iter().try_fold(first.domain()?, |[low, high], term| {
            let [a, b] = term.domain()?;
            Some([low.min(a), high.max(b)])
        })
    }

    fn is_grey(&self) -> bool {
        self.terms.iter().all(VolumeModel::is_grey)
    }

    fn has_integral(&self) -> bool {
        self.terms.iter().all(VolumeModel::has_integral)
    }

    #[inline]
    fn integral<L: Lanes>(&self, section: &Section) -> L {
        self.terms.iter().fold(L::splat(0.0), |sum, term| sum + term.integral(section))
    }

    fn moved(&self, by: DVec3) -> Self {
        Self { terms: self.terms.iter().map(|term| term.moved(by)).collect(), ..*self }
    }

    fn at_time(&self, time: f64) -> Option<Self> {
        all_at_time(&self.terms, time).map(|terms| Self { terms, ..*self })
    }
}
