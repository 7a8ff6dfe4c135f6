//! Stopping where every pixel's error is small enough (P03T A.2.3), without bias.
//!
//! A pixel that stops because its own samples look calm stops too soon where they happened to be low: its mean is
//! biased. Hence two halves of independent passes. A pixel's mean over one half ends where the *other* half's samples
//! say that the error is small enough: the decision to stop is independent of the samples that are averaged.
//!
//! The contributions of light subpaths to the film are a mean over passes too, of all pixels at once. For a half it
//! ends when the last pixel of the other half has converged.

use super::{image::Progress, monitor::Stopwatch, subject::Stage, sums::halves::Halves};
use crate::error::Result;
use std::time::Duration;

/// Passes up to the next check over those up to the last. Checks are few, so that chance has few opportunities to stop
/// early.
const GROWTH: f64 = 1.25;

/// A render to a precision at work.
pub(super) struct Adaptive<'a, 's> {
    pub stage: &'a Stage<'s>,
    pub stopwatch: &'a Stopwatch,
    /// Called now and then; the halves that it sees last are those to resume from.
    pub watch: &'a mut dyn FnMut(Progress, &Halves),
}

impl Adaptive<'_, '_> {
    /// Goes on from `halves` until every pixel has converged or the budget is spent.
    pub(super) fn run(mut self, halves: &mut Halves) -> Result<()> {
        let before = halves.elapsed + self.stage.instrument.settings.budget.spent;
        while halves.active.contains(&true) {
            if !self.advance(halves, before)? {
                self.tell(halves, true);
                // After `tell`: a resumed render checks after other numbers of passes.
                halves.look();
                return Ok(());
            }
            halves.look();
            halves.goal = (halves.goal + 1).max((halves.goal as f64 * GROWTH) as u64);
        }
        self.tell(halves, true);
        Ok(())
    }

    /// Renders until both halves have passes up to the next check; false if the budget ends before. An unfinished pass is
    /// left out of the image, unless it is the first.
    fn advance(&mut self, halves: &mut Halves, before: Duration) -> Result<bool> {
        let (stage, stopwatch) = (self.stage, self.stopwatch);
        let (budget, count) = (stage.instrument.settings.budget, stage.instrument.compiled.blocks().count());
        let end = budget.samples_per_pixel.unwrap_or(u64::MAX).min(2 * halves.goal);
        let is_over = || budget.is_over(stopwatch.elapsed());
        // Which pixels are active changes at checks only.
        let active = halves.active.clone();
        while halves.passes() < end {
            let first = halves.passes();
            let is_done = stage.show(first, |instrument, most| {
                let last = end.min(first.saturating_add(most as u64)) as usize;
                let tasks = first as usize * count + halves.blocks..last * count;
                let render = |pass, block| instrument.render(pass, block, &|pixel: usize| active[pixel]);
                let pass = |task| task / count;
                let done = instrument.work_in_turn(tasks.clone(), pass, is_over, render, |_, outcomes| {
                    outcomes.iter().for_each(|outcome| halves.add(outcome, count));
                    halves.elapsed = before + stopwatch.elapsed();
                    self.tell(halves, false);
                });
                done >= tasks.len() && !is_over()
            })?;
            if !is_done {
                return Ok(false);
            }
        }
        Ok(end == 2 * halves.goal)
    }

    fn tell(&mut self, halves: &Halves, is_last: bool) {
        (self.watch)(halves.progress(self.stopwatch.elapsed(), is_last), halves);
    }
}
