//! `product`: the values of nested volumes, multiplied: a shape times a texture.

use super::{NESTED, Place, Volume, VolumeModel, all_at_time, build, nested_in};
use crate::{
    description::{Object, Params, Table, table},
    error::Result,
    math::{Channels, DVec3, RaySegment, Spectrum, Vec3},
};
use std::sync::Arc;

/// A product. It has an integral if at most one factor varies and that one has.
#[derive(Clone, Debug)]
pub struct Product {
    /// All that does not vary.
    constant: Spectrum,
    factors: Arc<[Volume]>,
    /// An albedo whose complement, 1 - albedo, is a factor too. Like any albedo it is evaluated everywhere.
    albedo: Option<Arc<Volume>>,
}

impl Product {
    pub(super) const TABLE: Table =
        table! { "The product of nested volumes, such as a shape and a texture."; ; NESTED };

    pub(super) fn build(params: &Params<'_>, place: &Place) -> Result<Self> {
        let (constants, varying): (Vec<_>, Vec<_>) =
            nested_in(params)?.into_iter().partition(|object| object.plugin == "constvolume");
        let built = |objects: Vec<&Object>, place: &Place| {
            objects.into_iter().map(|object| build(object, params.library, place)).collect::<Result<Vec<_>>>()
        };
        let alone = varying.len() == 1;
        let constants = built(constants, place)?;
        let factor = Self::new(constants.clone()).constant.max_element();
        // Of several that vary nobody knows what each may be.
        let most = if alone && factor > 0.0 { place.most / factor } else { f32::INFINITY };
        Ok(Self::new([constants, built(varying, &place.up_to(most))?].concat()))
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
        Self { constant, factors: factors.into(), albedo: None }
    }

    /// `sigma_t` times 1 - `albedo`.
    pub(super) fn absorbed(sigma_t: Volume, albedo: Volume) -> Self {
        match albedo {
            Volume::Constant(constant) => Self::new(vec![sigma_t, Volume::Constant(constant.complement())]),
            varying => Self { albedo: Some(Arc::new(varying)), ..Self::new(vec![sigma_t]) },
        }
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
            Self::absorbed(wave(6), wave(4)),
            Self::absorbed(wave(6), constant(Spectrum::splat(0.25))),
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
    fn eval<L: Channels>(&self, position: Vec3) -> L {
        let constant = L::from_spectrum(self.constant);
        let product = self.factors.iter().fold(constant, |product, factor| product * factor.inside(position));
        match &self.albedo {
            None => product,
            Some(albedo) => {
                let rest = Spectrum::ONE - albedo.eval::<L>(position).to_spectrum();
                product * L::from_spectrum(rest)
            }
        }
    }

    fn range(&self, low: Vec3, high: Vec3) -> [Spectrum; 2] {
        let ranges = self.factors.iter().map(|factor| factor.range_inside(low, high));
        let rest = self.albedo.as_ref().map(|albedo| {
            let [least, most] = albedo.range(low, high);
            [Spectrum::ONE - most, Spectrum::ONE - least]
        });
        // Once it is 0, what else it is made of need not be known.
        let product = ranges.chain(rest).try_fold([self.constant; 2], |product, range| {
            if product == [Spectrum::ZERO; 2] { Err(product) } else { Ok(times(product, range)) }
        });
        let (Ok([least, most]) | Err([least, most])) = product;
        let slack = least.abs().max(most.abs()) * (f32::EPSILON * (2 + self.factors.len()) as f32);
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
        self.constant.is_grey() && self.factors.iter().chain(self.albedo.as_deref()).all(VolumeModel::is_grey)
    }

    fn has_integral(&self) -> bool {
        self.albedo.is_none() && self.factors.len() <= 1 && self.factors.iter().all(VolumeModel::has_integral)
    }

    #[inline]
    fn integral<L: Channels>(&self, segment: &RaySegment) -> L {
        let varying =
            self.factors.first().map_or(L::splat(segment.length), |factor| factor.integral(segment));
        L::from_spectrum(self.constant) * varying
    }

    fn moved(&self, by: DVec3) -> Self {
        let albedo = self.albedo.as_ref().map(|albedo| Arc::new(albedo.moved(by)));
        Self { factors: self.factors.iter().map(|factor| factor.moved(by)).collect(), albedo, ..*self }
    }

    fn at_time(&self, time: f64) -> Option<Self> {
        let factors = all_at_time(&self.factors, time);
        let albedo = self.albedo.as_ref().and_then(|albedo| albedo.at_time(time)).map(Arc::new);
        if factors.is_none() && albedo.is_none() {
            return None;
        }
        let factors = factors.unwrap_or_else(|| Arc::clone(&self.factors));
        Some(Self { factors, albedo: albedo.or_else(|| self.albedo.clone()), ..*self })
    }
}
