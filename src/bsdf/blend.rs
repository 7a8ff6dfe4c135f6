//! A mixture of two materials: Mitsuba's `blendbsdf`.

use super::{Bsdf, BsdfModel, BsdfSample, BsdfValue, Transport, bounded, only_nested};
use crate::description::{Params, Table, table};
use crate::error::Result;
use crate::math::{Spectrum, Uv, Vec3};
use crate::sampling::Stream;
use crate::texture::Texture;
use std::sync::Arc;

/// (1 - weight) first + weight second.
///
/// Where one part is smooth and the other is not, Mitsuba 3.9.1 adds the density of the other part to the
/// probability of the Dirac lobe and so loses light (of a mirror under 30% black paint it shows 62% and not
/// 70%). That is not imitated.
#[derive(Clone, Debug)]
pub struct Blend {
    weight: Texture,
    parts: Arc<[Bsdf; 2]>,
    /// Which parts let light get to the other side.
    across: [bool; 2],
}

impl Blend {
    pub(super) const TABLE: Table = table! {
        "A mixture of two BSDFs.";
        texture("weight", 1.0, Required, "Weight of the second."),
        nested("bsdf", Required, "The two BSDFs."),
    };

    pub(super) fn build(params: &Params<'_>) -> Result<Self> {
        let weight = bounded(params, "weight", "")?;
        Ok(Self::new(weight, only_nested(params)?))
    }

    fn new(weight: Texture, parts: [Bsdf; 2]) -> Self {
        let across = [parts[0].scatters_across(), parts[1].scatters_across()];
        Self { weight, parts: Arc::new(parts), across }
    }

    #[inline]
    fn weights(&self, uv: Uv) -> [f32; 2] {
        let second = self.weight.number(uv).clamp(0.0, 1.0);
        [1.0 - second, second]
    }

    /// Survival of part `i`; if light crosses the surface, that of the side with more. A part that lets light across
    /// survives alike on both: evaluating it twice would double the cost at every depth of blends.
    #[inline]
    fn survival_of(&self, i: usize, uv: Uv, wi: Vec3) -> f32 {
        let here = self.parts[i].survival(uv, wi);
        if self.across[i] || !self.scatters_across() {
            here
        } else {
            here.max(self.parts[i].survival(uv, -wi))
        }
    }

    /// Probabilities of sampling either part, by the light that it scatters; 0 where none does. Light that passes
    /// straight through is left out.
    #[inline]
    fn choices(&self, uv: Uv, wi: Vec3) -> [f32; 2] {
        let weights = self.weights(uv);
        let kept = |i: usize| {
            let through = self.parts[i].null_transmission(uv, wi.z.abs()).max_element();
            weights[i] * self.parts[i].survival(uv, wi) * (1.0 - through).max(0.0)
        };
        let kept = [kept(0), kept(1)];
        let total = kept[0] + kept[1];
        kept.map(|kept| if kept > 0.0 { kept / total } else { 0.0 })
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        use super::{Conductor, Dielectric, Diffuse, Mask, Null, Plastic, RoughDielectric, ThinDielectric};
        let with = |weight, first: Bsdf, second: Bsdf| {
            Self::new(Texture::constant(Spectrum::splat(weight)), [first, second])
        };
        let grey = |x| Bsdf::from(Diffuse::grey(x));
        let glass = Bsdf::from(Dielectric::examples().swap_remove(0));
        let frosted = Bsdf::from(RoughDielectric::examples().swap_remove(0));
        let pane = Bsdf::from(ThinDielectric::examples().swap_remove(4));
        let plastic = Bsdf::from(Plastic::examples().swap_remove(1));
        let gold = Bsdf::from(Conductor::examples().swap_remove(1));
        let masked = Bsdf::from(Mask::examples().swap_remove(0));
        let inner = Bsdf::from(with(0.5, grey(0.9), glass.clone()));
        vec![
            with(0.25, grey(0.5), grey(0.9)),
            with(0.5, grey(0.8), glass),
            with(0.4, frosted.clone(), plastic.clone()),
            with(0.5, pane, grey(0.6)),
            with(0.3, gold.clone(), plastic),
            with(0.2, Null.into(), frosted),
            with(0.5, masked, inner),
            with(1.0, gold, grey(0.3)),
        ]
    }
}

impl BsdfModel for Blend {
    #[inline]
    fn evaluate(&self, uv: Uv, wi: Vec3, wo: Vec3, transport: Transport) -> BsdfValue {
        let weights = self.weights(uv);
        let (there, back) = (self.choices(uv, wi), self.choices(uv, wo));
        let part = |i: usize| {
            let BsdfValue { value, pdf_fwd, pdf_rev } = self.parts[i].evaluate(uv, wi, wo, transport);
            (value * weights[i], pdf_fwd * there[i], pdf_rev * back[i])
        };
        let (first, second) = (part(0), part(1));
        BsdfValue { value: first.0 + second.0, pdf_fwd: first.1 + second.1, pdf_rev: first.2 + second.2 }
    }

    /// A Dirac lobe belongs to its part alone; of the rest either part could have made the sample.
    #[inline]
    fn sample(&self, uv: Uv, wi: Vec3, transport: Transport, stream: &mut Stream) -> Option<BsdfSample> {
        let choices = self.choices(uv, wi);
        let chosen = usize::from(stream.uniform() >= choices[0]);
        if choices[chosen] <= 0.0 {
            return None;
        }
        let sample = self.parts[chosen].sample(uv, wi, transport, stream)?;
        if !sample.dirac {
            return self.evaluate(uv, wi, sample.wo, transport).sampled(sample.wo);
        }
        let (choice, back) = (choices[chosen], self.choices(uv, sample.wo)[chosen]);
        Some(BsdfSample {
            weight: sample.weight * (self.weights(uv)[chosen] / choice),
            pdf_fwd: sample.pdf_fwd * choice,
            pdf_rev: sample.pdf_rev * back,
            ..sample
        })
    }

    /// The mean of both parts. Where some light passes straight through, their shares of the rest depend on the
    /// direction, and the greater survival counts.
    #[inline]
    fn survival(&self, uv: Uv, wi: Vec3) -> f32 {
        let weights = self.weights(uv);
        let part = |i: usize| if weights[i] > 0.0 { self.survival_of(i, uv, wi) } else { 0.0 };
        let [first, second] = [part(0), part(1)];
        if self.has_null() { first.max(second) } else { weights[0] * first + weights[1] * second }
    }

    #[inline]
    fn null_transmission(&self, uv: Uv, cosine: f32) -> Spectrum {
        let weights = self.weights(uv);
        let part = |i: usize| self.parts[i].null_transmission(uv, cosine) * weights[i];
        part(0) + part(1)
    }

    fn is_connectible(&self) -> bool {
        self.parts.iter().any(BsdfModel::is_connectible)
    }

    fn has_dirac(&self) -> bool {
        self.parts.iter().any(BsdfModel::has_dirac)
    }

    fn has_null(&self) -> bool {
        self.parts.iter().any(BsdfModel::has_null)
    }

    #[inline]
    fn albedo(&self, uv: Uv, wi: Vec3) -> Spectrum {
        let [first, second] = self.weights(uv);
        self.parts[0].albedo(uv, wi) * first + self.parts[1].albedo(uv, wi) * second
    }

    fn scatters_across(&self) -> bool {
        self.across != [false, false]
    }
}
