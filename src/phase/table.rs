//! A tabulated phase function, linear between its entries: Mitsuba's `tabphase`.

use super::{Deflection, PhaseModel, deflect};
use crate::description::{self, Params, table};
use crate::error::Result;
use crate::math::{Vec3, warp};
use crate::sampling::{Discrete, Stream};
use std::f64::consts::TAU;
use std::sync::Arc;

/// Values at cosines spaced evenly from -1 (straight back, the first entry) to 1 (straight on, the last).
#[derive(Clone, Debug)]
pub struct Table(Arc<Entries>);

#[derive(Debug)]
struct Entries {
    /// Normalised to 1 over the sphere (1/sr).
    values: Vec<f32>,
    /// The sections between neighbouring entries, by their share.
    sections: Discrete,
    mean_cosine: f32,
}

impl Table {
    /// Any overall scale; at least two entries, finite and >= 0, not all 0.
    pub fn new(values: &[f64]) -> Self {
        let width = 2.0 / (values.len() - 1) as f64;
        let pairs = || values.iter().zip(&values[1..]);
        let sections = Discrete::new(pairs().map(|(a, b)| 0.5 * (a + b) * width));
        // Simpson's rule is exact on each section: the integrand, cos times the value, is quadratic.
        let moment = |(i, (a, b)): (usize, (&f64, &f64))| {
            let c = -1.0 + i as f64 * width;
            width / 6.0 * (a * c + (a + b) * (2.0 * c + width) + b * (c + width))
        };
        let mean_cosine = (pairs().enumerate().map(moment).sum::<f64>() / sections.total()) as f32;
        let scale = 1.0 / (TAU * sections.total());
        let values = values.iter().map(|v| (v * scale) as f32).collect();
        Self(Arc::new(Entries { values, sections, mean_cosine }))
    }

    pub(super) const TABLE: description::Table = table! {
        "Values at equal steps of the cosine, from straight back to straight on, interpolated linearly.";
        text("values", "a string of comma-separated numbers", Required, "Two or more numbers >= 0 on any scale."),
    };

    pub(super) fn build(params: &Params<'_>) -> Result<Self> {
        let text = params.string("values")?;
        let words = text.split([',', ' ', '\n', '\t']).filter(|word| !word.is_empty());
        let values = words.map(|word| entry(params, word)).collect::<Result<Vec<f64>>>()?;
        let sum: f64 = values.iter().sum();
        if values.len() >= 2 && sum > 0.0 && sum.is_finite() {
            return Ok(Self::new(&values));
        }
        let found = format!("{} with the sum {sum}", values.len());
        Err(params.complain("values", "at least two numbers with a finite sum > 0", found))
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        let tables: [&[f64]; 4] =
            [&[1.0, 1.0], &[0.5, 1.0, 1.5, 3.0], &[2.0, 0.0, 0.0, 5.0], &[0.0, 1.0, 0.0]];
        tables.map(Self::new).to_vec()
    }
}

fn entry(params: &Params<'_>, word: &str) -> Result<f64> {
    match word.parse::<f64>() {
        Ok(value) if value.is_finite() && value >= 0.0 => Ok(value),
        _ => Err(params.complain("values", "numbers >= 0, separated by commas", format!("\"{word}\""))),
    }
}

impl PhaseModel for Table {
    #[inline]
    fn pdf_sr(&self, turn: Deflection) -> f32 {
        let values = &self.0.values;
        let position = 0.5 * (turn.cosine() + 1.0) * (values.len() - 1) as f32;
        let index = (position as usize).min(values.len() - 2);
        let t = position - index as f32;
        values[index] * (1.0 - t) + values[index + 1] * t
    }

    #[inline]
    fn sample(&self, direction: Vec3, stream: &mut Stream) -> Vec3 {
        let Entries { values, sections, .. } = &*self.0;
        let (index, _) = sections.sample(stream.uniform());
        let u = stream.square();
        let position = index as f32 + warp::linear(values[index], values[index + 1], u.x);
        let cosine = (2.0 * position / (values.len() - 1) as f32 - 1.0).clamp(-1.0, 1.0);
        deflect(direction, warp::spherical(cosine, TAU as f32 * u.y))
    }

    fn mean_cosine(&self) -> f32 {
        self.0.mean_cosine
    }
}
