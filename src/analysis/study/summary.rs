//! From the numbers of all seeds to what is reported: means, intervals, slopes, and what gives cause for
//! doubt.

use super::{
    reference::Truth,
    unit::{Measured, Slot, Unit},
};
use crate::analysis::{
    interval::{self, Mean},
    study::outcome::{Apart, Chosen, ContenderOutcome, Interval, Point},
};
use std::path::PathBuf;

/// What all seeds of one contender gave.
pub struct Turns<'a> {
    /// As shown.
    pub name: &'a str,
    /// Its first render.
    pub first: Slot<'a>,
    /// One a seed, the first first.
    pub units: &'a [Unit],
}

/// Sums up a contender; `first` is the one that others are compared with.
pub fn contender(
    turns: &Turns<'_>,
    first: Option<&[Unit]>,
    truth: &Truth,
    mut notes: Vec<String>,
    confidence: f64,
) -> ContenderOutcome {
    let units = turns.units;
    let count = units.first().map_or(0, |unit| unit.points.len());
    let points: Vec<Point> = (0..count).map(|index| point(turns, index, confidence)).collect();
    if units.iter().any(|unit| unit.is_timed_outside) {
        notes.push("its seconds are those of the whole command, start included: it reports none".to_owned());
    }
    let apart = apart(&last_of(units), truth);
    if let Some(last) = points.last() {
        notes.extend(doubts(&last_of(units), last, apart, truth));
    }
    ContenderOutcome {
        name: turns.name.to_owned(),
        load_seconds: units.first().and_then(|unit| unit.load_seconds),
        slope: slope(units, confidence),
        efficiency: interval::bootstrap(units.len(), confidence, |picks| 1.0 / cost(units, picks)),
        ratio: first.map(|first| ratio(units, first, confidence)),
        points,
        chosen: chosen(units),
        apart,
        variance: variance_image(turns.first.scene, turns.first.contender),
        notes,
    }
}

/// Where a contender's variance lies, beside `study.json`.
pub fn variance_image(scene: &str, contender: &str) -> PathBuf {
    PathBuf::from(format!("images/{scene}/{contender}/variance.exr"))
}

fn point(turns: &Turns<'_>, index: usize, confidence: f64) -> Point {
    let all =
        |of: fn(&Measured) -> f64| turns.units.iter().map(|unit| of(&unit.points[index])).collect::<Vec<_>>();
    let positive = |of| interval::positive(&all(of), confidence);
    let cpu: Option<Vec<f64>> = turns.units.iter().map(|unit| unit.points[index].cpu_seconds).collect();
    Point {
        samples: turns.units[0].points[index].samples,
        seconds: positive(|m| m.seconds),
        cpu_seconds: cpu.map(|all| interval::positive(&all, confidence)),
        mse: positive(|m| m.mse),
        relmse: positive(|m| m.relmse),
        trimmed_relmse: positive(|m| m.trimmed_relmse),
        mape: positive(|m| m.mape),
        smape: positive(|m| m.smape),
        difference: interval::plain(&all(|m| m.difference), confidence),
        image: turns.first.shown_image(index),
    }
}

/// What the first seed did, and how many did otherwise.
fn chosen(units: &[Unit]) -> Option<Chosen> {
    let first = units.first()?.plan.as_ref()?;
    let otherwise = units.iter().filter(|unit| unit.plan.as_ref() != Some(first)).count() as u64;
    Some(Chosen { what: first.clone(), otherwise, seeds: units.len() as u64 })
}

/// The mean of the images of the last budget, from that of the reference.
fn apart(last: &[&Measured], truth: &Truth) -> Option<Apart> {
    let difference = Mean::of(&last.iter().map(|m| m.difference).collect::<Vec<_>>());
    let error = difference.error.hypot(truth.mean_error.unwrap_or(0.0)).hypot(ROUNDING);
    let errors = difference.value / error;
    let limit = interval::quantile(difference.freedom, SURE);
    errors.is_finite().then_some(Apart { errors, limit })
}

/// The mean over seeds of the slope of each seed's own curve: its points share samples, seeds share nothing.
fn slope(units: &[Unit], confidence: f64) -> Option<Interval> {
    let of =
        |unit: &Unit| interval::slope(&unit.points.iter().map(|m| (m.seconds, m.relmse)).collect::<Vec<_>>());
    let slopes: Option<Vec<f64>> = units.iter().map(of).collect();
    slopes.map(|slopes| interval::plain(&slopes, confidence))
}

fn last_of(units: &[Unit]) -> Vec<&Measured> {
    units.iter().filter_map(|unit| unit.points.last()).collect()
}

/// Mean relMSE times mean time (s) at the last budget, of the seeds `picks`.
fn cost(units: &[Unit], picks: &[usize]) -> f64 {
    let last = |pick: &usize| units[*pick].points.last();
    let sum =
        |of: fn(&Measured) -> f64| picks.iter().filter_map(last).map(of).sum::<f64>() / picks.len() as f64;
    sum(|m| m.relmse) * sum(|m| m.seconds)
}

fn ratio(units: &[Unit], first: &[Unit], confidence: f64) -> Interval {
    interval::bootstrap(units.len(), confidence, |picks| cost(first, picks) / cost(units, picks))
}

/// A mean this far off by chance alone is seen once in a thousand studies.
const SURE: f64 = 0.999;
/// What single precision may do to a mean, relative.
const ROUNDING: f64 = 1e-5;
/// An error this many times that of the reference is nearly all the contender's own.
const FAR_ABOVE: f64 = 10.0;

