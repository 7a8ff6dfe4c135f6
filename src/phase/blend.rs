//! A weighted sum of two phase functions: Mitsuba's `blendphase`, and the two-term functions of P03 eq. 3 and
//! P03T 2.3.4.

use super::{Deflection, HenyeyGreenstein, Phase, PhaseModel, Schlick, asymmetry, build, required};
use crate::description::{Params, Value};
use crate::error::{Error, Result};
use crate::math::Vec3;
use crate::sampling::Stream;
use std::sync::Arc;

/// (1 - weight) first + weight second.
#[derive(Clone, Debug)]
pub struct Blend {
    weight: f32,
    parts: Arc<[Phase; 2]>,
}

impl Blend {
    /// `weight` in [0, 1] is the share of the second part.
    pub fn new(weight: f32, first: Phase, second: Phase) -> Self {
        Self { weight, parts: Arc::new([first, second]) }
    }

    pub(super) fn build(params: &Params<'_>) -> Result<Self> {
        let expected = "a number from 0 to 1 (a weight that varies in space is not supported)";
        match params.property("weight").map(|weight| &weight.value) {
            None => return Err(params.missing("weight", expected)),
            Some(volume @ (Value::Object(_) | Value::Reference(_))) => {
                return Err(params.complain("weight", expected, volume.describe()));
            }
            Some(_) => {}
        }
        let weight = params.float_within("weight", 0.5, 0.0, 1.0)? as f32;
        match params.children(|child| child.name != "weight")?.as_slice() {
            [first, second] => {
                let part = |object| build(object, params.library);
                Ok(Self::new(weight, part(first.object)?, part(second.object)?))
            }
            others => Err(Error::new(
                params.location(),
                "two nested phase functions",
                format!("{}", others.len()),
                "give exactly two; a blend of three is a blend with a nested blend",
            )),
        }
    }

    /// Two Henyey & Greenstein functions: r of asymmetry g1 and 1 - r of g2.
    pub(super) fn two_term_hg(params: &Params<'_>) -> Result<Self> {
        Self::two_term(params, |g| HenyeyGreenstein::new(g).into())
    }

    /// The same of Schlick's functions.
    pub(super) fn two_term_schlick(params: &Params<'_>) -> Result<Self> {
        Self::two_term(params, |g| Schlick::new(g).into())
    }

    fn two_term(params: &Params<'_>, term: fn(f64) -> Phase) -> Result<Self> {
        required(params, "r", "the share of the first term, a number from 0 to 1")?;
        let first = params.float_within("r", 0.5, 0.0, 1.0)?;
        let asymmetry = |name| {
            required(params, name, "a number between -1 and 1")?;
            asymmetry(params, name, 0.0)
        };
        Ok(Self::new((1.0 - first) as f32, term(asymmetry("g1")?), term(asymmetry("g2")?)))
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        use super::{HenyeyGreenstein, Isotropic, Rayleigh};
        let hg = |g| Phase::HenyeyGreenstein(HenyeyGreenstein::new(g));
        let inner = Self::new(0.25, hg(0.9), hg(-0.5));
        vec![
            Self::new(0.0, hg(0.5), Phase::Isotropic(Isotropic)),
            Self::new(1.0, hg(0.5), Phase::Isotropic(Isotropic)),
            inner.clone(),
            Self::new(0.7, Phase::Blend(inner), Phase::Rayleigh(Rayleigh)),
        ]
    }
}

impl PhaseModel for Blend {
    #[inline]
    fn pdf_sr(&self, turn: Deflection) -> f32 {
        let [first, second] = &*self.parts;
        first.pdf_sr(turn) * (1.0 - self.weight) + second.pdf_sr(turn) * self.weight
    }

    #[inline]
    fn sample(&self, direction: Vec3, stream: &mut Stream) -> Vec3 {
        let chosen = usize::from(stream.uniform() < self.weight);
        self.parts[chosen].sample(direction, stream)
    }

    fn mean_cosine(&self) -> f32 {
        let [first, second] = &*self.parts;
        first.mean_cosine() * (1.0 - self.weight) + second.mean_cosine() * self.weight
    }
}
