//! `product`: the values of nested volumes, multiplied: a shape times a texture.

use super::{Place, Volume, VolumeModel, nested};
use crate::{
    description::Params,
    error::Result,
    math::{Lanes, Section, Spectrum, Vec3},
};
use std::sync::Arc;

/// A product. It has an integral if at most one factor varies and that one has.
#[derive(Clone, Debug)]
pub struct Product {
    /// All that does not vary.
    constant: Spectrum,
    factors: Arc<[Volume]>,
}

impl Product {
    pub(super) fn build(params: &Params<'_>, place: &Place) -> Result<Self> {
        nested(params, place).map(Self::new)
    }

    pub(super) fn new(all: Vec<Volume>) -> Self {
        let (mut constant, mut factors) = (Spectrum::ONE, Vec::new());
        for factor in all {
            match factor {
                Volume::Constant(_) => {
                    constant *= factor.eval::<Spectrum>(Vec3::ZERO);
                }
                _ => factors.push(factor),
            }
        }
        Self { constant, factors: factors.into() }
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        let constant = |c| Volume::Constant(super::Constant::new(c, [Vec3::ZERO, Vec3::ONE]));
        let red = constant(Spectrum::new(0.5, 0.2, 0.1));
        let wave = |i: usize| Volume::Cosine(super::Cosine::examples().swap_remove(i));
        let fog = Volume::Exponential(super::Exponential::examples().remove(1));
        vec![
            Self::new(vec![wave(3), wave(6)]),
            Self::new(vec![red.clone(), fog, constant(Spectrum::splat(3.0))]),
            Self::new(vec![red]),
            Self::new(vec![wave(6), wave(4)]),
        ]
    }
}

/// Bounds of a product of two numbers, channel by channel.
fn times([a, b]: [Spectrum; 2], [c, d]: [Spectrum; 2]) -> [Spectrum; 2] {
    let (p, q, r, s) = (a * c, a * d, b * c, b * d);
    [p.min(q).min(r.min(s)), p.max(q).max(r.max(s))]
}

impl VolumeModel for Product {
    #[inline]
    fn eval<L: Lanes>(&self, position: Vec3) -> L {
        let constant = L::from_spectrum(self.constant);
        self.factors.iter().fold(constant, |product, factor| product * factor.inside(position))
    }

    fn range(&self, low: Vec3, high: Vec3) -> [Spectrum; 2] {
        let ranges = self.factors.iter().map(|factor| factor.range_inside(low, high));
        let [least, most] = ranges.fold([self.constant; 2], times);
        let slack = least.abs().max(most.abs()) * (f32::EPSILON * (1 + self.factors.len()) as f32);
        [least - slack, most + slack]
    }

    /// Where the domains of all factors are; an empty box where they have nothing in common.
    fn domain(&self) -> Option<[Vec3; 2]> {
        let domains = self.factors.iter().filter_map(VolumeModel::domain);
        let [low, high] = domains.reduce(|[a, b], [c, d]| [a.max(c), b.min(d)])?;
        Some([low, high.max(low)])
    }

    fn is_grey(&self) -> bool {
        use crate::math::SpectrumExt;
        self.constant.is_grey() && self.factors.iter().all(VolumeModel::is_grey)
    }

    fn has_integral(&self) -> bool {
        self.factors.len() <= 1 && self.factors.iter().all(VolumeModel::has_integral)
    }

    #[inline]
    fn integral<L: Lanes>(&self, section: &Section) -> L {
        let varying =
            self.factors.first().map_or(L::splat(section.length), |factor| factor.integral(section));
        L::from_spectrum(self.constant) * varying
    }
}
