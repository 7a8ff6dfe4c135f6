//! How many samples everybody takes. Where budgets are times, pilots turn them into samples once, and what they found is
//! written down: from then on only the measured times depend on chance of the machine.

use super::{
    contender::{Entry, How, Renderer},
    question::{Effort, Question},
    unit,
};
use crate::{error::Result, passes::budget::Budget};
use serde::{Deserialize, Serialize};
use std::time::Duration;

/// A question and what is planned for its scenes so far.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Plan {
    /// The question.
    pub question: Question,
    /// One entry a scene, in their order; fewer as long as not all are planned.
    pub scenes: Vec<ScenePlan>,
}

/// What is planned for a scene.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct ScenePlan {
    /// Every contender's part.
    pub contenders: Vec<Part>,
    /// How the reference is made, by one renderer or several; none where it is read from a file.
    pub reference: Vec<Batches>,
}

/// A contender's part.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Part {
    /// Budgets in samples per pixel, in growing order.
    Budgets(Vec<u64>),
    /// It cannot render the scene: why.
    Refused(String),
}

/// A reference, or its part by one renderer, in independent batches.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Batches {
    /// What renders it.
    pub how: How,
    /// The contender that has the same strategies or is the same renderer, if any.
    pub like: Option<String>,
    /// How many, two at least.
    pub count: u64,
    /// Samples per pixel of each.
    pub samples: u64,
}

impl Plan {
    /// Nothing planned yet.
    pub fn new(question: Question) -> Self {
        Self { question, scenes: Vec::new() }
    }
}

/// At most `count` budgets in samples per pixel, each half of the next, that end near `largest` (exactly there if
/// `exact`, else so that they double exactly).
pub fn budgets(largest: u64, count: u32, exact: bool) -> Vec<u64> {
    let finest = 1u64 << (count - 1).min(63);
    let largest = match largest.max(1) {
        largest if exact => largest,
        largest if largest < finest => 1 << largest.ilog2(),
        largest => largest / finest * finest,
    };
    (0..count.min(64)).rev().map(|k| largest >> k).filter(|samples| *samples > 0).collect()
}

/// The seed of pilots: none of a render's.
const PILOT_SEED: u64 = 1 << 62;
/// No pilot needs more samples per pixel.
const PILOT_SAMPLES: u64 = 1 << 20;

/// The part of the wanted time that a pilot takes at most.
const PILOT_PART: f64 = 0.25;

/// Samples per pixel that `effort` buys `entry`: as many as are requested, or measured by a pilot of a quarter of the
/// time. Another renderer always shows first that it can render the scene; as what it spends on starting a pass may exceed
/// what few samples take, its pilot counts from half of that quarter on.
pub fn samples(entry: &Entry, effort: Effort, first_seed: u64) -> Result<u64> {
    let seed = first_seed ^ PILOT_SEED;
    let (seconds, is_timed) = match effort {
        Effort::Samples(_) => (0.0, false),
        Effort::Seconds(seconds) => (seconds, true),
    };
    let each = match &entry.renderer {
        Renderer::Own { .. } if !is_timed => 0.0,
        Renderer::Own { .. } => {
            let time = Some(Duration::from_secs_f64((PILOT_PART * seconds).clamp(1e-3, 60.0)));
            let budget = Budget { time, ..Budget::samples(PILOT_SAMPLES) };
            let image = unit::pilot(entry, seed, budget)?;
            image.map_or(f64::INFINITY, |image| image.elapsed.as_secs_f64() / image.samples())
        }
        Renderer::External(external) => {
            let mut spp = 1;
            loop {
                let rendered = external.render(seed, &[spp])?;
                let taken = rendered.seen[0].snapshot.elapsed.as_secs_f64().max(1e-6);
                if taken >= 0.5 * PILOT_PART * seconds || spp >= PILOT_SAMPLES {
                    break taken / spp as f64;
                }
                spp = (2 * spp).max((spp as f64 * PILOT_PART * seconds / taken) as u64).min(PILOT_SAMPLES);
            }
        }
    };
    Ok(match effort {
        Effort::Samples(samples) => samples.max(1),
        Effort::Seconds(seconds) => (seconds / each).round().max(1.0) as u64,
    })
}

/// Relative variance of few samples of `entry`, the same number for everybody; NaN if unknown.
pub fn variance(entry: &Entry, first_seed: u64) -> f64 {
    const SAMPLES: u64 = 16;
    let budget = Budget::samples(SAMPLES);
    // What goes wrong here goes wrong again, and is told, where images count.
    let image = unit::pilot(entry, first_seed ^ PILOT_SEED, budget).ok().flatten();
    image.and_then(|image| image.noise).map_or(f64::NAN, |noise| noise.error * noise.error)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn budgets_double() {
        assert_eq!(budgets(64, 4, true), [8, 16, 32, 64]);
        assert_eq!(budgets(100, 3, true), [25, 50, 100]);
        assert_eq!(budgets(4, 6, true), [1, 2, 4]);
        assert_eq!(budgets(101, 4, false), [12, 24, 48, 96]);
        assert_eq!(budgets(7, 6, false), [1, 2, 4]);
        assert_eq!(budgets(0, 1, false), [1]);
    }
}
