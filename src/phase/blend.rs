//! A weighted sum of two phase functions: Mitsuba's `blendphase`, and the two-term functions of P03 eq. 3 and
//! P03T 2.3.4.

use super::{Deflection, HenyeyGreenstein, Phase, PhaseModel, Schlick, build};
use crate::description::{Params, Table, Value, parameter::Parameter, rows, table};
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

/// What functions of two lobes have.
const TERMS: &[Parameter] = rows! {
    number("r", "", within(0.0, 1.0), Required, "Share of the first lobe."),
    number("g1", "", between(-1.0, 1.0), Required, "Asymmetry of the first lobe."),
    number("g2", "", between(-1.0, 1.0), Required, "Asymmetry of the second lobe."),
};

impl Blend {
    /// `weight` in [0, 1] is the share of the second part.
    pub fn new(weight: f32, first: Phase, second: Phase) -> Self {
        Self { weight, parts: Arc::new([first, second]) }
    }

    pub(super) const TABLE: Table = table! {
        "Two phase functions, mixed: (1 - weight) first + weight second.";
        number("weight", "", within(0.0, 1.0), Required, "Share of the second."),
        nested("phase", Required, "The two."),
    };

    pub(super) fn build(params: &Params<'_>) -> Result<Self> {
        let expected = "a number from 0 to 1 (a weight that varies in space is not supported)";
        if let Some(volume @ (Value::Object(_) | Value::Reference(_))) =
            params.given("weight").map(|p| &p.value)
        {
            return Err(params.complain("weight", expected, volume.describe()));
        }
        let weight = params.float("weight")? as f32;
        match params.children("phase", |child| child.name != "weight")?.as_slice() {
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

    pub(super) const HG_TABLE: Table = table! {
    "Two of Henyey and Greenstein's, mixed: r hg(g1) + (1 - r) hg(g2) (P03 eq. 3)."; ; TERMS };

    pub(super) const SCHLICK_TABLE: Table = table! {
    "Two of Schlick's, mixed (P03T 2.3.4); r, g1, g2 as Blasi et al. fit them: Rayleigh's 0.5, -0.46, 0.46, haze 0.12, -0.5, 0.7, murk 0.19, -0.65, 0.91."; ; TERMS };

    pub(super) fn two_term_hg(params: &Params<'_>) -> Result<Self> {
        Self::two_term(params, |g| HenyeyGreenstein::new(g).into())
    }

    pub(super) fn two_term_schlick(params: &Params<'_>) -> Result<Self> {
        Self::two_term(params, |g| Schlick::new(g).into())
    }

    fn two_term(params: &Params<'_>, term: fn(f64) -> Phase) -> Result<Self> {
        let first = params.float("r")?;
        Ok(Self::new((1.0 - first) as f32, term(params.float("g1")?), term(params.float("g2")?)))
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