/// What the last budget gives cause to say.
fn doubts(last: &[&Measured], point: &Point, apart: Option<Apart>, truth: &Truth) -> Vec<String> {
    let mut doubts = Vec::new();
    let broken = last.iter().filter(|m| !m.mse.is_finite()).count();
    if broken > 0 {
        doubts.push(format!("{broken} of its {} images hold NaN or infinite values", last.len()));
    }
    if apart.is_some_and(|apart| !apart.is_chance()) {
        let percent = 100.0 * point.difference.mean;
        let why = "light that it leaves out or finds too seldom, bias, or a reference that is off";
        doubts.push(format!("its mean differs from the reference's by {percent:+.2} %: {why}"));
    }
    let own = truth.own_relmse.unwrap_or(0.0);
    if own > 0.0 && point.relmse.mean < FAR_ABOVE * own {
        let (found, times) = (point.relmse.mean, point.relmse.mean / own);
        let what = "part of its error is the reference's";
        doubts
            .push(format!("its relMSE of {found:.3e} is only {times:.1} times the reference's own: {what}"));
    }
    doubts
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{analysis::picture::Picture, math::Spectrum};

    fn measured(samples: u64, relmse: f64, difference: f64) -> Measured {
        let seconds = 0.01 * samples as f64;
        Measured {
            samples,
            seconds,
            cpu_seconds: Some(2.0 * seconds),
            mse: relmse,
            relmse,
            trimmed_relmse: relmse,
            mape: relmse,
            smape: relmse,
            difference,
        }
    }

    fn units(scale: f64, bias: f64) -> Vec<Unit> {
        let noise = |seed: u64| 1.0 + 0.1 * (seed as f64 - 1.5);
        let at = |seed: u64, n: u64| measured(n, scale * noise(seed) / n as f64, bias * noise(seed));
        let points = |seed| [1, 2, 4, 8].map(|n| at(seed, n)).to_vec();
        (0..4)
            .map(|seed| Unit {
                seed,
                load_seconds: None,
                is_timed_outside: false,
                plan: Some("pt".into()),
                points: points(seed),
            })
            .collect()
    }

    fn truth(own: f64) -> Truth {
        let picture = Picture::new(1, 1, vec![Spectrum::ONE]);
        Truth {
            picture,
            how: String::new(),
            own_relmse: Some(own),
            mean_error: Some(0.0),
            known_by: None,
            apart: None,
            notes: Vec::new(),
        }
    }

    fn sum_up(units: &[Unit], first: Option<&[Unit]>, own: f64) -> ContenderOutcome {
        let slot = Slot { scene: "a", contender: "b", seed: 0 };
        contender(&Turns { name: "b", first: slot, units }, first, &truth(own), Vec::new(), 0.95)
    }

    #[test]
    fn an_unbiased_contender_has_slope_minus_one_and_no_notes() {
        let found = sum_up(&units(1.0, 0.0), None, 1e-6);
        let slope = found.slope.unwrap();
        assert!((slope.mean + 1.0).abs() < 1e-9, "{slope:?}");
        // relMSE x seconds is 0.01 in the mean.
        assert!((found.efficiency.mean - 100.0).abs() < 1e-6, "{:?}", found.efficiency);
        assert!(found.notes.is_empty() && found.ratio.is_none(), "{:?}", found.notes);
        let (cpu, wall) = (found.points[2].cpu_seconds.unwrap(), found.points[2].seconds);
        assert!((cpu.mean - 2.0 * wall.mean).abs() < 1e-12, "{cpu:?}");
        assert!(found.apart.unwrap().is_chance(), "{:?}", found.apart);
        assert_eq!(found.points[2].image, PathBuf::from("images/a/b/2.exr"));
    }

    #[test]
    fn bias_a_bad_reference_and_broken_images_are_told() {
        assert!(sum_up(&units(1.0, 0.05), None, 1e-6).notes[0].contains("+5.00 %"));
        assert!(sum_up(&units(1.0, 0.0), None, 0.1).notes[0].contains("only 1.2 times"));
        let mut broken = units(1.0, 0.0);
        broken[1].points[3].mse = f64::NAN;
        assert!(sum_up(&broken, None, 1e-6).notes[0].contains("1 of its 4 images"));
    }

    #[test]
    fn what_seeds_choose_and_what_some_of_them_do_not_know() {
        let mut units = units(1.0, 0.05);
        units[2].plan = Some("bdpt".into());
        units[3].points[1].cpu_seconds = None;
        let found = sum_up(&units, None, 1e-6);
        let chosen = found.chosen.unwrap();
        assert_eq!((chosen.what.as_str(), chosen.otherwise, chosen.seeds), ("pt", 1, 4));
        assert_eq!(chosen.sentence(), "pt; 1 of 4 seeds chose otherwise");
        let known: Vec<bool> = found.points.iter().map(|point| point.cpu_seconds.is_some()).collect();
        assert_eq!(known, [true, false, true, true]);
        let apart = found.apart.unwrap();
        assert!(!apart.is_chance() && apart.errors > 0.0, "{apart:?}");
    }

    /// The noise of paired seeds cancels: the ratio has no interval at all.
    #[test]
    fn ratios_are_paired() {
        let (first, second) = (units(3.0, 0.0), units(1.0, 0.0));
        let ratio = sum_up(&second, Some(&first), 1e-6).ratio.unwrap();
        assert!((ratio.low - 3.0).abs() < 1e-9 && (ratio.high - 3.0).abs() < 1e-9, "{ratio:?}");
    }
}
